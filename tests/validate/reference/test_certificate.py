"""The certificates prove what is true and reject what is false."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction

import pytest
from flint import arb, arb_mat, arb_poly, ctx
from mechanism_drawings import DRAWINGS, described
from mpmath import mpf
from reference_cars import ReferenceCar

from validate.reference import (
    InfeasibleError,
    NotDecidedError,
    SingularPoseError,
    instants_of,
    solve_reference,
)
from validate.reference.certificate import certify
from validate.reference.design import Known, values_only
from validate.reference.exact import as_fraction, bits
from validate.reference.fold import Fold, fold_ahead, pose_before
from validate.reference.krawczyk import Contraction, System, newton
from validate.reference.route import closed
from validate.reference.way import Way, next_pose, proven_tube, series_of, start_pose

Table = dict[str, tuple[int, int, int]]
BOX = Fraction(1, 10**60)


@pytest.fixture(autouse=True)
def _precision() -> Iterator[None]:
    with ctx.workprec(bits(60)):
        yield


def drawn(name: str) -> tuple[Known, list[arb]]:
    """What is given as drawn, and a refined solution at the present precision."""
    design = DRAWINGS[name]()
    known = values_only(design.known_as_drawn())
    return known, newton(known.system, closed(design).pose.unknown)[0]


def wrong(known: Known, which: int) -> Known:
    """With one coefficient of one row a little off."""
    rows = [list(row) for row in known.equations.rows]
    places = [(i, k) for i, row in enumerate(rows) for k in range(len(row))]
    i, k = places[which % len(places)]
    monomial, coefficient = rows[i][k]
    rows[i][k] = (monomial, coefficient + arb("1e-40"))
    return replace(known, equations=replace(known.equations, rows=tuple(tuple(row) for row in rows)))


@pytest.mark.parametrize("name", DRAWINGS)
def test_a_refined_solution_is_certified_and_the_enclosure_is_far_inside_the_box(name: str) -> None:
    known, solution = drawn(name)
    certificate = certify(solution, known, BOX)
    assert all(ball.rad() < arb("1e-70") for ball in certificate.enclosure)


@pytest.mark.parametrize("name", DRAWINGS)
def test_a_planted_error_in_any_unknown_is_rejected_or_if_it_places_no_point_mended(name: str) -> None:
    known, solution = drawn(name)
    for place in range(len(solution)):
        off = list(solution)
        off[place] = (off[place] + arb("1e-50")).mid()
        try:
            mended = certify(off, known, BOX).enclosure[place]
        except NotDecidedError:
            continue
        # It places no point, so that the box leaves it room: the proof finds it by itself.
        assert abs(mended - solution[place]) < arb("1e-75")
        moved, there = (known.equations.points_of(unknown) for unknown in (off, solution))
        for name, point in moved.items():
            assert all(abs(a - b) < arb("1e-60") for a, b in zip(point, there[name], strict=True)), name


@pytest.mark.parametrize("name", DRAWINGS)
def test_a_wrong_number_in_any_row_is_rejected(name: str) -> None:
    known, solution = drawn(name)
    count = sum(len(row) for row in known.equations.rows)
    for which in range(0, count, 7):
        planted = wrong(known, which)
        if all(abs(x) < arb("1e-60") for x in planted.residual(solution)):
            continue  # it multiplies an unknown that is 0 as drawn
        with pytest.raises(NotDecidedError):
            certify(solution, planted, BOX)


def test_a_matrix_that_is_no_inverse_proves_nothing() -> None:
    line = System(lambda x: [x[0]], lambda _: arb_mat([[1]]), lambda _: arb_mat(1, 1))
    for factor, proven in ((1, True), (1.5, True), (2.5, False), (-1, False)):
        proof = Contraction.at(line, [arb(0)], arb_mat([[factor]]))
        assert (proof.settled() is not None) == proven


def near_the_last_rack(car: ReferenceCar) -> tuple[Way, Fold]:
    """The way beyond the last rack travel, and the fold on it."""
    design = car.design
    here = closed(design)
    begin = values_only(design.known_as_drawn())
    end = values_only(design.known(design.driven({**car.still, "rack": (2 * car.last_rack, 0, 0)})))
    numbers = [begin.numbers[0], end.numbers[1]]
    way = Way(begin.equations, begin.numbers, numbers)
    pose = start_pose(way, here.pose.unknown, arb(0))
    while (fold := fold_ahead(way, pose)) is None:
        pose = next_pose(way, pose, arb(1))
    return way, fold


def test_near_a_fold_the_two_branches_are_told_apart_and_no_box_or_tube_holds_both(car: ReferenceCar) -> None:
    with ctx.workprec(212):
        way, fold = near_the_last_rack(car)
        t = (fold.t - arb("1e-12")).mid()
        pose = pose_before(way, fold, t)
        s = pose.unknown[fold.index] - fold.unknown[fold.index]
        mirrored = fold.tube.at((fold.tube.start - s).mid())
        other = start_pose(way, mirrored[:-1], t)
        assert not pose.holds(other.box)
        assert not other.holds(pose.box)
        width = max(abs(a - b).upper() for a, b in zip(pose.unknown, other.unknown, strict=True))
        assert arb("1e-8") < width < arb("1e-3")
        # A tube between both, as wide as to hold them, is none; nor is a step across the fold.
        between = replace(
            pose, unknown=[((a + b) / 2).mid() for a, b in zip(pose.unknown, other.unknown, strict=True)]
        )
        still = [arb_poly([x]) for x in between.unknown]
        assert proven_tube(way, t, still, t, (t + arb("1e-30")).mid()) is None
        assert proven_tube(way, t, series_of(way, pose, 7), t, (fold.t + arb("1e-12")).mid()) is None
        short = (t + arb("1e-14")).mid()
        tube = proven_tube(way, t, series_of(way, pose, 7), t, short)
        assert tube is not None
        assert tube.holds(t, pose.box)
        assert not tube.holds(t, other.box)


def edge(car: ReferenceCar, name: str) -> Fraction:
    """The greatest feasible input, from the fold on the way beyond it."""
    beyond = {"arm_angle": Fraction(3), "rack": car.last_rack}[name]
    instants = instants_of(car.design, [car.still, {**car.still, name: (beyond, 0, 0)}])
    next(instants)
    with pytest.raises(InfeasibleError) as caught:
        next(instants)
    return as_fraction(caught.value.inputs[name], name)


@pytest.mark.parametrize("name", ["arm_angle", "rack"])
def test_poses_all_but_singular_are_certified_and_just_beyond_is_proven_infeasible(
    car: ReferenceCar, name: str
) -> None:
    at = edge(car, name)
    for distance in (Fraction(1, 10**6), Fraction(1, 10**20)):
        near = car.solve({**car.still, name: (at - distance, 1, 0)})
        # A fold: the condition grows as the inverse square root of the distance.
        assert near.condition > 0.1 * float(distance) ** -0.5
        assert near.error_bound["velocity"] < mpf("1e-40")
        with pytest.raises(InfeasibleError):
            car.solve({**car.still, name: (at + distance, 0, 0)})


# An arm of 300 mm about a level line, driven by the height of its end: 300 is its dead point.
ARM = described(
    {"front": (-100, 0, 0), "rear": (100, 0, 0), "end": (0, -300, 0), "beside": (50, -100, 20)},
    {"chassis": ["front", "rear"], "arm": ["front", "rear", "end", "beside"]},
    {"height": {"height": "end"}},
)


def test_an_exactly_singular_pose_is_an_error_that_says_so() -> None:
    with pytest.raises(SingularPoseError, match="400 digits") as caught:
        solve_reference(ARM, {"height": (300, 1, 0)})
    assert isinstance(caught.value.reason, NotDecidedError)


@pytest.mark.parametrize("power", [6, 30, 80])
def test_a_pose_all_but_at_its_dead_point_keeps_all_digits_and_beyond_it_is_none(power: int) -> None:
    hair = Fraction(1, 10**power)
    end = solve_reference(ARM, {"height": (300 - hair, 0, 0)}).position["end"]
    want = 600 * mpf(10) ** -power - mpf(10) ** (-2 * power)
    assert end[1] < 0  # on the side of the drawing
    assert abs(end[1] ** 2 / want - 1) < mpf("1e-15")
    with pytest.raises(InfeasibleError) as caught:
        solve_reference(ARM, {"height": (300 + hair, 0, 0)})
    assert abs(caught.value.inputs["height"] - 300) < mpf("1e-20")


@pytest.mark.parametrize(("power", "offset"), [(-18, 10**9), (11, -(2**40))])
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
