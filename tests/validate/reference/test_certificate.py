"""The certificate proves what is true and rejects what is false."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction

import mpmath
import pytest
from flint import arb, ctx
from mpmath import mpf
from reference_cars import CARS, OFF_AXIS, ReferenceCar

from validate.reference import InfeasibleError, NotDecidedError, SingularPoseError, solve_reference
from validate.reference.candidates import choices_of_table, every_candidate
from validate.reference.certificate import certify, refine
from validate.reference.exact import as_fraction, bits
from validate.reference.instant import prove_instant
from validate.reference.linkage import Choices, Known
from validate.reference.macpherson import DRAWN
from validate.reference.macpherson.collinear import LAMBDA, MU
from validate.reference.macpherson.drawn import AXIS, SLIDE
from validate.reference.macpherson.points import END, LOWER, OUTER, TOP
from validate.reference.vectors import dot, minus, plus, times

Table = dict[str, tuple[int, int, int]]
BOX = Fraction(1, 10**60)
# Unknowns that place no point: the box leaves them room, and the proof finds them by itself.
FREE = {"strut as drawn": {SLIDE}, "collinear strut": {MU, LAMBDA}}
ORDERS = ("position", "velocity", "acceleration", "angular_velocity", "angular_acceleration")


@pytest.fixture(autouse=True)
def _precision() -> Iterator[None]:
    with ctx.workprec(bits(60)):
        yield


def drawn(car: ReferenceCar) -> Choices:
    """The choices of the drawing."""
    return choices_of_table(car.design.table, car.design.up, car.linkage)


def posed(car: ReferenceCar, **changed: object) -> tuple[Known, list[arb]]:
    """What is given, some inputs changed, and a refined solution at the present precision, local."""
    known = car.known(**changed)
    chosen = car.linkage.candidate(known, drawn(car))
    return known, refine(car.linkage.unknown_of(chosen.points, known), known)


def test_a_refined_solution_is_certified_and_the_enclosure_is_far_inside_the_box(car: ReferenceCar) -> None:
    known, solution = posed(car)
    certificate = certify(solution, known, BOX)
    assert all(ball.rad() < arb("1e-70") for ball in certificate.enclosure)


@pytest.mark.parametrize(
    ("name", "place"), [(n, i) for n, car in CARS.items() for i in range(car.linkage.size)]
)
def test_a_planted_error_in_any_unknown_is_rejected_or_if_it_places_no_point_mended(
    name: str, place: int
) -> None:
    known, solution = posed(CARS[name])
    right = solution[place]
    solution[place] = (right + arb("1e-58")).mid()
    if place in FREE.get(name, ()):
        assert abs(certify(solution, known, BOX).enclosure[place] - right) < arb("1e-75")
    else:
        with pytest.raises(NotDecidedError):
            certify(solution, known, BOX)


def test_a_wrong_length_is_rejected(car: ReferenceCar) -> None:
    known, solution = posed(car)
    # The rod's length is not in the equations of the strut as drawn: it only says where its end is.
    for link in set(car.linkage.links) - ({(END, TOP)} if car.linkage is DRAWN else set()):
        lengths = {**known.squared_length, link: known.squared_length[link] + arb("1e-50")}
        with pytest.raises(NotDecidedError):
            certify(solution, replace(known, squared_length=lengths), BOX)


def test_a_wrong_input_is_rejected(car: ReferenceCar) -> None:
    known, solution = posed(car)
    for name, number in known.driven.items():
        with pytest.raises(NotDecidedError):
            certify(solution, replace(known, driven={**known.driven, name: number + arb("1e-50")}), BOX)


@pytest.mark.parametrize("place", [OUTER, LOWER, AXIS])
@pytest.mark.parametrize("component", range(3))
def test_a_wrong_shape_of_the_knuckle_is_rejected(place: str, component: int) -> None:
    known, solution = posed(CARS["strut as drawn"])
    k = list(known.knuckle[place])
    k[component] += arb("1e-50")
    with pytest.raises(NotDecidedError):
        certify(solution, replace(known, knuckle={**known.knuckle, place: tuple(k)}), BOX)


def test_a_mirrored_knuckle_meets_the_equations_and_is_not_certified() -> None:
    # With 6 in the plane of 5 and the axis, the knuckle's mirror image in that plane keeps 5, 6, 7 and u.
    b, t, lower = (OFF_AXIS[n] for n in ("lower_ball_joint", "strut_top", "strut_lower"))
    outer = plus(b, plus(times(minus(t, b), Fraction(1, 16)), times(minus(lower, b), Fraction(-1))))
    flat = {**OFF_AXIS, "tie_rod_outer": outer}
    car = replace(CARS["strut as drawn"], points=flat)
    theta = car.close().inputs["arm_angle"]
    known, solution = posed(car, arm_angle=theta, rack=230)
    certify(solution, known, BOX)
    k, u = known.knuckle[LOWER], known.knuckle[AXIS]
    n = (k[1] * u[2] - k[2] * u[1], k[2] * u[0] - k[0] * u[2], k[0] * u[1] - k[1] * u[0])
    columns = [tuple(solution[3 + 3 * i : 6 + 3 * i]) for i in range(3)]
    image = plus(plus(times(columns[0], n[0]), times(columns[1], n[1])), times(columns[2], n[2]))
    mirrored = [minus(c, times(image, 2 * n[i] / dot(n, n))) for i, c in enumerate(columns)]
    wrong = refine([*solution[:3], *(x for c in mirrored for x in c), solution[12]], known)
    assert all(abs(row) < arb("1e-80") for row in DRAWN.residual(wrong, known))
    with pytest.raises(NotDecidedError):
        certify(wrong, known, BOX)


def test_a_box_that_holds_two_assemblies_is_rejected(car: ReferenceCar) -> None:
    # Close to the end of the rack's travel the two answers of the tie rod come together.
    choices = drawn(car)
    near, beyond = car.inputs["rack"][0], car.last_rack
    while beyond - near > Fraction(1, 1000):
        middle = (near + beyond) / 2
        gap = car.linkage.candidate(car.known(rack=middle), choices).gaps["tie_rod"]
        near, beyond = (middle, beyond) if gap < 0 else (near, middle)
    known = car.known(rack=near)
    one, other = (
        refine(car.linkage.unknown_of(car.linkage.candidate(known, c).points, known), known)
        for c in (choices, replace(choices, tie=-choices.tie))
    )
    width = max(float(abs(a - b).mid()) for a, b in zip(one, other, strict=True))
    assert 1e-5 < width < 0.02
    certify(one, known, BOX)
    certify(other, known, BOX)
    with pytest.raises(NotDecidedError):
        certify(one, known, Fraction(width))


def test_an_assembly_other_than_the_expected_one_is_rejected(car: ReferenceCar) -> None:
    design, expected = car.design, drawn(car)
    known, solution = design.known(design.driven(car.still)), posed(car)[1]
    assert prove_instant(design, known, solution, expected, 60, 60).choices == expected
    for other in every_candidate(car.known()):
        if other.choices != expected:
            with pytest.raises(NotDecidedError, match="choices"):
                prove_instant(design, known, solution, other.choices, 60, 60)


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


def test_newton_from_nonsense_never_ends_in_a_number_without_proof(car: ReferenceCar) -> None:
    known = car.known()
    with pytest.raises(NotDecidedError):
        certify(refine([arb(0)] * car.linkage.size, known), known, BOX)


@pytest.mark.parametrize("digits", [15, 50, 60, 100, 150])
def test_more_digits_stay_within_the_radius_of_fewer(car: ReferenceCar, digits: int) -> None:
    few, many = (car.solve(car.inputs, digits=d) for d in (digits, 200))
    for quantity in ORDERS:
        limit = few.error_bound[quantity] + many.error_bound[quantity]
        for name, vector in getattr(few, quantity).items():
            other = getattr(many, quantity)[name]
            assert all(abs(a - b) <= limit for a, b in zip(vector, other, strict=True))
    assert few.error_bound["position"] < few.radius <= mpf(10) ** (3 - digits)


def edge(car: ReferenceCar, name: str) -> Fraction:
    """The greatest feasible input to 1e-40, by bisection on proven infeasibility."""
    near, beyond = car.inputs[name][0], {"arm_angle": Fraction(3), "rack": car.last_rack}[name]
    while beyond - near > Fraction(1, 10**40):
        middle = (near + beyond) / 2
        try:
            car.solve({**car.still, name: (middle, 0, 0)}, digits=15)
            near = middle
        except InfeasibleError:
            beyond = middle
    return near


@pytest.mark.parametrize("name", ["arm_angle", "rack"])
def test_poses_all_but_singular_are_certified_and_just_beyond_is_proven_infeasible(
    car: ReferenceCar, name: str
) -> None:
    at = edge(car, name)
    for distance in (Fraction(1, 10**6), Fraction(1, 10**12), Fraction(1, 10**30)):
        near = car.solve({**car.still, name: (at - distance, 1, 0)})
        # A fold: the condition grows as the inverse square root of the distance.
        assert near.condition > 0.1 * float(distance) ** -0.5
        assert near.error_bound["velocity"] < mpf("1e-40")
        with pytest.raises(InfeasibleError):
            car.solve({**car.still, name: (at + distance, 0, 0)})


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
def test_size_and_place_of_the_mechanism_cost_nothing(car: ReferenceCar, power: int, offset: int) -> None:
    size = Fraction(2) ** power
    far = replace(car, points={n: tuple(size * x + offset for x in p) for n, p in car.points.items()})
    lengths = {n: tuple(size * x for x in car.inputs[n]) for n in ("rack", "heave")}
    here, there = car.solve(car.inputs), far.solve({**car.inputs, **lengths})
    scale = mpf(size.numerator) / size.denominator
    for name in here.position:
        for a, b in zip(here.position[name], there.position[name], strict=True):
            assert abs(a * scale + offset - b) <= there.radius + here.radius * scale
    assert there.digits == here.digits
    assert there.condition == pytest.approx(here.condition)
