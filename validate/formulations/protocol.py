"""The interface of a formulation: a name, and a method that solves a scene into plain arrays."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field, replace
from functools import partial as bind
from typing import Any, Protocol

import numpy as np

from pointcoord.effects.registry import QUANTITIES
from pointcoord.scene.scene_file import Scene
from validate.arrays import Array, Flags, Indices
from validate.errors import NoAnswer

NOTHING = 1e150
"""The error bound of a number without a known bound: larger than any number, and its square is finite."""

Numbers = Mapping[str, Mapping[str, Array]]
"""By quantity, then by point, body or angle: (N, 3), or (N,) for a number of the car."""


Places = slice | Flags | Indices
"""A selection of instants."""


def numbers_at(numbers: Numbers, places: Places) -> Numbers:
    """Numbers at a selection of their instants."""
    return {q: {name: array[places] for name, array in of.items()} for q, of in numbers.items()}


def largest_at(numbers: Array) -> Array:
    """The largest component at each instant, (N,), of numbers (N, ...)."""
    return np.asarray(numbers.reshape(len(numbers), -1).max(axis=-1))


def shape_of(quantity: str, count: int) -> tuple[int, ...]:
    """The shape of a quantity's array at `count` instants: vectors, but scalars for numbers of the car."""
    return (count,) if QUANTITIES[quantity].of == "car" else (count, 3)


class AccuracyError(ValueError):
    """An error bound that a formulation returns is not valid as a bound."""

    def __init__(self, claim: str, problem: str, allowed: str) -> None:
        self.claim = claim
        self.problem = problem
        self.allowed = allowed
        super().__init__(f"the accuracy of {claim} {problem}; allowed: {allowed}")


@dataclass(frozen=True)
class Accuracy:
    """The error bounds that a formulation returns with its numbers.

    The tolerance of a difference is the sum of the error bounds of both formulations (see `comparison.pair`).
    So a bound must include all rounding and truncation. A bound must also be no wider than the error that the
    method should reach: a bound that grew with the actual error would let any fault pass.

    Attributes:
        condition: condition number of the matrix that gives the rates, shape (N,).
        claims: error bounds by quantity and name, each in the shape and unit of its numbers.
        proven: whether the error bounds are proven; otherwise they are estimates.
        blind: for error bounds that follow from an accuracy stated beforehand: the instants at which this
            accuracy gives no bound, (N,). At all other instants such bounds test, however wide they are.
            None: the width of the bounds decides whether they test (see `comparison.pair`).
        stated: accuracy of points that was stated beforehand, mm, if any.
        usual: by quantity, the largest error of the method in any number where nothing is wrong, (N,), if
            known apart from the bounds: the proven error of a number may by chance be far less.
    Raises:
        AccuracyError: an error bound is not a finite number from 0 up, does not have the shape of its
            numbers, or belongs to an unknown quantity.
    """

    condition: Array
    claims: Numbers = field(default_factory=dict)
    proven: bool = False
    blind: Flags | None = None
    stated: float | None = None
    usual: Mapping[str, Array] = field(default_factory=dict)

    def at(self, places: Places) -> Accuracy:
        """The accuracy at a selection of its instants."""
        if isinstance(places, slice) and places == slice(None):
            return self
        return replace(
            self,
            condition=self.condition[places],
            claims=numbers_at(self.claims, places),
            blind=None if self.blind is None else self.blind[places],
            usual={quantity: most[places] for quantity, most in self.usual.items()},
        )

    def with_claims(self, claims: Numbers) -> Accuracy:
        """The accuracy with the error bounds of some quantities replaced."""
        return replace(self, claims={**self.claims, **claims})

    def __post_init__(self) -> None:
        if np.ndim(self.condition) != 1:
            raise AccuracyError("condition", f"has the shape {np.shape(self.condition)}", "one per instant")
        count = len(self.condition)
        _check_claim("condition", self.condition, (count,))
        for quantity, most in _by_name("usual", self.usual).items():
            _check_claim(f"{quantity} as usual", most, (count,))
        for quantity, claims in _by_name("claims", self.claims).items():
            if quantity not in QUANTITIES:
                raise AccuracyError(f"{quantity!r}", "is of no known quantity", ", ".join(QUANTITIES))
            for name, claim in _by_name(quantity, claims).items():
                _check_claim(f"{quantity} of {name}", claim, shape_of(quantity, count))


def _by_name(what: str, part: Mapping[str, Any]) -> Mapping[str, Any]:
    if not isinstance(part, Mapping):
        raise AccuracyError(what, f"is of type {type(part).__name__}", "arrays by quantity and name")
    return part


def _check_claim(what: str, claim: Array, shape: tuple[int, ...]) -> None:
    array = np.asarray(claim)
    if array.dtype.kind != "f":
        raise AccuracyError(what, f"is of type {array.dtype}", "floating point numbers")
    if array.shape != shape:
        raise AccuracyError(what, f"has the shape {array.shape}", f"{shape}, as many as instants")
    wrong = ~(np.isfinite(array) & (array >= 0.0))
    if wrong.any():
        where = tuple(int(i) for i in np.argwhere(wrong)[0])
        raise AccuracyError(
            what, f"is {array[where]:.6g} at instant number {where[0]}", "finite numbers from 0 up"
        )


@dataclass(frozen=True, repr=False)
class Solution:
    """A solved scene as plain arrays. Every quantity in it is also an attribute, such as `position`.

        Solution("mine", times, {"position": {"wheel_centre": places}}, Accuracy(np.ones(len(times))))

    Attributes:
        formulation: name of the formulation.
        times: instants, shape (N,), s.
        numbers: by quantity (see `pointcoord.effects.registry.QUANTITIES`, which gives the units) and by
            point, body or angle. Numbers that the scene does not ask for may be left out.
        accuracy: error bounds of the numbers; a number without an error bound cannot be tested.
        notes: remarks of the formulation on numbers that have no meaning.
        faults: one line for each part of the numbers that cannot be used, with the reason.
    """

    formulation: str
    times: Array
    numbers: Numbers
    accuracy: Accuracy
    notes: tuple[str, ...] = ()
    faults: tuple[str, ...] = ()

    def at(self, places: Places) -> Solution:
        """The solution at a selection of its instants."""
        numbers, accuracy = numbers_at(self.numbers, places), self.accuracy.at(places)
        return replace(self, times=self.times[places], numbers=numbers, accuracy=accuracy)

    def with_numbers(self, numbers: Numbers) -> Solution:
        """The solution with the numbers of some quantities replaced."""
        return replace(self, numbers={**self.numbers, **numbers})

    def __getattr__(self, name: str) -> Mapping[str, Array]:
        numbers: Numbers = self.__dict__.get("numbers", {})
        if name in numbers:
            return numbers[name]
        raise AttributeError(f"the solution of {self.__dict__.get('formulation')} has no {name!r}")

    def __repr__(self) -> str:
        given = ", ".join(quantity for quantity, arrays in self.numbers.items() if arrays)
        return f"<Solution of {self.formulation}: {np.size(self.times)} instants; {given}>"


class Formulation(Protocol):
    """A way to solve a scene. A new formulation is a class with these two members."""

    @property
    def name(self) -> str:
        """Name on the command line and in reports."""
        ...

    def solve(self, scene: Scene) -> Solution:
        """Solve a scene at its instants.

        Raises:
            FormulationError: the scene cannot be solved; `reason` is the formulation's own error.
        """
        ...


class FormulationError(Exception):
    """A formulation refused a scene; `reason` is its own error."""

    def __init__(
        self,
        formulation: str,
        reason: Exception,
        partial: Solution | Callable[[], Solution | None] | None = None,
    ) -> None:
        self.formulation = formulation
        self.reason = reason
        self._partial = partial
        super().__init__(f"{formulation}: {reason}")

    @property
    def partial(self) -> Solution | None:
        """The solution at the first instants, up to the refusal; None without any, or without error bounds.

        If it was given as a function, it is computed on first use: error bounds cost as much as for a whole
        motion, and are rarely wanted after a refusal.
        """
        if callable(self._partial):
            before, self._partial = self._partial, None
            with suppress(AccuracyError, FormulationError, NoAnswer):
                self._partial = before()
        return self._partial


@contextmanager
def refusing(
    formulation: str, *kinds: type[Exception], partial: Callable[[Any], Solution] | None = None
) -> Iterator[None]:
    """Raise errors of these kinds as refusals of a formulation.

    Args:
        partial: makes the solution at the first instants from the `partial` of an error, if that is not None.
    """
    try:
        yield
    except kinds as error:
        before = getattr(error, "partial", None)
        if partial is None or before is None:
            raise FormulationError(formulation, error) from error
        raise FormulationError(formulation, error, bind(partial, before)) from error


def reason_of(error: Exception) -> Exception:
    """The formulation's own error if it refused a scene; any other error unchanged."""
    return error.reason if isinstance(error, FormulationError) else error
