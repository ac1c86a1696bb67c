"""A crank on a car that rolls and pitches, against rotations written out and differentiated in 60 digits."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from flat import built_in, flat, shipped
from kinds import KINDS
from mpmath import mp, mpf
from numpy.typing import NDArray

import absolute

Array = NDArray[np.float64]
Law = Callable[[Any], Any]

EPS = float(np.finfo(float).eps)
POINTS = {
    "a": (10.0, 20.0, 5.0),
    "b": (110.0, 20.0, 5.0),
    "end": (60.0, 320.0, 5.0),
    "middle": (700.0, -30.0, 50.0),
}
TIMES = (0.0, 0.3, 0.7)
# Polynomials with exact coefficients: value, rate and acceleration are exact in few digits.
LAWS = {
    "crank": (0.5, 2.0, -1.5),
    "roll": (0.25, -1.25, 0.5),
    "pitch": (-0.125, 0.75, 2.0),
}
SHIFT = (3.0, -8.0, 16.0)
# Axes as they are told, and as they are: up is z, right is y, so forward is -x and left -y.
AXES = {"roll": ("forward", (-1, 0, 0), "middle"), "pitch": ("left", (0, -1, 0), "end")}


def crank(order: tuple[str, ...] = ("roll", "pitch")) -> absolute.Model:
    turns = {n: {"turns": "chassis", "along": AXES[n][0], "about": AXES[n][2]} for n in order}
    return absolute.compile(
        {
            "name": "crank",
            "bodies": {"chassis": ["a", "b", "middle"], "crank": ["a", "b", "end"]},
            "inputs": {"crank": {"angle": "crank", "from": "drawing", "on": "chassis"}, **turns},
            "points": POINTS,
            "up": (0, 0, 1),
            "right": (0, 1, 0),
            "side": "left",
        }
    )


def told(law: tuple[float, ...]) -> Array:
    c0, c1, c2 = law
    times = [mpf(t) for t in TIMES]
    return np.array([[float(c0 + c1 * t + c2 * t * t), float(c1 + 2 * c2 * t), 2 * c2] for t in times])


def rotation(axis: tuple[int, ...], angle: Any) -> Any:
    """Right-handed about an axis, by its exponential series' two sums."""
    x, y, z = axis
    across = mp.matrix([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return mp.eye(3) + mp.sin(angle) * across + (1 - mp.cos(angle)) * across * across


class Exact:
    """Places and turns of the crank on the turned car, at any time."""

    def __init__(self, order: tuple[str, ...] = ("roll", "pitch")) -> None:
        self.order = order

    def law(self, name: str, t: Any) -> Any:
        c0, c1, c2 = LAWS[name]
        return c0 + c1 * t + c2 * t * t

    def turn(self, t: Any, own: bool) -> Any:
        turned = rotation((1, 0, 0), self.law("crank", t)) if own else mp.eye(3)
        for name in self.order:
            turned = rotation(AXES[name][1], self.law(name, t)) * turned
        return turned

    def place(self, name: str, t: Any) -> Any:
        hinge, place = mp.matrix(POINTS["a"]), mp.matrix(POINTS[name])
        if name == "end":
            place = hinge + rotation((1, 0, 0), self.law("crank", t)) * (place - hinge)
        for turn in self.order:
            about = mp.matrix(POINTS[AXES[turn][2]])
            place = about + rotation(AXES[turn][1], self.law(turn, t)) * (place - about)
        c0, c1, c2 = SHIFT
        place[2] += c0 + c1 * t + c2 * t * t
        return place

    def spin(self, t: Any) -> Any:
        """w of R' = (w x) R."""
        rate = mp.matrix(3, 3)
        for i in range(3):
            for j in range(3):
                rate[i, j] = mp.diff(lambda s, i=i, j=j: self.turn(s, True)[i, j], t)
        across = rate * self.turn(t, True).T
        return mp.matrix([across[2, 1], across[0, 2], across[1, 0]])


def rates_of(vector: Law, t: Any, order: int) -> list[Any]:
    return [mp.diff(lambda s, i=i: vector(s)[i], t, order) for i in range(3)]


def solved(order: tuple[str, ...] = ("roll", "pitch"), **options: Any) -> absolute.Solution:
    shift = told(SHIFT)[:, :, None] * np.array([0.0, 0.0, 1.0])
    return absolute.solve(
        crank(order), {name: told(law) for name, law in LAWS.items()}, chassis=shift, **options
    )


def within(found: Array, off: float, exact: list[Any]) -> None:
    assert all(abs(mpf(x) - e) <= off for x, e in zip(found.tolist(), exact, strict=True)), (found, exact)


@pytest.mark.parametrize("order", [("roll", "pitch"), ("pitch", "roll")])
def test_every_point_and_body_moves_as_the_turned_car_written_out(order: tuple[str, ...]) -> None:
    motion, exact = solved(order), Exact(order)
    # A place below 512 mm has some ten roundings of 2^-53 of that in three turns, 6e-13 mm; the three turn by
    # less than 7 rad/s together, so that a rate loses less than ten times as much, and an acceleration ten
    # times that. A turn the wrong way, no Coriolis term or another point would be off by millimetres.
    points = {"position": 1e-12, "velocity": 1e-11, "acceleration": 1e-10}
    with mp.workdps(60):
        for i, t in enumerate(map(mpf, TIMES)):
            for name in POINTS:
                for number, (quantity, off) in enumerate(points.items()):
                    meant = rates_of(lambda s, name=name: exact.place(name, s), t, number)
                    within(getattr(motion, quantity)[name][i], off, meant)
            within(motion.angular_velocity["crank"][i], 1e-13, list(exact.spin(t)))
            within(motion.angular_acceleration["crank"][i], 1e-12, rates_of(exact.spin, t, 1))


def test_a_turn_that_is_not_told_is_none() -> None:
    inputs = {"crank": told(LAWS["crank"])}
    still = absolute.solve(crank(), inputs)
    for name, place in absolute.solve(crank(()), inputs).acceleration.items():
        assert np.array_equal(place, still.acceleration[name])
    zero = {name: np.zeros((len(TIMES), 3)) for name in AXES}
    for name, place in absolute.solve(crank(), inputs | zero).acceleration.items():
        assert np.abs(place - still.acceleration[name]).max() <= 8 * EPS * 300.0 * 16.0


def test_wheel_angles_are_those_of_the_turned_wheel_against_the_ground() -> None:
    kind = KINDS["double wishbone"]
    file, names = shipped("double_wishbone"), ("camber", "kingpin", "toe", "caster")
    file["inputs"]["roll"] = {"turns": "chassis", "about": "lower_arm_front", "along": "forward"}
    file["inputs"]["yaw"] = {"turns": "chassis", "about": "wheel_centre", "along": "up"}
    inputs = kind.inputs(np.linspace(0.0, 0.4, 5))
    turn = np.zeros((5, 3))
    turn[:, 0] = np.linspace(-0.3, 0.2, 5)
    driven = ("arm_angle", "rack", "roll", "yaw")
    model = absolute.compile(flat(file, kind.car, driven))
    still = absolute.solve(built_in("double_wishbone", kind.car), inputs, effects=names)
    for name in ("yaw", "roll"):
        motion = absolute.solve(model, inputs | {name: turn}, effects=names)
        line = motion.position["wheel_centre"] - motion.position["wheel_axis_inner"]
        # Of a left wheel, outboard is -y; toe leads forward, which is -x, of the wheel inwards.
        seen = {"camber": np.arctan2(-line[:, 2], -line[:, 1]), "toe": np.arctan2(-line[:, 0], -line[:, 1])}
        for angle, value in seen.items():
            # The ends of a line of 60 mm are rounded at 800 mm.
            assert np.abs(motion.effects[angle] - value).max() <= 1e-13
        if name == "yaw":
            # The car's front goes to the left, and that of a left wheel outwards.
            assert np.abs(motion.effects["toe"] - still.effects["toe"] + turn[:, 0]).max() <= 1e-13


def test_a_motion_that_ends_on_its_way_is_turned_as_far_as_it_goes() -> None:
    kind = KINDS["strut"]
    file = shipped("macpherson")
    file["inputs"]["roll"] = {"turns": "chassis", "about": "lower_arm_front", "along": "forward"}
    model = absolute.compile(flat(file, kind.car, ("arm_angle", "rack", "roll")))
    inputs = kind.inputs(np.linspace(0.0, 20.0, 200)) | {"roll": np.tile([0.1, 0.2, 0.3], (200, 1))}
    with pytest.raises(absolute.UnreachableError) as refused:
        absolute.solve(model, inputs)
    partial = refused.value.partial
    assert partial is not None
    count = len(partial.residual)
    whole = absolute.solve(model, {name: law[:count] for name, law in inputs.items()}, conditions=True)
    # Two ways to the same pose differ by what its condition makes of rounding.
    assert whole.condition is not None
    off = 16 * EPS * whole.condition[:, None]
    for name, speed in whole.velocity.items():
        assert (np.abs(partial.velocity[name] - speed) <= off * np.abs(speed).max()).all()


@pytest.mark.parametrize(
    ("law", "words"),
    [
        (np.zeros((2, 3)), "'roll' has 2 instants, the others have 3"),
        (np.full((3, 3), np.nan), "'roll' is .nan, nan, nan. at instant 0"),
        (np.tile([0.0, 1e101, 0.0], (3, 1)), "turn 'roll' is .0.0, 1e.101, 0.0. at instant 0; products"),
        (np.zeros(3), "'roll' has shape"),
    ],
)
def test_a_turn_that_is_no_motion_is_refused_with_what_and_where(law: Array, words: str) -> None:
    with pytest.raises(absolute.InputError, match=words) as refused:
        absolute.solve(crank(), {"crank": told(LAWS["crank"]), "roll": law})
    assert refused.value.name == "roll"


def test_a_turn_about_no_point_of_the_car_is_refused() -> None:
    points = {"a": (0, 0, 0), "b": (100, 0, 0), "end": (0, 300, 0)}
    told = {
        "name": "crank",
        "bodies": {"chassis": ["a", "b"], "crank": ["a", "b", "end"]},
        "inputs": {
            "crank": {"angle": "crank", "from": "drawing", "on": "chassis"},
            "roll": {"turns": "chassis", "about": "centre", "along": "forward"},
        },
        "points": points,
        "up": (0, 0, 1),
        "right": (0, 1, 0),
        "side": "left",
    }
    with pytest.raises(absolute.DescriptionError, match="the point of input 'roll' is 'centre'"):
        absolute.compile(told)
