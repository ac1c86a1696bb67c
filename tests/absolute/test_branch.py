"""Of all assemblies of a drawing's bodies the one that is drawn, all along a motion, or a refusal."""

from collections import Counter
from typing import Any

import numpy as np
import pytest
from many_digits import DIGITS
from mechanism_files import plain_scene
from mpmath import mp
from shipped import EPS, Array, Motion, error, exact, off, shipped

import absolute
import absolute.follow
from absolute.mechanism import Mechanism
from absolute.newton import Configurations, newton

STRUT, WISHBONE = (
    plain_scene("steer", ["arm_angle", "rack"]),
    plain_scene("double-wishbone", ["arm_angle", "rack"]),
)
MIRROR = np.array([1.0, -1.0, 1.0])
# A strut off its line by 2 mm, drawn so near to a fold that closing it takes it past the fold.
NEAR_A_FOLD = {
    "lower_arm_front": (206.58457845918298, -16.047917967635197, 77.56057576892586),
    "lower_arm_rear": (306.5853286868517, 31.475233419497492, 33.43749101134641),
    "lower_ball_joint": (139.2777022852912, 188.66497551565004, 12.934525869954458),
    "rack_centre": (359.30777256137833, -23.511675265250304, 55.56943319779327),
    "strut_lower": (166.59420118124112, 170.97120566410172, 67.38052851504797),
    "strut_rod_end": (232.07563488070033, 123.3821616307481, 207.42134033079233),
    "strut_top": (259.45946351632466, 101.52557443202944, 274.50436997089247),
    "tie_rod_inner": (357.61942247140325, -21.76018844508973, 55.440305684019826),
    "tie_rod_outer": (203.88748091723122, 114.59302944730229, -59.75657233169844),
    "wheel_centre": (143.53692551149965, 142.25743444961975, -40.593789848475836),
}
# Its two assemblies at the drawn inputs: strut and rack on their lines, and all that turns about the strut
# in two places.
ON_THE_LINE = {
    "strut_lower": (164.62487131, 170.28666998, 68.1014246),
    "strut_rod_end": (229.21740501, 123.45298537, 208.68397885),
    "tie_rod_inner": (359.30777256, -21.76018845, 55.5694332),
}
NEAR = {
    "drawn side": {
        "tie_rod_outer": (214.55350737, 124.59035013, -58.98951738),
        "wheel_centre": (150.92533596, 145.90278514, -42.4983988),
    },
    "nearer": {
        "tie_rod_outer": (196.67504985, 106.32747323, -56.85911752),
        "wheel_centre": (139.20678185, 140.2793021, -38.98756011),
    },
}


def over(points: dict[str, Array], *planes: tuple[str, str, str, str]) -> dict[str, Array]:
    """Points drawn on the other side of planes through three others: distances to these stay."""
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
        # The lower ball joint on the other side of its arm's axis, as high.
        car["lower_ball_joint"][1] = 2.0 * -560.0 - car["lower_ball_joint"][1]
    car = over(car, *planes)
    drawn = absolute.close_drawing(absolute.compile(WISHBONE | {"points": car})).inputs
    t = np.linspace(0.0, 1.0, 4)
    inputs = {
        "arm_angle": np.stack([drawn["arm_angle"] + 0.12 * np.sin(6 * t), 0 * t, 0 * t], -1),
        "rack": np.stack([drawn["rack"] + 12.0 * t, 0 * t, 0 * t], -1),
    }
    motion = Motion(WISHBONE | {"points": car}, inputs)
    solution = motion.solve(rates=False, conditions=True)
    for k, (points, *_) in enumerate(exact(motion)):
        for name, place in solution.position.items():
            assert error(place[k], points[name]) <= off(solution)[k], name


@pytest.mark.parametrize(
    "scene", ["bounce", "double-wishbone", "off-axis-strut", "pushrod", "spatial-four-bar"]
)
def test_drawing_a_pose_of_the_motion_instead_gives_the_same_motion(scene: str) -> None:
    motion = shipped(scene)
    plain = motion.solve(conditions=True)
    points = motion.plain["points"] | {name: place[2] for name, place in plain.position.items()}
    inputs = {name: law.copy() for name, law in motion.inputs.items()}
    for name in inputs:
        # These are measured from the drawing.
        if "height" in motion.plain["inputs"][name] or "drawing" in motion.plain["inputs"][name].values():
            inputs[name][:, 0] -= motion.inputs[name][2, 0]
    again = Motion(motion.plain | {"points": points}, inputs).solve()
    # The drawn lengths carry the rounding of the pose that was drawn.
    allowed = 4 * off(plain)[2] * plain.condition.max()
    for name, place in again.position.items():
        assert np.abs(place - plain.position[name]).max() <= allowed, name


@pytest.mark.parametrize("always", [False, True])
@pytest.mark.parametrize("check", ["signs", "senses", "far"])
def test_a_pose_that_left_the_branch_is_led_to_by_nearer_ones_or_refused(
    monkeypatch: pytest.MonkeyPatch, always: bool, check: str
) -> None:
    """Planted: a determinant has another sign, a joint is turned round, or nothing closes; once or always."""
    motion, seen = shipped("bounce-and-steer", 20), 0
    plain, assembled = motion.solve(conditions=True), absolute.Assembled(absolute.compile(motion.plain))

    def wrong(*arguments: Any) -> Configurations:
        nonlocal seen
        found, seen = newton(*arguments), seen + 1
        if not always and seen > 2:
            return found
        if check == "signs":
            return found._replace(signs=-found.signs)
        if check == "far":
            return found._replace(closed=np.zeros_like(found.closed))
        return found._replace(placed=found.placed._replace(rotation=np.zeros_like(found.placed.rotation)))

    monkeypatch.setattr(absolute.follow, "newton", wrong)
    if always:
        with pytest.raises(absolute.PoseError):
            assembled.solve(motion.inputs)
        return
    again = assembled.solve(motion.inputs)
    for name, place in again.position.items():
        assert np.abs(place - plain.position[name]).max() <= 2 * off(plain).max(), name


def test_a_long_way_close_by_a_fold_does_not_cross_it() -> None:
    # Straight to this goal the motion passes a fold so close that Newton converges beyond it: only
    # the sign of a determinant tells.
    goal = {"arm_angle": 0.5714841988334616, "rack": -27.604730159848856}
    held = {name: np.array([[value, 0.0, 0.0]]) for name, value in goal.items()}
    with mp.workdps(DIGITS):
        table = [{"arm_angle": 0.8, "rack": 0.0}, {"arm_angle": 0.5714841988334616, "rack": 0.0}, goal]
    ways = Motion(STRUT, {name: np.array([[one[name], 0.0, 0.0] for one in table]) for name in goal})
    try:
        solution = Motion(STRUT, held).solve(rates=False, conditions=True)
    except absolute.UnreachableError:
        return
    for name, place in exact(ways)[-1][0].items():
        assert error(solution.position[name][0], place) <= off(solution)[0], name


def test_groups_of_bodies_have_signs_of_their_own_that_multiply_to_that_of_the_whole() -> None:
    seen = set()
    for planes in ((), (UPPER,), (OUTER,), (UPPER, OUTER)):
        mechanism = Mechanism(absolute.compile(WISHBONE | {"points": over(short_lower_arm(), *planes)}))
        jacobian = mechanism.stack.jacobian(mechanism.stack.place(*mechanism.poses(mechanism.drawn)))
        signs = mechanism.signs(jacobian)
        seen.add((*signs.tolist(), float(np.prod(signs) * np.sign(np.linalg.det(jacobian)))))
    # The arm and the rack have signs of their own; what hangs between upper arm and tie rod has one for both.
    assert len({signs[:-1] for signs in seen}) == 2
    assert len({signs[-1] for signs in seen}) == 1
    assert {len(signs) for signs in seen} == {4}


# Closing a drawing


def test_a_drawing_much_nearer_to_a_fold_than_to_its_closed_pose_is_refused() -> None:
    # The nearer of its assemblies is beyond the fold, and was once given without a warning.
    with pytest.raises(absolute.AssemblyError, match="stands for two assemblies: 'slide strut"):
        absolute.close_drawing(absolute.compile(STRUT | {"points": with_rack(NEAR_A_FOLD), "side": "right"}))


@pytest.mark.parametrize("assembly", NEAR)
def test_a_car_drawn_as_one_of_two_near_assemblies_stays_in_it(assembly: str) -> None:
    drawing = with_rack(NEAR_A_FOLD | ON_THE_LINE | NEAR[assembly])
    closed = absolute.close_drawing(absolute.compile(STRUT | {"points": drawing, "side": "right"}))
    assert max(closed.movement.values()) <= 1e-6


def with_rack(points: dict[str, Any]) -> dict[str, Any]:
    return {"rack_centre": points["tie_rod_inner"], **points}


def side_of(pole: Array, car: Any) -> float:
    """On which side of the plane through a steering axis and the rack the steering arm is, 1 or -1."""
    ball = car["lower_ball_joint"]
    return float(np.sign(np.linalg.det([car["tie_rod_outer"] - ball, pole, car["tie_rod_inner"] - ball])))


def test_a_strut_closes_on_the_side_that_it_is_drawn_on_by_both_its_axes_or_is_refused() -> None:
    # Drawn off its line, a strut has two steering axes: to the top mount, and along the knuckle's own line.
    seen = Counter[tuple[bool, str]]()
    for seed in range(150):
        random = np.random.default_rng(seed)
        scale = 10.0 ** random.uniform(1.0, 2.2)
        car = {name: p + random.uniform(-scale, scale, 3) for name, p in STRUT["points"].items()}
        ball = car["lower_ball_joint"]
        to_top, line = car["strut_top"] - ball, car["strut_lower"] - ball
        # The knuckle's line may be drawn against the strut, and stays so.
        clear = side_of(to_top, car) == side_of(np.sign(to_top @ line) * line, car)
        try:
            closed = absolute.close_drawing(absolute.compile(STRUT | {"points": car})).position
        except absolute.AssemblyError as error:
            said = "two" if "stands for two assemblies" in str(error) else "locks"
            assert not clear or said == "locks"
        else:
            said = "closed"
            assert clear
            assert side_of(closed["strut_top"] - closed["lower_ball_joint"], closed) == side_of(to_top, car)
        seen[clear, said] += 1
    assert seen[True, "closed"] > 90
    assert seen[False, "two"] > 8


def test_a_strut_that_closing_moves_as_far_as_the_car_is_large_is_refused() -> None:
    # The certified way of closing turns back at a fold after 0.056 of it; another assembly lies far away.
    points = STRUT["points"] | {"strut_lower": STRUT["points"]["lower_arm_front"]}
    with pytest.raises(absolute.AssemblyError, match=r"moves 'strut_lower' by 437 mm; .* may be meant"):
        absolute.close_drawing(absolute.compile(STRUT | {"points": points}))


@pytest.mark.parametrize("along", [-150.0, -10.0, 10.0, 150.0])
def test_what_is_drawn_off_its_line_is_put_on_it_at_its_distance_and_on_its_side(along: float) -> None:
    scene = plain_scene("off-axis-strut")
    car = {name: np.array(place, float) for name, place in scene["points"].items()}
    top, low = car["strut_top"], car["strut_lower"]
    axis = (top - low) / np.linalg.norm(top - low)
    beside = np.cross(axis, [1.0, 0.0, 0.0]) * 9.0
    closed = absolute.close_drawing(
        absolute.compile(scene | {"points": car | {"strut_rod_end": top + along * axis + beside}})
    )
    wanted = top + np.copysign(np.hypot(along, np.linalg.norm(beside)), along) * axis
    # Condition numbers are below 60, lengths 500 mm.
    assert np.abs(closed.position["strut_rod_end"] - wanted).max() <= 60 * EPS * 500.0
    away = {"rack_centre": car["rack_centre"] + [3.0, 25.0, 0.0]}
    closed = absolute.close_drawing(absolute.compile(scene | {"points": car | away}))
    inner = closed.position["tie_rod_inner"] - car["tie_rod_inner"]
    assert np.abs(inner - [3.0, 0.0, 0.0]).max() <= 60 * EPS * 500.0
    assert closed.movement["tie_rod_outer"] > 0.01
    assert closed.movement["tie_rod_inner"] == pytest.approx(3.0)
    assert closed.movement["lower_ball_joint"] <= 60 * EPS * 500.0


def test_a_rack_drawn_at_its_centre_is_at_nothing_and_not_at_minus_nothing() -> None:
    rack = absolute.close_drawing(absolute.compile(STRUT)).inputs["rack"]
    assert (rack, np.copysign(1.0, rack)) == (0.0, 1.0)
