"""What cannot be described or solved is refused with the name, the place and the value."""

import dataclasses
import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from flat import built_in
from kinds import Kind
from numpy.typing import NDArray
from reach_of_accuracy import off

import absolute
from absolute import DescriptionError, InputError

Array = NDArray[np.float64]
Table = dict[str, tuple[float, float, float]]


@pytest.mark.parametrize(
    "bad", [(1.0, 2.0), (1.0, np.nan, 2.0), (np.inf, 0.0, 0.0), "abc", None, ((1, 2, 3),)]
)
def test_a_point_needs_three_finite_numbers(kind: Kind, bad: Any) -> None:
    with pytest.raises(DescriptionError, match="wheel_centre") as caught:
        kind.build({**kind.car, "wheel_centre": bad})
    assert caught.value.name == "wheel_centre"


@pytest.mark.parametrize(
    ("moved", "onto"),
    [
        ("lower_arm_rear", "lower_arm_front"),
        ("lower_ball_joint", "lower_arm_front"),
        ("strut_lower", "lower_ball_joint"),
        ("strut_rod_end", "strut_top"),
        ("tie_rod_outer", "tie_rod_inner"),
    ],
)
def test_coincident_points_of_an_axis_are_refused(
    table: Table, held: Callable[[float, float], dict[str, Array]], moved: str, onto: str
) -> None:
    with pytest.raises(DescriptionError, match=f"{moved}|{onto}"):
        absolute.solve(
            built_in("macpherson", {**table, moved: table[onto]}, closure="collinear"), held(1.6, 0.0)
        )


def test_nearly_coincident_points_of_an_axis_are_refused(
    table: Table, held: Callable[[float, float], dict[str, Array]]
) -> None:
    x, y, z = table["lower_ball_joint"]
    with pytest.raises(DescriptionError, match="apart"):
        absolute.solve(
            built_in("macpherson", {**table, "strut_lower": (x, y, z + 1e-7)}, closure="collinear"),
            held(1.6, 0.0),
        )


def test_directions_are_checked(kind: Kind) -> None:
    with pytest.raises(DescriptionError, match="right angle"):
        kind.build(kind.car, up=(0, 0, 1), right=(0, 1, 0.1))
    with pytest.raises(DescriptionError, match="up is"):
        kind.build(kind.car, up=(0, 0, 0))
    with pytest.raises(DescriptionError, match="right is"):
        kind.build(kind.car, right=(0, np.nan, 0))


def test_ball_joint_on_its_own_pivot_axis_is_singular(
    table: Table, held: Callable[[float, float], dict[str, Array]]
) -> None:
    front, rear = np.array(table["lower_arm_front"]), np.array(table["lower_arm_rear"])
    ball, top = 0.4 * front + 0.6 * rear, np.array(table["strut_top"])
    # The strut is drawn along its own line, so that nothing else is wrong.
    drawn = {
        "lower_ball_joint": ball,
        "strut_lower": 0.9 * ball + 0.1 * top,
        "strut_rod_end": 0.5 * (ball + top),
    }
    with pytest.raises(absolute.SingularError, match="condition number") as caught:
        absolute.solve(built_in("macpherson", {**table, **drawn}, closure="collinear"), held(1.6, 0.0))
    assert caught.value.instant is None


def test_exact_limit_of_the_motion_is_refused(
    table: Table, held: Callable[[float, float], dict[str, Array]]
) -> None:
    # With a pivot axis along x the ball joint is highest straight above it, and goes no further.
    level = {**table, "lower_arm_rear": (540.0, -5.0, -10.0)}
    d = np.subtract(level["lower_ball_joint"], level["lower_arm_front"])
    angle = float(np.arccos(np.hypot(d[1], d[2]) / np.linalg.norm(d)))
    with pytest.raises(absolute.PoseError):
        absolute.solve(built_in("macpherson", level, closure="collinear"), held(angle, 0.0))


def test_row_count_must_match_the_unknowns(strut: absolute.Model) -> None:
    fewer = {name: joint for name, joint in strut.joints.items() if name != "ball joint lower_ball_joint"}
    with pytest.raises(DescriptionError, match=r"21 rows for 24 unknown.*add"):
        dataclasses.replace(strut, joints=fewer)
    extra = {**strut.inputs, "again": strut.inputs["rack"]}
    twice = dataclasses.replace(strut, inputs=extra)
    still = {"arm_angle": np.array([[1.4, 0.0, 0.0]]), "rack": np.zeros((1, 3))}
    with pytest.raises(DescriptionError, match=r"25 rows for 24 unknown.*remove"):
        absolute.solve(twice, still)


@pytest.mark.parametrize(
    ("inputs", "say"),
    [
        ({"arm_angle": np.zeros((2, 3))}, "missing: \\['rack'\\]"),
        (
            {"arm_angle": np.zeros((2, 3)), "rack": np.zeros((2, 3)), "steer": np.zeros((2, 3))},
            "unknown: \\['steer'\\]",
        ),
        ({"arm_angle": np.zeros((2, 3)), "rack": np.zeros((3, 3))}, "instants"),
        ({"arm_angle": np.zeros((2, 3)), "rack": np.zeros(2)}, "shape"),
        ({"arm_angle": np.zeros((2, 2)), "rack": np.zeros((2, 3))}, "shape"),
        ({"arm_angle": np.zeros((2, 3)), "rack": [["a", "b", "c"]]}, "not an array of numbers"),
        ({"arm_angle": np.zeros((2, 3)), "rack": np.array([[0, 0, 0], [0, np.inf, 0]])}, "instant 1"),
    ],
)
def test_inputs_of_wrong_name_shape_or_value_are_refused(
    strut: absolute.Model, inputs: Any, say: str
) -> None:
    with pytest.raises(InputError, match=say):
        absolute.solve(strut, inputs)


@pytest.mark.parametrize(
    "chassis", [np.zeros((1, 3)), np.zeros((2, 3, 3)), np.full((1, 3, 3), np.nan), "still"]
)
def test_chassis_motion_is_checked(
    strut: absolute.Model, held: Callable[[float, float], dict[str, Array]], chassis: Any
) -> None:
    with pytest.raises(InputError, match="chassis") as caught:
        absolute.solve(strut, held(1.6, 0.0), chassis=chassis)
    assert caught.value.name == "chassis"


def test_every_refusal_is_of_one_family() -> None:
    for error in (
        DescriptionError,
        InputError,
        absolute.AssemblyError,
        absolute.UnreachableError,
        absolute.SingularError,
    ):
        assert issubclass(error, absolute.AbsoluteError)


def test_errors_models_and_solutions_travel_between_processes(
    strut: absolute.Model, held: Callable[[float, float], dict[str, Array]]
) -> None:
    with pytest.raises(absolute.UnreachableError) as caught:
        absolute.solve(strut, held(1.6, 500.0))
    copy = pickle.loads(pickle.dumps(caught.value))
    assert (str(copy), copy.instant, copy.reached) == (str(caught.value), 0, caught.value.reached)
    again = absolute.solve(pickle.loads(pickle.dumps(strut)), held(1.6, 5.0))
    solution = pickle.loads(pickle.dumps(again))
    assert (solution.position["wheel_centre"] == again.position["wheel_centre"]).all()


def test_results_and_descriptions_cannot_be_changed(
    strut: absolute.Model, held: Callable[[float, float], dict[str, Array]]
) -> None:
    motion = absolute.solve(strut, held(1.6, 0.0), conditions=True)
    for array in (
        motion.position["strut_top"],
        motion.velocity["wheel_centre"],
        motion.residual,
        motion.iterations,
    ):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0
    with pytest.raises(TypeError):
        strut.points["strut_top"] = (0, 0, 0)


@pytest.mark.parametrize("instant", [0, 1, 300])
@pytest.mark.parametrize(
    ("name", "fast"), [("arm_angle", [1e200, 0.0]), ("rack", [1e300, 1e308]), ("rack", [0.0, 1.7e308])]
)
def test_rates_too_large_for_floating_point_are_refused_with_their_input_and_instant(
    strut: absolute.Model, name: str, fast: list[float], instant: int
) -> None:
    # Of two seconds, so that instants before the 256th and after it are solved apart.
    inputs = {"arm_angle": np.tile([1.6, 0.1, 0.2], (302, 1)), "rack": np.tile([5.0, 0.3, 0.4], (302, 1))}
    inputs[name][instant, 1:] = fast
    with pytest.raises(InputError, match=f"instant {instant}: ") as caught:
        absolute.solve(strut, inputs)
    assert (caught.value.name, caught.value.instant) == (name, instant)
    assert caught.value.value == [[column[instant, k] for column in inputs.values()] for k in (1, 2)]
    kept = caught.value.partial
    assert (0 if kept is None else len(kept.residual)) == instant


@pytest.mark.parametrize("fast", np.logspace(150.0, 155.0, 11))
def test_rates_are_finite_or_refused(strut: absolute.Model, fast: float) -> None:
    # The bodies' own numbers, in units of the size, overflow a little later than those of points in mm.
    inputs = {"arm_angle": np.array([[1.6, fast, 0.0]]), "rack": np.zeros((1, 3))}
    # Squared 1e305, times 500 mm and the ratio of arms.
    if fast > 3e152:
        with pytest.raises(InputError, match="overflow"):
            absolute.solve(strut, inputs)
    else:
        motion = absolute.solve(strut, inputs)
        assert all(np.isfinite(array).all() for array in motion.acceleration.values())


@pytest.mark.parametrize("tiny", [1e-258, 1e-160, 5e-324])
def test_tiny_inputs_are_as_good_as_none(strut: absolute.Model, tiny: float) -> None:
    inputs = {"arm_angle": np.array([[1.6, tiny, tiny]]), "rack": np.full((1, 3), tiny)}
    none = {"arm_angle": np.array([[1.6, 0.0, 0.0]]), "rack": np.zeros((1, 3))}
    motion, still = absolute.solve(strut, inputs), absolute.solve(strut, none)
    for name in strut.points:
        # Size 500 mm, condition number below 60, two roundings.
        rounding = 2 * np.finfo(float).eps * 500 * 60
        assert np.allclose(motion.position[name], still.position[name], rtol=0, atol=rounding)
        assert (np.abs(motion.velocity[name]) <= 1e6 * tiny).all()
        assert (np.abs(motion.acceleration[name]) <= 1e6 * tiny).all()


@pytest.mark.parametrize("fast", [1e6, 1e12, 1e100])
def test_huge_rates_give_rates_in_proportion(strut: absolute.Model, fast: float) -> None:
    def moving(scale: float) -> absolute.Solution:
        # Time runs faster by `scale`: rates by it, accelerations by its square.
        scales = np.array([1.0, scale, scale**2])
        arm, rack = np.array([[1.6, 0.25, 0.1]]) * scales, np.array([[10.0, 5.0, 2.0]]) * scales
        return absolute.solve(strut, {"arm_angle": arm, "rack": rack}, conditions=True)

    plain, quick = moving(1.0), moving(fast)
    for name in strut.points:
        speed, second = (
            np.abs(getattr(quick, quantity)[name] / scale - getattr(plain, quantity)[name])
            for quantity, scale in (("velocity", fast), ("acceleration", fast**2))
        )
        # Rates of both are off as their places are, and rates of the inputs are below 1 rad/s.
        assert speed.max() <= 2.0 * off(plain)[0]
        assert second.max() <= 2.0 * off(plain)[0]
