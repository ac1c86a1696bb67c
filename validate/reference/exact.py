"""Exact numbers: a given float is a fraction, a proven number is a ball with an exact centre."""

from __future__ import annotations

import math
import numbers
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any, TypeVar

from flint import arb, ctx, fmpq

from validate.reference.errors import NoReferenceError, NotDecidedError, SingularPoseError

MOST_DIGITS = 400  # of the arithmetic: enough for an arm 1e-100 rad from its dead point

Answer = TypeVar("Answer")


def as_fraction(value: Any, what: str) -> Fraction:
    """The given number as an exact fraction; binary numbers (float, mpmath's mpf) are not rounded.

    Raises:
        NoReferenceError: not a real number, or not finite.
    """
    try:
        if isinstance(value, numbers.Integral):
            return Fraction(int(value))
        return Fraction(*(int(part) for part in value.as_integer_ratio()))
    except (AttributeError, ValueError, OverflowError):  # infinities and not-a-number have no ratio
        allowed = "a finite real number (int, float, Fraction or mpf)"
        raise NoReferenceError(what, f"is {value!r}", allowed, value) from None


def as_ball(value: Fraction | fmpq | int) -> arb:
    """A ball that contains the fraction, at the present precision; exact if it fits."""
    return arb(fmpq(value.numerator, value.denominator))


def centre_of(ball: arb) -> Fraction:
    """The centre of a ball, without rounding."""
    mantissa, exponent = (int(part) for part in ball.mid().man_exp())
    return Fraction(mantissa << exponent) if exponent >= 0 else Fraction(mantissa, 1 << -exponent)


def bits(digits: int) -> int:
    """Binary digits for so many decimal digits, with 25 decimal digits to spare for the arithmetic."""
    return math.ceil((digits + 25) * math.log2(10))


def with_more_digits(attempt: Callable[[int], Answer], ladder: Sequence[int]) -> Answer:
    """The result of an attempt with the first of these numbers of digits with which its proofs succeed.

    Raises:
        SingularPoseError: the proofs succeed with none of them.
    """
    for digits in ladder:
        try:
            with ctx.workprec(bits(digits)):
                return attempt(digits)
        except NotDecidedError as error:
            doubt = error
    raise SingularPoseError(digits, doubt)
