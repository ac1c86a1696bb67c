"""The pieces that the reference is put together of, in numbers known by hand."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

import pytest
from flint import arb
from plain_mechanisms import design_of
from reference_cars import OFF_AXIS

from validate.reference.dual import Dual
from validate.reference.errors import BadInputError
from validate.reference.exact import as_ball, bits, centre_of
from validate.reference.jet import Jet
from validate.reference.kinematics import body_rates
from validate.reference.vectors import Vector, cross, plus

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


JET, OTHER = Jet(3, 5, -7), Jet(-2, 11, 13)
LONG = Jet(1, 2, 3, 5)


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
        (Jet(4) * JET, (12, 20, -28)),
        (LONG * LONG, (1, 4, 14, 46)),  # 2 x times the third and 6 x' x'': 10 + 36
        (LONG * JET, (3, 11, 22, 18)),  # 15 + 45 - 42, and nothing of what is missing
    ],
)
def test_a_jet_follows_leibniz(jet: Jet, meant: tuple[int, ...]) -> None:
    assert tuple(jet.part(order) for order in range(len(meant))) == meant


@pytest.mark.parametrize("digits", [15, 200])
def test_bits_hold_the_digits_and_25_more(digits: int) -> None:
    assert 2 ** bits(digits) >= 10 ** (digits + 25) > 2 ** (bits(digits) - 1)


def test_the_centre_of_a_ball_is_taken_whole() -> None:
    assert (arb(1) / 3).mid() == as_ball(centre_of(arb(1) / 3))
    assert centre_of(arb(5, 1)) == 5
    assert centre_of(arb(2) ** 90) == 2**90


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
        ((0, MILLIONTH + MILLIONTH**2, 1), (1, 0, 0), False),
        # A cosine of exactly 1e-12 between them, and one a little beyond it.
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
