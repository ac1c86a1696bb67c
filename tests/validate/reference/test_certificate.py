"""True statements are proven and false ones are not, at a pose and all along a step."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction

import pytest
from flint import arb, arb_poly, ctx
from mechanism_drawings import DRAWINGS, ReferenceCar, described, drawing
from mpmath import mpf

from validate.reference import (
    Design,
    InfeasibleError,
    Instant,
    NotDecidedError,
    SingularPoseError,
    instants_of,
)
from validate.reference.design import equations_in, values_only
from validate.reference.exact import bits
from validate.reference.fold import Fold, fold_ahead, pose_before
from validate.reference.krawczyk import Contraction, less, middle_inverse, newton
from validate.reference.path import StraightPath, next_pose, proven_tube, series_of, start_pose
from validate.reference.polynomial import Polynomial
from validate.reference.route import closed

NARROW = [arb("1e-60")]


@pytest.fixture(autouse=True)
def _precision() -> Iterator[None]:
    with ctx.workprec(bits(60)):
        yield


def drawn(name: str) -> tuple[StraightPath, list[arb]]:
    """The equations as drawn, and a refined solution at the present precision."""
    design = drawing(name)
    numbers = design.mechanism.drawn_numbers
    path = StraightPath(equations_in(design.mechanism), numbers, numbers)
    return path, newton(path, closed(design).pose.unknown, arb(0))[0]


def holds_one(path: StraightPath, centre: list[arb], width: list[arb] = NARROW, factor: float = 1.0) -> bool:
    """Whether a box about a place is proven to contain a solution, with a multiple of the inverse."""
    inverse = factor * middle_inverse(path.matrix(centre, arb(0)))
    proof = Contraction.at(path, centre, arb(0), inverse)
    return less(proof.image(width * len(centre)), width * len(centre))


@pytest.mark.parametrize("name", DRAWINGS)
def test_a_refined_solution_is_certified_and_a_planted_error_in_any_unknown_or_row_is_not(name: str) -> None:
    path, solution = drawn(name)
    assert holds_one(path, solution)
    assert holds_one(path, solution, factor=1.5)
    assert not holds_one(path, solution, factor=2.5)
    assert not holds_one(path, solution, width=[arb(10)])  # other solutions are in this box
    assert all(ball.rad() < arb("1e-70") for ball in start_pose(path, solution, arb(0)).box)
    for place, x in enumerate(solution):
        assert not holds_one(path, [*solution[:place], (x + arb("1e-50")).mid(), *solution[place + 1 :]])
    rows = path.equations.rows
    for i, monomial in [(i, monomial) for i, row in enumerate(rows) for monomial in row.terms][::7]:
        planted = Polynomial({**rows[i].terms, monomial: rows[i].terms[monomial] + arb("1e-40")})
        every = (*rows[:i], planted, *rows[i + 1 :])
        wrong = replace(path, equations=replace(path.equations, rows=every))
        # Except if it multiplies an unknown that is 0.
        if not all(abs(x) < arb("1e-60") for x in wrong.rows(solution, arb(0))):
            assert not holds_one(wrong, solution)


def way_of_the_rack(car: ReferenceCar, rack: Fraction) -> StraightPath:
    """The path from the drawing to a rack travel."""
    design = car.design
    begin = design.mechanism.drawn_numbers
    end = values_only(design.known(design.driven({**car.still, "rack": (rack, 0, 0)}))).numbers
    return StraightPath(equations_in(design.mechanism), begin, [begin[0], end[1]])


def near_the_last_rack(car: ReferenceCar) -> tuple[StraightPath, Fold]:
    """The path beyond the last rack travel, and the fold on it."""
    path = way_of_the_rack(car, 2 * car.last_rack)
    pose = start_pose(path, closed(car.design).pose.unknown, arb(0))
    while (fold := fold_ahead(path, pose)) is None:
        pose = next_pose(path, pose, arb(1))
    return path, fold


def test_near_a_fold_the_two_branches_are_told_apart_and_no_box_or_tube_holds_both(car: ReferenceCar) -> None:
    with ctx.workprec(212):
        path, fold = near_the_last_rack(car)
        t = (fold.t - arb("1e-12")).mid()
        pose = pose_before(path, fold, t)
        s = pose.unknown[fold.index] - fold.s
        mirrored = fold.tube.at((fold.tube.start - s).mid())
        other = start_pose(path, mirrored[:-1], t)
        assert not pose.holds(other.box)
        assert not other.holds(pose.box)
        width = max(abs(a - b).upper() for a, b in zip(pose.unknown, other.unknown, strict=True))
        assert arb("1e-8") < width < arb("1e-3")
        # No tube between them, wide enough for both, is proven, nor a step across the fold.
        between = replace(
            pose, unknown=[((a + b) / 2).mid() for a, b in zip(pose.unknown, other.unknown, strict=True)]
        )
        still = [arb_poly([x]) for x in between.unknown]
        assert proven_tube(path, t, still, t, (t + arb("1e-30")).mid()) is None
        assert proven_tube(path, t, series_of(path, pose, 7), t, (fold.t + arb("1e-12")).mid()) is None
        short = (t + arb("1e-14")).mid()
        tube = proven_tube(path, t, series_of(path, pose, 7), t, short)
        assert tube is not None
        assert tube.holds(t, pose.box)
        assert not tube.holds(t, other.box)


# An arm of 300 mm about a level line, driven by the height of its end: 300 is its dead point.
ARM = described(
    {"front": (-100, 0, 0), "rear": (100, 0, 0), "end": (0, -300, 0), "beside": (50, -100, 20)},
    {"chassis": ["front", "rear"], "arm": ["front", "rear", "end", "beside"]},
    {"height": {"height": "end"}},
)


def at_height(height: Fraction, rate: int = 0) -> Instant:
    return next(instants_of(Design.from_plain(ARM), [{"height": (height, rate, 0)}]))


def test_an_exactly_singular_pose_is_an_error_that_says_so() -> None:
    with pytest.raises(SingularPoseError, match="400 digits") as caught:
        at_height(Fraction(300), 1)
    assert isinstance(caught.value.doubt, NotDecidedError)


@pytest.mark.parametrize("power", [6, 30, 80])
def test_a_pose_all_but_at_its_dead_point_keeps_all_digits_and_beyond_it_is_none(power: int) -> None:
    hair = Fraction(1, 10**power)
    end = at_height(300 - hair).position["end"]
    want = 600 * mpf(10) ** -power - mpf(10) ** (-2 * power)
    assert end[1] < 0  # on the side of the drawing
    assert abs(end[1] ** 2 / want - 1) < mpf("1e-15")
    with pytest.raises(InfeasibleError) as caught:
        at_height(300 + hair)
    assert abs(caught.value.inputs["height"] - 300) < mpf("1e-20")


@pytest.mark.parametrize("off", ["0", "1e-9", "1e-3"])
def test_a_step_holds_the_solution_all_along_or_is_not_proven(car: ReferenceCar, off: str) -> None:
    with ctx.workprec(212):
        path = way_of_the_rack(car, car.last_rack / 2)
        pose = start_pose(path, closed(car.design).pose.unknown, arb(0))
        series = series_of(path, pose, 7)
        # An inexact series gives a wider tube or none, but never one without the solution.
        planted = [one + arb_poly([0, 0, arb(off).mid()]) for one in series]
        tube = proven_tube(path, pose.t, planted, pose.t, arb(0.125))
        assert tube is not None or off == "1e-3"
        if tube is not None:
            for t in (arb(k) / 32 for k in range(5)):
                right = start_pose(path, [one(t) for one in series], t)
                assert tube.holds(t, right.box)
