"""What a formulation is to a comparison: a name, and a way from a scene to plain arrays."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from pointcoord.effects.registry import QUANTITIES
from pointcoord.scene.scene_file import Scene

Array = NDArray[np.float64]

NOTHING = 1e150
"""Claimed where nothing can be said: wider than any number, and its square is finite."""

Numbers = Mapping[str, Mapping[str, Array]]
"""By quantity, then by point, body or angle: (N, 3), or (N,) of what the car has one number of."""


Places = slice | NDArray[np.bool_] | NDArray[np.intp]
"""Which instants of several."""


def numbers_at(numbers: Numbers, places: Places) -> Numbers:
    """Numbers at some of their instants."""
    return {q: {name: array[places] for name, array in of.items()} for q, of in numbers.items()}


def shape_of(quantity: str, count: int) -> tuple[int, ...]:
    """The shape of the numbers of a quantity at `count` instants: vectors but of what the whole car has."""
    return (count,) if QUANTITIES[quantity].of == "car" else (count, 3)


class AccuracyError(ValueError):
    """What a formulation claims of its accuracy is no bound of an error."""

    def __init__(self, claim: str, problem: str, allowed: str) -> None:
        self.claim = claim
        self.problem = problem
        self.allowed = allowed
        super().__init__(f"the accuracy of {claim} {problem}; allowed: {allowed}")


@dataclass(frozen=True)
class Accuracy:
    """What a formulation says of its own accuracy: how far each of its numbers may be off, at most.

    A comparison holds the difference of two formulations to the sum of what they claim (see `tolerance`). So
    a claim must cover all that the formulation rounds and leaves out. It must also be no wider than what the
    method should reach: a claim that followed the number's own error would let any fault pass.

    Attributes:
        condition: condition number of the matrix that gives the rates, shape (N,).
        claims: by quantity and name, each like the numbers that it is about, in their unit.
        proven: whether the claims are proven bounds or estimates.
        blind: where the claims are what an accuracy makes that was stated beforehand, at which instants they
            say nothing, (N,); such claims may be as wide as they are, and elsewhere they test. None: how
            much they test is judged by their width (see `comparison.tolerance`).
        stated: how exactly it says beforehand that it places points, mm, if it does.
        usual: by quantity, the most that its method loses of any number where nothing is wrong, (N,), if that
            is known beside the claims: what is proven of a number may by chance be far less.
    Raises:
        AccuracyError: a claim is not a finite number from 0 up, has not the shape of its numbers, or is
            about no quantity that there is.
    """

    condition: Array
    claims: Numbers = field(default_factory=dict)
    proven: bool = False
    blind: NDArray[np.bool_] | None = None
    stated: float | None = None
    usual: Mapping[str, Array] = field(default_factory=dict)

    def at(self, places: Places) -> Accuracy:
        """The same at some of its instants."""
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
        """The same with other claims of some quantities."""
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
        raise AccuracyError(what, f"is a {type(part).__name__}", "arrays by quantity and name")
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
    """A solved scene as plain arrays; every quantity that it gives is an attribute too, such as `position`.

        Solution("mine", times, {"position": {"wheel_centre": places}}, Accuracy(np.ones(len(times))))

    Attributes:
        formulation: who gives it.
        times: shape (N,), s.
        numbers: by quantity (see `pointcoord.effects.registry.QUANTITIES`, which gives the units) and by
            point, body or angle. What the scene does not ask for may be left out.
        accuracy: how far each number may be off; what is not claimed of a number cannot be tested.
        notes: what the formulation itself says of numbers that have no meaning.
        faults: what it gives that cannot be used, and why, a line each.
    """

    formulation: str
    times: Array
    numbers: Numbers
    accuracy: Accuracy
    notes: tuple[str, ...] = ()
    faults: tuple[str, ...] = ()

    def at(self, places: Places) -> Solution:
        """The same at some of its instants."""
        numbers, accuracy = numbers_at(self.numbers, places), self.accuracy.at(places)
        return replace(self, times=self.times[places], numbers=numbers, accuracy=accuracy)

    def with_numbers(self, numbers: Numbers) -> Solution:
        """The same with other numbers of some quantities."""
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
    """A way to solve a scene. Adding one is writing one class with these two members."""

    @property
    def name(self) -> str:
        """Name on the command line and in reports."""
        ...

    def solve(self, scene: Scene) -> Solution:
        """Solve a scene at its instants.

        Raises:
            FormulationError: the scene cannot be solved; carries the formulation's own error.
        """
        ...


class FormulationError(Exception):
    """A formulation refused a scene, with its own reason as the cause."""

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
        """What was solved before, at the first of the scene's instants; None if nothing, or not how well.

        Found when it is first asked for, if it was given as a function: what is claimed of it costs as much
        as of a whole motion, and few who are refused want it.
        """
        if callable(self._partial):
            before, self._partial = self._partial, None
            with suppress(AccuracyError, FormulationError):
                self._partial = before()
        return self._partial
