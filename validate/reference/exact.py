"""Numbers without loss: a given float is a fraction, a proven number is a ball with an exact centre."""

from __future__ import annotations

import math
import numbers
from decimal import Decimal
from fractions import Fraction

from flint import arb, fmpq
from mpmath import libmp, mp, mpf

from validate.reference.errors import BadInputError


def as_fraction(value: object, what: str) -> Fraction:
    """The given number as a fraction, exactly: binary numbers (float, mpf) are what they are.

    Raises:
        BadInputError: not a real number, or not finite.
    """
    try:
        if isinstance(value, numbers.Integral):
            return Fraction(int(value))
        if isinstance(value, Fraction | Decimal):
            return Fraction(value)
        if isinstance(value, mpf):
            return Fraction(*(int(part) for part in value.as_integer_ratio()))
        if isinstance(value, numbers.Real):
            return Fraction(float(value))
    except (ValueError, OverflowError):  # infinities and not-a-number have no ratio
        pass
    raise BadInputError(what, value, "a finite real number (int, float, Fraction or mpf)")


def as_ball(value: Fraction | int) -> arb:
    """A ball that contains the fraction, at the present precision; exact if it fits."""
    value = Fraction(value)
    return arb(fmpq(value.numerator, value.denominator))


def centre_of(ball: arb) -> mpf:
    """The centre of a ball, without rounding, whatever the working precision of mpmath is."""
    mantissa, exponent = ball.mid().man_exp()
    return mp.make_mpf(libmp.from_man_exp(int(mantissa), int(exponent)))


def mpf_from_fraction(value: Fraction, digits: int) -> mpf:
    """The fraction as mpf: exact if its denominator is a power of two, else rounded to `digits`."""
    power = value.denominator.bit_length() - 1
    if value.denominator == 1 << power:
        return mp.make_mpf(libmp.from_man_exp(value.numerator, -power))
    precision = bits(digits)
    return mp.make_mpf(libmp.from_rational(value.numerator, value.denominator, precision))


def bits(digits: int) -> int:
    """Binary digits that hold so many decimal digits, with 25 to spare for the arithmetic."""
    return math.ceil((digits + 25) * math.log2(10))
