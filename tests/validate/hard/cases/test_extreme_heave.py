"""Heave of any size and law: right, or refused with a reason; the displaced reference is one too."""

from __future__ import annotations

import numpy as np
import pytest

from pointcoord import Scene
from validate.adjudication.reference_solution import reference_solution
from validate.formulations.input_rates import rates
from validate.hard.case import Answer, Trial
from validate.hard.cases import extreme_heave
from validate.hard.trial import solved

BY_NAME = {case.name: case for case in extreme_heave.CASES}
NOT_FINITE = BY_NAME["heave-not-finite"]


def test_every_number_of_every_law_is_tried() -> None:
    tried = {(t.facts["place"], t.facts["number"]) for t in map(NOT_FINITE.examine, NOT_FINITE.values)}
    places = {"constant", *(f"polynomial.{k}" for k in range(3))}
    places |= {f"sine.{key}" for key in extreme_heave.LAWS["sine"]["sine"]}
    assert tried == {(place, f"{number:g}") for place in places for number in extreme_heave.NOT_FINITE}


def test_the_displaced_reference_is_the_reference_where_that_can_be_proven() -> None:
    law = extreme_heave.law("polynomial", 0, 1e6)
    scene, plain = (Scene.from_mapping(extreme_heave.content(heave)) for heave in (law, None))
    reference, home = reference_solution(scene), reference_solution(plain)
    found = extreme_heave.added(home, rates(scene.inputs["heave"], scene.instants), scene.mechanism.up)
    for quantity in ("position", "velocity", "acceleration"):
        for name, array in getattr(reference, quantity).items():
            # Rounded once more than the reference.
            assert np.abs(getattr(found, quantity)[name] - array).max() <= np.spacing(np.abs(array).max())


def test_a_wrong_place_far_away_is_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    law = extreme_heave.law("constant", None, 1e308)
    unjudged = Trial(1.0, (Answer("absolute", "unjudged"),))
    scene = Scene.from_mapping(extreme_heave.content(law))
    plain = solved("absolute", Scene.from_mapping(extreme_heave.content(None)))
    assert not isinstance(plain, Answer)
    law_there = rates(scene.inputs["heave"], scene.instants)
    for factor, outcome in ((1.0, "right"), (1.0 + 1e-14, "wrong")):
        answer = extreme_heave.added(plain, factor * law_there, scene.mechanism.up)
        monkeypatch.setattr(extreme_heave, "solved", lambda *_, answer=answer: answer)
        assert extreme_heave.displaced(unjudged, law).answers[0].outcome == outcome
