"""The closed form of every suspension, held to what its links are."""

from collections.abc import Iterator
from itertools import combinations

import mpmath
import numpy as np
import pytest
from cars_in_closed_form import DRAWN, FORMS, PUT_IN_PLACE, VARIANTS, ClosedForm, Linkage, cars_of
from hypothesis import assume, given
from hypothesis import strategies as st

from validate.cars.car import Car

EPS = float(np.finfo(float).eps)
STRUTS = tuple(v for v in VARIANTS if v.suspension == "macpherson")
REAR_LINK = ("lower_arm_rear", "lower_ball_joint")
# By mechanism and closure, four points whose place tells one assembly from another: the fourth lies on one
# side of the plane of the others.
TIE = ("lower_ball_joint", "upper_ball_joint", "tie_rod_inner", "tie_rod_outer")
UPPER_ARM = ("upper_arm_front", "upper_arm_rear", "lower_ball_joint", "upper_ball_joint")
SIDES = {
    ("macpherson", "drawn"): (("lower_ball_joint", "strut_top", "tie_rod_inner", "tie_rod_outer"),),
    ("macpherson", "collinear"): (("lower_ball_joint", "strut_lower", "tie_rod_inner", "tie_rod_outer"),),
    ("double_wishbone", "drawn"): (UPPER_ARM, TIE),
}
SHARES = st.floats(-1.0, 1.0)


@pytest.fixture(autouse=True)
def digits() -> Iterator[None]:
    with mpmath.workdps(50):
        yield


def near_drawing(car: Car, arm: float, rack: float) -> tuple[float, float]:
    linkage = Linkage.of(car)
    return linkage.drawn_angle + 0.25 * arm, linkage.drawn_rack + 30.0 * rack


def exact(car: Car) -> ClosedForm:
    return FORMS[car.suspension].of(car, mpmath.mpf)


def pose_of(form: ClosedForm, angle: float, rack: float) -> dict[str, np.ndarray]:
    """The pose in many digits, points from the arm's front pivot."""
    pose = form.pose(np.array([mpmath.mpf(angle)]), np.array([mpmath.mpf(rack)]))
    return {name: place[0] - form.origin for name, place in pose.items()}


def exists(pose: dict[str, np.ndarray]) -> bool:
    return not any(mpmath.isnan(x) for place in pose.values() for x in place)


def length(vector: np.ndarray) -> mpmath.mpf:
    return mpmath.sqrt(sum(x * x for x in vector))


def product(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> mpmath.mpf:
    return sum(x * y for x, y in zip(np.cross(a, b), c, strict=True))


@given(cars_of(), SHARES, SHARES)
def test_links_and_knuckle_keep_their_lengths_and_inputs_are_what_they_say(
    car: Car, arm: float, rack: float
) -> None:
    form = exact(car)
    angle, travel = near_drawing(car, arm, rack)
    p = pose_of(form, angle, travel)
    assume(exists(p))
    carried = [name for name in form.knuckle if name in p]
    for start, end in {REAR_LINK, *form.links, *combinations(carried, 2)}:
        assert abs(length(p[start] - p[end]) - length(form.p[start] - form.p[end])) < 1e-40
    ball = p["lower_ball_joint"]
    assert abs(sum(ball * form.up) - length(form.p["lower_ball_joint"]) * mpmath.cos(angle)) < 1e-40
    assert all(abs(x) < 1e-40 for x in p["tie_rod_inner"] - form.p["rack_centre"] + travel * form.right)
    for name in form.chassis:
        assert all(x == 0 for x in p[name] - form.p[name])


@given(cars_of(), SHARES, SHARES)
def test_every_side_is_that_of_the_drawing_and_the_knuckle_is_no_mirror_image(
    car: Car, arm: float, rack: float
) -> None:
    form = exact(car)
    p = pose_of(form, *near_drawing(car, arm, rack))
    assume(exists(p))
    for origin, *others in SIDES[car.suspension, car.closure]:
        drawn, now = (product(*(q[name] - q[origin] for name in others)) for q in (form.p, p))
        assert drawn * now >= 0
    beside = [product(q["lower_arm_rear"], form.up, q["lower_ball_joint"]) for q in (form.p, p)]
    assert beside[0] * beside[1] >= 0
    carried = [name for name in form.knuckle if name in p][:4]
    drawn, now = (product(*(q[name] - q[carried[0]] for name in carried[1:])) for q in (form.p, p))
    assert abs(drawn - now) < 1e-30


@given(cars_of(STRUTS), SHARES, SHARES)
def test_the_top_of_a_strut_stays_on_the_axis_of_its_knuckle(car: Car, arm: float, rack: float) -> None:
    form = exact(car)
    p = pose_of(form, *near_drawing(car, arm, rack))
    assume(exists(p))
    # The axis: in a drawn strut through the drawn top, in a collinear one through the ball joint.
    fixed = form.p["strut_top"] if car.closure == "drawn" else form.p["lower_ball_joint"]
    direction = form.p["strut_lower"] - fixed
    there = p["strut_lower"] - p["strut_top"]
    assert length(np.cross(there, p["strut_rod_end"] - p["strut_top"])) < 1e-40
    rods = (length(q["strut_rod_end"] - q["strut_top"]) for q in (form.p, p))
    assert abs(next(rods) - next(rods)) < 1e-40
    for name in ("lower_ball_joint", "tie_rod_outer", "wheel_centre"):
        # A knuckle point keeps its place along the axis and its distance from it.
        drawn, now = form.p[name] - form.p["strut_lower"], p[name] - p["strut_lower"]
        sense = 1 if sum(direction * drawn) * sum(there * now) >= 0 else -1
        along = sense * sum(direction * drawn) * length(there) - sum(there * now) * length(direction)
        assert abs(along) < 1e-30
        across = length(np.cross(direction, drawn)) * length(there)
        assert abs(across - length(np.cross(there, now)) * length(direction)) < 1e-30


@given(cars_of(DRAWN))
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


@given(cars_of(PUT_IN_PLACE), SHARES, SHARES)
def test_a_collinear_drawing_once_closed_is_the_same_strut_as_drawn(
    car: Car, arm: float, rack: float
) -> None:
    collinear, linkage = exact(car), Linkage.of(car)
    home = pose_of(collinear, linkage.drawn_angle, linkage.drawn_rack)
    assume(exists(home))
    closed = Car(home, car.side, car.up, car.right)
    drawn = FORMS[closed.suspension].of(closed, mpmath.mpf)
    inputs = near_drawing(car, arm, rack)
    there, again = pose_of(collinear, *inputs), pose_of(drawn, *inputs)
    assume(exists(there))
    # 50 digits, of which a fold within the search's own rounding of it takes half.
    assert max(abs(x) for name in there for x in there[name] - again[name]) < 1e-15
