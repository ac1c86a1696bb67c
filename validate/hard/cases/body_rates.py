r"""Rates of the knuckle where the printed quotient is 0/0, and rates that are exactly zero.

The paper prints omega = v65 x v75 / (v65 . r75). As v = omega x r, its divisor is omega . (r65 x r75): it is
zero whenever omega lies in the plane of the knuckle's three points. While the arm is held v75 itself is zero,
and omega along the strut, in that plane; but the turning arm, too, passes an angle where it lies there.
Least squares over the three points divides by an inertia tensor, which only a knuckle in line makes singular.
"""

from __future__ import annotations

from functools import partial

import numpy as np

from pointcoord.effects.registry import QUANTITIES
from validate.hard.cars import CARS, PAPER_CAR, SQUARE, scene_content
from validate.hard.case import FAILS, RIGHT, SOLVERS, case, decades, family
from validate.hard.subjects import SUBJECTS, Content, Subject, hyphens
from validate.hard.trial import Trial

VALUES = (*decades(-12, -1), 0.0)
# Of points and bodies; where points are, and angles of the wheel, are no rates.
RATES = tuple(q.name for q in QUANTITIES.values() if q.of != "car" and q.name != "position")
RACK_RATE = 150.0  # mm/s, the paper's steering scene
PLANE_ANGLE = 1.760964175417552  # rad, where omega comes to lie in the knuckle's plane while the arm turns on


def omega_errors(_: Subject, value: float, trial: Trial) -> Trial:
    """Largest error of any component of the knuckle's angular velocity, by formulation."""
    if trial.tried is None or trial.tried.known is None:
        return trial
    true = trial.tried.known.angular_velocity["knuckle"]
    facts: dict[str, float | str] = {"largest angular velocity [rad/s]": float(np.abs(true).max())}
    for name, solution in trial.tried.solutions.items():
        found = solution.angular_velocity["knuckle"]
        facts[f"error of it, {name} [rad/s]"] = float(np.abs(found - true).max())
    return trial.noting(facts)


def largest_rates(_: Subject, value: float, trial: Trial) -> Trial:
    """Largest rate of any point or body, by formulation: of a car at rest it must be 0 to the last bit."""
    facts: dict[str, float | str] = {}
    for name, solution in ({} if trial.tried is None else trial.tried.solutions).items():
        # A mechanism whose points are all of rods and slides has no angular velocity.
        rates = [array for q in RATES for array in solution.numbers.get(q, {}).values()]
        facts[f"largest rate, {name}"] = max(float(np.abs(array).max()) for array in rates)
    return trial.noting(facts)


def arm_all_but_held(_: Subject, value: float) -> Content:
    """Points 5 and 7 stand almost still while the rack moves: the printed omega is 0/0."""
    return scene_content(PAPER_CAR, [SQUARE, value], [0.0, RACK_RATE, 25.0], stop=0.4)


def omega_in_the_knuckle_plane(_: Subject, value: float) -> Content:
    """Omega lies in the plane of the knuckle's points: the divisor of the printed quotient is zero."""
    return scene_content(PAPER_CAR, [PLANE_ANGLE + value, 1.0])


# Of the two suspensions that the catalogue began with, the one at rest leans every way, or is far off too.
LEANING = {"paper": CARS["other"], "wishbone": CARS["wishbone-turned"]}


def at_rest(subject: Subject, value: float) -> Content:
    """All inputs rest, so every rate is zero: rounding must not make a motion of it."""
    still = [value, 0.0, 0.0], [20.0 if subject.level else value, 0.0], 0.0 if subject.heaves else None
    return subject.content(*still, car=LEANING.get(subject.name, subject.car), stop=1.0)


def hardly_moves(driven: str, subject: Subject, value: float) -> Content:
    """One input at this rate, all others at rest."""
    whole = subject.content()
    home = subject.home[driven]
    return {**whole, "inputs": {**whole["inputs"], driven: {"polynomial": [home, value]}}}


GROUP = "Body rates"
_printed = partial(
    case,
    values=VALUES,
    expected={**dict.fromkeys(SOLVERS, RIGHT), "printed": FAILS},
    group=GROUP,
    judged=omega_errors,
    behaviour="pointcoord and the absolute model are right; the printed omega loses all its digits",
)
_rates = partial(family, group=GROUP, judged=largest_rates)
WORDS = {"arm_angle": ("arm", "rad/s"), "rack": ("rack", "mm/s")}
INPUTS = {name: unit for subject in SUBJECTS for name, unit in subject.units.items()}

CASES = (
    _printed(arm_all_but_held, "rate of the arm while the rack is driven, rad/s; then the arm is held"),
    _printed(
        omega_in_the_knuckle_plane,
        "distance of the turning arm from the angle at which it does, rad; then at it",
    ),
    *(
        case
        for name, unit in INPUTS.items()
        for label, per_second in (WORDS.get(name, (name, f"{unit}/s")),)
        for case in _rates(
            partial(hardly_moves, name),
            f"rate of the {label}, {per_second}; then at rest",
            (*(float(f"1e-{25 * k}") for k in range(1, 13)), 0.0),
            subjects=[one for one in SUBJECTS if name in one.kinds],
            name=f"{hyphens(label)}-hardly-moves",
            why=f"Only the {label} moves, slower and slower: rates keep their digits down to zero.",
            behaviour="right, and exactly zero at rest",
        )
    ),
    *_rates(
        at_rest,
        "arm angle from a right angle, rad; then at it",
        VALUES,
        behaviour="every rate is exactly zero",
    ),
)
