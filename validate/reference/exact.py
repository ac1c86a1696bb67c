"""Exact numbers: given floats become fractions; proven numbers are balls with exact centres."""

from __future__ import annotations

import math
import numbers
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any, TypeVar

from flint import arb, ctx, fmpq

from validate.reference.errors import NoReferenceError, NotDecidedError, SingularPoseError

MOST_DIGITS = 400  # of the arithmetic: enough for an arm 1e-100 rad from its dead point

Result = TypeVar("Result")


def as_fraction(value: Any, what: str) -> Fraction:
    """A number as an exact fraction; floats and mpmath's mpf are not rounded.

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
    """Bits for this many decimal digits and 25 more for the errors of the arithmetic."""
    return math.ceil((digits + 25) * math.log2(10))


def with_more_digits(attempt: Callable[[], Result], ladder: Sequence[int]) -> Result:
    """The result of an attempt at the first of these numbers of digits at which its proofs succeed.

    Raises:
        SingularPoseError: the proofs fail at all of them.
    """
    for digits in ladder:
        try:
            with ctx.workprec(bits(digits)):
                return attempt()
        except NotDecidedError as error:
            doubt = error
    raise SingularPoseError(digits, doubt)
