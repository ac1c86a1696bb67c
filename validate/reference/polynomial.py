"""Exact polynomials of at most second degree: the equations are written with them once, as vector algebra.

The unknowns are the symbols 0, 1 and so on, the numbers w of the inputs are -1, -2 and so on.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from validate.reference.vectors import Scalar

Monomial = tuple[int, ...]  # at most two symbols, in ascending order


@dataclass(frozen=True)
class Polynomial:
    """A sum of products of at most two symbols, with exact coefficients."""

    terms: Mapping[Monomial, Fraction]

    @classmethod
    def symbol(cls, number: int) -> Polynomial:
        """One symbol."""
        return cls({(number,): Fraction(1)})

    def __add__(self, other: Scalar) -> Polynomial:
        terms = dict(self.terms)
        for monomial, coefficient in polynomial(other).terms.items():
            terms[monomial] = terms.get(monomial, Fraction(0)) + coefficient
        return _without_zeros(terms)

    def __mul__(self, other: Scalar) -> Polynomial:
        terms: dict[Monomial, Fraction] = {}
        for one, a in self.terms.items():
            for two, b in polynomial(other).terms.items():
                if len(one) + len(two) > 2:
                    raise ValueError("a product of more than two symbols: no row may be more than quadratic")
                monomial = tuple(sorted(one + two))
                terms[monomial] = terms.get(monomial, Fraction(0)) + a * b
        return _without_zeros(terms)

    def __neg__(self) -> Polynomial:
        return Polynomial({monomial: -coefficient for monomial, coefficient in self.terms.items()})

    def __sub__(self, other: Scalar) -> Polynomial:
        return self + -polynomial(other)

    def __rsub__(self, other: Scalar) -> Polynomial:
        return polynomial(other) - self

    __radd__ = __add__
    __rmul__ = __mul__

    def derivative(self, symbol: int) -> Polynomial:
        """By one symbol."""
        terms: dict[Monomial, Fraction] = {}
        for monomial, coefficient in self.terms.items():
            if symbol in monomial:
                rest = list(monomial)
                rest.remove(symbol)
                terms[tuple(rest)] = coefficient * monomial.count(symbol)
        return Polynomial(terms)

    def at(self, values: Sequence[Scalar], exact: Callable[[Fraction], Scalar]) -> Scalar:
        """Its value, in the kind of number of the values, into which `exact` takes a fraction."""
        ordered = sorted(self.terms.items(), key=lambda term: -len(term[0]))
        return value_of([(monomial, exact(coefficient)) for monomial, coefficient in ordered], values)


def polynomial(number: Scalar) -> Polynomial:
    """A number as a polynomial; a polynomial is itself."""
    return number if isinstance(number, Polynomial) else Polynomial({(): Fraction(number)} if number else {})


def ordered(unknown: Sequence[Scalar], numbers: Sequence[Scalar]) -> list[Scalar]:
    """Values such that each stands where its symbol says, of w counted from the end."""
    return [*unknown, *reversed(numbers)]


def value_of(terms: Sequence[tuple[Monomial, Scalar]], values: Sequence[Scalar]) -> Scalar:
    """The sum of the terms, a constant last; of the kind of the values even where no symbol is in it."""
    total: Scalar = None
    for monomial, coefficient in terms:
        if len(monomial) == 2:
            term = values[monomial[0]] * values[monomial[1]] * coefficient
        elif monomial:
            term = values[monomial[0]] * coefficient
        else:
            term = coefficient if total is not None else values[0] * 0 + coefficient
        total = term if total is None else total + term
    return values[0] * 0 if total is None else total


def _without_zeros(terms: Mapping[Monomial, Fraction]) -> Polynomial:
    return Polynomial({monomial: coefficient for monomial, coefficient in terms.items() if coefficient})
