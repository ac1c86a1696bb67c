"""A sweep is what its designs are one by one: numbers, reasons, warnings; whichever are beside them."""

import tracemalloc
from typing import Any

import numpy as np
import pytest
from changed_scenes import scene_with
from within_bounds import beyond_claims

from pointcoord import (
    InputOutOfRange,
    PointcoordError,
    SceneError,
    Sweep,
    SweepError,
    UnknownName,
    designs_of,
    grid_of,
    simulate,
    sweep,
    sweep_blocks,
)
from pointcoord.numerics.arrays import Flags
from pointcoord.solve import series_in_inputs, taylor
from pointcoord.sweeping import solving

WISHBONE, STRUT, PAPER = (
    scene_with(name, samples=7) for name in ("double-wishbone", "off-axis-strut", "steer")
)
# Offsets of lower_ball_joint.z, mm: with the last two the car cannot be where the scene begins.
HEIGHTS = (-20.0, 0.0, 7.5, 150.0, 160.0)
SOUND = 3
# With this one it stops 0.15 s into the motion.
STOPS = 125.0


def assert_right(found: Sweep, number: int) -> None:
    """What is proven of a number that is not this design's is as wide as it is wrong."""
    assert beyond_claims(found.proof(number, rates=True)) == []


def test_a_point_of_a_part_is_varied_by_its_whole_name() -> None:
    axle = scene_with("axle-opposed", samples=3, effects=["toe"])
    found = sweep(axle, offsets={"left.tie_rod_outer.z": [0.0, 2.0]})
    change = {side: np.abs(np.diff(found.wheel[f"{side}.toe"], axis=0)).max() for side in ("left", "right")}
    # 2 mm of bump steer at one wheel; the other one stays to rounding.
    assert change["left"] > 1e-4
    assert change["right"] < 1e-13
    with pytest.raises(UnknownName, match=r"no point named 'left.tie_rod_outr'"):
        sweep(axle, offsets={"left.tie_rod_outr.z": [0.0]})


def test_a_design_fails_with_the_words_that_it_has_alone_and_disturbs_no_other() -> None:
    together = sweep(WISHBONE, offsets={"lower_ball_joint.z": (*HEIGHTS, STOPS)})
    assert set(together.failures) == {3, 4, 5}
    assert together.solved.tolist() == [True] * SOUND + [False] * 3
    for channel in together.numbers.values():
        for array in channel.values():
            assert np.isfinite(array[:SOUND]).all()
            assert np.isnan(array[SOUND:]).all()
    sound = sweep(WISHBONE, offsets={"lower_ball_joint.z": HEIGHTS[:SOUND]})
    for number in range(SOUND):
        assert_right(together, number)
        assert_right(sound, number)
    for number, failure in together.failures.items():
        with pytest.raises(PointcoordError) as alone_raised:
            simulate(together.scene(number))
        own = alone_raised.value
        assert type(failure.error) is type(own)
        # The last digits of where a fold is found hang on the steps that led there.
        assert str(failure.error).partition(" at t = ")[0] == str(own).partition(" at t = ")[0]
        assert str(failure.error).partition("limited by")[2] == str(own).partition("limited by")[2]
        assert failure.instant == pytest.approx(own.instant, abs=1e-6)
        with pytest.raises(type(own)):
            together.of(number)


@pytest.mark.parametrize("inputs", [2, 0])
def test_a_design_whose_end_is_not_confirmed_goes_on_without_the_others(
    inputs: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of series in the inputs, and of chains in time."""
    monkeypatch.setattr(series_in_inputs, "INPUTS", inputs)
    right = taylor.confirmed

    def all_but_the_third(*arguments: Any) -> Flags:
        good = np.array(right(*arguments))
        if good.shape[:1] == (9,):
            good[2] = False
        return good

    for module in (taylor, series_in_inputs):
        monkeypatch.setattr(module, "confirmed", all_but_the_third)
    found = sweep(WISHBONE, offsets={"lower_ball_joint.z": np.linspace(-20.0, 20.0, 9)})
    assert found.solved.all()
    for number in (0, 2, 8):
        assert_right(found, number)


@pytest.mark.parametrize(
    ("point", "place"),
    [
        ("wheel_centre", (100.0, -3000.0, 0.0)),
        ("wheel_axis_inner", WISHBONE.mechanism.points["wheel_centre"]),
        ("tie_rod_outer", (np.nan, 0.0, 0.0)),
        ("upper_ball_joint", WISHBONE.mechanism.points["lower_ball_joint"]),
    ],
)
def test_a_drawing_that_is_refused_alone_is_refused_among_others(
    point: str, place: tuple[float, float, float]
) -> None:
    drawn = WISHBONE.mechanism.points[point]
    found = sweep(
        WISHBONE, {point: [drawn, place, drawn], "rack_centre": WISHBONE.mechanism.points["rack_centre"]}
    )
    assert set(found.failures) == {1}
    with pytest.raises(PointcoordError) as alone:
        simulate(found.scene(1))
    said, own = str(found.failures[1].error), str(alone.value)
    title = WISHBONE.title
    assert said.replace("design 1", title) == own.replace("design 1", title)


def test_closing_that_makes_another_car_is_refused_and_less_is_warned_of() -> None:
    rack = STRUT.mechanism.points["rack_centre"]
    found = sweep(STRUT, {"rack_centre": rack}, offsets={"tie_rod_inner.z": [0.0, 0.5, 30.0]})
    assert set(found.failures) == {2}
    assert "that is another car" in str(found.failures[2].error)
    assert found.failures[2].reason == "closing the drawing makes another car of it"
    (note,) = [note for note in found.notes if note.kind == "closing"]
    assert (note.count, note.design) == (1, 1)
    alone = simulate(found.scene(1))
    assert note.words == alone.closing.words
    assert note.words in alone.notes


def test_a_rack_drawn_at_the_end_of_the_tie_rod_goes_along_with_it() -> None:
    assert PAPER.mechanism.points["rack_centre"] == PAPER.mechanism.points["tie_rod_inner"]
    found = sweep(PAPER, offsets={"tie_rod_inner.z": [0.0, 5.0]})
    points = found.scene(1).mechanism.points
    assert points["rack_centre"] == points["tie_rod_inner"]
    held = sweep(PAPER, {"rack_centre.x": 570.0}, offsets={"tie_rod_inner.z": [0.0, 5.0]})
    assert held.scene(1).mechanism.points["rack_centre"] == PAPER.mechanism.points["rack_centre"]


def test_doubts_are_gathered_and_told_of_a_design_that_has_them() -> None:
    offsets = np.zeros(6)
    offsets[[2, 4]] = 800.0
    found = sweep(WISHBONE, offsets={"lower_arm_front.x": offsets})
    doubts = {note.words: note for note in found.notes if "is drawn" in note.words}
    assert len(doubts) == 1
    (note,) = doubts.values()
    assert note.count == 2
    assert note.words in found.scene(note.design).mechanism.doubts
    assert note.design in {2, 4}


def test_a_grid_has_every_combination_once() -> None:
    designs = grid_of(PAPER, offsets={"strut_top.y": [-1.0, 1.0], "tie_rod_outer.z": [0.0, 1.0, 2.0]})
    pairs = designs.varied(np.arange(designs.count))
    x, z = PAPER.mechanism.points["strut_top"][1], PAPER.mechanism.points["tie_rod_outer"][2]
    wanted = [(x + a, z + b) for a in (-1.0, 1.0) for b in (0.0, 1.0, 2.0)]
    assert list(zip(pairs["strut_top.y"], pairs["tie_rod_outer.z"], strict=True)) == wanted


def test_blocks_are_the_sweep_in_parts() -> None:
    heights = np.linspace(-10.0, 10.0, 6)
    whole = sweep(WISHBONE, offsets={"lower_ball_joint.z": heights})
    course = solving.Course.of(whole.designs)
    memory = float(course.bytes_of_a_design + course.bytes_on_the_way)
    blocks = list(sweep_blocks(WISHBONE, offsets={"lower_ball_joint.z": heights}, memory=memory))
    assert len(blocks) > 1
    assert [number for block in blocks for number in block.numbers_of_designs] == list(range(6))
    varied = [height for block in blocks for height in block.varied["lower_ball_joint.z"]]
    assert varied == whole.varied["lower_ball_joint.z"].tolist()
    assert_right(blocks[-1], 5)


def test_blocks_take_no_more_memory_than_is_stated() -> None:
    samples, count, memory = 1001, 40, 30e6
    scene = scene_with("double-wishbone", samples=samples)
    designs = designs_of(scene, offsets={"lower_ball_joint.z": np.linspace(-3.0, 3.0, count)})
    next(sweep_blocks(designs_of(scene)))  # what is made once stays
    tracemalloc.start()
    try:
        blocks = sum(1 for _ in sweep_blocks(designs, memory=memory))
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert blocks > 1
    # The last block is held while the next one is solved.
    assert peak <= 2.0 * memory


def test_a_law_that_all_share_is_refused_as_alone() -> None:
    scene = scene_with("off-axis-strut", laws={"arm_angle": {"constant": 9.0}})
    with pytest.raises(InputOutOfRange, match="arm_angle"):
        sweep(scene, offsets={"strut_top.y": [0.0, 1.0]})


def test_what_makes_no_designs_is_said() -> None:
    with pytest.raises(UnknownName, match=r"did you mean 'lower_ball_joint'"):
        sweep(STRUT, {"lower_bal_joint.z": [1.0]})
    with pytest.raises(UnknownName, match=r"no axis of strut_top named 'w'"):
        sweep(STRUT, {"strut_top.w": [1.0]})
    for points, offsets, problem in (
        ({"strut_top.x": []}, {}, "has no values"),
        ({"strut_top.x": [1.0]}, {"strut_top.x": [1.0]}, "is varied twice"),
        ({"strut_top": [1.0, 2.0]}, {}, r"has the shape \(2,\)"),
        ({"strut_top.x": ["a"]}, {}, "allowed: numbers"),
    ):
        with pytest.raises(SweepError, match=problem):
            sweep(STRUT, points, offsets=offsets)
    with pytest.raises(SweepError, match="is not a coordinate of a grid"):
        sweep(STRUT, {"strut_top": [[1.0, 2.0, 3.0]]}, grid=True)
    with pytest.raises(SweepError, match="use sweep_blocks"):
        sweep(STRUT, offsets={f"strut_top.{axis}": np.linspace(-1, 1, 1000) for axis in "xyz"}, grid=True)
    with pytest.raises(SweepError, match="more memory, or fewer instants"):
        sweep_blocks(STRUT, offsets={"strut_top.x": [0.0]}, memory=1e3)
    with pytest.raises(SceneError, match="not a scene"):
        sweep("steer")
    with pytest.raises(SweepError, match="design 7 is not in this block; allowed: 0 to 0"):
        sweep(STRUT).of(7)


@pytest.mark.parametrize("inputs", [2, 0])
def test_a_law_of_more_swings_than_a_chain_can_follow_is_followed_by_its_inputs_or_design_by_design(
    inputs: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(series_in_inputs, "INPUTS", inputs)
    monkeypatch.setattr(taylor, "MOST_SEGMENTS", 20)
    swings = {"sine": {"amplitude": 5.0, "angular_frequency": 300.0}}
    scene = scene_with("off-axis-strut", laws={"rack": swings}, samples=7, effects=[])
    found = sweep(scene, offsets={"strut_top.y": [1.0]})
    assert found.solved.all()
    assert [note.count for note in found.notes if note.kind == "alone"] == ([] if inputs else [1])
    alone = simulate(found.scene(0))
    assert alone.method == "map"
    for name, places in alone.position.items():
        # Each of the two is within the tolerance; followed alone they are the same numbers.
        difference = np.abs(found.position[name][0] - places).max()
        assert difference <= (2.0 * scene.tolerance if inputs else 0.0)
