"""Exact polynomials of at most second degree, in which the equations are written as vector algebra.

The unknowns are the symbols 0, 1 and so on; the numbers w of the inputs are the symbols -1, -2 and so on.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain, product

from flint import fmpq

from validate.reference.vectors import Exact, Scalar, Vector, each

Monomial = tuple[int, ...]  # at most two symbols, in ascending order


@dataclass(frozen=True)
class Polynomial:
    """A sum of products of at most two symbols, with coefficients in one kind of number.

    Exact coefficients are flint's fractions, which are twenty times as fast as Python's.
    """

    terms: Mapping[Monomial, Scalar]

    @classmethod
    def symbol(cls, number: int) -> Polynomial:
        """The polynomial that is one symbol."""
        return cls({(number,): fmpq(1)})

    def __add__(self, other: Scalar) -> Polynomial:
        return _summed(chain(self.terms.items(), polynomial(other).terms.items()))

    def __mul__(self, other: Scalar) -> Polynomial:
        pairs = product(self.terms.items(), polynomial(other).terms.items())
        return _summed((tuple(sorted(one + two)), a * b) for (one, a), (two, b) in pairs)

    def __neg__(self) -> Polynomial:
        return Polynomial({monomial: -coefficient for monomial, coefficient in self.terms.items()})

    def __sub__(self, other: Scalar) -> Polynomial:
        return self + -polynomial(other)

    def __rsub__(self, other: Scalar) -> Polynomial:
        return polynomial(other) - self

    __radd__ = __add__
    __rmul__ = __mul__

    @property
    def unknowns(self) -> list[int]:
        """The unknowns that occur."""
        return sorted({symbol for monomial in self.terms for symbol in monomial if symbol >= 0})

    def derivative(self, symbol: int) -> Polynomial:
        """The derivative by one symbol."""
        terms: dict[Monomial, Scalar] = {}
        for monomial, coefficient in self.terms.items():
            if symbol in monomial:
                i = monomial.index(symbol)
                terms[monomial[:i] + monomial[i + 1 :]] = coefficient * monomial.count(symbol)
        return Polynomial(terms)

    def of_kind(self, number: Exact) -> Polynomial:
        """The polynomial with coefficients in another kind of number; the constant term comes last."""
        ordered = sorted(self.terms.items(), key=lambda term: -len(term[0]))
        return Polynomial({monomial: number(coefficient) for monomial, coefficient in ordered})

    def at(self, values: Sequence[Scalar]) -> Scalar:
        """The value, in the kind of number of `values` even if no symbol occurs; see `of_kind`."""
        total: Scalar = None
        for monomial, term in self.terms.items():
            if monomial:
                for symbol in monomial:
                    term = values[symbol] * term
            elif total is None:
                term = values[0] * 0 + term
            total = term if total is None else total + term
        return values[0] * 0 if total is None else total


def polynomial(number: Scalar) -> Polynomial:
    """A fraction as a polynomial; a polynomial is returned as it is."""
    if isinstance(number, Polynomial):
        return number
    return Polynomial({(): fmpq(number.numerator, number.denominator)} if number else {})


def ordered(unknown: Sequence[Scalar], numbers: Sequence[Scalar]) -> list[Scalar]:
    """Values indexed by symbol: the negative symbols of w count from the end."""
    return [*unknown, *reversed(numbers)]


def of_kind(vector: Vector, number: Exact) -> Vector:
    """A vector of polynomials and fractions as polynomials in one kind of number."""
    return each(lambda one: polynomial(one).of_kind(number), vector)


def at(vector: Vector, values: Sequence[Scalar]) -> Vector:
    """The value of a vector of polynomials."""
    return each(lambda one: one.at(values), vector)


def _summed(terms: Iterable[tuple[Monomial, Scalar]]) -> Polynomial:
    found: dict[Monomial, Scalar] = {}
    for monomial, coefficient in terms:
        if len(monomial) > 2:
            raise ValueError("a product of more than two symbols: no row may be more than quadratic")
        found[monomial] = found[monomial] + coefficient if monomial in found else coefficient
    return Polynomial({monomial: coefficient for monomial, coefficient in found.items() if coefficient})
