"""A motion stays in the drawn assembly, or it is refused."""

from typing import Any

import numpy as np
import pytest
from mechanism_files import plain_scene
from shipped import Array, Motion, error, exact, off, shipped

import absolute
import absolute.follow
from absolute.newton import Configurations, newton

STRUT, WISHBONE = (
    plain_scene("steer", ["arm_angle", "rack"]),
    plain_scene("double-wishbone", ["arm_angle", "rack"]),
)
MIRROR = np.array([1.0, -1.0, 1.0])


def over(points: dict[str, Array], *planes: tuple[str, str, str, str]) -> dict[str, Array]:
    """Points mirrored in planes through three others: their distances to these stay."""
    points = {name: np.array(place, float) for name, place in points.items()}
    for moved, *through in planes:
        a, b, c = (points[name] for name in through)
        normal = np.cross(b - a, c - a) / np.linalg.norm(np.cross(b - a, c - a))
        points[moved] = points[moved] - 2.0 * ((points[moved] - a) @ normal) * normal
    return points


UPPER = ("upper_ball_joint", "upper_arm_front", "upper_arm_rear", "lower_ball_joint")
OUTER = ("tie_rod_outer", "lower_ball_joint", "upper_ball_joint", "tie_rod_inner")


def short_lower_arm() -> dict[str, Array]:
    """A car whose lower arm meets its dead points before the upper one does; it has eight assemblies."""
    car = {name: np.array(place, float) * MIRROR for name, place in WISHBONE["points"].items()}
    car["lower_arm_front"][1] = car["lower_arm_rear"][1] = -560.0
    car["upper_arm_front"][1] = car["upper_arm_rear"][1] = -250.0
    car["tie_rod_inner"] = np.array([-120.0, -250.0, 225.0])
    return {**car, "rack_centre": car["tie_rod_inner"]}


@pytest.mark.parametrize("below", [False, True])
@pytest.mark.parametrize("planes", [(), (UPPER,), (OUTER,), (UPPER, OUTER)])
def test_each_of_the_eight_assemblies_of_a_double_wishbone_keeps_to_its_own(
    planes: tuple[Any, ...], below: bool
) -> None:
    car = short_lower_arm()
    if below:
        # The lower ball joint on the other side of its arm's axis, at the same height.
        car["lower_ball_joint"][1] = 2.0 * -560.0 - car["lower_ball_joint"][1]
    car = over(car, *planes)
    drawn = absolute.close_drawing(absolute.compile(WISHBONE | {"points": car})).inputs
    t = np.linspace(0.0, 1.0, 4)
    inputs = {
        "arm_angle": np.stack([drawn["arm_angle"] + 0.12 * np.sin(6 * t), 0 * t, 0 * t], -1),
        "rack": np.stack([drawn["rack"] + 12.0 * t, 0 * t, 0 * t], -1),
    }
    motion = Motion(WISHBONE | {"points": car}, inputs)
    solution = motion.solve(rates=False)
    for k, (points, *_) in enumerate(exact(motion)):
        for name, place in solution.position.items():
            assert error(place[k], points[name]) <= off(solution)[k], name


@pytest.mark.parametrize("always", [False, True])
@pytest.mark.parametrize("check", ["signs", "far"])
def test_a_pose_that_left_the_branch_is_led_to_by_nearer_ones_or_refused(
    monkeypatch: pytest.MonkeyPatch, always: bool, check: str
) -> None:
    """Planted faults: a determinant has another sign, or nothing closes; once or always."""
    motion, seen = shipped("bounce-and-steer", 20), 0
    plain, assembled = motion.solve(), absolute.Assembled(absolute.compile(motion.plain))

    def wrong(*arguments: Any) -> Configurations:
        nonlocal seen
        found, seen = newton(*arguments), seen + 1
        if not always and seen > 2:
            return found
        if check == "signs":
            return found._replace(signs=-found.signs)
        return found._replace(closed=np.zeros_like(found.closed))

    monkeypatch.setattr(absolute.follow, "newton", wrong)
    if always:
        with pytest.raises(absolute.PoseError):
            assembled.solve(motion.inputs)
        return
    again = assembled.solve(motion.inputs)
    for name, place in again.position.items():
        assert np.abs(place - plain.position[name]).max() <= 2 * off(plain).max(), name


@pytest.mark.parametrize("rack", [0.0, 25.0, -25.0])
def test_poses_are_predicted_to_the_second_order_in_all_inputs_together(
    monkeypatch: pytest.MonkeyPatch, rack: float
) -> None:
    assembled = absolute.Assembled(absolute.compile(STRUT))
    way, missed = 0.5 ** np.arange(5)[::-1], list[Array]()

    def seen(*arguments: Any) -> Configurations:
        found = newton(*arguments)
        missed.append(np.abs(found.q - arguments[2]).max(axis=1))
        return found

    monkeypatch.setattr(absolute.follow, "newton", seen)
    drawn, ends = assembled.drawn_inputs, {"arm_angle": 0.1, "rack": rack}
    laws = {name: np.stack([drawn[name] + end * way, 0 * way, 0 * way], -1) for name, end in ends.items()}
    assembled.solve(laws, rates=False)
    # Half of the path has an eighth of the third-order error.
    assert len(missed) == 1
    assert missed[0][1:] / missed[0][:-1] == pytest.approx(8.0, rel=0.2)


def test_a_strut_that_closing_moves_as_far_as_the_car_is_large_is_refused() -> None:
    # The proven path of closing turns back at a fold after 0.056 of its length; another assembly is far away.
    points = STRUT["points"] | {"strut_lower": STRUT["points"]["lower_arm_front"]}
    with pytest.raises(absolute.AssemblyError, match=r"moves 'strut_lower' by 437 mm; .* may be meant"):
        absolute.close_drawing(absolute.compile(STRUT | {"points": points}))


def test_a_rack_drawn_at_its_centre_is_at_nothing_and_not_at_minus_nothing() -> None:
    rack = absolute.close_drawing(absolute.compile(STRUT)).inputs["rack"]
    assert (rack, np.copysign(1.0, rack)) == (0.0, 1.0)
