"""The closed form of the general strut, held to what a strut is, and its ends to brute force."""

import math
from collections.abc import Iterator
from itertools import pairwise

import mpmath
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from validate.cars.closed_form import ClosedForm
from validate.cars.input_limits import ARM, STRUT, TIE_ROD, Car, Linkage
from validate.cars.near_singular import random_car
from validate.cars.strategies import RIGHT, UP, cars

EPS = float(np.finfo(float).eps)
LINKS = (
    ("lower_arm_front", "lower_ball_joint"),
    ("lower_arm_rear", "lower_ball_joint"),
    ("lower_ball_joint", "tie_rod_outer"),
    ("tie_rod_outer", "strut_lower"),
    ("strut_lower", "lower_ball_joint"),
    ("tie_rod_outer", "tie_rod_inner"),
    ("strut_top", "strut_rod_end"),
    *(("wheel_centre", name) for name in ("lower_ball_joint", "tie_rod_outer", "strut_lower")),
)
SHARES = st.floats(-1.0, 1.0)


@pytest.fixture(autouse=True)
def digits() -> Iterator[None]:
    with mpmath.workdps(50):
        yield


def near_drawing(car: Car, arm: float, rack: float) -> tuple[float, float]:
    linkage = Linkage.of(car)
    return linkage.drawn_angle + 0.25 * arm, linkage.drawn_rack + 30.0 * rack


def exact(car: Car) -> ClosedForm:
    return ClosedForm.of(car.points, car.up, car.right, car.closure, mpmath.mpf)


def pose_of(form: ClosedForm, angle: float, rack: float) -> dict[str, np.ndarray]:
    pose = form.pose(np.array([mpmath.mpf(angle)]), np.array([mpmath.mpf(rack)]))
    return {name: place[0] for name, place in pose.items()}


def length(vector: np.ndarray) -> mpmath.mpf:
    return mpmath.sqrt(sum(x * x for x in vector))


def turning(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> mpmath.mpf:
    return sum(x * y for x, y in zip(np.cross(a, b), c, strict=True))


@given(cars(), SHARES, SHARES)
def test_links_keep_their_lengths_and_the_top_stays_on_the_axis_of_the_knuckle(
    car: Car, arm: float, rack: float
) -> None:
    form = exact(car)
    angle, travel = near_drawing(car, arm, rack)
    pose = pose_of(form, angle, travel)
    assume(not any(mpmath.isnan(x) for place in pose.values() for x in place))
    p = {name: place - form.origin for name, place in pose.items()}
    for start, end in LINKS:
        assert abs(length(p[start] - p[end]) - length(form.p[start] - form.p[end])) < 1e-40
    ball = p["lower_ball_joint"]
    assert abs(sum(ball * form.up) - length(form.p["lower_ball_joint"]) * mpmath.cos(angle)) < 1e-40
    assert all(abs(x) < 1e-40 for x in p["tie_rod_inner"] - form.p["rack_centre"] + travel * form.right)
    # The axis: in a drawn strut through the drawn top, in a collinear one through the ball joint.
    fixed = form.p["strut_top"] if car.closure == "drawn" else form.p["lower_ball_joint"]
    direction = form.p["strut_lower"] - fixed
    there = p["strut_lower"] - p["strut_top"]
    assert length(np.cross(there, p["strut_rod_end"] - p["strut_top"])) < 1e-40
    for name in ("lower_ball_joint", "tie_rod_outer", "wheel_centre"):
        # A knuckle point keeps its place along the axis and its distance from it.
        drawn, now = form.p[name] - form.p["strut_lower"], p[name] - p["strut_lower"]
        sense = 1 if sum(direction * drawn) * sum(there * now) >= 0 else -1
        assert (
            abs(sense * sum(direction * drawn) * length(there) - sum(there * now) * length(direction)) < 1e-30
        )
        across = length(np.cross(direction, drawn)) * length(there)
        assert abs(across - length(np.cross(there, now)) * length(direction)) < 1e-30
    # No mirror image: the knuckle's tetrahedron keeps its sense, and so do arm and tie rod.
    for names in (("tie_rod_outer", "strut_lower", "wheel_centre"),):
        drawn_sense, sense_now = (
            turning(*(q[name] - q["lower_ball_joint"] for name in names)) for q in (form.p, p)
        )
        assert abs(drawn_sense - sense_now) < 1e-30


@given(cars(["drawn"]))
def test_a_drawing_comes_back_at_its_own_inputs_to_what_it_leaves_over(car: Car) -> None:
    linkage = Linkage.of(car)
    inner = linkage.p["tie_rod_inner"] - linkage.p["rack_centre"]
    assume(float(np.linalg.norm(inner - (inner @ linkage.right) * linkage.right)) == 0.0)
    pose = linkage.form.pose(linkage.drawn_angle, linkage.drawn_rack)
    # Rounding of one part in the height h of a folded triangle is one in 2 h^2 of it: arm and tie rod.
    room = min(float(linkage.spare(np.array(linkage.drawn_angle), np.array(linkage.drawn_rack))), 1.0)
    low, high = linkage.dead_points()
    assume(
        room > 1e-3 and min(linkage.drawn_angle - low, high - linkage.drawn_angle) > 0.05 and linkage.sound
    )
    far = linkage.size + float(np.abs(linkage.form.origin).max())
    for name, place in car.points.items():
        if name != "strut_rod_end":
            assert float(np.abs(pose[name] - place).max()) <= 100 * EPS * far / (room * 0.05), name


@given(cars(["collinear"]), SHARES, SHARES)
def test_a_collinear_drawing_once_closed_is_the_same_strut_as_drawn(
    car: Car, arm: float, rack: float
) -> None:
    collinear, linkage = exact(car), Linkage.of(car)
    home = pose_of(collinear, linkage.drawn_angle, linkage.drawn_rack)
    assume(not any(mpmath.isnan(x) for place in home.values() for x in place))
    drawn = ClosedForm.of(home, car.up, car.right, "drawn", mpmath.mpf)
    inputs = near_drawing(car, arm, rack)
    there, again = pose_of(collinear, *inputs), pose_of(drawn, *inputs)
    assume(not any(mpmath.isnan(x) for place in there.values() for x in place))
    # 50 digits, of which a fold within the search's own rounding of it takes half.
    assert max(abs(x) for name in there for x in there[name] - again[name]) < 1e-15


@given(cars(), SHARES, SHARES)
def test_floating_point_and_many_digits_agree(car: Car, arm: float, rack: float) -> None:
    linkage = Linkage.of(car)
    angle, travel = near_drawing(car, arm, rack)
    low, high = linkage.dead_points()
    assume(linkage.sound and low + 0.05 < angle < high - 0.05)
    assume(float(linkage.spare(np.array(angle), np.array(travel))) > 1e-3)
    there, true = linkage.form.pose(angle, travel), pose_of(exact(car), angle, travel)
    for name, place in there.items():
        assert max(abs(float(x)) for x in place - true[name]) < 1e-9 * linkage.size, name


def has_pose(car: Car, angle: float, rack: float) -> tuple[bool, bool]:
    """Whether arm and slide have a place, and whether the tie rod has one: looked for, not calculated."""
    p = {name: np.array(place) for name, place in car.points.items()}
    front, ball, top = p["lower_arm_front"], p["lower_ball_joint"], p["strut_top"]
    axis = (p["lower_arm_rear"] - front) / np.linalg.norm(p["lower_arm_rear"] - front)
    turns = np.linspace(-math.pi, math.pi, 200_001)[:, None]
    arm = ball - front
    circle = (
        np.cos(turns) * (arm - arm @ axis * axis) + np.sin(turns) * np.cross(axis, arm) + arm @ axis * axis
    )
    height = circle @ np.array(car.up) - math.cos(angle) * np.linalg.norm(arm)
    side = np.cross(axis, car.up) @ arm
    places = [
        circle[i]
        for i, (a, b) in enumerate(pairwise(height))
        if a * b <= 0.0 and (np.cross(axis, car.up) @ circle[i]) * side > 0
    ]
    if not places:
        return False, False
    now = places[0]
    lower = p["strut_lower"] - ball
    base, toward = (lower, top - p["strut_lower"]) if car.closure == "drawn" else (np.zeros(3), lower)
    slides = np.linspace(-5e3, 5e3, 200_001)[:, None] / np.linalg.norm(toward)
    carried = base + slides * toward
    reach = np.linalg.norm(carried, axis=1) - np.linalg.norm(top - front - now)
    if not (reach <= 0.0).any():
        return False, False
    drawn_side = float((top - ball) @ toward)
    crossings = [i for i, (a, b) in enumerate(pairwise(reach)) if a * b <= 0.0]
    (along,) = [carried[i] for i in crossings if float(carried[i] @ toward) * drawn_side > 0.0]
    along /= np.linalg.norm(along)
    outer = p["tie_rod_outer"] - ball
    climb, radius = outer @ along, np.linalg.norm(np.cross(along, outer))
    line = (top - front - now) / np.linalg.norm(top - front - now)
    first = np.cross(line, (0.6, 0.0, 0.8))
    first /= np.linalg.norm(first)
    ring = now + climb * line + radius * (np.cos(turns) * first + np.sin(turns) * np.cross(line, first))
    inner = p.get("rack_centre", p["tie_rod_inner"]) - rack * np.array(car.right) - front
    gap = np.linalg.norm(ring - inner, axis=1) - np.linalg.norm(p["tie_rod_outer"] - p["tie_rod_inner"])
    return True, bool((gap <= 0.0).any() and (gap >= 0.0).any())


@pytest.mark.parametrize("lock", [ARM, STRUT, TIE_ROD])
def test_an_input_ends_where_brute_force_finds_no_further_pose(lock: str) -> None:
    """A share of 1e-3 of the range inside its end there is a pose, and as much beyond it there is none."""
    tried, rng = 0, np.random.default_rng(3)
    while tried < 8:
        car = random_car(rng)
        linkage = Linkage.of(car)
        if not linkage.sound or linkage.size > 1e3 or linkage.size < 200.0:
            continue
        home = {"arm_angle": linkage.drawn_angle, "rack": linkage.drawn_rack}
        for driven in ("arm_angle", "rack"):
            low, high = (linkage.end(home, driven, ahead) for ahead in (False, True))
            if low is None or high is None:
                continue
            for this, other in ((low, high), (high, low)):
                if this[1] != lock:
                    continue
                step = 1e-3 * (other[0] - this[0])
                inside, beyond = (home | {driven: this[0] + step * s} for s in (1.0, -1.0))
                assert has_pose(car, inside["arm_angle"], inside["rack"]) == (True, True)
                strut, rod = has_pose(car, beyond["arm_angle"], beyond["rack"])
                assert not rod
                assert strut == (lock == TIE_ROD)
                tried += 1


def test_the_slide_runs_out_where_the_ball_joint_is_as_near_to_the_top_as_beside_the_axis() -> None:
    rng = np.random.default_rng(7)
    found = 0
    while found < 10:
        car = random_car(rng)
        linkage = Linkage.of(car)
        home = {"arm_angle": linkage.drawn_angle, "rack": linkage.drawn_rack}
        for ahead in (False, True):
            end = linkage.end(home, "arm_angle", ahead)
            if end is None or end[1] != STRUT:
                continue
            near = float(np.linalg.norm(linkage.p["strut_top"] - linkage.form.ball_joint(end[0])))
            top, lower = linkage.p["strut_top"], linkage.p["strut_lower"]
            axis = (top - lower) / np.linalg.norm(top - lower)
            beside = float(np.linalg.norm(np.cross(linkage.p["lower_ball_joint"] - lower, axis)))
            assert near == pytest.approx(beside, rel=1e-12)
            found += 1


def test_a_collinear_slide_never_runs_out() -> None:
    rng = np.random.default_rng(8)
    struts = [car for car in (random_car(rng) for _ in range(60)) if car.closure == "collinear"]
    assert struts
    for car in struts:
        linkage = Linkage.of(car)
        assert float(linkage.form.slide_spare(np.array(linkage.drawn_angle))) == 1.0


def test_an_array_of_inputs_gives_the_poses_of_each() -> None:
    car = Car(
        {name: tuple(place) for name, place in random_car(np.random.default_rng(1)).points.items()},
        "left",
        UP,
        RIGHT,
    )
    form = Linkage.of(car).form
    angles, racks = np.linspace(1.0, 1.6, 6).reshape(2, 3), np.linspace(-3.0, 3.0, 3)
    both = form.pose(angles, racks)
    for i, k in np.ndindex(angles.shape):
        one = form.pose(float(angles[i, k]), float(racks[k]))
        for name, place in one.items():
            assert np.array_equal(both[name][i, k], place, equal_nan=True)
