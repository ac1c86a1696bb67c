"""Proven patches: boxes of inputs with series of the coordinates and proven error bounds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any, Self

import numpy as np

from pointcoord.numerics.arrays import Array, Indices, Integers
from pointcoord.numerics.monomials import monomials
from pointcoord.numerics.multi_index import powers
from pointcoord.patches.domain import Domain
from pointcoord.patches.evaluation import sum_series
from pointcoord.patches.jet import Jet
from pointcoord.patches.lookup import Lookup
from pointcoord.patches.reported_points import moving_points


@dataclass(frozen=True)
class Patches:
    """Series and error bounds of the reported points on proven patches.

    Attributes:
        domain: the domain that is divided into boxes.
        order: total degree of the series.
        low, high: corners of the patches, in smallest boxes, (P, p).
        coefficients: series of the reported points, (P, powers, 3 points), mm from the mechanism's origin.
        off: error bounds of the sums and of their derivatives by inputs in half widths, (P, 3 points), mm.
    """

    domain: Domain
    order: int
    low: Integers
    high: Integers
    coefficients: Array
    off: Jet

    def taken(self, places: Indices) -> Self:
        """Some of the patches, by number."""

        def some(value: Any) -> Any:
            if isinstance(value, Jet):
                return value.each(lambda part: part[places])
            return value[places] if isinstance(value, np.ndarray) else value

        return type(self)(*(some(getattr(self, part.name)) for part in fields(self)))

    def joined(self, others: Sequence[Self]) -> Self:
        """These patches, followed by other patches of the same domain."""

        def together(parts: Sequence[Any]) -> Any:
            if isinstance(parts[0], Jet):
                return Jet.joined(parts, 0)
            return np.concatenate(parts) if isinstance(parts[0], np.ndarray) else parts[0]

        every = (self, *others)
        return type(self)(*(together([getattr(one, part.name) for one in every]) for part in fields(self)))

    @cached_property
    def boxes(self) -> tuple[Array, Array]:
        """Middles and half widths of the patches, each (P, p)."""
        return self.domain.middle_and_half(self.low, self.high)

    @cached_property
    def lookup(self) -> Lookup:
        """The patch of each smallest box."""
        return Lookup.of(self.domain, self.low, self.high)

    def sums(
        self,
        table: Array,
        states: Sequence[Array],
        patch: Integers | None = None,
        out: Sequence[Array] | None = None,
    ) -> Sequence[Array]:
        """Sums of the series of each pose's patch, and their time derivatives.

        Args:
            table: coefficients of the wanted numbers, (P, powers, m).
            states: inputs and their time derivatives, each (N, p).
            patch: number of the patch of each pose, (N,), if known.
            out: arrays to write the sums into; new arrays unless given.
        Returns:
            One array for each derivative, (m, N), per s^d.
        """
        number = self.lookup.at(states[0]) if patch is None else patch
        return sum_series(table, self.boxes, self.order, number, states, out)


@dataclass(frozen=True)
class ProvenPatches(Patches):
    """Patches with the series of the unknown coordinates and the proof of their assembly.

    Attributes:
        series: series of the unknown coordinates, (P, powers, unknowns), in the mechanism's units.
        error: error bound of these series on each patch, (P, unknowns).
        unique_within: distance within which there is no other assembly, (P, unknowns).
    """

    series: Array
    error: Array
    unique_within: Array

    @classmethod
    def none(cls, domain: Domain, order: int) -> ProvenPatches:
        """The empty set of patches of a domain."""
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
        """The same patches with the reported points only."""
        return Patches(*(getattr(self, part.name) for part in fields(Patches)))

    def unknowns_at(self, which: Indices, values: Array) -> Array:
        """Unknown coordinates on patches `which`, (N,), at inputs `values`, (N, p), shape (N, unknowns)."""
        middle, half = (part[which] for part in self.boxes)
        (row,) = monomials([((values - middle) / half).T], self.order)
        return np.asarray(np.einsum("kn,nku->nu", row, self.series[which]))

    def holds(self, values: Array, y: Array) -> bool:
        """Whether a pose is the assembly of the patch at its inputs.

        Args:
            values: free inputs of the pose, (p,).
            y: coordinates of the pose, (size,).
        """
        number = self.lookup.at(values[None])
        if number[0] < 0:
            return False
        (unknown,) = self.unknowns_at(number, values[None])
        apart = np.abs(unknown - y[: len(unknown)]) + self.error[number[0]]
        return bool((apart < self.unique_within[number[0]]).all())
