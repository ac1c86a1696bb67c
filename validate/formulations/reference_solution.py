"""The reference as a solution and as a formulation: at a scene's instants, rounded to doubles.

A drawing need not be assembled exactly. So the reference reports a drawing as unclear if another assembly is
nearer than 1e-9 of its size. A car may be drawn near a pose where two assemblies meet on purpose, with exact
coordinates; `exact_sides` then turns this check off.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import lru_cache
from math import nan
from typing import Any

import numpy as np

from pointcoord import Scene
from pointcoord.effects.point_states import STATES
from pointcoord.effects.registry import NUMBERS_OF_THE_CAR, QUANTITIES
from pointcoord.numerics.rounding import EPS, UNIT_ROUNDOFF
from validate.arrays import Array
from validate.formulations.asked_numbers import asked_numbers, asked_of_the_car, is_force
from validate.formulations.input_rates import laws_of
from validate.formulations.protocol import Accuracy, Solution, largest_at, refusing
from validate.formulations.stated_accuracy import accuracy_at
from validate.reference import Design, Instant, NoReferenceError, instants_of
from validate.reference.effects.at_pose import numbers_of
from validate.reference.effects.registry import ANGLES, EFFECTS
from validate.reference.exact import as_fraction
from validate.reference.instant import derivative_called
from validate.reference.loads import FORCES
from validate.reference.route import CLEAR

Arrays = dict[str, Array]
OF_BODIES = ("angular_velocity", "angular_acceleration")

ANGLE = NUMBERS_OF_THE_CAR[ANGLES[0]].quantity.name
DIGITS = 60
Inputs = Mapping[str, Sequence[float]]


def inputs_at(scene: Scene, time: float) -> dict[str, tuple[float, ...]]:
    """Value, rate and acceleration of every input at an instant, and higher derivatives if asked for."""
    return {name: tuple(law[0].tolist()) for name, law in laws_of(scene, np.array([time])).items()}


def design_of(scene: Scene) -> Design:
    """The scene's mechanism in the form of the reference; kept, so its drawing is closed only once."""
    return _design(json.dumps(scene.mechanism.plain(tuple(scene.inputs))))


@lru_cache(maxsize=64)
def _design(plain: str) -> Design:
    return Design.from_plain(json.loads(plain))


def reference_instant(scene: Scene, inputs: Inputs, digits: int = DIGITS) -> Instant:
    """The reference for a scene's car at given inputs, reached from the drawing.

    Args:
        inputs: value, rate and acceleration of each input, and higher derivatives as far as points need them.
    Raises:
        NoReferenceError: there is no pose, or no pose can be proven.
    """
    return next(instants_of(design_of(scene), [inputs], digits, CLEAR, effects_of(scene)))


def reference_motion(scene: Scene, times: Sequence[float], exact_sides: bool = False) -> list[Instant]:
    """The reference at instants of a scene's motion; each pose is reached from the one before.

    Args:
        exact_sides: whether the drawing is exact, however near it is to another assembly.
    Raises:
        NoReferenceError: an instant has no pose, or no pose can be proven.
    """
    inputs, clear = (inputs_at(scene, time) for time in times), 0.0 if exact_sides else CLEAR
    return list(instants_of(design_of(scene), inputs, DIGITS, clear, effects_of(scene)))


def effects_of(scene: Scene) -> tuple[str, ...]:
    """The numbers of the car to compute: those that the scene asks for, and always the angles."""
    asked = dict.fromkeys((*ANGLES, *asked_of_the_car(scene)))
    return tuple(name for name in asked if name.rpartition(".")[2] in EFFECTS)


def reference_solution(scene: Scene, exact_sides: bool = False) -> Solution:
    """The reference at a scene's instants, rounded, in the form that `compare_solutions` takes.

    Raises:
        NoReferenceError: an instant has no pose, or no pose can be proven.
    """
    return as_solution(scene, reference_motion(scene, scene.instants.tolist(), exact_sides))


def as_solution(scene: Scene, instants: Sequence[Instant], times: Array | None = None) -> Solution:
    """The reference at the instants of a scene, or at other times, rounded to doubles.

    A number smaller than the reference's proven error is set to zero, and its error bound is that error: the
    midpoints of intervals about 0 are some 1e-170. An angle that is missing at one instant is left out of the
    solution. Any other number of the car is NaN where it is missing: the wheels are not steered to one side,
    or a centre is at infinity.
    """
    times, asked = scene.instants if times is None else times, asked_numbers(scene)
    asked[ANGLE] = tuple(dict.fromkeys((*ANGLES, *asked.get(ANGLE, ()))))
    car, orders = filter(_is_effect, asked), len(instants[0].derivatives)
    had = {number.name for number in numbers_of(design_of(scene), effects_of(scene))}
    numbers, claims = dict[str, Arrays](), dict[str, Arrays]()
    for quantity in (*STATES[:orders], *OF_BODIES, *FORCES, *car):
        rows = [exact_numbers(instant, quantity) for instant in instants]
        names = [name for name in asked[quantity] if name in had] if _is_effect(quantity) else [*rows[0]]
        if quantity == ANGLE or is_force(quantity):
            names = [name for name in names if all(name in row for row in rows)]
        found = {n: np.array([row.get(n, nan) for row in rows], dtype=float) for n in names}
        proven = proven_error(instants, quantity)
        numbers[quantity] = {n: np.where(np.abs(one) <= proven, 0.0, one) for n, one in found.items()}
        claims[quantity] = {
            n: UNIT_ROUNDOFF * np.abs(np.nan_to_num(one)) + proven for n, one in numbers[quantity].items()
        }
    return Solution("reference", times, numbers, Accuracy(np.ones(len(times)), claims, proven=True))


def exact_numbers(instant: Instant, quantity: str) -> Mapping[str, Any]:
    """The reference's exact numbers of a quantity of pointcoord at an instant, by name."""
    if quantity in STATES:
        return instant.derivatives[STATES.index(quantity)]
    return instant.effects if _is_effect(quantity) else getattr(instant, quantity)


def proven_error(instants: Sequence[Instant], quantity: str) -> float:
    """The largest proven error of a quantity of pointcoord at some instants, in the quantity's unit."""
    name = "effects" if _is_effect(quantity) else quantity
    if quantity in STATES:
        name = derivative_called(STATES.index(quantity))
    return max(float(instant.error_bound[name]) for instant in instants)


def _is_effect(quantity: str) -> bool:
    return QUANTITIES[quantity].of == "car" and not is_force(quantity)


def off_by(found: float, exact: Any) -> float:
    """The distance of a double from a number of the reference, rounded once."""
    return float(abs(as_fraction(exact, "number") - Fraction(float(found))))


def told_by(reference: Solution, scene: Scene) -> dict[str, tuple[str, ...]]:
    """The names that the scene asks for, by quantity, as far as the reference has them at every instant.

    An angle that the reference leaves out is 0/0 at some instant, or half a turn, where its sign has no
    meaning.
    """
    given = reference.numbers
    return {
        quantity: tuple(n for n in names if n in given[quantity] and not np.isnan(given[quantity][n]).any())
        for quantity, names in asked_numbers(scene).items()
        if quantity in given
    }


class ManyDigits:
    """The reference as a formulation, for use where no other model is available.

    Exact equations in ball arithmetic, solved to 60 digits and rounded to doubles.

    The error bounds are those of the rounding. The usual error of a method in doubles (`Accuracy.usual`) is
    the error of a solver whose points are accurate to EPS times the car's size.
    """

    name = "reference"

    def solve(self, scene: Scene) -> Solution:
        """Solve a scene.

        Raises:
            FormulationError: an instant has no pose, or no pose can be proven.
        """
        with refusing(self.name, NoReferenceError):
            found = reference_solution(scene)
        places = found.numbers["position"]
        off = EPS * float(np.ptp([place[0] for place in places.values()], axis=0).max())
        rounded = accuracy_at(scene, off, places, laws_of(scene, scene.instants), solves_rates=True)
        usual = {
            quantity: np.max([largest_at(one) for one in of.values()], axis=0)
            for quantity, of in rounded.claims.items()
            if of
        }
        return replace(found, accuracy=replace(found.accuracy, usual=usual))
