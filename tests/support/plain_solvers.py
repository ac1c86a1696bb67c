"""A solver apart from the project's: closed forms in many digits, plain data in and out."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from cars_in_closed_form import STEERED, pose_of
from many_digits import DIGITS, Array, unit
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
        axis = STEERED[car.suspension]
        ends = (axis[0], "tie_rod_outer", "wheel_centre")
        turning = [
            _turning([_frame(*(pose[n][k] for n in ends)) for pose in (before, now, after)])
            for k in range(len(now[axis[0]]))
        ]
    quantities = ("position", "velocity", "acceleration")
    found: dict[str, Any] = {
        q: {n: state[n] for n in given["asked"].get(q, ())}
        for q, state in zip(quantities, states, strict=True)
    }
    for name, rates in zip(
        ("angular_velocity", "angular_acceleration"), zip(*turning, strict=True), strict=True
    ):
        found[name] = {"knuckle": np.array(rates, dtype=float)}
    inner = "wheel_axis_inner" if "wheel_axis_inner" in points else "strut_lower"
    places = states[0]
    spin, kingpin = places["wheel_centre"] - places[inner], places[axis[1]] - places[axis[0]]
    return found | {"wheel": _angles(given, spin, kingpin)}


def _poses(car: Car, inputs: Mapping[str, Any], step: mpf) -> dict[str, Any]:
    """Where every point is a little before or after each instant, (N, 3)."""
    moved = {}
    for name in ("arm_angle", "rack", "heave"):
        value, rate, bend = (np.array([mpf(x) for x in inputs[name][o]]) for o in inputs[name])
        moved[name] = value + step * rate + step * step * bend / 2
    count = len(moved["rack"])
    poses = [pose_of(car, **{name: law[k] for name, law in moved.items()}) for k in range(count)]
    return {name: np.stack([pose[name] for pose in poses]) for name in poses[0]}


def _frame(first: Array, second: Array, third: Array) -> Array:
    """Axes of a body as columns, from three of its points."""
    along = unit(second - first)
    across = unit(np.cross(along, third - first))
    return np.stack([along, across, np.cross(along, across)], axis=1)


def _turning(frames: list[Array]) -> tuple[Array, Array]:
    """omega and alpha of axes R: R' R^T = [omega]x, R'' R^T = [alpha]x + [omega]x^2, the square symmetric."""
    before, now, after = frames
    spins = ((after - before) / (2 * STEP), (after - 2 * now + before) / STEP**2)
    omega, alpha = (
        np.array([m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]]) / 2
        for m in (s @ now.T for s in spins)
    )
    return omega, alpha


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
