r"""Multi-indices: the powers of several variables in a series, and which pairs of powers multiply to which.

A series in s = (s_1 .. s_p) up to a total degree N is  sum_k c_k s^k  with s^k = s_1^k_1 .. s_p^k_p and
|k| = k_1 + .. + k_p <= N. Powers are ordered by total degree, 1 first, so that the powers of a lower order
are the first ones of a higher order.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import product
from math import comb

import numpy as np

from pointcoord.numerics.arrays import Indices

Places = tuple[slice, ...]


@dataclass(frozen=True)
class Products:
    """Pairs of powers i and j with s^i s^j = s^k, by k.

    Attributes:
        first, second: the pairs, shape (pairs,). starts: index of each k's first pair, shape (targets,).
        targets: index of each k among the powers, shape (targets,).
    """

    first: Indices
    second: Indices
    starts: Indices
    targets: Indices

    @cached_property
    def edges(self) -> list[int]:
        """Index of the first pair of each target, and the number of pairs at the end."""
        return [*self.starts.tolist(), len(self.first)]


@dataclass(frozen=True)
class Powers:
    """The powers of `inputs` variables up to a total degree `order`.

    Attributes:
        exponents: k of each power, shape (powers, inputs).
    """

    inputs: int
    order: int
    exponents: Indices

    @property
    def count(self) -> int:
        """Number of powers: (order + inputs) over inputs."""
        return len(self.exponents)

    def first_of(self, degree: int) -> int:
        """Index of the first power of a total degree; one above the last, the number of powers."""
        return self.edges[degree]

    @cached_property
    def edges(self) -> list[int]:
        """Index of the first power of each total degree, and the number of powers at the end."""
        degrees = self.exponents.sum(axis=-1)
        edges: list[int] = np.searchsorted(degrees, np.arange(self.order + 2), side="left").tolist()
        return edges

    @cached_property
    def pairs(self) -> list[tuple[Places, Places]]:
        """For each power k, slices of all i and of all k - i, 0 <= i <= k, in a table of all exponents."""
        return [
            (tuple(slice(one + 1) for one in k), tuple(slice(one, None, -1) for one in k))
            for k in self.exponents.tolist()
        ]

    def places(self, low: int, high: int) -> Indices | slice:
        """Indices of powers in a flat table of all exponents up to `order`."""
        return slice(low, high) if self.inputs == 1 else self._places[low:high]

    @cached_property
    def _places(self) -> Indices:
        return self.exponents @ (self.order + 1) ** np.arange(self.inputs)[::-1]

    def power_of(self, variable: int, exponent: int) -> int:
        """Index of a power of one variable alone."""
        wanted = np.zeros(self.inputs, dtype=np.intp)
        wanted[variable] = exponent
        return int(np.flatnonzero((self.exponents == wanted).all(axis=-1))[0])


@lru_cache(maxsize=128)
def powers(inputs: int, order: int) -> Powers:
    """The powers of a number of variables, ordered by total degree."""
    every = [k for k in product(range(order + 1), repeat=inputs) if sum(k) <= order]
    every.sort(key=lambda k: (sum(k), tuple(-one for one in k)))
    return Powers(inputs, order, np.array(every, dtype=np.intp).reshape(-1, inputs))


@lru_cache(maxsize=128)
def powers_counted(inputs: int, count: int) -> Powers:
    """The powers of a number of variables, from the number of powers."""
    return powers(inputs, next(degree for degree in range(count) if comb(degree + inputs, inputs) == count))


@lru_cache(maxsize=256)
def products(inputs: int, order: int, degrees: tuple[int, int], lowest: int) -> Products:
    """Pairs of powers up to `order`, each of degree `lowest` or more, with a product of wanted degree.

    Args:
        degrees: first and last wanted degree of the products, up to 2 `order`.
    """
    of_factors, of_products = powers(inputs, order).exponents, powers(inputs, 2 * order).exponents
    degree = of_factors.sum(axis=-1)
    low, high = degrees
    first, second = np.indices((len(degree), len(degree))).reshape(2, -1)
    total = degree[first] + degree[second]
    wanted = (total >= low) & (total <= high) & (np.minimum(degree[first], degree[second]) >= lowest)
    first, second = first[wanted], second[wanted]
    # A number for each exponent, equal for factors and products.
    base = (2 * order + 1) ** np.arange(inputs)
    place = np.argsort(of_products @ base, kind="stable")
    key = (of_factors[first] + of_factors[second]) @ base
    target = place[np.searchsorted((of_products @ base)[place], key)]
    by_target = np.argsort(target, kind="stable")
    first, second, target = first[by_target], second[by_target], target[by_target]
    starts = np.flatnonzero(np.diff(target, prepend=-1))
    return Products(first, second, starts.astype(np.intp), target[starts].astype(np.intp))
