"""The reference as a solution: at a scene's instants, in doubles, which are off by their rounding.

A drawing need not be assembled, so `solve_reference` calls a side unclear that is less than 1e-9 of the
lengths that it is made of. Cars may be drawn so near to where two assemblies meet on purpose, and then their
coordinates are exact: the sign of an exact product of them is the side that was drawn, however small the
product is. Whoever knows that asks for `exact_sides`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene
from pointcoord.numerics.rounding import UNIT_ROUNDOFF
from validate.formulations.asked_numbers import asked_numbers
from validate.formulations.input_rates import rates
from validate.formulations.protocol import Accuracy, Numbers, Solution
from validate.reference import Design, Instant, instants_of, solve_reference
from validate.reference.candidates import CLEAR_SIGN

Array = NDArray[np.float64]
Arrays = dict[str, Array]

# The reference is proven to 60 digits of the greatest number of its kind; ten are left for what "greatest"
# means.
DUST = 1e-50
DIGITS = 60
Inputs = Mapping[str, Sequence[float]]


def inputs_at(scene: Scene, time: float) -> dict[str, tuple[float, ...]]:
    """Every input's value, rate and acceleration at an instant."""
    return {name: tuple(rates(part, np.array([time]))[0].tolist()) for name, part in scene.inputs.items()}


def reference_instant(
    scene: Scene, inputs: Inputs, exact_sides: bool = False, digits: int = DIGITS
) -> Instant:
    """The reference for a scene's car at given inputs.

    Args:
        inputs: value, rate and acceleration of each.
        exact_sides: whether every side that is drawn is meant, however small the product that tells it.
    Raises:
        NoReferenceError: there is no pose, or none can be proven.
    """
    part = scene.mechanism
    return solve_reference(
        dict(part.points),
        inputs,
        up=part.up,
        right=part.right,
        side=part.side,
        digits=digits,
        closure=part.closure,
        suspension=part.type,
        clearness=0.0 if exact_sides else CLEAR_SIGN,
    )


def reference_solution(scene: Scene, exact_sides: bool = False) -> Solution:
    """The reference at a scene's instants, rounded, in the form that `compare_solutions` takes.

    Raises:
        NoReferenceError: an instant has no pose, or none can be proven.
    """
    laws = {name: rates(part, scene.instants).tolist() for name, part in scene.inputs.items()}
    inputs = [{name: law[k] for name, law in laws.items()} for k in range(len(scene.instants))]
    part = scene.mechanism
    design = Design.from_points(dict(part.points), part.up, part.right, part.side, part.closure, part.type)
    clearness = 0.0 if exact_sides else CLEAR_SIGN
    return as_solution(scene, list(instants_of(design, inputs, DIGITS, clearness)))


def as_solution(scene: Scene, instants: Sequence[Instant]) -> Solution:
    """The reference at the instants of a scene, rounded to doubles.

    Numbers that are zero up to the reference's own proven error, which it claims, are zero: the middles of
    its intervals about 0 are some 1e-170. An angle that one of the instants leaves out is left out.
    """
    times, bodies, first = scene.instants, scene.mechanism.topology.bodies, instants[0]
    angles = [name for name in first.effects if all(name in i.effects for i in instants)]
    numbers = {
        "position": {n: np.array([i.position_as_float(n) for i in instants]) for n in first.position},
        "velocity": _rounded([i.velocity for i in instants], first.velocity),
        "acceleration": _rounded([i.acceleration for i in instants], first.acceleration),
        "angular_velocity": _rounded([i.angular_velocity for i in instants], bodies),
        "angular_acceleration": _rounded([i.angular_acceleration for i in instants], bodies),
        "wheel": {n: np.array([float(i.effects[n]) for i in instants]) for n in angles},
    }
    dust = {quantity: DUST * scale for quantity, scale in scales(numbers).items()}
    swept = {
        q: {n: np.where(np.abs(array) > dust[q], array, 0.0) for n, array in arrays.items()}
        for q, arrays in numbers.items()
    }
    claims = {
        q: {n: UNIT_ROUNDOFF * np.abs(array) + dust[q] for n, array in arrays.items()}
        for q, arrays in swept.items()
    }
    return Solution("reference", times, swept, Accuracy(np.ones(len(times)), claims, proven=True))


def scales(numbers: Numbers) -> dict[str, float]:
    """The greatest number of each kind; of an acceleration the parts that cancel count, speed^2 / size."""
    corners = np.stack(list(numbers["position"].values()))
    size = float((corners.max(axis=0) - corners.min(axis=0)).max())
    fastest, hardest = _largest(numbers["velocity"]), _largest(numbers["acceleration"])
    push = hardest + fastest * (fastest / size)
    return {
        "position": float(np.abs(corners).max()),
        "velocity": fastest,
        "acceleration": push,
        "angular_velocity": fastest / size,
        "angular_acceleration": push / size,
        "wheel": 1.0,
    }


def _largest(vectors: Mapping[str, Array]) -> float:
    return max(float(np.abs(array).max()) for array in vectors.values())


def _rounded(rows: Sequence[Mapping[str, Any]], names: Iterable[str]) -> Arrays:
    return {n: np.array([[float(x) for x in row[n]] for row in rows]) for n in names}


def told_by(reference: Solution, scene: Scene) -> dict[str, tuple[str, ...]]:
    """What the scene asks for, by quantity, without the angles that the reference leaves out.

    Such an angle is 0/0 there, or half a turn, where its sign has no meaning.
    """
    return {
        quantity: tuple(name for name in names if name in reference.numbers[quantity])
        for quantity, names in asked_numbers(scene).items()
        if quantity in reference.numbers
    }
