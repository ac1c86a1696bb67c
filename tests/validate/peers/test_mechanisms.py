"""Mechanisms in trees of joints: ends of motions, refusals, assemblies.

tests/mechanisms/test_formulations.py compares every shipped mechanism with the reference.
"""

from typing import Any

import numpy as np
import pytest
from every_number import TURNED, asked
from mechanism_files import mechanism_file, plain, plain_scene

from pointcoord import Scene
from pointcoord.drawing_stands import drawn_inputs
from pointcoord.effects.registry import EFFECTS
from pointcoord.numerics.arrays import Array
from validate.comparison.compare import compare
from validate.errors import NoAnswer
from validate.peers.in_exudyn import InExudyn
from validate.peers.in_mujoco import InMujoco
from validate.peers.in_pinocchio import InPinocchio
from validate.peers.motion import Motion
from validate.reference.effects.wheel import OF_POSITIONS
from validate.spanning_tree.cut import cut


def plain_car(scene: str) -> dict[str, Any]:
    """The flat description of a shipped car by arm angle and rack."""
    return plain_scene(scene, ("arm_angle", "rack"))


def held(values: Array) -> Array:
    """An input with these values, without rates."""
    return np.stack([values, 0.0 * values, 0.0 * values], axis=-1)


def solved(mechanism: Any, laws: dict[str, Array], program_of: Any = InPinocchio) -> Motion:
    tree = cut(mechanism)
    program = program_of(tree)
    return program.motion(tree.series(laws), 1e-12, program.closed(1e-12))


def test_rows_that_depend_on_others_are_left_out_and_looked_at_in_every_pose() -> None:
    """The Bricard mechanism moves although its rows are as many as its joints."""
    mechanism = plain_scene("bricard")
    laws = {name: held(np.linspace(0.0, 0.5, 6)) for name in mechanism["inputs"]}
    solved(mechanism, laws)
    # With errors of 1e-7 mm the rows stay dependent to rounding in the drawing, but not in the motion.
    rng = np.random.default_rng(3)
    for point, place in mechanism["points"].items():
        mechanism["points"][point] = (np.array(place) + 1e-7 * rng.standard_normal(3)).tolist()
    with pytest.raises(NoAnswer, match="violates closures that are dependent in the drawing"):
        solved(mechanism, laws)


def test_a_way_that_is_blocked_between_two_poses_is_refused_and_the_way_round_is_taken() -> None:
    """Below a rack travel of -0.0029 mm the paper's arm cannot pass 35.1 degrees, above it can."""

    def reached(*places: tuple[float, float]) -> Motion:
        angles, racks = np.array(places).T
        return solved(plain_car("bounce"), {"arm_angle": held(np.deg2rad(angles)), "rack": held(racks)})

    assert len(reached((37.0, -0.1), (37.0, 0.1), (34.0, 0.1), (34.0, -0.1)).inputs) == 4
    with pytest.raises(NoAnswer, match="lock each other") as caught:
        reached((37.0, -0.1), (34.0, -0.1))
    assert caught.value.instant == 1
    assert "tie_rod" in caught.value.links
    # The arm ends at 35.27 degrees there.
    assert np.rad2deg(caught.value.reached["arm_angle"]) == pytest.approx(35.27, abs=0.005)


def test_inputs_that_are_too_many_or_too_few_are_refused() -> None:
    mechanism = plain_car("bounce")
    mechanism["inputs"]["again"] = dict(mechanism["inputs"]["arm_angle"])
    with pytest.raises(NoAnswer, match="does not move the mechanism in addition to the others"):
        InPinocchio(cut(mechanism)).closed(1e-12)
    del mechanism["inputs"]["again"], mechanism["inputs"]["rack"]
    with pytest.raises(NoAnswer, match="is free to move as drawn"):
        InPinocchio(cut(mechanism)).closed(1e-12)


@pytest.mark.parametrize("wrong", [np.nan, None])
def test_an_input_that_is_no_number_or_missing_is_refused_with_its_instant(wrong: float | None) -> None:
    laws = {name: held(np.full(9, value)) for name, value in drawn_inputs(Scene.load("bounce")).items()}
    if wrong is None:
        del laws["rack"]
    else:
        laws["rack"][7, 0] = wrong
    with pytest.raises(NoAnswer, match="rack") as caught:
        cut(plain_car("bounce")).series(laws)
    assert caught.value.instant == (None if wrong is None else 7)


def parallelogram(apart: float) -> Any:
    """Two cranks of 1 m that a coupler keeps parallel, or crossed from where all lie in one line."""
    mechanism = plain_scene("n-four-bar")
    del mechanism["bodies"]["crank_2"], mechanism["rods"]["coupler_2"]
    mechanism["bodies"]["chassis"] = ["A0", "A0_pin", "A1", "A1_pin"]
    kept = {name for points in mechanism["bodies"].values() for name in points}
    moved = {"A1": [apart, 0, 0], "A1_pin": [apart, 0, 1000], "B1": [apart, 1000, 0]}
    mechanism["points"] = {n: moved.get(n, p) for n, p in mechanism["points"].items() if n in kept}
    return mechanism


@pytest.mark.parametrize("program_of", [InPinocchio, InMujoco, InExudyn])
@pytest.mark.parametrize(("apart", "count"), [(500.0, 7), (1000.0, 2), (1000.0, 101), (2000.0, 5)])
def test_a_way_does_not_go_over_to_a_branch_that_crosses_it(
    program_of: Any, apart: float, count: int
) -> None:
    """The determinant changes its sign if the cranks stay parallel, and keeps it if they cross."""
    turns = np.linspace(0.0, 3.0, count)
    with pytest.raises(NoAnswer, match="cannot be reached") as caught:
        solved(parallelogram(apart), {"crank": held(turns)}, program_of)
    assert caught.value.reached["crank"] == pytest.approx(0.5 * np.pi, abs=1e-6)
    assert caught.value.partial is None or len(caught.value.partial.inputs) == np.sum(turns < 0.5 * np.pi)


@pytest.mark.parametrize("program_of", [InPinocchio, InMujoco, InExudyn])
def test_a_way_that_turns_back_before_a_fold_is_followed_back(program_of: Any) -> None:
    """The stroke stops 1e-11 mm short of its dead point, where branches meet to rounding, and goes back."""
    mechanism = plain_scene("slider-crank", ["stroke"])
    with pytest.raises(NoAnswer) as caught:
        solved(mechanism, {"stroke": held(np.array([15.0, 75.0]))}, program_of)
    strokes = np.array([15.0, caught.value.reached["stroke"] - 1e-11, 15.0])
    poses = solved(mechanism, {"stroke": held(strokes)}, program_of)
    assert np.abs(poses.coordinates[0] - poses.coordinates[2]).max() < 1e-11


def test_a_wheel_that_lies_flat_or_has_no_radius_has_no_contact_point() -> None:
    tables, points = mechanism_file("five_link"), dict(plain_scene("five-link")["points"])
    tables["inputs"] = {"lift": {"contact": ["wheel_axis_inner", "wheel_centre"]}}
    with pytest.raises(NoAnswer, match="wheel_radius"):
        cut(plain(tables, {"points": points}, ["lift"]))
    x, y, z = points["wheel_centre"]
    points["wheel_axis_inner"] = (x, y, z - 100.0)
    with pytest.raises(NoAnswer, match="lies flat"):
        cut(plain(tables, {"points": points, "wheel_radius": 300.0}, ["lift"]))


@pytest.mark.parametrize("name", ["pushrod", TURNED])
def test_a_tree_gives_every_number_of_a_wheel_that_positions_make(name: str) -> None:
    """tests/mechanisms compares what scenes ask for."""
    scene, known = asked(name), {one.name for one in OF_POSITIONS}
    effects = [one for one in scene.effects if known & {*EFFECTS[one].own_names}]
    outcome = compare(scene.model_copy(update={"effects": effects}), "relative", "reference")
    rows = [row for row in outcome.rows if row.name in known]
    assert len(rows) > 10
    assert [row for row in rows if row.verdict == "not given" or row.share > 1.0] == []


@pytest.mark.parametrize("program_of", [InMujoco, InExudyn, InPinocchio])
def test_an_assembly_on_another_side_than_the_drawings_is_refused(program_of: Any) -> None:
    tree = cut(plain_car("off-axis-strut"))
    driven = np.multiply.outer(tree.drawn_inputs[None], [1.0, 0.0, 0.0])
    engine = program_of(tree)
    home = engine.closed(1e-12)
    assert len(engine.motion(driven, 1e-12, home).coordinates) == 1
    # As if the drawing were on the other side.
    engine.drawn = -engine.drawn
    with pytest.raises(NoAnswer, match="cannot be reached"):
        engine.motion(driven, 1e-12, home)
