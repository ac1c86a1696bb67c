"""Laws that need no second model: turn, move, mirror or scale the car, run its inputs backwards."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, event, given, settings
from hypothesis import strategies as st
from lengthwise_angles import expected_angle
from numpy.typing import NDArray
from rate_sensitivity import rate_sensitivities
from sample_cars import GENERAL_STRUT, PAPER_STRUT, WISHBONE, SampleCar, by_car
from scipy.linalg import expm

from pointcoord import AssemblyError, Motion, Scene, simulate
from pointcoord.method import METHODS

Array = NDArray[np.float64]
Car = dict[str, Array]
EPS = np.finfo(float).eps
few = settings(deadline=None, max_examples=max(15, settings.default.max_examples // 2))


def box(low: tuple[float, float, float], high: tuple[float, float, float]) -> st.SearchStrategy[Array]:
    return st.tuples(*(st.floats(a, b) for a, b in zip(low, high, strict=True))).map(np.array)


@st.composite
def struts(draw: st.DrawFn) -> Car:
    """A strut of several hundred millimetres, its points placed from the axis of the strut outwards."""
    lower = draw(box((300.0, -400.0, -100.0), (600.0, -250.0, 100.0)))
    top = lower + draw(box((-40.0, 100.0, 450.0), (40.0, 200.0, 600.0)))
    off = box((-6.0, -6.0, -6.0), (6.0, 6.0, 6.0))
    strut_lower = lower + draw(st.floats(0.08, 0.2)) * (top - lower) + draw(off)
    outer = lower + draw(box((80.0, -10.0, 60.0), (140.0, 40.0, 120.0)))
    inner = outer + draw(box((-15.0, 300.0, -10.0), (15.0, 380.0, 40.0)))
    return {
        "lower_arm_front": lower + draw(box((-220.0, 280.0, 0.0), (-140.0, 350.0, 40.0))),
        "lower_arm_rear": lower + draw(box((60.0, 280.0, 0.0), (120.0, 350.0, 40.0))),
        "rack_centre": inner,
        "strut_top": top,
        "lower_ball_joint": lower,
        "tie_rod_outer": outer,
        "strut_lower": strut_lower,
        "strut_rod_end": top - draw(st.floats(0.4, 0.6)) * (top - lower) + draw(off),
        "tie_rod_inner": inner,
        "wheel_centre": strut_lower + draw(box((-10.0, -100.0, -10.0), (10.0, -70.0, 10.0))),
    }


@st.composite
def general_struts(draw: st.DrawFn) -> Car:
    """The same with the ball joint beside the axis, the rod's end on it, and a spin axis of its own."""
    car = draw(struts())
    top, lower = car["strut_top"], car["strut_lower"]
    car["lower_ball_joint"] = car["lower_ball_joint"] + draw(box((-20.0, -60.0, -10.0), (20.0, -10.0, 10.0)))
    car["strut_rod_end"] = top + draw(st.floats(0.4, 0.6)) * (lower - top)
    return car | {"wheel_axis_inner": car["wheel_centre"] + draw(box((-5.0, 60.0, -5.0), (5.0, 90.0, 5.0)))}


@st.composite
def wishbones(draw: st.DrawFn) -> Car:
    """A double wishbone of a small car: its points up to 15 mm from the built-in one's, mirrored."""
    nudge = box((-15.0, -15.0, -15.0), (15.0, 15.0, 15.0))
    car = {name: np.array(p) * [1.0, -1.0, 1.0] + draw(nudge) for name, p in WISHBONE.points.items()}
    return car | {"rack_centre": car["tie_rod_inner"]}


@dataclass(frozen=True)
class Kind:
    """A suspension with a closure, and random left wheels of it."""

    sample: SampleCar
    cars: st.SearchStrategy[Car]


KINDS = [Kind(PAPER_STRUT, struts()), Kind(GENERAL_STRUT, general_struts()), Kind(WISHBONE, wishbones())]
by_kind = pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.sample.name)


@st.composite
def inputs(draw: st.DrawFn) -> dict[str, Any]:
    """Arm and rack moving together, rates of the size of a car on a road."""
    arm = draw(st.tuples(st.floats(1.35, 1.8), st.floats(-0.4, 0.4), st.floats(-0.3, 0.3)))
    rack = draw(st.tuples(st.floats(-20.0, 20.0), st.floats(-40.0, 40.0), st.floats(-30.0, 30.0)))
    return {"arm_angle": arm, "rack": rack, "stop": 0.5, "samples": 5}


def moved_by(matrix: Array, shift: Array, scale: float, car: Car) -> Car:
    return {name: scale * (matrix @ p) + shift for name, p in car.items()}


def solve(scene: Scene, method: str) -> Motion:
    """Solved; an example whose car cannot follow its inputs is rejected, and counted."""
    try:
        motion = simulate(scene, method)
    except AssemblyError:
        event("rejected: cannot be assembled")
        assume(False)
    event("solved")
    return motion


class Tolerances:
    """What rounding may make of two solutions of one car, from their proven bounds and sensitivities.

    Both poses lie within their bounds. Hardpoints that were turned or scaled are other data: each
    coordinate is off by 4 eps of the car's size and of its distance from the origin, which changes a row
    by at most 24 of these relative to its largest entry (six differences of two, and a squared length made
    of three more) and the pose by the condition number times that. Rates: the pose's error times its
    proven effect, of unknown coordinates and as much again of known ones, plus the rounding of a solve;
    for the series, as much of the rate as the tolerance is of the car's size. A carried point gains on its
    carriers what its proven bound gains on theirs.
    """

    def __init__(
        self,
        sample: SampleCar,
        motions: tuple[Motion, Motion],
        distance: float,
        truncation: float,
        unit: float,
    ) -> None:
        proofs = [motion.proof() for motion in motions]
        condition = max(float(p.condition.max()) for p in proofs)
        gain = max(float((p.carried_bound / p.bound).max()) for p in proofs)
        data = 4 * EPS * (2 * unit + distance)
        solved = sum(float(p.bound.max()) for p in proofs) + 24 * condition * data + 2 * truncation
        self.position = gain * solved + 2 * EPS * distance
        share = 24 * condition * data / unit + 2 * truncation / unit
        fast, hard = (
            max(float(np.abs(v).max()) for m in motions for v in getattr(m, q).values())
            for q in ("velocity", "acceleration")
        )
        sense, bend = (
            max(float(largest.max()) for largest in both)
            for both in zip(*(rate_sensitivities(motion) for motion in motions), strict=True)
        )
        velocity = 2 * sense * solved + share * fast
        acceleration = 2 * bend * solved + 4 * sense * velocity + share * hard
        # Edges of the carriers turn with the knuckle, so a carried rate also takes the lower orders' error.
        self.velocity = gain * (velocity + sense * solved)
        self.acceleration = gain * (acceleration + 2 * sense * velocity + bend * solved)
        topology, place = sample.topology, motions[0].position
        points = [place[name] for name in topology.role("knuckle")]
        edges = [points[i] - points[i - 1] for i in range(3)]
        lengths = [np.linalg.norm(e, axis=-1).max() for e in edges]
        height = np.linalg.norm(np.cross(edges[0], edges[1]), axis=-1).min() / max(lengths)
        # A body's rate follows from its points' within twice sqrt(3) over the triangle's least height, and
        # its lever arms are off by the pose's error.
        rate = max(float(np.abs(m.angular_velocity["knuckle"]).max()) for m in motions)
        turn = max(float(np.abs(m.angular_acceleration["knuckle"]).max()) for m in motions)
        self.omega = 4 * (self.velocity + 2 * rate * self.position) / height
        self.alpha = (
            4 * (self.acceleration + 4 * rate * self.velocity + 2 * (turn + rate**2) * self.position) / height
        )
        lines = (topology.steering_axis, topology.wheel_axis)
        shortest = min(np.linalg.norm(place[b] - place[a], axis=-1).min() for a, b in lines)
        self.angle = 4 * self.position / shortest


def compare(
    plain: Motion, other: Motion, matrix: Array, shift: Array, scale: float, tolerance: Tolerances
) -> None:
    for name in plain.position:
        expected = scale * plain.position[name] @ matrix.T + shift
        assert np.abs(other.position[name] - expected).max() <= tolerance.position
        for quantity, allowed in (("velocity", tolerance.velocity), ("acceleration", tolerance.acceleration)):
            expected = scale * getattr(plain, quantity)[name] @ matrix.T
            assert np.abs(getattr(other, quantity)[name] - expected).max() <= allowed
    # An angular velocity is an axial vector: a mirror turns its sense round.
    sense = np.sign(np.linalg.det(matrix))
    for quantity, allowed in (
        ("angular_velocity", tolerance.omega),
        ("angular_acceleration", tolerance.alpha),
    ):
        expected = sense * getattr(plain, quantity)["knuckle"] @ matrix.T
        assert np.abs(getattr(other, quantity)["knuckle"] - expected).max() <= allowed
    for name in plain.wheel:
        # A steer angle is positive to the left on both wheels.
        turned = sense if name == "steer_angle" else 1.0
        expected = turned * expected_angle(name, plain, other, matrix)
        assert np.abs(other.wheel[name] - expected).max() <= tolerance.angle


vectors = st.tuples(*[st.floats(-3.0, 3.0)] * 3).map(np.array)
methods = st.sampled_from(list(METHODS))


def changed_car(
    make_scene: Callable[..., Scene],
    sample: SampleCar,
    car: Car,
    given_inputs: Mapping[str, Any],
    method: str,
    matrix: Array,
    shift: Array,
    scale: float,
    side: str = "left",
) -> None:
    plain = solve(make_scene(car=sample, points=car, **given_inputs, side=side), method)
    scaled = dict(given_inputs, rack=tuple(scale * c for c in given_inputs["rack"]))
    other = solve(
        make_scene(
            car=sample,
            points=moved_by(matrix, shift, scale, car),
            up=matrix[:, 2],
            right=matrix[:, 1],
            tolerance=1e-9 * scale,
            side=side,
            **scaled,
        ),
        method,
    )
    truncation = 1e-9 * scale if method == "series" else 0.0
    as_scaled = Tolerances(sample, (other, other), float(np.abs(shift).max()), truncation, other.unit)
    # The plain car's own errors, in the other's units.
    own = Tolerances(sample, (plain, plain), 0.0, 1e-9 if method == "series" else 0.0, plain.unit)
    for name, value in vars(own).items():
        factor = 1.0 if name in ("omega", "alpha", "angle") else scale
        setattr(as_scaled, name, getattr(as_scaled, name) + factor * value)
    # A turned vector is off by at most sqrt(3) times the largest error of a component.
    for name, value in vars(as_scaled).items():
        setattr(as_scaled, name, np.sqrt(3.0) * value)
    compare(plain, other, matrix, shift, scale, as_scaled)


@by_kind
@few
@given(data=st.data(), run=inputs(), turn=vectors, mirrored=st.booleans(), method=methods)
def test_turned_or_mirrored_car_moves_turned_or_mirrored(
    make_scene: Callable[..., Scene],
    kind: Kind,
    data: st.DataObject,
    run: dict[str, Any],
    turn: Array,
    mirrored: bool,
    method: str,
) -> None:
    x, y, z = turn
    matrix = expm(np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]]))
    if mirrored:
        matrix = matrix @ np.diag([1.0, -1.0, 1.0])
    changed_car(make_scene, kind.sample, data.draw(kind.cars), run, method, matrix, np.zeros(3), 1.0)


@by_kind
@few
@given(data=st.data(), run=inputs(), shift=vectors, power=st.integers(0, 8), method=methods)
def test_moved_car_moves_the_same_elsewhere(
    make_scene: Callable[..., Scene],
    kind: Kind,
    data: st.DataObject,
    run: dict[str, Any],
    shift: Array,
    power: int,
    method: str,
) -> None:
    changed_car(
        make_scene, kind.sample, data.draw(kind.cars), run, method, np.eye(3), shift * 10.0**power, 1.0
    )


@by_kind
@few
@given(data=st.data(), run=inputs(), power=st.floats(-9.0, 9.0), method=methods)
def test_scaled_car_moves_scaled(
    make_scene: Callable[..., Scene],
    kind: Kind,
    data: st.DataObject,
    run: dict[str, Any],
    power: float,
    method: str,
) -> None:
    changed_car(
        make_scene, kind.sample, data.draw(kind.cars), run, method, np.eye(3), np.zeros(3), 10.0**power
    )


@by_kind
@few
@given(data=st.data(), run=inputs())
def test_right_wheel_is_the_mirror_image_of_the_left(
    make_scene: Callable[..., Scene], kind: Kind, data: st.DataObject, run: dict[str, Any]
) -> None:
    mirror = np.diag([1.0, -1.0, 1.0])
    sample, car = kind.sample, data.draw(kind.cars)
    left = solve(make_scene(car=sample, points=car, **run, side="left"), "newton")
    # The car's right stays right: the rack's travel changes its sign, the wheel lies on the other side.
    other_run = dict(run, rack=tuple(-c for c in run["rack"]))
    right = solve(
        make_scene(car=sample, points=moved_by(mirror, np.zeros(3), 1.0, car), side="right", **other_run),
        "newton",
    )
    tolerance = Tolerances(sample, (left, right), 0.0, 0.0, max(left.unit, right.unit))
    compare(left, right, mirror, np.zeros(3), 1.0, tolerance)


@by_kind
@few
@given(data=st.data(), run=inputs(), method=methods)
def test_inputs_run_backwards_retrace_the_path(
    make_scene: Callable[..., Scene], kind: Kind, data: st.DataObject, run: dict[str, Any], method: str
) -> None:
    sample, car = kind.sample, data.draw(kind.cars)
    forwards = solve(make_scene(car=sample, points=car, side="left", **run), method)
    stop = run["stop"]

    def backwards(c: tuple[float, float, float]) -> tuple[float, float, float]:
        """c(stop - t)."""
        return (c[0] + c[1] * stop + c[2] * stop**2, -c[1] - 2 * c[2] * stop, c[2])

    other = solve(
        make_scene(
            car=sample,
            points=car,
            side="left",
            **dict(run, arm_angle=backwards(run["arm_angle"]), rack=backwards(run["rack"])),
        ),
        method,
    )
    tolerance = Tolerances(sample, (forwards, other), 0.0, 1e-9 if method == "series" else 0.0, forwards.unit)
    for name in car:
        assert np.abs(other.position[name][::-1] - forwards.position[name]).max() <= tolerance.position
        assert np.abs(other.velocity[name][::-1] + forwards.velocity[name]).max() <= tolerance.velocity
        gap = other.acceleration[name][::-1] - forwards.acceleration[name]
        assert np.abs(gap).max() <= tolerance.acceleration
    omega = other.angular_velocity["knuckle"][::-1] + forwards.angular_velocity["knuckle"]
    assert np.abs(omega).max() <= tolerance.omega


@by_car
def test_tolerances_of_these_laws_would_see_a_wrong_car(
    make_scene: Callable[..., Scene], car: SampleCar
) -> None:
    run = {"arm_angle": (1.5, 0.3, 0.1), "rack": (0.0, 30.0, 10.0), "stop": 0.5, "samples": 5}
    motion = simulate(make_scene(car=car, **run), "newton")
    tolerance = Tolerances(car, (motion, motion), 0.0, 0.0, motion.unit)
    # A millionth of a millimetre, of a rate or of a radian; ten times as much of an acceleration.
    assert tolerance.position < 1e-6
    assert tolerance.velocity < 1e-6 * max(np.abs(v).max() for v in motion.velocity.values())
    assert tolerance.acceleration < 1e-5 * max(np.abs(v).max() for v in motion.acceleration.values())
    assert tolerance.omega < 1e-6
    assert tolerance.angle < 1e-6
