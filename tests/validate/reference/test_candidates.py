"""The closed form of each assembly solves the equations, on the sides that its choices say."""

from __future__ import annotations

from dataclasses import fields, replace
from fractions import Fraction
from typing import Any

import pytest
from flint import arb
from reference_cars import CARS, ReferenceCar

from validate.reference.candidates import choices_of, choices_of_table, every_candidate
from validate.reference.errors import AmbiguousAssemblyError, NotDecidedError
from validate.reference.linkage import Known
from validate.reference.vectors import minus

# Choices that an assembly can have: the side of a drawn strut's rod is the drawing's.
POSSIBLE = {"strut as drawn": 8, "collinear strut": 16, "double wishbone": 8}


# A strut as drawn whose axis passes the ball joint farther off than the strut top is at this arm angle.
LOW = {
    **CARS["strut as drawn"].points,
    "strut_top": (1350, -720, 260),
    "strut_lower": (1350, -660, 160),
    "strut_rod_end": (1350, -690, 210),
}
# Inputs at which a closure cannot be met, and the choice that it would leave.
BEYOND = [
    (CARS["strut as drawn"], {"arm_angle": 3}, "arm", "arm"),
    (CARS["strut as drawn"], {"rack": 600}, "tie_rod", "tie"),
    (replace(CARS["strut as drawn"], points=LOW), {"arm_angle": Fraction(1415, 1000)}, "strut", "strut"),
    (CARS["collinear strut"], {"rack": 200}, "tie_rod", "tie"),
    (CARS["double wishbone"], {"arm_angle": Fraction(23, 10)}, "upper_arm", "upper_arm"),
]


@pytest.mark.parametrize(("car", "inputs", "closure", "choice"), BEYOND)
def test_where_a_closure_cannot_be_met_its_two_answers_are_the_one_that_comes_nearest(
    car: ReferenceCar, inputs: dict[str, Any], closure: str, choice: str
) -> None:
    every = {candidate.choices: candidate for candidate in every_candidate(car.known(**inputs))}
    missed = [choices for choices in every if every[choices].gaps[closure] > 0]
    assert missed
    for choices in missed:
        other = replace(choices, **{choice: -getattr(choices, choice)})
        for name, place in every[choices].points.items():
            for one, two in zip(place, every[other].points[name], strict=True):
                assert one.overlaps(two)
                assert one.rad() < 1e-6


@pytest.fixture(params=CARS)
def known(request: pytest.FixtureRequest) -> tuple[str, Known]:
    """Each car at inputs near its drawing."""
    return request.param, CARS[request.param].known()


def test_every_combination_of_choices_is_tried_once(known: tuple[str, Known]) -> None:
    name, given = known
    every = [candidate.choices for candidate in every_candidate(given)]
    assert len(every) == len(set(every)) == POSSIBLE[name]
    for choices in every:
        assert {abs(getattr(choices, part.name)) for part in fields(choices)} == {1}


def test_a_candidate_whose_closures_are_met_is_an_assembly(known: tuple[str, Known]) -> None:
    name, given = known
    linkage = given.linkage
    met = [c for c in every_candidate(given) if all(gap < 0 for gap in c.gaps.values())]
    assert len(met) >= 4
    for candidate in met:
        candidate.require_feasible(1.0)
        assert choices_of(candidate.points, given) == candidate.choices
        unknown = linkage.unknown_of(candidate.points, given)
        assert linkage.handedness(unknown) > 0
        # Local coordinates are of the size of 1.
        for row in linkage.residual(unknown, given):
            assert row.contains(0)
            assert row.rad() < 1e-6
        again = linkage.points_of(unknown, given)
        assert set(again) == set(candidate.points)
        for point, place in candidate.points.items():
            assert all(arb(x).contains(0) for x in minus(again[point], place))
    design = CARS[name].design
    assert choices_of_table(design.table, design.up, linkage) in [candidate.choices for candidate in met]


@pytest.mark.parametrize("radius", [0.0, 0.1])
def test_a_side_that_may_be_either_is_not_decided(known: tuple[str, Known], radius: float) -> None:
    _, given = known
    anywhere = {name: (arb(0, radius),) * 3 for name in given.linkage.points}
    with pytest.raises(NotDecidedError, match="the sign of the arm choice"):
        choices_of(anywhere, given)


@pytest.mark.parametrize("name", CARS)
@pytest.mark.parametrize(
    ("sine", "settings", "clear"),
    [
        ("1.1e-9", {}, True),
        ("0.9e-9", {}, False),
        ("0", {}, False),
        ("0.9e-9", {"clearness": 0}, True),
        ("1e-40", {"clearness": 0}, True),
        ("0", {"clearness": 0}, False),
        ("0.09", {"clearness": 0.1}, False),
        ("0.11", {"clearness": 0.1}, True),
    ],
)
def test_a_drawing_must_be_a_billionth_beside_where_two_assemblies_meet(
    name: str, sine: str, settings: dict[str, float], clear: bool
) -> None:
    car = CARS[name]
    for sign in (1, -1):
        for length in (1, 1000):
            value = sign * Fraction(sine) * length
            sides = {choice.name: (value, Fraction(length**2)) for choice in fields(car.linkage.choices)}
            linkage = replace(car.linkage, drawn_sides=lambda table, up, sides=sides: sides)
            if clear:
                found = choices_of_table(car.design.table, car.design.up, linkage, **settings)
                assert {getattr(found, choice) for choice in sides} == {sign}
            else:
                with pytest.raises(AmbiguousAssemblyError, match="the sign of the arm choice"):
                    choices_of_table(car.design.table, car.design.up, linkage, **settings)


def test_a_drawing_without_any_length_to_measure_by_is_ambiguous() -> None:
    car = CARS["strut as drawn"]
    sides = {choice.name: (Fraction(0), Fraction(0)) for choice in fields(car.linkage.choices)}
    linkage = replace(car.linkage, drawn_sides=lambda table, up: sides)
    with pytest.raises(AmbiguousAssemblyError, match="arm choice: 0"):
        choices_of_table(car.design.table, car.design.up, linkage, 0.0)
