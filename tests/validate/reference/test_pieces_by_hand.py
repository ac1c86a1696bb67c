"""The pieces that the reference is put together of, in numbers known by hand."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

import mpmath
import numpy as np
import pytest
from flint import arb, ctx
from plain_mechanisms import design_of
from reference_cars import OFF_AXIS

from validate.reference.dual import Dual, slope_of, value_of
from validate.reference.errors import BadInputError, NotDecidedError
from validate.reference.exact import as_ball, bits, centre_of, mpf_from_fraction
from validate.reference.jet import Jet
from validate.reference.kinematics import body_rates
from validate.reference.vectors import Vector, cross, dot, minus, plus, squares, times

ONES: tuple[Vector, ...] = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
A, B = (2, -3, 5), (7, 11, -13)


def test_sums_and_products_of_vectors_are_numpys() -> None:
    a, b = np.array(A), np.array(B)
    assert plus(A, B) == tuple(a + b)
    assert minus(A, B) == tuple(a - b)
    assert times(A, 4) == tuple(4 * a)
    assert dot(A, B) == a @ b
    assert cross(A, B) == tuple(np.cross(a, b))
    assert squares(A) == a @ a
    assert squares(A, B) == (a @ a) * (b @ b)
    assert squares(A, B, A) == (a @ a) ** 2 * (b @ b)


X, Y, DX, DY = (Fraction(n) for n in (3, 4, 5, -7))


@pytest.mark.parametrize(
    ("of", "value", "by_x", "by_y"),
    [
        (lambda x, y: x + y, X + Y, 1, 1),
        (lambda x, y: x - y, X - Y, 1, -1),
        (lambda x, y: x * y, X * Y, Y, X),
        (lambda x, y: x / y, X / Y, 1 / Y, -X / Y**2),
    ],
)
def test_a_dual_follows_the_rules_of_differentiation(
    of: Callable[..., Dual], value: Fraction, by_x: Fraction, by_y: Fraction
) -> None:
    x, y = Dual(X, DX), Dual(Y, DY)
    assert of(x, y) == Dual(value, by_x * DX + by_y * DY)
    assert of(x, Y) == Dual(value, by_x * DX)
    assert of(X, y) == Dual(value, by_y * DY)


def test_a_number_does_not_depend_on_the_parameter() -> None:
    assert Dual(X) == Dual(X, Fraction(0))
    assert -Dual(X, DX) == Dual(-X, -DX)
    assert (value_of(Dual(X, DX)), slope_of(Dual(X, DX))) == (X, DX)
    assert (value_of(X), slope_of(X)) == (X, 0)


def test_sine_and_cosine_turn_into_each_other() -> None:
    sine, cosine = Dual(arb(1) / 2, arb(3)).sin_cos()
    assert sine.value.overlaps((arb(1) / 2).sin())
    assert cosine.value.overlaps((arb(1) / 2).cos())
    assert sine.slope.overlaps(3 * (arb(1) / 2).cos())
    assert cosine.slope.overlaps(-3 * (arb(1) / 2).sin())


def test_a_root_changes_by_half_its_share() -> None:
    root = Dual(arb(9), arb(5)).sqrt()
    assert root.value == 3
    assert root.slope.overlaps(arb(5) / 6)


JET, OTHER = Jet(3, 5, -7), Jet(-2, 11, 13)
UP, RIGHT = (0, 0, 1), (0, 1, 0)


@pytest.mark.parametrize(
    ("jet", "meant"),
    [
        (JET + OTHER, (1, 16, 6)),
        (JET - OTHER, (5, -6, -20)),
        (JET * OTHER, (-6, 23, 163)),  # -10 + 33;  14 + 2 * 55 + 39
        (-JET, (-3, -5, 7)),
        (JET + 4, (7, 5, -7)),
        (4 + JET, (7, 5, -7)),
        (JET - 4, (-1, 5, -7)),
        (4 - JET, (1, -5, 7)),
        (JET * 4, (12, 20, -28)),
        (4 * JET, (12, 20, -28)),
        (Jet(4), (4, 0, 0)),
    ],
)
def test_a_jet_follows_leibniz(jet: Jet, meant: tuple[int, int, int]) -> None:
    assert jet == Jet(*meant)


def test_arrays_leave_sums_and_products_to_the_jet() -> None:
    assert isinstance(np.array([1.0, 2.0]) * JET, Jet)


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
