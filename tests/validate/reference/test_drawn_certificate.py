"""The equations of the drawn strut are differentiated rightly, and false poses of it are not certified."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction

import pytest
from flint import arb, ctx
from hypothesis import given, settings
from hypothesis import strategies as st
from off_axis_cars import BASE, Points, closing

from validate.reference import (
    AmbiguousAssemblyError,
    BadInputError,
    NotDecidedError,
    closed_drawing,
    solve_reference,
)
from validate.reference.branches import candidate, choices_of_table
from validate.reference.certificate import certify, refine
from validate.reference.design import Design, Driven, values_only
from validate.reference.equations import CHASSIS, Known
from validate.reference.exact import bits
from validate.reference.jet import Jet
from validate.reference.knuckle_equations import AXIS, LINKS, SIZE, SLIDE, jacobian, residual, unknown_of
from validate.reference.vectors import dot, minus, plus, times

UP, RIGHT = (0, 0, 1), (0, 1, 0)
POINTS = closing(BASE, Fraction(1, 2), Fraction(230), RIGHT)
STILL = {"arm_angle": (1.5, 0, 0), "rack": (230, 0, 0)}
BOX = Fraction(1, 10**60)

fractions = st.integers(-1000, 1000).map(lambda n: Fraction(n, 16))
unknowns = st.lists(fractions, min_size=SIZE, max_size=SIZE)


def known_numbers(numbers: list[Fraction]) -> Known:
    """A set of given quantities filled from a list of 36 fractions."""
    take = iter(numbers)

    def vector() -> tuple[Fraction, Fraction, Fraction]:
        return next(take), next(take), next(take)

    chassis, up, right = {n: vector() for n in CHASSIS}, vector(), vector()
    shape = {n: vector() for n in (6, 7, 8, AXIS)}
    return Known("drawn", chassis, up, right, {k: next(take) for k in LINKS}, *take, knuckle=shape)


knowns = st.lists(fractions, min_size=36, max_size=36).map(known_numbers)


@given(unknowns, unknowns, knowns)
@settings(max_examples=40, deadline=None)
def test_the_jacobian_is_exactly_the_central_difference_of_the_quadratic_residual(
    y: list[Fraction], step: list[Fraction], known: Known
) -> None:
    ahead = residual([a + b for a, b in zip(y, step, strict=True)], known)
    behind = residual([a - b for a, b in zip(y, step, strict=True)], known)
    product = [Fraction(0)] * SIZE
    for row, column, entry in jacobian(y, known):
        product[row] += entry * step[column]
    assert product == [(a - b) / 2 for a, b in zip(ahead, behind, strict=True)]


@given(unknowns, unknowns, unknowns, knowns)
@settings(max_examples=20, deadline=None)
def test_jets_give_the_exact_derivatives_along_a_parabola(
    y: list[Fraction], rate: list[Fraction], bend: list[Fraction], known: Known
) -> None:
    def at(t: int) -> list[Fraction]:
        return residual([a + b * t + c * t * t / 2 for a, b, c in zip(y, rate, bend, strict=True)], known)

    # C(y(t)) has degree 4 in t, for which five-point differences are exact.
    p2, p1, p0, m1, m2 = (at(t) for t in (2, 1, 0, -1, -2))
    jets = residual([Jet(a, b, c) for a, b, c in zip(y, rate, bend, strict=True)], known)
    for i, jet in enumerate(jets):
        assert jet.value == p0[i]
        assert jet.rate == (8 * (p1[i] - m1[i]) - (p2[i] - m2[i])) / 12
        assert jet.acceleration == (16 * (p1[i] + m1[i]) - (p2[i] + m2[i]) - 30 * p0[i]) / 12


@pytest.fixture(autouse=True)
def _precision() -> Iterator[None]:
    with ctx.workprec(bits(60)):
        yield


def posed(points: Points = POINTS, theta: object = 1.5) -> tuple[Known, list[arb]]:
    """The given quantities and a refined solution at the present precision, local."""
    design = Design.from_points(points, UP, RIGHT, "left", "drawn")
    inputs = {"arm_angle": (theta, 0, 0), "rack": (230, 0, 0)}
    known = values_only(design.known(Driven.from_mapping(inputs)))
    chosen = candidate(known, choices_of_table(design.table, design.up, "drawn"))
    return known, refine(unknown_of(chosen.points, known), known)


def test_a_refined_solution_is_certified_and_the_enclosure_is_far_inside_the_box() -> None:
    known, solution = posed()
    assert all(ball.rad() < arb("1e-70") for ball in certify(solution, known, BOX).enclosure)


@pytest.mark.parametrize("place", range(SLIDE))
def test_a_planted_error_in_any_unknown_that_places_points_is_rejected(place: int) -> None:
    known, solution = posed()
    solution[place] = (solution[place] + arb("1e-58")).mid()
    with pytest.raises(NotDecidedError):
        certify(solution, known, BOX)


def test_a_planted_error_in_the_slide_is_mended_by_the_enclosure() -> None:
    known, solution = posed()
    right = solution[SLIDE]
    solution[SLIDE] = (right + arb("1e-58")).mid()
    assert abs(certify(solution, known, BOX).enclosure[SLIDE] - right) < arb("1e-75")


def test_a_wrong_length_is_rejected() -> None:
    known, solution = posed()
    for link in ((5, 1), (5, 2), (9, 6)):
        lengths = {**known.squared_length, link: known.squared_length[link] + arb("1e-50")}
        with pytest.raises(NotDecidedError):
            certify(solution, replace(known, squared_length=lengths), BOX)


@pytest.mark.parametrize("place", [6, 7, AXIS])
@pytest.mark.parametrize("component", range(3))
def test_a_wrong_shape_of_the_knuckle_is_rejected(place: int, component: int) -> None:
    known, solution = posed()
    k = list(known.knuckle[place])
    k[component] += arb("1e-50")
    with pytest.raises(NotDecidedError):
        certify(solution, replace(known, knuckle={**known.knuckle, place: tuple(k)}), BOX)


def test_a_mirrored_knuckle_meets_the_equations_and_is_not_certified() -> None:
    # With 6 in the plane of 5 and the axis, the knuckle's mirror image in that plane keeps 5, 6, 7 and u.
    b, t, lower = (POINTS[n] for n in ("lower_ball_joint", "strut_top", "strut_lower"))
    outer = plus(b, plus(times(minus(t, b), Fraction(1, 16)), times(minus(lower, b), Fraction(-1))))
    flat = {**POINTS, "tie_rod_outer": outer}
    known, solution = posed(flat, closed_drawing(flat, closure="drawn").arm_angle)
    certify(solution, known, BOX)
    k, u = known.knuckle[7], known.knuckle[AXIS]
    n = (k[1] * u[2] - k[2] * u[1], k[2] * u[0] - k[0] * u[2], k[0] * u[1] - k[1] * u[0])
    columns = [tuple(solution[3 + 3 * i : 6 + 3 * i]) for i in range(3)]
    image = plus(plus(times(columns[0], n[0]), times(columns[1], n[1])), times(columns[2], n[2]))
    mirrored = [minus(c, times(image, 2 * n[i] / dot(n, n))) for i, c in enumerate(columns)]
    wrong = refine([*solution[:3], *(x for c in mirrored for x in c), solution[12]], known)
    assert all(abs(row) < arb("1e-80") for row in residual(wrong, known))
    with pytest.raises(NotDecidedError):
        certify(wrong, known, BOX)


def test_a_box_that_holds_two_assemblies_is_rejected() -> None:
    # Close to the end of the rack's travel the two answers of the tie rod come together.
    design = Design.from_points(POINTS, UP, RIGHT, "left", "drawn")
    near, beyond = Fraction(230), Fraction(600)
    while beyond - near > Fraction(1, 1000):
        middle = (near + beyond) / 2
        inputs = {"arm_angle": (1.5, 0, 0), "rack": (middle, 0, 0)}
        known = values_only(design.known(Driven.from_mapping(inputs)))
        gap = candidate(known, choices_of_table(design.table, design.up, "drawn")).gaps["tie_rod"]
        near, beyond = (middle, beyond) if gap < 0 else (near, middle)
    known = values_only(design.known(Driven.from_mapping({"arm_angle": (1.5, 0, 0), "rack": (near, 0, 0)})))
    choices = choices_of_table(design.table, design.up, "drawn")
    one, other = (
        refine(unknown_of(candidate(known, c).points, known), known)
        for c in (choices, replace(choices, tie=-choices.tie))
    )
    width = max(float(abs(a - b).mid()) for a, b in zip(one, other, strict=True))
    assert 1e-5 < width < 0.01
    certify(one, known, BOX)
    certify(other, known, BOX)
    with pytest.raises(NotDecidedError):
        certify(one, known, Fraction(width))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"strut_lower": BASE["strut_top"]}, "strut_lower below strut_top"),
        ({"strut_rod_end": BASE["strut_top"]}, "length between points 8 and 4"),
        ({"strut_rod_end": plus(BASE["strut_top"], (80, -12, 0))}, "drawn square to the strut's axis"),
        (
            {
                "strut_lower": plus(BASE["lower_ball_joint"], (5, 40, 150)),
                "strut_top": plus(BASE["lower_ball_joint"], (20, 160, 600)),
                "tie_rod_outer": plus(BASE["lower_ball_joint"], (1, 8, 30)),
            },
            "beside the axis",
        ),
    ],
)
def test_a_strut_that_is_none_is_refused_by_name(change: Points, message: str) -> None:
    with pytest.raises(BadInputError, match=message):
        solve_reference({**POINTS, **change}, STILL, closure="drawn")


def test_a_closure_that_does_not_exist_is_refused() -> None:
    with pytest.raises(BadInputError, match="closure is 'bent'; allowed is 'drawn' or 'collinear'"):
        solve_reference(POINTS, STILL, closure="bent")


def test_a_point_that_the_car_does_not_have_is_no_guess() -> None:
    short = {name: place for name, place in POINTS.items() if name != "wheel_axis_inner"}
    with pytest.raises(BadInputError, match="names among"):
        solve_reference(short, STILL, guess={"wheel_axis_inner": (0, 0, 0)}, closure="drawn")
    found = solve_reference(POINTS, STILL, guess=POINTS, closure="drawn")
    assert found.position == solve_reference(POINTS, STILL, closure="drawn").position


def test_points_5_6_and_7_on_one_line_are_no_harm_to_a_strut_whose_axis_passes_beside_them() -> None:
    ball, lower = POINTS["lower_ball_joint"], POINTS["strut_lower"]
    line = {**POINTS, "tie_rod_outer": plus(ball, times(minus(lower, ball), Fraction(1, 2)))}
    closed = closed_drawing(line, closure="drawn")
    assert closed.farthest[1] < 1e-75
    with pytest.raises(BadInputError, match="a triangle 5, 6, 7"):
        solve_reference(line, STILL, closure="collinear")


@pytest.mark.parametrize("small", [Fraction(1, 10**3), Fraction(1, 10**12), Fraction(1, 10**30)])
def test_strut_lower_drawn_next_to_the_strut_top_costs_nothing(small: Fraction) -> None:
    top = POINTS["strut_top"]
    near = {**POINTS, "strut_lower": plus(top, times(minus(POINTS["strut_lower"], top), small))}
    there, here = (solve_reference(p, STILL, closure="drawn") for p in (near, POINTS))
    assert there.digits == here.digits
    assert there.condition < 3 * here.condition
    same = set(POINTS) - {"strut_lower"}  # the axis is the same line
    for name in same:
        assert all(
            abs(x) <= there.radius + here.radius for x in minus(there.position[name], here.position[name])
        )


def test_a_side_that_is_clear_only_in_exact_numbers_is_taken_when_asked_for() -> None:
    # The tie rod is drawn a hair above and below the plane in which its two assemblies meet.
    ball, top, inner = (POINTS[n] for n in ("lower_ball_joint", "strut_top", "tie_rod_inner"))
    middle = plus(
        ball, plus(times(minus(top, ball), Fraction(1, 8)), times(minus(inner, ball), Fraction(1, 4)))
    )
    signs = []
    for hair in (Fraction(1, 10**9), Fraction(-1, 10**9)):
        points = {**POINTS, "tie_rod_outer": plus(middle, (hair, 0, 0))}
        with pytest.raises(AmbiguousAssemblyError, match="tie choice"):
            closed_drawing(points, closure="drawn")
        signs.append(closed_drawing(points, closure="drawn", clearness=0).instant.choices.tie)
    assert sorted(signs) == [-1, 1]
    with pytest.raises(AmbiguousAssemblyError, match="tie choice"):
        closed_drawing({**POINTS, "tie_rod_outer": middle}, closure="drawn", clearness=0)
