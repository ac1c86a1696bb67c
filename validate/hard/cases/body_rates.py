r"""Rates of the knuckle where the printed quotient is 0/0, and rates that are exactly zero.

The paper prints omega = v65 x v75 / (v65 . r75). As v = omega x r, its divisor is omega . (r65 x r75): it is
zero whenever omega lies in the plane of the knuckle's three points. While the arm is held v75 itself is zero,
and omega along the strut, in that plane; but the turning arm, too, passes an angle where it lies there.
Least squares over the three points divides by an inertia tensor, which only a knuckle in line makes singular.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from scipy.optimize import brentq

from pointcoord.effects.registry import QUANTITIES
from pointcoord.suspensions.macpherson import KNUCKLE
from validate.cars.car import Car
from validate.cars.scene_content import SQUARE, scene_content
from validate.hard.cars import CARS, OTHER_CAR, PAPER_CAR, paper_car
from validate.hard.case import FAILS, RIGHT, Case, coarse, decades
from validate.hard.trial import Facts, Tried, scene_case
from validate.reference import solve_reference

GROUP = "Body rates"
VALUES = (*decades(-12, -1), 0.0)
OURS = {"pointcoord": RIGHT, "pointcoord-newton": RIGHT, "absolute": RIGHT, "relative": RIGHT}
ALL = OURS | {"printed": FAILS}
# Of points and bodies; where points are, and angles of the wheel, are no rates.
RATES = tuple(q.name for q in QUANTITIES.values() if q.of != "car" and q.name != "position")
RACK_RATE = 150.0  # mm/s, the paper's steering scene


def omega_errors(tried: Tried) -> Facts:
    """Largest error of any component of the knuckle's angular velocity, by formulation."""
    if tried.reference is None:
        return {}
    true = tried.reference.angular_velocity["knuckle"]
    facts: dict[str, float | str] = {"largest angular velocity [rad/s]": float(np.abs(true).max())}
    for name, solution in tried.solutions.items():
        found = solution.angular_velocity["knuckle"]
        facts[f"error of it, {name} [rad/s]"] = float(np.abs(found - true).max())
    return facts


def largest_rates(tried: Tried) -> Facts:
    """Largest rate of any point or body, by formulation: of a car at rest it must be 0 to the last bit."""
    facts: dict[str, float | str] = {}
    for name, solution in tried.solutions.items():
        rates = [array for q in RATES for array in solution.numbers[q].values()]
        facts[f"largest rate, {name}"] = max(float(np.abs(array).max()) for array in rates)
    return facts


def _steered(value: float) -> dict[str, Any]:
    return paper_car([SQUARE, value], [0.0, RACK_RATE, 25.0], stop=0.4)


def across_the_plane(arm_angle: float) -> float:
    """Sine of the angle of the true omega with the plane of the knuckle's points; the rack is held."""
    pose = solve_reference(
        PAPER_CAR.points, {"arm_angle": (arm_angle, 1, 0), "rack": (0, 0, 0)}, closure="collinear"
    )
    first, second, third = (np.array(pose.position_as_float(name)) for name in KNUCKLE)
    normal = np.cross(second - first, third - first)
    omega = np.array([float(x) for x in pose.angular_velocity["knuckle"]])
    return float(omega @ normal) / float(np.linalg.norm(omega) * np.linalg.norm(normal))


@cache
def plane_angle() -> float:
    """Arm angle, rad, at which omega comes to lie in the knuckle's plane while the arm turns on."""
    # The sine above is -0.02 and 0.02 at these, and changes little between them.
    return float(brentq(across_the_plane, 1.6, 1.85, xtol=1e-15, rtol=8.9e-16))


def _in_the_plane(value: float) -> dict[str, Any]:
    return paper_car([plane_angle() + value, 1.0])


def _resting(car: Car) -> Callable[[float], dict[str, Any]]:
    return lambda value: scene_content(car, [SQUARE + value, 0.0, 0.0], [20.0, 0.0], 0.0, stop=1.0)


def _one_rate(car: Car, name: str) -> Callable[[float], dict[str, Any]]:
    def content(value: float) -> dict[str, Any]:
        laws: dict[str, Any] = {"arm_angle": SQUARE, "rack": 0.0}
        return scene_content(car, **laws | {name: [laws[name], value]})

    return content


def _slow_and_still(suffix: str, moved: Car, still: Car) -> tuple[Case, ...]:
    """Inputs that hardly move, and inputs at rest."""
    tiny = (*(float(f"1e-{25 * k}") for k in range(1, 13)), 0.0)
    return (
        *(
            scene_case(
                name=f"{label}-hardly-moves{suffix}",
                group=GROUP,
                why=f"only the {label} moves, slower and slower: rates keep their digits down to zero",
                parameter=f"rate of the {label}, {unit}; then at rest",
                values=coarse(tiny) if suffix else tiny,
                scene=_one_rate(moved, name),
                expected=OURS,
                behaviour="right, and exactly zero at rest",
                measure=largest_rates,
            )
            for name, label, unit in (("arm_angle", "arm", "rad/s"), ("rack", "rack", "mm/s"))
        ),
        scene_case(
            name=f"at-rest{suffix}",
            group=GROUP,
            why="all inputs rest, so every rate is zero: rounding must not make a motion of it",
            parameter="arm angle from a right angle, rad; then at it",
            values=coarse(VALUES) if suffix else VALUES,
            scene=_resting(still),
            expected=OURS,
            behaviour="every rate is exactly zero",
            measure=largest_rates,
        ),
    )


CASES: tuple[Case, ...] = (
    scene_case(
        name="arm-all-but-held",
        group=GROUP,
        why="points 5 and 7 stand almost still while the rack moves: the printed omega is 0/0",
        parameter="rate of the arm while the rack is driven, rad/s; then the arm is held",
        values=VALUES,
        scene=_steered,
        expected=ALL,
        behaviour="pointcoord and the absolute model are right; the printed omega loses all its digits",
        measure=omega_errors,
    ),
    scene_case(
        name="omega-in-the-knuckle-plane",
        group=GROUP,
        why="omega lies in the plane of the knuckle's points: the divisor of the printed quotient is zero",
        parameter="distance of the turning arm from the angle at which it does, rad; then at it",
        values=VALUES,
        scene=_in_the_plane,
        expected=ALL,
        behaviour="pointcoord and the absolute model are right; the printed omega loses all its digits",
        measure=omega_errors,
    ),
    *_slow_and_still("", PAPER_CAR, OTHER_CAR),
    *_slow_and_still("-wishbone", CARS["wishbone"], CARS["wishbone-turned"]),
)
