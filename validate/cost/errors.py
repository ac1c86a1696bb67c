"""Errors of a method's numbers against the many-digit reference.

The radius of a row is the reference's proven error plus its rounding to doubles. The reference solves the
scene with inputs rounded to doubles at each instant (`input_rates`), as every method does. So rounding an
input by half a unit in the last place is not an error of a method.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache

import numpy as np

from pointcoord import Scene
from pointcoord.effects.registry import QUANTITIES
from validate.arrays import Array
from validate.cost.race import Found, absent
from validate.errors import NoAnswer
from validate.formulations.protocol import Numbers, Solution
from validate.formulations.reference_solution import as_solution, reference_motion, told_by


def judge(scene: Scene, instants: Array, positions: bool = True) -> Callable[[Numbers], Found]:
    """A function that returns the errors of an answer; it solves the reference once, when first called.

    Args:
        instants: (N,), s.
        positions: whether to judge positions, in addition to all other quantities.
    """
    truth = cache(lambda: truth_of(scene, instants))
    return lambda numbers: errors_of(numbers, truth(), positions)


def truth_of(scene: Scene, instants: Array) -> Solution:
    """The reference at instants, (N,), s: the numbers that the scene asks for, without fixed points.

    Raises:
        NoReferenceError: an instant has no pose, or none can be proven.
    """
    solved = as_solution(scene, reference_motion(scene, instants.tolist()), instants)
    # A point of the chassis is at its drawn position, which tests no method.
    fixed = set(scene.mechanism.topology.chassis)
    numbers: dict[str, dict[str, Array]] = {}
    for quantity, names in told_by(solved, scene).items():
        if moving := [name for name in names if name not in fixed]:
            numbers[quantity] = {name: solved.numbers[quantity][name] for name in moving}
    return replace(solved, numbers=numbers)


def errors_of(numbers: Numbers, truth: Solution, positions: bool = True) -> Found:
    """The columns of a row for each quantity that the scene asks for, with verdict `left out` if not given.

    If any number of a quantity is given, all its numbers must be given.

    Raises:
        NoAnswer: a number is missing or not finite, or has a wrong shape.
    """
    found: Found = {}
    for quantity, names in truth.numbers.items():
        if quantity == "position" and not positions:
            continue
        given = numbers.get(quantity) or {}
        if quantity != "position" and not any(name in given for name in names):
            found[quantity] = absent("left out", f"gives no {QUANTITIES[quantity].words}")
            continue
        error = max(float(np.abs(_error(quantity, n, given, exact)).max()) for n, exact in names.items())
        radius = max(float(truth.accuracy.claims[quantity][name].max()) for name in names)
        found[quantity] = {"error": error, "radius": radius}
    return found


def _error(quantity: str, name: str, given: Mapping[str, Array], exact: Array) -> Array:
    """Errors of the numbers of one point, body or angle."""
    what = f"{QUANTITIES[quantity].words} of {name}"
    if name not in given:
        raise NoAnswer(what, "is not given", "every number of a quantity of which any is given")
    if given[name].shape != exact.shape:
        raise NoAnswer(what, f"has the shape {given[name].shape}", str(exact.shape))
    with np.errstate(over="ignore", invalid="ignore"):
        off = np.asarray(given[name] - exact)
    bad = ~np.isfinite(off).reshape(len(off), -1).all(axis=-1)
    if bad.any():
        where = f"{np.count_nonzero(bad)} of {len(off)} instants, first at number {int(np.argmax(bad))}"
        raise NoAnswer(what, f"is not finite at {where}", "finite numbers")
    return off
