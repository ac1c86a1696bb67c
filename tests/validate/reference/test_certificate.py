"""The certificates prove what is true and reject what is false, at a pose and all along a step."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction

import pytest
from flint import arb, arb_mat, arb_poly, ctx
from mechanism_drawings import DRAWINGS, described
from mpmath import mpf
from reference_cars import ReferenceCar

from validate.reference import InfeasibleError, NotDecidedError, SingularPoseError, solve_reference
from validate.reference.certificate import certify
from validate.reference.design import Design, Known, values_only
from validate.reference.exact import bits
from validate.reference.fold import Fold, fold_ahead, pose_before
from validate.reference.krawczyk import Contraction, System, newton
from validate.reference.route import closed
from validate.reference.way import Way, next_pose, proven_tube, series_of, start_pose

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


def way_of_the_rack(design: Design, car: ReferenceCar) -> Way:
    """From the drawing to half of the last rack travel."""
    begin = values_only(design.known_as_drawn())
    end = values_only(design.known(design.driven({**car.still, "rack": (car.last_rack / 2, 0, 0)})))
    return Way(begin.equations, begin.numbers, [begin.numbers[0], end.numbers[1]])


@pytest.mark.parametrize("off", ["0", "1e-9", "1e-3"])
def test_a_step_holds_the_solution_all_along_or_is_not_proven(car: ReferenceCar, off: str) -> None:
    with ctx.workprec(212):
        way = way_of_the_rack(car.design, car)
        pose = start_pose(way, closed(car.design).pose.unknown, arb(0))
        series = series_of(way, pose, 7)
        # A series that is off makes the tube wider, or none: never one beside the solution.
        planted = [one + arb_poly([0, 0, arb(off).mid()]) for one in series]
        tube = proven_tube(way, pose.t, planted, pose.t, arb(0.125))
        assert tube is not None or off == "1e-3"
        if tube is not None:
            for t in (arb(k) / 32 for k in range(5)):
                right = start_pose(way, [one(t) for one in series], t)
                assert tube.holds(t, right.box)
