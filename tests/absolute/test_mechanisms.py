"""Redundant rows, and derivatives of an arm on an arm."""

from math import comb
from typing import Any

import numpy as np
import pytest
from scipy.linalg import expm
from shipped import Array, Motion

import absolute


def at(values: Any, rate: float = 0.0) -> Array:
    """Value, rate and no acceleration at N instants."""
    values = np.asarray(values, dtype=float)
    return np.stack([values, np.full_like(values, rate), np.zeros_like(values)], axis=-1)


def four_bar(tilt: float = 0.0, **more: Any) -> dict[str, Any]:
    """Hinges along x at (0, 0), (40, 30), (160, 60), (150, 0) in y and z; the last one tilted."""
    places = [(0, 0), (40, 30), (160, 60), (150, 0)]
    points = {f"p{i}": (0, y, z) for i, (y, z) in enumerate(places)}
    points |= {f"q{i}": (100, y + (100 * tilt if i == 3 else 0), z) for i, (y, z) in enumerate(places)}
    bodies = {
        "chassis": ["p0", "q0", "p3", "q3"],
        "crank": ["p0", "q0", "p1", "q1"],
        "coupler": ["p1", "q1", "p2", "q2"],
        "rocker": ["p2", "q2", "p3", "q3"],
    }
    inputs = {"turn": {"angle": "crank", "from": "drawing", "on": "chassis"}}
    axes = {"up": (0.0, 0.0, 1.0), "right": (0.0, 1.0, 0.0), "side": "left"}
    return {"name": "four-bar", "bodies": bodies, "points": points, "inputs": inputs, **axes, **more}


@pytest.mark.parametrize(
    ("tilt", "turn", "rate", "effects", "kind", "words"),
    [
        (1e-2, [0.0], 0.0, [], absolute.DescriptionError, "hinge of.*overconstrained"),
        (1e-9, [0.0, 0.5], 0.0, [], absolute.PoseError, "hinge of"),
        (1e-10, [0.0], 1.0, [], absolute.AssemblyError, r"hinge of.*locked"),
        (1e-10, [0.0], 0.0, ["toe_by_travel"], absolute.AssemblyError, r"hinge of.*locked"),
    ],
)
def test_a_four_bar_whose_hinges_are_not_parallel_is_locked(
    tilt: float, turn: list[float], rate: float, effects: list[str], kind: type[Exception], words: str
) -> None:
    bars = four_bar(tilt, roles={"wheel_axis": ["q1", "q2"]})
    with pytest.raises(kind, match=words):
        Motion(bars, {"turn": at(turn, rate)}).solve(effects=effects)
    if tilt == 1e-10:
        assert Motion(bars, {"turn": at([0.0])}).solve(effects=["toe"]).effects


def test_every_derivative_of_an_arm_that_turns_on_a_turning_arm_is_that_of_two_rotations() -> None:
    """The hinge on the first arm is askew, so that its axis turns: up to order 20, over more than a turn."""
    speeds, points = (1.7, -2.3), {"o": (0, 0, 0), "p": (0, 0, 9), "a": (40, 3, 5), "b": (46, 5, 14)}
    points |= {"end": (70, -20, 9)}
    arms = {"chassis": ["o", "p"], "upper": ["o", "p", "a", "b"], "fore": ["a", "b", "end"]}
    inputs = {
        "shoulder": {"angle": "upper", "from": "drawing", "on": "chassis"},
        "elbow": {"angle": "fore", "from": "drawing", "on": "upper"},
    }
    times, orders = np.linspace(0.0, 4.0, 9), np.arange(21)
    laws = {n: np.zeros((9, 21)) for n in inputs}
    for law, speed in zip(laws.values(), speeds, strict=True):
        law[:, 0], law[:, 1] = speed * times, speed
    described = {"bodies": arms, "points": points, "inputs": inputs}
    found = absolute.solve(absolute.compile(four_bar() | described), laws).derivatives

    def spun(speed: float, axis: Array, t: float) -> Array:
        """A rotation and its derivatives, each the one before turned by a right angle."""
        k = speed * np.cross(axis / np.linalg.norm(axis), np.eye(3)).T
        return np.stack([expm(k * t) @ np.linalg.matrix_power(k, n) for n in orders])

    place = {name: np.array(point, float) for name, point in points.items()}
    for i, t in enumerate(times):
        first = spun(speeds[0], place["p"], t)
        second = spun(speeds[1], place["b"] - place["a"], t) @ (place["end"] - place["a"])
        second[0] += place["a"]
        for n in orders:
            meant = sum(comb(n, j) * first[j] @ second[n - j] for j in range(n + 1))
            np.testing.assert_allclose(found[n]["end"][i], meant, rtol=0.0, atol=1e-12 * 100.0 * 4.0**n)
