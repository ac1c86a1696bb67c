"""The certificate proves what is true and rejects what is false."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import mpmath
import pytest
from flint import arb, ctx
from mpmath import mpf

from validate.reference import Choices, InfeasibleError, NotDecidedError, SingularPoseError, solve_reference
from validate.reference.branches import candidate
from validate.reference.certificate import certify, refine
from validate.reference.design import Design, Driven, values_only
from validate.reference.equations import MU, Known, unknown_of
from validate.reference.exact import as_fraction, bits
from validate.reference.instant import prove_instant

Table = dict[str, tuple[int, int, int]]
DESIGN_CHOICES = Choices(arm=1, strut=1, rod=1, tie=-1)
BOX = Fraction(1, 10**60)


def posed(table: Table, theta: object) -> tuple[Known, list[arb]]:
    """The given quantities and a refined solution at the present precision, local."""
    design = Design.from_points(table, (0, 0, 1), (0, 1, 0), "left", "collinear")
    known = values_only(design.known(Driven.from_mapping({"arm_angle": (theta, 0, 0)})))
    return known, refine(unknown_of(candidate(known, DESIGN_CHOICES).points, known), known)


@pytest.fixture(autouse=True)
def _precision() -> object:
    with ctx.workprec(bits(60)):
        yield


def test_a_refined_solution_is_certified_and_the_enclosure_is_far_inside_the_box(table: Table) -> None:
    known, solution = posed(table, 1.5)
    certificate = certify(solution, known, BOX)
    assert all(ball.rad() < arb("1e-70") for ball in certificate.enclosure)


@pytest.mark.parametrize("coordinate", range(MU))
def test_a_planted_error_in_any_coordinate_is_rejected(table: Table, coordinate: int) -> None:
    known, solution = posed(table, 1.5)
    solution[coordinate] = (solution[coordinate] + arb("1e-59")).mid()
    with pytest.raises(NotDecidedError):
        certify(solution, known, BOX)


def test_a_wrong_length_is_rejected(table: Table) -> None:
    known, solution = posed(table, 1.5)
    for link in known.squared_length:
        lengths = {**known.squared_length, link: known.squared_length[link] + arb("1e-50")}
        with pytest.raises(NotDecidedError):
            certify(solution, replace(known, squared_length=lengths), BOX)


def test_a_box_that_holds_two_assemblies_is_rejected(table: Table) -> None:
    # Close below the dead point of the arm two assemblies are about 0.002 of the mechanism apart.
    known, solution = posed(table, Fraction("2.653128"))
    twin = unknown_of(candidate(known, replace(DESIGN_CHOICES, arm=-1)).points, known)
    apart = max(float(abs(a - b).mid()) for a, b in zip(solution[:MU], twin[:MU], strict=True))
    assert apart < 0.01
    certify(solution, known, BOX)
    with pytest.raises(NotDecidedError):
        certify(solution, known, Fraction(apart))


def test_an_assembly_other_than_the_expected_one_is_rejected(table: Table) -> None:
    design = Design.from_points(table, (0, 0, 1), (0, 1, 0), "left", "collinear")
    known = design.known(Driven.from_mapping({"arm_angle": (1.5, 0, 0)}))
    solution = posed(table, 1.5)[1]
    assert prove_instant(design, known, solution, DESIGN_CHOICES, 60, 60).choices == DESIGN_CHOICES
    with pytest.raises(NotDecidedError, match="choices"):
        prove_instant(design, known, solution, replace(DESIGN_CHOICES, tie=1), 60, 60)


@pytest.mark.parametrize("digits", [60, 200])
def test_a_knuckle_all_but_on_one_line_costs_digits_and_no_wrong_number(table: Table, digits: int) -> None:
    # The strut is straight, and point 6 lies 1e-20 mm beside its line: the wheel centre magnifies
    # every error of point 6. At the table's own angle the table is the answer.
    sliver = Fraction(1, 10**20)
    thin = {
        **table,
        "strut_lower": (451, -315, 11),
        "strut_rod_end": (455, -255, 215),
        "tie_rod_outer": (452 + sliver, -300, 62),
    }
    theta = mpmath.acos(mpf(-30) / mpmath.sqrt(180**2 + 325**2 + 30**2))
    reference = solve_reference(
        thin, {"arm_angle": (theta, 0, 0)}, guess=thin, digits=digits, closure="collinear"
    )
    assert reference.condition > 1e18
    assert reference.digits > digits or digits == 200
    for name, place in thin.items():
        for got, want in zip(reference.position[name], place, strict=True):
            q = as_fraction(want, name)
            exact = mpf(q.numerator) / q.denominator
            assert abs(got - exact) <= reference.radius + mpf("1e-100")  # theta has 150 digits


def test_newton_from_nonsense_never_ends_in_a_number_without_proof(table: Table) -> None:
    known, solution = posed(table, 1.5)
    with pytest.raises(NotDecidedError):
        certify(refine([arb(0)] * len(solution), known), known, BOX)


@pytest.mark.parametrize("digits", [15, 50, 60, 100, 150])
def test_more_digits_stay_within_the_radius_of_fewer(table: Table, digits: int) -> None:
    inputs = {"arm_angle": (1.5, 0.25, 0.125), "rack": (20.0, 150.0, 50.0), "heave": (3.0, 100.0, 10.0)}
    few, many = (
        solve_reference(table, inputs, digits=digits, closure="collinear"),
        solve_reference(table, inputs, digits=200, closure="collinear"),
    )
    for quantity in ("position", "velocity", "acceleration", "angular_velocity", "angular_acceleration"):
        limit = few.error_bound[quantity] + many.error_bound[quantity]
        for name, vector in getattr(few, quantity).items():
            other = getattr(many, quantity)[name]
            assert all(abs(a - b) <= limit for a, b in zip(vector, other, strict=True))
    assert few.error_bound["position"] < few.radius <= mpf(10) ** (3 - digits)


def edge(table: Table, name: str) -> Fraction:
    """The greatest feasible input to 1e-40, by bisection on proven infeasibility."""
    near, beyond = {"arm_angle": (Fraction(2), Fraction(3)), "rack": (Fraction(0), Fraction(200))}[name]
    while beyond - near > Fraction(1, 10**40):
        middle = (near + beyond) / 2
        inputs = {"arm_angle": (Fraction(3, 2), 0, 0), name: (middle, 0, 0)}
        try:
            solve_reference(table, inputs, digits=15, closure="collinear")
            near = middle
        except InfeasibleError:
            beyond = middle
    return near


@pytest.mark.parametrize("name", ["arm_angle", "rack"])
@pytest.mark.parametrize("distance", [Fraction(1, 10**6), Fraction(1, 10**12), Fraction(1, 10**30)])
def test_poses_all_but_singular_are_certified_and_just_beyond_is_proven_infeasible(
    table: Table, name: str, distance: Fraction
) -> None:
    at = edge(table, name)
    reference = solve_reference(
        table, {"arm_angle": (Fraction(3, 2), 0, 0), name: (at - distance, 1, 0)}, closure="collinear"
    )
    # A fold: the condition grows as the inverse square root of the distance.
    assert reference.condition > 0.1 * float(distance) ** -0.5
    assert reference.error_bound["velocity"] < mpf("1e-40")
    assert reference.digits <= 120  # no more than it takes
    with pytest.raises(InfeasibleError) as caught:
        solve_reference(
            table, {"arm_angle": (Fraction(3, 2), 0, 0), name: (at + distance, 1, 0)}, closure="collinear"
        )
    assert caught.value.closure == {"arm_angle": "arm", "rack": "tie_rod"}[name]
    assert 0 < caught.value.gap < 1e-3


def test_an_exactly_singular_pose_is_an_error_that_says_so(table: Table) -> None:
    # The arm's axis is level and the arm stands upright: p5 is on top of its circle.
    upright = {
        **table,
        "lower_arm_front": (0, 0, 0),
        "lower_arm_rear": (200, 0, 0),
        "lower_ball_joint": (0, -300, 0),
    }
    with pytest.raises(SingularPoseError, match="400 digits") as caught:
        solve_reference(upright, {"arm_angle": (0, 1, 0)}, closure="collinear")
    assert isinstance(caught.value.reason, NotDecidedError)


@pytest.mark.parametrize("power", [-18, 0, 11])
@pytest.mark.parametrize("offset", [0, 10**9, -(2**40)])
def test_size_and_place_of_the_mechanism_cost_nothing(table: Table, power: int, offset: int) -> None:
    size = Fraction(2) ** power
    far = {name: tuple(size * x + offset for x in p) for name, p in table.items()}
    inputs = {"arm_angle": (1.5, 0.25, 0.125), "rack": (20, 150, 50)}
    moved_inputs = {**inputs, "rack": tuple(size * x for x in inputs["rack"])}
    here, there = (
        solve_reference(table, inputs, closure="collinear"),
        solve_reference(far, moved_inputs, closure="collinear"),
    )
    scale = mpf(size.numerator) / size.denominator
    for name in table:
        for a, b in zip(here.position[name], there.position[name], strict=True):
            assert abs(a * scale + offset - b) <= there.radius + here.radius * scale
    assert there.digits == here.digits
    assert there.condition == pytest.approx(here.condition)
