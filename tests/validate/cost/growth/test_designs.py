"""Many designs at once are the same cars, and the same answers, as one after the other."""

import numpy as np
import pytest

from pointcoord import Scene, simulate
from validate.closed_drawing import closed_drawing
from validate.cost.growth import designs
from validate.cost.growth.designs import (
    INSTANTS,
    MOVED,
    TOGETHER,
    DesignsInALoop,
    DesignsTogether,
    design_scene,
    designs_of,
)
from validate.cost.growth.task import WrongNumber
from validate.cost.instants import study_instants
from validate.cost.way import Setting
from validate.cost.ways.registry import ways_named

SCENES = ("steer", "off-axis-strut", "double-wishbone", "bounce-on-a-heaving-chassis")


def scene_named(name: str, tolerance: float = 1e-13) -> Scene:
    """A scene of positions only, as fine as series can be cut."""
    return Scene.load(name).model_copy(update={"effects": (), "tolerance": tolerance})


@pytest.mark.parametrize("name", SCENES)
def test_designs_are_different_cars_that_close_as_drawn(name: str) -> None:
    scene = scene_named(name)
    made = designs_of(scene, 5)
    drawn = closed_drawing(scene).places
    for number in range(5):
        closed = closed_drawing(design_scene(scene, made, number))
        # Closed to rounding, and so drawn: 700 mm hold 2^-43 mm, and Newton's last step some of these.
        assert closed.closing is not None
        assert closed.closing.largest <= 64.0 * 2.0**-43
    for point in drawn:
        assert np.abs(made[point][0] - drawn[point]).max() <= 64.0 * 2.0**-43
    moved = max(float(np.abs(made[point][1:] - drawn[point]).max()) for point in drawn)
    assert 0.5 * MOVED < moved < 20.0 * MOVED


def test_a_design_is_the_same_car_in_a_batch_of_any_size(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = scene_named("off-axis-strut")
    few = designs_of(scene, 3)
    monkeypatch.setattr(designs, "BLOCK", 2)
    for point, places in designs_of(scene, 7).items():
        assert np.abs(places[:3] - few[point]).max() <= 64.0 * 2.0**-43


@pytest.mark.parametrize("method", TOGETHER)
@pytest.mark.parametrize("name", SCENES)
def test_designs_together_equal_single_ones_to_rounding(
    name: str, method: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(designs, "BLOCK", 3)
    scene = scene_named(name)
    task = DesignsTogether(scene, method, 4)
    run = task.prepare()
    found = run.output(run.solve())
    instants, made = study_instants(scene, INSTANTS), designs_of(scene, 4)
    for number in range(4):
        motion = simulate(design_scene(scene, made, number))
        proof = motion.proof()
        # What is proven of the single motion is all that it lacks; the batch, solved by the same steps in
        # another order, may lack as much.
        allowed = 2.0 * float((proof.bound + proof.carried_bound).max())
        assert allowed < 1e-10
        for point, places in motion.at(instants).position.items():
            assert np.abs(found[point][number] - places).max() <= allowed, (number, point)
    assert task.check(found) == {}


@pytest.mark.parametrize("method", TOGETHER)
def test_designs_of_one_batch_may_be_measured_in_different_units(method: str) -> None:
    drawn = scene_named("double-wishbone")
    boxes = np.ptp(list(designs_of(drawn, 6).values()), axis=0).max(axis=-1)
    # The longest side of the box about the points just at a power of two, where the unit doubles.
    scale = 512.0 / np.median(boxes)
    points = {name: tuple(scale * x for x in place) for name, place in drawn.mechanism.points.items()}
    scene = drawn.model_copy(update={"mechanism": drawn.mechanism.model_copy(update={"points": points})})
    task = DesignsTogether(scene, method, 6)
    run = task.prepare()
    (block,) = run.blocks
    assert set(block.mechanism.unit) == {512.0, 1024.0}
    assert task.check(run.output(run.solve())) == {}


def test_making_the_designs_is_no_part_of_solving_them(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = scene_named("steer", 1e-9)
    (way,) = ways_named(["series"])
    for task in (DesignsTogether(scene, "series", 5), DesignsInALoop(scene, way, Setting(), 5)):
        designs._of_text.cache_clear()
        task.give()
        with monkeypatch.context() as patch:
            patch.setattr(designs, "designs_of", lambda *_: pytest.fail("made again"))
            run = task.prepare()
            task.check(run.output(run.solve()))


def test_designs_in_a_loop_are_checked_like_designs_together() -> None:
    scene = scene_named("double-wishbone", 1e-9)
    (way,) = ways_named(["series"])
    task = DesignsInALoop(scene, way, Setting("1e-9 mm", 1e-9), 3)
    run = task.prepare()
    solved = run.rates(run.solve())
    output = run.output(solved)
    assert task.check(output) == {}
    one = DesignsInALoop(scene, way, Setting("1e-9 mm", 1e-9), 1).prepare()
    assert run.counts(solved)["segments"] >= 3 * one.counts(one.solve())["segments"] - 3
    output[1], output[2] = output[2], output[1]
    with pytest.raises(WrongNumber, match="of design 1 is"):
        task.check(output)


@pytest.mark.parametrize("wrong", [1e-3, 1e-8, np.nan])
def test_a_wrong_design_is_found_whichever_it_is(wrong: float) -> None:
    scene = scene_named("steer", 1e-9)
    task = DesignsTogether(scene, "series", 6)
    run = task.prepare()
    found = run.output(run.solve())
    for number in range(6):
        spoilt = {point: places.copy() for point, places in found.items()}
        spoilt["tie_rod_outer"][number, 7, 1] += wrong
        with pytest.raises(WrongNumber, match=f"tie_rod_outer of design {number} is"):
            task.check(spoilt)


def test_a_design_that_cannot_follow_stops_the_batch_with_a_reason() -> None:
    far = Scene.load("steer")
    inputs = {**far.inputs, "rack": far.inputs["rack"].model_copy(update={"polynomial": (0.0, 1500.0)})}
    scene = far.model_copy(update={"inputs": inputs, "effects": ()})
    for method, words in (("series", "singular pose"), ("newton", "a design cannot be assembled")):
        run = DesignsTogether(scene, method, 2).prepare()
        with pytest.raises(Exception, match=words):
            run.solve()
