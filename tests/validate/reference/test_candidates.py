"""The closed form of each assembly solves the equations, on the sides that its choices say."""

from __future__ import annotations

from dataclasses import fields

import pytest
from flint import arb
from reference_cars import CARS

from validate.reference.candidates import choices_of, choices_of_table, every_candidate
from validate.reference.linkage import Known
from validate.reference.vectors import minus

# Choices that an assembly can have: the side of a drawn strut's rod is the drawing's.
POSSIBLE = {"strut as drawn": 8, "collinear strut": 16, "double wishbone": 8}


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
