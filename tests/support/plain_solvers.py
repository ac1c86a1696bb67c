"""A solver apart from the project's: closed forms in many digits, plain data in and out."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from cars_in_closed_form import STEERED, pose_of
from many_digits import DIGITS
from mpmath import mp, mpf

from validate.cars.car import Car

STEP = mpf(10) ** -12  # of differences: they leave out its square, and lose as many of the digits


def closed_form(given: Mapping[str, Any]) -> dict[str, Any]:
    """Every quantity of a strut or a double wishbone as drawn, to the last bits of a double."""
    return solved(given, given["points"])


def less_exact(off: float, seed: int = 1) -> Any:
    """The same for a car whose hardpoints are off by up to half of `off`, mm, each coordinate by itself."""

    def solve(given: Mapping[str, Any]) -> dict[str, Any]:
        rng = np.random.default_rng(seed)
        moved = {n: np.array(p) + off / 2.0 * rng.uniform(-1.0, 1.0, 3) for n, p in given["points"].items()}
        return solved(given, moved)

    return solve


def solved(given: Mapping[str, Any], points: Mapping[str, Any]) -> dict[str, Any]:
    """All that is asked, of a car with these hardpoints."""
    with mp.workdps(DIGITS):
        car = Car(
            {name: tuple(float(x) for x in place) for name, place in points.items()},
            given["side"],
            tuple(given["up"]),
            tuple(given["right"]),
            given["closure"],
            given["suspension"],
        )
        before, now, after = (_poses(car, given["inputs"], step) for step in (-STEP, mpf(0), STEP))
        states = [
            {n: place.astype(float) for n, place in now.items()},
            {n: ((after[n] - before[n]) / (2 * STEP)).astype(float) for n in now},
            {n: ((after[n] - 2 * now[n] + before[n]) / STEP**2).astype(float) for n in now},
        ]
    quantities = ("position", "velocity", "acceleration")
    found: dict[str, Any] = {
        q: {n: state[n] for n in given["asked"].get(q, ())}
        for q, state in zip(quantities, states, strict=True)
    }
    axis = STEERED[car.suspension]
    turning = _turning([_sides(state, (axis[0], "tie_rod_outer", "wheel_centre")) for state in states])
    found["angular_velocity"], found["angular_acceleration"] = ({"knuckle": turn} for turn in turning)
    inner = "wheel_axis_inner" if "wheel_axis_inner" in points else "strut_lower"
    return found | {
        "wheel": _angles(given, states[0]["wheel_centre"] - states[0][inner], _line(states[0], axis))
    }


def _poses(car: Car, inputs: Mapping[str, Any], step: mpf) -> dict[str, Any]:
    """Where every point is a little before or after each instant, (N, 3)."""
    moved = {}
    for name in ("arm_angle", "rack", "heave"):
        value, rate, bend = (np.array([mpf(x) for x in inputs[name][o]]) for o in inputs[name])
        moved[name] = value + step * rate + step * step * bend / 2
    count = len(moved["rack"])
    poses = [pose_of(car, **{name: law[k] for name, law in moved.items()}) for k in range(count)]
    return {name: np.stack([pose[name] for pose in poses]) for name in poses[0]}


def _line(state: Mapping[str, Any], ends: tuple[str, str]) -> Any:
    return state[ends[1]] - state[ends[0]]


def _sides(state: Mapping[str, Any], names: tuple[str, ...]) -> Any:
    """From the first point to the second and third, (N, 2, 3)."""
    first, *others = (state[name] for name in names)
    return np.stack([other - first for other in others], axis=1)


def _turning(sides: list[Any]) -> tuple[Any, Any]:
    """omega and alpha by least squares of s' = omega x s and s'' = alpha x s + omega x s' of two sides."""

    def solved_for(wanted: Any) -> Any:
        rows = np.concatenate([_crossing(sides[0][:, i]) for i in range(2)], axis=1)
        return np.array(
            [np.linalg.lstsq(a, b.reshape(-1), rcond=None)[0] for a, b in zip(rows, wanted, strict=True)]
        )

    omega = solved_for(sides[1])
    return omega, solved_for(sides[2] - np.cross(omega[:, None], sides[1]))


def _crossing(side: Any) -> Any:
    """Matrices that give omega x side, (N, 3, 3)."""
    x, y, z = side.T
    zero = np.zeros_like(x)
    return np.stack([zero, z, -y, -z, zero, x, y, -x, zero], axis=-1).reshape(-1, 3, 3)


def _angles(given: Mapping[str, Any], spin: Any, kingpin: Any) -> dict[str, Any]:
    up, right = np.array(given["up"]), np.array(given["right"])
    outboard = -right if given["side"] == "left" else right
    forward = np.cross(up, right)
    return {
        "camber": np.arctan2(-(spin @ up), spin @ outboard),
        "kingpin": np.arctan2(-(kingpin @ outboard), kingpin @ up),
        "toe": np.arctan2(spin @ forward, spin @ outboard),
        "caster": np.arctan2(-(kingpin @ forward), kingpin @ up),
    }
