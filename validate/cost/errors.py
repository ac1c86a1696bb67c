r"""Errors of a way's numbers against the many-digit reference.

The reference knows a number x to 60 digits, a way gives a double d near it, and d - x must be known to many
of its own digits, however small it is. So x is kept as a sum of two doubles, h = x rounded and l = x - h
rounded, and

    d - x = (d - h) - l

where d - h is exact for d within a factor of two of h (Sterbenz), and rounded by 2^-53 of itself elsewhere.
What h + l is not of x, 2^-106 of it, and what the reference does not prove of x, make the radius of the row.

The reference solves the scene with its inputs rounded to doubles at each instant (`input_rates`), which is
what anybody can be given: half a unit in the last place of an angle is no error of a way.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene
from pointcoord.effects.registry import QUANTITIES
from validate.cost.race import Found, absent
from validate.cost.way import Answer, NoNumbers
from validate.extras import MissingPackage
from validate.formulations.asked_numbers import asked_numbers
from validate.formulations.protocol import shape_of
from validate.formulations.reference_solution import DIGITS, reference_motion

try:
    from mpmath import mp, mpf
except ModuleNotFoundError as error:
    raise MissingPackage("validate.cost.errors", error) from None

Array = NDArray[np.float64]


class Exact(NamedTuple):
    """The reference of one point, body or angle at the instants: the sum of two arrays of doubles."""

    high: Array
    low: Array


@dataclass(frozen=True)
class Truth:
    """The reference at the instants of a study.

    Attributes:
        exact: by quantity and name, of what the scene asks for and what is not fixed to the chassis.
        radius: by quantity, the largest proven error of any of these numbers.
    """

    exact: Mapping[str, Mapping[str, Exact]]
    radius: Mapping[str, float]


def judge(scene: Scene, instants: Array, positions: bool | None = None) -> Callable[[Answer], Found]:
    """What tells the errors of answers at instants, (N,), s; the reference is solved once, when it is needed.

    Args:
        positions: whether only positions are looked at, or all else; everything if None.
    """
    truth = cache(lambda: truth_of(scene, instants))
    return lambda answer: errors_of(answer, truth(), positions)


def truth_of(scene: Scene, instants: Array) -> Truth:
    """Solve the reference at instants, (N,), s.

    Raises:
        NoReferenceError: an instant has no pose, or none can be proven.
    """
    solved = reference_motion(scene, instants.tolist())
    # A point of the chassis is where it is drawn: it would dilute the mean, and says nothing of a way.
    fixed = set(scene.mechanism.topology.chassis)
    exact: dict[str, dict[str, Exact]] = {}
    radius: dict[str, float] = {}
    with mp.workdps(2 * DIGITS + 40):
        for quantity, names in asked_numbers(scene).items():
            of_car, shape = QUANTITIES[quantity].of == "car", shape_of(quantity, len(solved))
            rows: list[Mapping[str, Any]] = [i.effects if of_car else getattr(i, quantity) for i in solved]
            numbers = {
                name: _split([row[name] for row in rows], shape)
                for name in names
                if name not in fixed and all(name in row for row in rows)
            }
            if numbers:
                exact[quantity] = numbers
                proven = max(i.error_bound["effects" if of_car else quantity] for i in solved)
                rounded = max(float(np.abs(x.low).max()) for x in numbers.values()) * 2.0**-53
                radius[quantity] = float(proven) + rounded
    return Truth(exact, radius)


def errors_of(answer: Answer, truth: Truth, positions: bool | None = None) -> Found:
    """Columns of a row for each quantity that the scene asks for; one that is not given is left out.

    A quantity that is given at all must be given whole.

    Raises:
        NoNumbers: a number is none, or it or its point is missing.
    """
    found: Found = {}
    work = ", ".join(f"{name} {count}" for name, count in answer.work.items())
    for quantity, names in truth.exact.items():
        if positions not in (None, quantity == "position"):
            continue
        given = answer.numbers.get(quantity) or {}
        if quantity != "position" and not any(name in given for name in names):
            found[quantity] = absent("left out", f"gives no {QUANTITIES[quantity].words}")
            continue
        errors = np.concatenate([_error(quantity, n, given, exact).ravel() for n, exact in names.items()])
        largest = float(np.abs(errors).max())
        # In parts of the largest, so that no square is too large or too small for a double.
        mean = float(np.mean((errors / largest) ** 2)) if largest > 0.0 else 0.0
        sizes = {"error": largest, "rms": largest * mean**0.5, "numbers": errors.size}
        found[quantity] = {**sizes, "radius": truth.radius[quantity], "work": work}
    return found


def _error(quantity: str, name: str, given: Mapping[str, Array], exact: Exact) -> Array:
    """Errors of the numbers of one point, body or angle."""
    what = f"{QUANTITIES[quantity].words} of {name}"
    if name not in given:
        raise NoNumbers(f"gives no {what}")
    if given[name].shape != exact.high.shape:
        raise NoNumbers(f"gives the {what} in the shape {given[name].shape}, not {exact.high.shape}")
    with np.errstate(over="ignore", invalid="ignore"):
        off = np.asarray((given[name] - exact.high) - exact.low)
    bad = ~np.isfinite(off).reshape(len(off), -1).all(axis=-1)
    if bad.any():
        where = f"{np.count_nonzero(bad)} of {len(off)} instants, first at number {int(np.argmax(bad))}"
        raise NoNumbers(f"the {what} is no finite number at {where}")
    return off


def _split(numbers: list[Any], shape: tuple[int, ...]) -> Exact:
    """Many-digit numbers, one or three an instant, as sums of two doubles."""
    flat = [x for row in numbers for x in (row if len(shape) == 2 else (row,))]
    high = [float(x) for x in flat]
    low = [float(x - mpf(h)) for x, h in zip(flat, high, strict=True)]
    return Exact(np.array(high).reshape(shape), np.array(low).reshape(shape))
