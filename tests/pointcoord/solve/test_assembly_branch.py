"""Assembly on the branch of the drawing: where it leads, where it ends, and what it says then."""

from collections.abc import Callable

import numpy as np
import pytest

from pointcoord import AssemblyError, Scene, simulate
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.solve.assembly import Pose, assemble

Points = dict[str, tuple[float, float, float]]
# The ends of what can be assembled with the other input held, certified apart from this package.
LOWEST_ANGLE, HIGHEST_ANGLE = np.deg2rad(32.228), np.deg2rad(152.013)
LOWEST_RACK, HIGHEST_RACK = -89.066, 130.101


def at(mechanism: Mechanism, angle: object, rack: object) -> Pose:
    return assemble(mechanism, {"arm_angle": np.asarray(angle, float), "rack": np.asarray(rack, float)})


@pytest.mark.parametrize(
    ("angle", "rack", "name"),
    [
        (LOWEST_ANGLE + np.deg2rad(0.001), 0.0, "arm_angle"),
        (HIGHEST_ANGLE - np.deg2rad(0.001), 0.0, "arm_angle"),
        (np.pi / 2, LOWEST_RACK + 0.001, "rack"),
        (np.pi / 2, HIGHEST_RACK - 0.001, "rack"),
    ],
)
def test_end_of_the_range_is_reached_just_inside_and_refused_just_outside(
    strut: Mechanism, angle: float, rack: float, name: str
) -> None:
    inside = at(strut, angle, rack)
    assert np.isfinite(inside.bound)
    # Two thousandths of a degree or of a millimetre further.
    outwards = np.sign(angle - np.pi / 2) * np.deg2rad(0.002), np.sign(rack) * 0.002
    goal = (angle + outwards[0], rack) if name == "arm_angle" else (angle, rack + outwards[1])
    with pytest.raises(AssemblyError, match="cannot be assembled") as caught:
        at(strut, *goal)
    error = caught.value
    assert error.reduce == name
    # The path is a straight line of cos(angle) and of the rack. It stops within the thousandth that the
    # limit's printed digits leave open, and does not claim to have passed it.
    limit = {"arm_angle": angle, "rack": rack}[name]
    width = np.deg2rad(0.001) if name == "arm_angle" else 0.001
    assert abs(error.reached[name] - limit) <= 2 * width
    assert error.wanted[name] == pytest.approx(goal[0 if name == "arm_angle" else 1], rel=1e-12)
    assert error.condition > 1e3
    message = str(error)
    for text in (
        f"{name} = {error.reached[name]:.10g}",
        f"{name} = {error.wanted[name]:.10g}",
        f"bring '{name}' back",
    ):
        assert text in message


def test_a_drawing_too_crooked_to_close_is_refused_as_a_drawing(
    make_scene: Callable[..., Scene], table: Points
) -> None:
    # The strut's lower point 200 mm in front of its line: no input is to blame, the drawing is.
    x, y, z = table["strut_lower"]
    with pytest.raises(
        AssemblyError, match=r"the drawing cannot be assembled.*; draw these nearer to closing"
    ) as caught:
        simulate(make_scene(points={**table, "strut_lower": (x - 200.0, y, z)}))
    assert caught.value.reduce == ""
    assert any("strut_lower" in name for name in caught.value.limits)


def test_pieces_of_the_strut_that_would_turn_over_are_refused(
    make_scene: Callable[..., Scene], table: Points
) -> None:
    # The knuckle's piece points up the strut; drawn at 100 degrees to the rod and at 120 to the way from
    # ball joint to top, it has no sense that both agree on.
    x, y, z = table["lower_ball_joint"]
    folded = {**table, "strut_lower": (x + 60.0, y, z - 6.0), "strut_rod_end": (420.0, -180.0, 466.0)}
    with pytest.raises(AssemblyError, match=r"can close in two ways, .* turns over against") as caught:
        simulate(make_scene(points=folded))
    assert caught.value.problem.startswith("the drawing")
