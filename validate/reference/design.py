"""The given points as exact fractions, in a frame of their own size."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from flint import arb

from validate.reference.closures import DEFAULT, equations_for
from validate.reference.equations import CHASSIS, NUMBER_OF, Known
from validate.reference.errors import BadInputError
from validate.reference.exact import as_ball, as_fraction
from validate.reference.jet import Jet
from validate.reference.vectors import Vector, cross, dot, minus, plus, times

DIRECTION_SLACK = Fraction(1, 10**12)  # a float64 unit vector is off by about 1e-16; a wrong one by far more
OPTIONAL = ("rack_centre", "wheel_axis_inner")
INPUTS = ("arm_angle", "rack", "heave")


@dataclass(frozen=True)
class Driven:
    """The three inputs at one instant, each (value, rate, acceleration) as fractions; rad, mm, mm."""

    arm_angle: Jet
    rack: Jet
    heave: Jet

    @classmethod
    def from_mapping(cls, inputs: Mapping[str, Sequence[object]]) -> Driven:
        """Inputs by name; an input that is not named rests at zero.

        Raises:
            BadInputError: an unknown name, or not three finite numbers.
        """
        for name, triple in inputs.items():
            if name not in INPUTS:
                raise BadInputError(f"inputs[{name!r}]", triple, f"one of {', '.join(INPUTS)}")
            if len(triple) != 3:
                raise BadInputError(f"inputs[{name!r}]", triple, "three numbers: value, rate, acceleration")
        if "arm_angle" not in inputs:
            raise BadInputError("inputs", sorted(inputs), "a mapping that names at least arm_angle")
        jets = {
            name: Jet(*(as_fraction(part, f"inputs[{name!r}]") for part in inputs.get(name, (0, 0, 0))))
            for name in INPUTS
        }
        return cls(**jets)


@dataclass(frozen=True)
class Design:
    """The mechanism as given. Local coordinates are (p - origin) / unit, exact.

    The shift and the unit keep balls tight whether the points lie 1e9 mm from the frame's origin or
    the mechanism is 1e-3 or 1e6 mm in size.

    Attributes:
        closure: which strut, "drawn" or "collinear".
        table: the points, local; without 11 where that is not given.
        origin: point 1, mm.
        unit: a power of two near the mechanism's size, mm.
        up: direction of z.
        right: direction of y.
        outboard: +1 where outboard is `right`, -1 where it is the opposite.
        squared_length: d_ij^2 of every link, local.
        knuckle: its shape, in the numbers that the equations of the closure use, local.
    """

    closure: str
    table: Mapping[int, Vector]
    origin: Vector
    unit: Fraction
    up: Vector
    right: Vector
    outboard: int
    squared_length: Mapping[tuple[int, int], Fraction]
    knuckle: Mapping[int, Vector]

    @classmethod
    def from_points(
        cls,
        points: Mapping[str, Sequence[object]],
        up: Sequence[object],
        right: Sequence[object],
        side: str,
        closure: str = DEFAULT,
    ) -> Design:
        """Take over the named points, mm. Without a rack centre the rack's line passes through point 9.

        Raises:
            BadInputError: a point is missing or unknown, a number is not finite, `up` and `right` are not
                unit vectors at right angles, a link or the knuckle has no extent, or the arm's axis is
                upright (then theta does not move the arm).
        """
        needed = [name for name in NUMBER_OF if name not in OPTIONAL]
        if not set(needed) <= set(points) <= set(NUMBER_OF):
            allowed = f"exactly the names {', '.join(needed)}, with or without {' and '.join(OPTIONAL)}"
            raise BadInputError("points", sorted(points), allowed)
        equations = equations_for(closure)
        given = {NUMBER_OF[name]: exact_vector(p, f"points[{name!r}]") for name, p in points.items()}
        given.setdefault(3, given[9])
        z, y = exact_vector(up, "up"), exact_vector(right, "right")
        if abs(dot(z, z) - 1) > DIRECTION_SLACK or abs(dot(y, y) - 1) > DIRECTION_SLACK:
            raise BadInputError("up and right", (up, right), "unit vectors, to 1e-12")
        if abs(dot(z, y)) > DIRECTION_SLACK:
            raise BadInputError("up and right", (up, right), "vectors at right angles, to 1e-12")
        if side not in ("left", "right"):
            raise BadInputError("side", side, "'left' or 'right'")
        unit = _unit(given)
        table = {n: times(minus(p, given[1]), 1 / unit) for n, p in given.items()}
        lengths = {}
        for i, j in equations.LINKS:
            link = minus(table[i], table[j])
            lengths[i, j] = dot(link, link)
            if lengths[i, j] == 0:
                raise BadInputError(f"the length between points {i} and {j}", 0, "more than 0")
        upright = cross(minus(table[2], table[1]), z)
        if dot(upright, upright) == 0:
            raise BadInputError("the arm's axis 1-2", "upright or without length", "an axis not along up")
        outboard = -1 if side == "left" else 1
        shape = equations.knuckle_of(table)
        return cls(closure, table, given[1], unit, z, y, outboard, lengths, shape)

    @property
    def names(self) -> dict[str, int]:
        """The points that this car has, by name."""
        return {name: n for name, n in NUMBER_OF.items() if n in self.table}

    def known(self, driven: Driven) -> Known:
        """What the equations take as given, as jets of balls at the present precision, local."""
        return self.known_for(balls(driven.arm_angle), balls(driven.rack), balls(driven.heave))

    def known_for(self, theta: Jet, rack: Jet, heave: Jet) -> Known:
        """The same from jets of balls, or of duals of balls; rad, mm, mm.

        Heave moves points 1 to 4 by heave(t) up. With h = d_51 cos(theta):
        h' = -d_51 sin(theta) theta',  h'' = -d_51 (cos(theta) theta'^2 + sin(theta) theta'').
        """
        rise = heave * as_ball(1 / self.unit)
        up = ball_vector(self.up)
        lift = (rise * up[0], rise * up[1], rise * up[2])
        sine, cosine = theta.value.sin_cos()
        d51 = as_ball(self.squared_length[5, 1]).sqrt()
        bend = cosine * theta.rate * theta.rate + sine * theta.acceleration
        return Known(
            closure=self.closure,
            chassis={n: plus(ball_vector(self.table[n]), lift) for n in CHASSIS},
            up=up,
            right=ball_vector(self.right),
            squared_length={link: as_ball(squared) for link, squared in self.squared_length.items()},
            arm_height=Jet(d51 * cosine, -d51 * sine * theta.rate, -d51 * bend),
            rack=rack * as_ball(1 / self.unit),
            knuckle={n: ball_vector(numbers) for n, numbers in self.knuckle.items()},
        )


def values_only(known: Known) -> Known:
    """The same with the values of the jets, for the position equations."""
    chassis = {n: (p[0].value, p[1].value, p[2].value) for n, p in known.chassis.items()}
    return replace(known, chassis=chassis, arm_height=known.arm_height.value, rack=known.rack.value)


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


def _unit(points: Mapping[int, Vector]) -> Fraction:
    size = max(abs(x) for p in points.values() for x in minus(p, points[1]))
    if size == 0:
        raise BadInputError("points", "all in one place", "points with some distance between them")
    power = size.numerator.bit_length() - size.denominator.bit_length()
    return Fraction(2**power) if power >= 0 else Fraction(1, 2**-power)
