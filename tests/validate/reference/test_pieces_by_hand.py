"""The pieces that the reference is put together of, in numbers known by hand."""

from __future__ import annotations

from fractions import Fraction

import mpmath
import numpy as np
import pytest
from flint import arb, ctx
from plain_mechanisms import design_of
from reference_cars import OFF_AXIS

from validate.reference.errors import BadInputError, NotDecidedError
from validate.reference.exact import as_ball, bits, centre_of, mpf_from_fraction
from validate.reference.jet import Jet
from validate.reference.kinematics import body_rates
from validate.reference.vectors import Vector, cross, plus

X, Y = Jet(3, 5, -7), Jet(-2, 11, 13)
UP, RIGHT = (0, 0, 1), (0, 1, 0)


@pytest.mark.parametrize(
    ("jet", "meant"),
    [
        (X + Y, (1, 16, 6)),
        (X - Y, (5, -6, -20)),
        (X * Y, (-6, 23, 163)),  # -10 + 33;  14 + 2 * 55 + 39
        (-X, (-3, -5, 7)),
        (X + 4, (7, 5, -7)),
        (4 + X, (7, 5, -7)),
        (X - 4, (-1, 5, -7)),
        (4 - X, (1, -5, 7)),
        (X * 4, (12, 20, -28)),
        (4 * X, (12, 20, -28)),
        (Jet(4), (4, 0, 0)),
    ],
)
def test_a_jet_follows_leibniz(jet: Jet, meant: tuple[int, int, int]) -> None:
    assert jet == Jet(*meant)


def test_arrays_leave_sums_and_products_to_the_jet() -> None:
    assert isinstance(np.array([1.0, 2.0]) * X, Jet)


@pytest.mark.parametrize("power", [0, 1, 70, 3000])
def test_a_fraction_of_a_power_of_two_is_taken_exactly(power: int) -> None:
    exact = Fraction(-(3**50), 2**power)
    found = mpf_from_fraction(exact, 15)
    assert Fraction(*(int(part) for part in found.as_integer_ratio())) == exact


@pytest.mark.parametrize("digits", [15, 200])
def test_other_fractions_are_rounded_to_the_digits_and_25_more(digits: int) -> None:
    found = mpf_from_fraction(Fraction(-5, 7), digits)
    off = abs(Fraction(*(int(part) for part in found.as_integer_ratio())) + Fraction(5, 7))
    assert 0 < off <= Fraction(1, 10 ** (digits + 25))
    assert off > Fraction(1, 10 ** (digits + 27))
    assert 2 ** bits(digits) >= 10 ** (digits + 25) > 2 ** (bits(digits) - 1)


def test_the_centre_of_a_ball_is_taken_whole_whatever_mpmaths_precision_is() -> None:
    with mpmath.workdps(5):
        centre = centre_of(arb(1) / 3)
    assert abs(arb(1) / 3 - arb(centre.man) * arb(2) ** centre.exp).abs_upper() < arb(2) ** -(ctx.prec - 1)
    assert centre_of(arb(5, 1)) == 5


def test_a_body_turns_as_its_vectors_say() -> None:
    omega, alpha = (2, -3, 5), (-7, 11, 4)

    def carried(r: Vector) -> Vector:
        rate = cross(omega, r)
        bend = plus(cross(alpha, r), cross(omega, rate))
        x, y, z = (Jet(*(arb(n) for n in parts)) for parts in zip(r, rate, bend, strict=True))
        return x, y, z

    for found, meant in zip(body_rates(carried((1, 2, 3)), carried((-2, 5, 1))), (omega, alpha), strict=True):
        for part, exact in zip(found, meant, strict=True):
            assert part.contains(exact)
            assert part.rad() < 1e-10


MILLIONTH = Fraction(1, 10**6)


@pytest.mark.parametrize(
    ("up", "right", "allowed"),
    [
        # A square of exactly 1 + 1e-12, and one a little beyond it.
        ((0, 0, 1), (MILLIONTH, 1, 0), True),
        ((0, MILLIONTH, 1), (1, 0, 0), True),
        ((0, 0, 1), (MILLIONTH + MILLIONTH**2, 1, 0), False),
        ((0, MILLIONTH + MILLIONTH**2, 1), (1, 0, 0), False),
        ((0, 0, 1), (0, 1 - MILLIONTH, 0), False),
        # A cosine of exactly 1e-12 between them, and one a little beyond it.
        ((0, 0, 1), (0, 1, MILLIONTH**2), True),
        ((0, 0, 1), (0, 1, -(MILLIONTH**2)), True),
        ((0, 0, 1), (0, 1, MILLIONTH**2 + MILLIONTH**3), False),
    ],
)
def test_directions_are_unit_vectors_at_right_angles_to_a_millionth_of_a_millionth(
    up: Vector, right: Vector, allowed: bool
) -> None:
    if allowed:
        design = design_of(OFF_AXIS, up=up, right=right)
        assert (design.up, design.right) == (up, right)
    else:
        with pytest.raises(BadInputError, match=r"up and right is .* to 1e-12"):
            design_of(OFF_AXIS, up=up, right=right)


def test_heave_moves_every_point_along_up_with_its_rates() -> None:
    up = (Fraction(2, 7), Fraction(3, 7), Fraction(6, 7))
    right = (Fraction(3, 7), Fraction(-6, 7), Fraction(2, 7))
    design = design_of(OFF_AXIS, up=up, right=right)
    known = design.known(design.driven({"arm_angle": (1.5, 0, 0), "heave": (7, -14, 21)}))
    place = (Jet(arb(1)), Jet(arb(2)), Jet(arb(3)))
    for axis, found in enumerate(known.chassis.moved(place)):
        rise = up[axis] / design.unit
        meant = (axis + 1 + 7 * rise, -14 * rise, 21 * rise)
        for part, exact in zip((found.value, found.rate, found.acceleration), meant, strict=True):
            assert arb(part).overlaps(as_ball(exact))


def test_a_doubt_is_told_in_six_digits() -> None:
    doubt = NotDecidedError("a claim", arb(1) / 3, "not 0")
    assert (doubt.value[:10], doubt.limit) == ("[0.333333 ", "not 0")


@pytest.mark.parametrize("size", [Fraction(1, 10**6), Fraction(1, 300), Fraction(1), Fraction(10**9)])
def test_the_unit_of_a_design_is_a_power_of_two_near_its_size(size: Fraction) -> None:
    points = {name: tuple(size * x for x in place) for name, place in OFF_AXIS.items()}
    unit = design_of(points).unit
    assert unit.numerator & (unit.numerator - 1) == unit.denominator & (unit.denominator - 1) == 0
    origin = design_of(points).origin
    reach = max(abs(x - o) for place in points.values() for x, o in zip(place, origin, strict=True))
    assert Fraction(1, 2) < reach / unit < 2
