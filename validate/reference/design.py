"""The given points as exact fractions, in a frame of their own size."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from flint import arb

from validate.reference.errors import BadInputError
from validate.reference.exact import as_ball, as_fraction
from validate.reference.jet import Jet
from validate.reference.linkage import Known, Link, Linkage
from validate.reference.suspensions import CLOSURE, SUSPENSION, linkage_for
from validate.reference.vectors import Vector, dot, minus, plus, times

DIRECTION_SLACK = Fraction(1, 10**12)  # a float64 unit vector is off by about 1e-16; a wrong one by far more
HEAVE = "heave"  # moves the chassis of every suspension, mm along up

# Every input of a linkage, and heave, each (value, rate, acceleration) in fractions; rad or mm.
Driven = Mapping[str, Jet]


@dataclass(frozen=True)
class Design:
    """The mechanism as given. Local coordinates are (p - origin) / unit, exact.

    The shift and the unit keep balls tight whether the points lie 1e9 mm from the frame's origin or
    the mechanism is 1e-3 or 1e6 mm in size.

    Attributes:
        linkage: which suspension, under which closure.
        table: the points that this car has, by name, local.
        origin: the first point, mm.
        unit: a power of two near the mechanism's size, mm.
        up: direction of z.
        right: direction of y.
        outboard: +1 where outboard is `right`, -1 where it is the opposite.
        squared_length: of every link, local.
        knuckle: its shape, in the numbers that the equations use, local.
    """

    linkage: Linkage
    table: Mapping[str, Vector]
    origin: Vector
    unit: Fraction
    up: Vector
    right: Vector
    outboard: int
    squared_length: Mapping[Link, Fraction]
    knuckle: Mapping[str, Vector]

    @classmethod
    def from_points(
        cls,
        points: Mapping[str, Sequence[object]],
        up: Sequence[object],
        right: Sequence[object],
        side: str,
        closure: str = CLOSURE,
        suspension: str = SUSPENSION,
    ) -> Design:
        """Take over the named points, mm; a point that is left out may have a stand-in.

        Raises:
            BadInputError: there is no such suspension, a point is missing or unknown, a number is not finite,
                `up` and `right` are not unit vectors at right angles, a link or the knuckle has no extent, or
                an input cannot drive the car.
        """
        linkage = linkage_for(suspension, closure)
        if not set(linkage.required) <= set(points) <= set(linkage.points):
            optional = " and ".join(n for n in linkage.points if n not in linkage.required)
            allowed = f"exactly the names {', '.join(linkage.required)}, with or without {optional}"
            raise BadInputError("points", sorted(points), allowed)
        given = {n: exact_vector(points[n], f"points[{n!r}]") for n in linkage.points if n in points}
        for name, other in linkage.stand_ins.items():
            given.setdefault(name, given[other])
        z, y = exact_vector(up, "up"), exact_vector(right, "right")
        if abs(dot(z, z) - 1) > DIRECTION_SLACK or abs(dot(y, y) - 1) > DIRECTION_SLACK:
            raise BadInputError("up and right", (up, right), "unit vectors, to 1e-12")
        if abs(dot(z, y)) > DIRECTION_SLACK:
            raise BadInputError("up and right", (up, right), "vectors at right angles, to 1e-12")
        if side not in ("left", "right"):
            raise BadInputError("side", side, "'left' or 'right'")
        unit, origin = _unit(given, linkage.points[0]), given[linkage.points[0]]
        present = (n for n in linkage.points if n in given)
        table = {n: times(minus(given[n], origin), 1 / unit) for n in present}
        lengths = {}
        for a, b in linkage.links:
            link = minus(table[a], table[b])
            lengths[a, b] = dot(link, link)
            if lengths[a, b] == 0:
                raise BadInputError(f"the distance from {a} to {b}", 0, "more than 0")
        for drive in linkage.inputs.values():
            drive.check(table, z)
        outboard = -1 if side == "left" else 1
        return cls(linkage, table, origin, unit, z, y, outboard, lengths, linkage.shape(table))

    @property
    def names(self) -> tuple[str, ...]:
        """The points that this car has."""
        return tuple(self.table)

    def driven(self, inputs: Mapping[str, Sequence[object]]) -> Driven:
        """Inputs by name as fractions; an input that is not named rests at zero.

        Raises:
            BadInputError: an unknown name, not three finite numbers, or an input is missing.
        """
        names = (*self.linkage.inputs, HEAVE)
        for name, triple in inputs.items():
            if name not in names:
                raise BadInputError(f"inputs[{name!r}]", triple, f"one of {', '.join(names)}")
            if len(triple) != 3:
                raise BadInputError(f"inputs[{name!r}]", triple, "three numbers: value, rate, acceleration")
        required = [name for name, drive in self.linkage.inputs.items() if drive.required]
        if not set(required) <= set(inputs):
            allowed = f"a mapping that names at least {' and '.join(required)}"
            raise BadInputError("inputs", sorted(inputs), allowed)
        return {
            name: Jet(*(as_fraction(part, f"inputs[{name!r}]") for part in inputs.get(name, (0, 0, 0))))
            for name in names
        }

    def known(self, driven: Driven) -> Known:
        """What the equations take as given, as jets of balls at the present precision, local."""
        return self.known_for({name: balls(jet) for name, jet in driven.items()})

    def known_for(self, driven: Mapping[str, Jet]) -> Known:
        """The same from jets of balls, or of duals of balls; rad, mm, mm."""
        numbers = {
            name: drive.driven(driven[name], self.squared_length, self.unit)
            for name, drive in self.linkage.inputs.items()
        }
        return self.known_at(numbers, driven[HEAVE])

    def known_at(self, numbers: Mapping[str, Jet], heave: Jet) -> Known:
        """The same from the numbers that the equations take for the inputs, local, and heave, mm.

        Heave moves the points of the chassis by heave(t) up.
        """
        rise = heave * as_ball(1 / self.unit)
        up = ball_vector(self.up)
        lift = (rise * up[0], rise * up[1], rise * up[2])
        return Known(
            linkage=self.linkage,
            chassis={n: plus(ball_vector(self.table[n]), lift) for n in self.linkage.chassis},
            up=up,
            right=ball_vector(self.right),
            squared_length={link: as_ball(squared) for link, squared in self.squared_length.items()},
            driven=numbers,
            knuckle={n: ball_vector(shape) for n, shape in self.knuckle.items()},
        )


def values_only(known: Known) -> Known:
    """The same with the values of the jets, for the position equations."""
    chassis = {n: (p[0].value, p[1].value, p[2].value) for n, p in known.chassis.items()}
    return replace(known, chassis=chassis, driven={n: jet.value for n, jet in known.driven.items()})


def exact_vector(numbers: Sequence[object], what: str) -> Vector:
    """Three numbers as fractions; `BadInputError` if there are not three."""
    if len(numbers) != 3:
        raise BadInputError(what, numbers, "three numbers")
    x, y, z = (as_fraction(number, what) for number in numbers)
    return x, y, z


def ball_vector(vector: Vector) -> tuple[arb, arb, arb]:
    """Three fractions as balls."""
    return as_ball(vector[0]), as_ball(vector[1]), as_ball(vector[2])


def balls(jet: Jet) -> Jet:
    """A jet of fractions as a jet of balls."""
    return Jet(as_ball(jet.value), as_ball(jet.rate), as_ball(jet.acceleration))


def _unit(points: Mapping[str, Vector], origin: str) -> Fraction:
    size = max(abs(x) for p in points.values() for x in minus(p, points[origin]))
    if size == 0:
        raise BadInputError("points", "all in one place", "points with some distance between them")
    power = size.numerator.bit_length() - size.denominator.bit_length()
    return Fraction(2**power) if power >= 0 else Fraction(1, 2**-power)
