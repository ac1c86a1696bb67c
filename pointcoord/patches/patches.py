"""Proven patches: boxes of inputs with their series, and what is proven of these."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from pointcoord.numerics.monomials import monomials
from pointcoord.numerics.multi_index import powers
from pointcoord.patches.domain import Domain
from pointcoord.patches.evaluation import sum_series
from pointcoord.patches.jet import Jet
from pointcoord.patches.lookup import Lookup
from pointcoord.patches.reported_points import moving_points

Array = NDArray[np.float64]
Whole = NDArray[np.int64]


@dataclass(frozen=True)
class Patches:
    """What proven patches say of the reported points.

    Attributes:
        domain: of which they are boxes. order: total degree of the series.
        low, high: corners of the boxes, in the smallest ones, (P, p).
        coefficients: of the reported points, (P, powers, 3 points), mm from the mechanism's origin.
        off: errors of their sums and of the derivatives of these by parts of the half widths, (P, 3 points),
            mm.
    """

    domain: Domain
    order: int
    low: Whole
    high: Whole
    coefficients: Array
    off: Jet

    def taken(self, places: NDArray[np.intp]) -> Self:
        """Some of them."""

        def some(value: Any) -> Any:
            if isinstance(value, Jet):
                return value.each(lambda part: part[places])
            return value[places] if isinstance(value, np.ndarray) else value

        return type(self)(*(some(getattr(self, part.name)) for part in fields(self)))

    def joined(self, others: Sequence[Self]) -> Self:
        """These and others of the same domain after them."""

        def together(parts: Sequence[Any]) -> Any:
            if isinstance(parts[0], Jet):
                return Jet.joined(parts, 0)
            return np.concatenate(parts) if isinstance(parts[0], np.ndarray) else parts[0]

        every = (self, *others)
        return type(self)(*(together([getattr(one, part.name) for one in every]) for part in fields(self)))

    @cached_property
    def boxes(self) -> tuple[Array, Array]:
        """Middles and half widths, each (P, p)."""
        return self.domain.middle_and_half(self.low, self.high)

    @cached_property
    def lookup(self) -> Lookup:
        """Which patch each of the smallest boxes lies in."""
        return Lookup.of(self.domain, self.low, self.high)

    def sums(
        self,
        table: Array,
        states: Sequence[Array],
        patch: Whole | None = None,
        out: Sequence[Array] | None = None,
    ) -> Sequence[Array]:
        """Series of the patches that poses lie on, summed, and their time derivatives.

        Args:
            table: coefficients of what is wanted, (P, powers, m).
            states: inputs and their time derivatives, each (N, p). patch: of each pose, where it is known.
            out: where the sums go; new arrays if not given.
        Returns:
            By derivative, each (m, N), per s^d.
        """
        number = self.lookup.at(states[0]) if patch is None else patch
        return sum_series(table, self.boxes, self.order, number, states, out)


@dataclass(frozen=True)
class ProvenPatches(Patches):
    """Patches with the assembly that they are proven of.

    Attributes:
        series: of the unknown coordinates, (P, powers, unknowns), in the mechanism's units.
        error: of these on each patch, (P, unknowns). unique_within: no other assembly is nearer, likewise.
    """

    series: Array
    error: Array
    unique_within: Array

    @classmethod
    def none(cls, domain: Domain, order: int) -> ProvenPatches:
        """Of a domain of which nothing is proven."""
        inputs, points = len(domain.free), 3 * len(moving_points(domain.mechanism.topology))
        count, unknowns = powers(inputs, order).count, domain.mechanism.map.unknowns
        corners = np.zeros((0, inputs), dtype=np.int64)
        return cls(
            domain,
            order,
            corners,
            corners,
            np.zeros((0, count, points)),
            Jet.constant(np.zeros((0, points)), inputs),
            np.zeros((0, count, unknowns)),
            np.zeros((0, unknowns)),
            np.zeros((0, unknowns)),
        )

    @property
    def reported(self) -> Patches:
        """What they say of the reported points alone."""
        return Patches(*(getattr(self, part.name) for part in fields(Patches)))

    def unknowns_at(self, which: NDArray[np.intp], values: Array) -> Array:
        """Unknown coordinates of some patches at one place each, shapes (N,) and (N, p) to (N, unknowns)."""
        middle, half = (part[which] for part in self.boxes)
        (row,) = monomials([((values - middle) / half).T], self.order)
        return np.asarray(np.einsum("kn,nku->nu", row, self.series[which]))

    def holds(self, values: Array, y: Array) -> bool:
        """Whether a pose is the assembly of the patch that its inputs lie on.

        Args:
            values: of the free inputs, (p,). y: the pose's coordinates, (size,).
        """
        number = self.lookup.at(values[None])
        if number[0] < 0:
            return False
        (unknown,) = self.unknowns_at(number, values[None])
        apart = np.abs(unknown - y[: len(unknown)]) + self.error[number[0]]
        return bool((apart < self.unique_within[number[0]]).all())
