r"""Kinds of input: what number the equations take for it, and where the drawing has it.

A drive works in local coordinates (see `design`), with jets of balls or of duals for the input's value, rate
and acceleration.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Protocol

from flint import arb
from mpmath import mpf

from validate.reference.errors import BadInputError
from validate.reference.exact import as_ball, centre_of, mpf_from_fraction
from validate.reference.jet import Jet
from validate.reference.vectors import Vector, cross, dot, minus

Table = Mapping[str, Vector]
Lengths = Mapping[tuple[str, str], Fraction]


class Drive(Protocol):
    """An input of a linkage.

    Attributes:
        required: whether it must be given; else it rests at zero.
    """

    @property
    def required(self) -> bool: ...

    def check(self, table: Table, up: Vector) -> None:
        """Pass if the input can drive the car as drawn, else `BadInputError`."""

    def driven(self, value: Jet, squared_length: Lengths, unit: Fraction) -> Jet:
        """The number that the equations take; from rad or mm to local."""

    def drawn(self, table: Table, up: Vector, right: Vector) -> Fraction:
        """That number as drawn, exact."""

    def input_of(self, drawn: Fraction, squared_length: Lengths, unit: Fraction, digits: int) -> mpf:
        """The input itself at that number, rad or mm."""


@dataclass(frozen=True)
class ArmAngle:
    """theta, rad: (p_end - p_front) . up = d cos(theta), d the drawn length; 0 to pi.

    Attributes:
        end: of the arm, at the knuckle.
        front: pivot on the chassis from which theta is measured.
        rear: other pivot.
    """

    end: str
    front: str
    rear: str
    required: bool = True

    def check(self, table: Table, up: Vector) -> None:
        """Where the arm's axis is upright theta does not move the arm."""
        upright = cross(minus(table[self.rear], table[self.front]), up)
        if dot(upright, upright) == 0:
            what = f"the arm's axis from {self.front} to {self.rear}"
            raise BadInputError(what, "upright or without length", "an axis not along up")

    def driven(self, value: Jet, squared_length: Lengths, unit: Fraction) -> Jet:
        """h = d cos(theta), with its derivatives.

        h' = -d sin(theta) theta',  h'' = -d (cos(theta) theta'^2 + sin(theta) theta'').
        """
        sine, cosine = value.value.sin_cos()
        d = as_ball(squared_length[self.end, self.front]).sqrt()
        bend = cosine * value.rate * value.rate + sine * value.acceleration
        return Jet(d * cosine, -d * sine * value.rate, -d * bend)

    def drawn(self, table: Table, up: Vector, right: Vector) -> Fraction:
        """The height of the arm's end over its front pivot."""
        height: Fraction = dot(minus(table[self.end], table[self.front]), up)
        return height

    def input_of(self, drawn: Fraction, squared_length: Lengths, unit: Fraction, digits: int) -> mpf:
        """theta, by cosine and sine: an arc cosine loses its digits where the arm stands upright."""
        # `up` is a unit vector to rounding only, so the difference may be just below zero.
        beside = max(squared_length[self.end, self.front] - drawn * drawn, Fraction(0))
        return centre_of(arb.atan2(as_ball(beside).sqrt(), as_ball(drawn)))


@dataclass(frozen=True)
class RackTravel:
    """S, mm: p_inner = p_centre - S right."""

    centre: str
    inner: str
    required: bool = False

    def check(self, table: Table, up: Vector) -> None:
        """Every rack can travel."""

    def driven(self, value: Jet, squared_length: Lengths, unit: Fraction) -> Jet:
        """S."""
        return value * as_ball(1 / unit)

    def drawn(self, table: Table, up: Vector, right: Vector) -> Fraction:
        """S as drawn; what lies across the rack's line does not count."""
        travel: Fraction = dot(minus(table[self.centre], table[self.inner]), right)
        return travel

    def input_of(self, drawn: Fraction, squared_length: Lengths, unit: Fraction, digits: int) -> mpf:
        """S, exact to `digits`."""
        return mpf_from_fraction(drawn * unit, digits)
