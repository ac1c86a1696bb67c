"""The ends of a motion: exact up to them, and beyond them an error that names the locking joints.

The hard cases of `validate` compare the ends with geometry.
"""

from typing import Any

import numpy as np
import pytest
from mechanism_files import mechanism_file, plain, plain_scene
from shipped import EPS, Array, Motion, error, exact, off, shipped
from test_branch import STRUT

import absolute
from absolute.follow import BlockedError, follow
from absolute.initial_assembly import assemble
from absolute.mechanism import Mechanism

ARM, UPPER, ROD = "hinge of lower_arm on chassis", "hinge of upper_arm on chassis", "rod tie_rod"


def at(**values: float) -> dict[str, Array]:
    """One instant at rest."""
    return {name: np.array([[value, 0.0, 0.0]]) for name, value in values.items()}


def low_mount(**moved: Any) -> dict[str, Any]:
    """A strut so short that its ball joint comes abreast of its top mount, 130 mm beside the axis."""
    top, low = np.array([460.0, -310.0, 190.0]), np.array([452.0, -420.0, 60.0])
    points = {"strut_top": top, "strut_lower": low, "strut_rod_end": top - 0.3 * (top - low)}
    part = {"points": STRUT["points"] | points | moved}
    return plain(mechanism_file("macpherson"), part, ["arm_angle", "rack"])


WISHBONE = plain_scene("double-wishbone", ["arm_angle", "rack"])


@pytest.mark.parametrize(
    ("described", "driven", "far", "link"),
    [
        (low_mount(), "arm_angle", -1.5, "slide strut at strut_top"),
        (WISHBONE, "arm_angle", 1.5, UPPER),
        (WISHBONE, "rack", -1e280, ROD),
        (plain_scene("five-link"), "wheel_travel", 900.0, "rod"),
        (plain_scene("slider-crank", ["stroke"]), "stroke", 1e3, "rod"),
        (plain_scene("pushrod-by-damper"), "damper_length", -1e3, "hinge of rocker on chassis"),
    ],
)
def test_a_refusal_names_what_holds_the_mechanism_and_keeps_what_was_solved(
    described: dict[str, Any], driven: str, far: float, link: str
) -> None:
    drawn = absolute.close_drawing(absolute.compile(described)).inputs
    inputs = {name: np.array([[value, 0.1, 0.2]] * 4) for name, value in drawn.items()}
    inputs[driven][1, 0] += 1e-3 * min(1.0, abs(far))
    inputs[driven][2, 0] += far
    with pytest.raises(absolute.UnreachableError, match=f"instant 2: .*locks at.*{link}") as caught:
        Motion(described, inputs).solve(effects=["travel"] if "wheel_axis" in described["roles"] else [])
    refused = caught.value
    assert any(link in name for name in refused.limits)
    assert (refused.instant, refused.limit) == (2, driven)
    assert f"limited by {', '.join(refused.limits)}" in str(refused)
    assert refused.partial is not None
    assert all(len(number) == 2 for number in refused.partial.effects.values())
    kept = Motion(described, {name: law[:2] for name, law in inputs.items()}).solve()
    assert all((refused.partial.acceleration[name] == of).all() for name, of in kept.acceleration.items())


@pytest.mark.parametrize("degrees", [-31.0, 211.0])
def test_bricards_six_hinges_are_not_led_beyond_their_fold(degrees: float) -> None:
    # One row follows from the others from -30 to 210 degrees only: without it bodies could go on, torn apart.
    with pytest.raises(absolute.UnreachableError) as caught:
        Motion(plain_scene("bricard"), at(turn=np.radians(degrees))).solve()
    reached = np.degrees(caught.value.reached["turn"])
    assert reached == pytest.approx(-30.0, abs=1e-6) if degrees < 0 else reached < 210.0 + 1e-6


def test_a_row_that_says_what_no_other_says_is_kept_though_it_followed_from_them_in_the_drawing() -> None:
    # At 90 degrees the first row of the first hinge is independent of the others, and they do not determine
    # the pose without it.
    ways = np.radians([[30.0, 60.0, 90.0], [90.0, 150.0, 200.0]])
    for turns in ways:
        law = np.stack([turns, np.ones(3), np.zeros(3)], axis=-1)
        motion = Motion(plain_scene("bricard"), {"turn": law})
        solution = motion.solve()
        assert solution.condition[turns == np.pi / 2] < 100.0
        for k, (points, *_) in enumerate(exact(motion)):
            for name, place in solution.position.items():
                assert error(place[k], points[name]) <= off(solution)[k], name


@pytest.mark.parametrize(
    ("moved", "link"),
    [
        # The ball joint straight above its arm's axis; the upper one in the plane of its pivots and the lower
        # one; the tie rod's end in the plane of the kingpin and its other end.
        (
            lambda car: {
                "lower_arm_rear": car["lower_arm_front"] + [200.0, 0.0, 0.0],
                "lower_ball_joint": car["lower_arm_front"] + [100.0, 0.0, -60.0],
            },
            ARM,
        ),
        (
            lambda car: {
                "upper_ball_joint": 1.25 * (car["upper_arm_front"] + car["upper_arm_rear"])
                - 1.5 * car["lower_ball_joint"]
            },
            UPPER,
        ),
        (
            lambda car: {
                "tie_rod_outer": 0.75 * car["lower_ball_joint"]
                + 0.5 * car["upper_ball_joint"]
                - 0.25 * car["tie_rod_inner"]
            },
            ROD,
        ),
    ],
    ids=["lower arm", "upper arm", "tie rod"],
)
def test_a_drawing_at_a_dead_point_is_refused_with_its_links(moved: Any, link: str) -> None:
    car = {name: np.array(place, float) for name, place in WISHBONE["points"].items()}
    with pytest.raises((absolute.SingularError, absolute.AssemblyError), match=link) as caught:
        absolute.close_drawing(absolute.compile(WISHBONE | {"points": car | moved(car)}))
    assert link in caught.value.limits
    assert caught.value.instant is None


def test_a_ball_joint_drawn_abreast_of_the_top_mount_is_refused() -> None:
    # The foot of the normal from it is the top mount; powers of two make it exact.
    strut = {"strut_top": (512.0, -256.0, 256.0), "strut_lower": (512.0, -256.0, 128.0)}
    rest = {"strut_rod_end": (512.0, -256.0, 192.0), "lower_ball_joint": (512.0, -384.0, 256.0 + 1e-13)}
    with pytest.raises(absolute.SingularError, match=r"slide strut at strut_top.*move a point off it"):
        absolute.close_drawing(absolute.compile(low_mount(**strut, **rest)))


def test_a_drawing_that_locks_before_it_closes_names_its_links() -> None:
    # The rack's line further away than the tie rod is long.
    points = STRUT["points"] | {"rack_centre": np.add(STRUT["points"]["rack_centre"], [0.0, 0.0, 1500.0])}
    with pytest.raises(absolute.AssemblyError, match=r"limited by .*rod tie_rod"):
        absolute.close_drawing(absolute.compile(STRUT | {"points": points}))


def test_where_the_straight_way_is_blocked_inputs_go_one_by_one() -> None:
    # Straight from the drawing to this pose the tie rod locks; with one input after the other it does not.
    motion = shipped("steer")
    mechanism = Mechanism(absolute.compile(motion.plain))
    begin, goals = mechanism.drawn_inputs, np.array([[0.57, -27.6]])
    with pytest.raises(BlockedError):
        list(follow(mechanism, assemble(mechanism), begin, goals, mechanism.targets))
    position = Motion(motion.plain, at(arm_angle=0.57, rack=-27.6)).solve(rates=False).position
    for a, b in (("tie_rod_outer", "tie_rod_inner"), ("lower_ball_joint", "lower_arm_front")):
        drawn = np.linalg.norm(np.subtract(STRUT["points"][a], STRUT["points"][b]))
        # Two rows of an end each, closed to 4 eps of the vectors in it: less than three times 400 mm.
        assert (
            np.abs(np.linalg.norm(position[a] - position[b], axis=1) - drawn).max() <= 2 * 4 * EPS * 3 * 400.0
        )
