"""The pieces that the reference is put together of, in numbers known by hand."""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction

import mpmath
import numpy as np
import pytest
from flint import arb, ctx, fmpq
from mpmath import mpf
from reference_cars import OFF_AXIS

from validate.reference import Design
from validate.reference.carried import carried_by, shape_on
from validate.reference.drives import ArmAngle, RackTravel
from validate.reference.errors import BadInputError, InfeasibleError, NotDecidedError
from validate.reference.exact import bits, centre_of, mpf_from_fraction
from validate.reference.intersection import meet
from validate.reference.jet import Jet
from validate.reference.kinematics import body_rates
from validate.reference.linkage import Candidate, Choices
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


# An arm of length 5 whose end is 3 above its front pivot: the cosine is 3/5.
ARM = ArmAngle("end", "front", "rear")
TABLE: dict[str, Vector] = {"front": (1, 2, -1), "rear": (7, 2, -1), "end": (1, 6, 2)}
SQUARED = {("end", "front"): Fraction(25)}


def test_an_arm_angle_drives_the_height_of_the_arms_end() -> None:
    assert ARM.drawn(TABLE, UP, RIGHT) == 3
    theta = ARM.input_of(Fraction(3), SQUARED, Fraction(1000), 30)
    assert abs(theta - mpf(math.atan2(4, 3))) < 1e-15
    driven = ARM.driven(Jet(arb.atan2(arb(4), arb(3)), 2, 7), SQUARED, Fraction(9))
    # h = 5 cos, h' = -5 sin theta', h'' = -5 (cos theta'^2 + sin theta'') with cos 3/5 and sin 4/5
    for part, meant in ((driven.value, 3), (driven.rate, -8), (driven.acceleration, -12 - 28)):
        assert part.contains(meant)
        assert part.rad() < 1e-10


def test_an_arm_that_is_a_rounding_too_short_stands_upright() -> None:
    longer = Fraction(5) + Fraction(1, 10**16)
    assert ARM.input_of(longer, SQUARED, Fraction(1), 30) == 0
    assert abs(ARM.input_of(-longer, SQUARED, Fraction(1), 30) - mpf(math.pi)) < 1e-15
    # Near upright the difference of the squares is all that there is of the angle.
    near = ARM.input_of(Fraction(5) - Fraction(5, 2 * 10**12), SQUARED, Fraction(1), 30)
    assert abs(near - mpf("1e-6")) < 1e-15


def test_an_arm_about_an_upright_axis_cannot_be_driven() -> None:
    ARM.check(TABLE, UP)
    with pytest.raises(BadInputError, match="axis from front to rear"):
        ARM.check({**TABLE, "rear": (1, 2, 7)}, UP)
    assert ARM.required


def test_a_rack_is_drawn_by_how_far_its_end_lies_against_right() -> None:
    rack = RackTravel("centre", "inner")
    table: dict[str, Vector] = {"centre": (1, 2, 3), "inner": (50, -5, 60)}
    assert rack.drawn(table, UP, RIGHT) == 7
    assert rack.input_of(Fraction(7), {}, Fraction(8), 30) == 56
    local = rack.driven(Jet(arb(56), arb(16), arb(-8)), {}, Fraction(8))
    assert (local.value, local.rate, local.acceleration) == (7, 2, -1)
    assert not rack.required


@pytest.mark.parametrize("sign", [1, -1])
def test_two_planes_meet_a_sphere_on_the_side_that_is_asked_for(sign: int) -> None:
    a, b = _balls((2, 0, 0)), _balls((1, 3, 0))
    # x . a = 2, x . b = 7 and |x|^2 = 14: x = (1, 2, +-3), and det(a, b, x) = 6 x_3.
    point, gap = meet(a, arb(2), b, arb(7), arb(14), sign)
    for found, meant in zip(point, (1, 2, 3 * sign), strict=True):
        assert found.contains(meant)
        assert found.rad() < 1e-10
    assert gap.overlaps(arb(5).sqrt() - arb(14).sqrt())
    assert gap.rad() < 1e-10


def test_where_a_sphere_is_too_small_the_flat_part_and_the_gap_are_left() -> None:
    point, gap = meet(_balls((2, 0, 0)), arb(2), _balls((1, 3, 0)), arb(7), arb(4), 1)
    for found, meant in zip(point, (1, 2, 0), strict=True):
        assert found.contains(meant)
        assert found.rad() < 1e-10
    assert gap.overlaps(arb(5).sqrt() - 2)


def _balls(vector: Vector) -> Vector:
    return arb(vector[0]), arb(vector[1]), arb(vector[2])


TRIANGLE = ("a", "b", "c")
DRAWN: dict[str, Vector] = {
    "a": (Fraction(1), 2, 3),
    "b": (Fraction(3), 2, 4),
    "c": (Fraction(1), 5, 2),
    "p": (Fraction(7), -3, 11),
}


def test_a_carried_point_goes_where_its_body_goes() -> None:
    shape = shape_on(TRIANGLE, DRAWN, ["p", "left_out"])
    assert set(shape) == {"p"}
    assert carried_by(TRIANGLE, DRAWN, shape) == {"p": DRAWN["p"]}
    # A turn by a right angle about z and a shift take it along exactly.
    there = {name: (10 - y, x - 4, z + 1) for name, (x, y, z) in DRAWN.items()}
    assert carried_by(TRIANGLE, there, shape) == {"p": there["p"]}


def test_three_points_on_a_line_carry_nothing() -> None:
    with pytest.raises(BadInputError, match="a, b and c on one line"):
        shape_on(TRIANGLE, {**DRAWN, "c": (Fraction(5), 2, 5)}, ["p"])


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


@pytest.mark.parametrize(
    ("gap", "refused"),
    [
        (lambda: arb(-1), None),
        (lambda: arb(1) / 2, InfeasibleError),
        (lambda: arb(0, 1), NotDecidedError),
        (lambda: arb(0), NotDecidedError),
    ],
)
def test_a_closure_is_met_if_its_gap_is_proven_to_be_negative(
    gap: Callable[[], arb], refused: type[Exception] | None
) -> None:
    candidate = Candidate(Choices(), {}, {"arm": arb(-2), "tie_rod": gap()})
    if refused is None:
        candidate.require_feasible(100.0)
        return
    with pytest.raises(refused, match="tie_rod closure") as caught:
        candidate.require_feasible(100.0)
    if isinstance(caught.value, InfeasibleError):
        assert caught.value.gap == 50.0


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
        design = Design.from_points(OFF_AXIS, up, right, "left")
        assert (design.up, design.right) == (up, right)
    else:
        with pytest.raises(BadInputError, match=r"up and right is .* to 1e-12"):
            Design.from_points(OFF_AXIS, up, right, "left")


def test_heave_moves_every_point_of_the_chassis_along_up_with_its_rates() -> None:
    up = (Fraction(2, 7), Fraction(3, 7), Fraction(6, 7))
    right = (Fraction(3, 7), Fraction(-6, 7), Fraction(2, 7))
    design = Design.from_points(OFF_AXIS, up, right, "left")
    known = design.known(design.driven({"arm_angle": (1.5, 0, 0), "heave": (7, -14, 21)}))
    assert set(known.chassis) == set(known.linkage.chassis)
    for name, place in known.chassis.items():
        for axis in range(3):
            rise = up[axis] / design.unit
            meant = (design.table[name][axis] + 7 * rise, -14 * rise, 21 * rise)
            for part, exact in zip(
                (place[axis].value, place[axis].rate, place[axis].acceleration), meant, strict=True
            ):
                assert arb(part).contains(arb(fmpq(exact.numerator, exact.denominator)))


def test_a_closure_that_misses_says_which_input_helps() -> None:
    assert "try less rack travel or arm angle" in str(InfeasibleError("tie_rod", 2.0))
    for closure in ("arm", "strut", "upper_arm"):
        assert "try an arm angle nearer the design's" in str(InfeasibleError(closure, 2.0))


def test_a_doubt_is_told_in_six_digits() -> None:
    doubt = NotDecidedError("a claim", arb(1) / 3, "not 0")
    assert (doubt.value[:10], doubt.limit) == ("[0.333333 ", "not 0")


def test_what_may_be_left_out_of_a_car_is_left_out_or_stood_in_for() -> None:
    axes = (UP, RIGHT, "left")
    whole = Design.from_points(OFF_AXIS, *axes)
    few = {name: OFF_AXIS[name] for name in whole.linkage.required}
    design = Design.from_points(few, *axes)
    assert set(whole.names) - set(design.names) == {"wheel_axis_inner"}
    assert design.table["rack_centre"] == design.table["tie_rod_inner"]
    for name in few:
        short = {other: place for other, place in few.items() if other != name}
        with pytest.raises(BadInputError, match="exactly the names"):
            Design.from_points(short, *axes)


def test_a_link_without_length_is_told_to_have_none() -> None:
    points = {**OFF_AXIS, "lower_ball_joint": OFF_AXIS["lower_arm_rear"]}
    with pytest.raises(
        BadInputError, match="distance from lower_ball_joint to lower_arm_rear is 0; allowed is more"
    ):
        Design.from_points(points, UP, RIGHT, "left")


@pytest.mark.parametrize("size", [Fraction(1, 10**6), Fraction(1, 300), Fraction(1), Fraction(10**9)])
def test_the_unit_of_a_design_is_a_power_of_two_near_its_size(size: Fraction) -> None:
    points = {name: tuple(size * x for x in place) for name, place in OFF_AXIS.items()}
    unit = Design.from_points(points, UP, RIGHT, "left").unit
    assert unit.numerator & (unit.numerator - 1) == unit.denominator & (unit.denominator - 1) == 0
    origin = points["lower_arm_front"]
    reach = max(abs(x - o) for place in points.values() for x, o in zip(place, origin, strict=True))
    assert Fraction(1, 2) < reach / unit < 2
