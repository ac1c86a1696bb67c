"""Proven bounds against the reference on random cars, up to where they lock; a false claim is found."""

import math
from typing import Any

import pandas as pd
import pytest
from counted_study import worked_out
from hypothesis import assume, given, target
from hypothesis import strategies as st
from searched import searched

from pointcoord.results import proof
from validate.cars.base_cars import variants
from validate.cars.random_cars import approach, near_pose
from validate.exit_status import ExitStatus
from validate.output.table import text_of
from validate.strategies import cars
from validate.studies.bounds import bounds, held_pose, measured
from validate.studies.claims import claims
from validate.studies.study import Row


@st.composite
def checks(draw: st.DrawFn) -> pd.DataFrame:
    """A random car held near the end of an input, at a distance that a search can move."""
    car, variant = draw(cars())
    names = draw(st.sampled_from(variant.input_sets))
    pose = approach(
        car,
        variant,
        names,
        driven=draw(st.sampled_from(names)),
        forward=draw(st.booleans()),
        aside=draw(st.floats(-1.0, 1.0)),
        distance=10.0 ** draw(st.floats(-12.0, -1.0)),
    )
    assume(pose is not None)
    assert pose is not None
    row = held_pose(pose)
    assume("refusal" not in row)
    return measured([row])


# An end and its pose take a second.
@searched(2)
@given(check=checks())
def test_no_search_finds_an_error_above_its_bound_or_a_sudden_loss_of_digits(check: pd.DataFrame) -> None:
    (share,), (loss,) = check["share"], check["loss"]
    if 0.0 < share < math.inf:
        target(math.log10(share), label="error / bound")
        target(-math.log10(share), label="bound / error")
    assert share <= 1.0, check
    # Newton ends where its step is no larger than its own rounding: 6 u in each of 17 rows, C_u^-1 and the
    # size of the car, where eps is 2 u; the reported point is rounded once more.
    assert loss <= 17 * 6, check


def test_a_bound_below_the_error_is_found_and_ends_with_status_1(monkeypatch: pytest.MonkeyPatch) -> None:
    honest = proof._of_poses

    def short(*given: Any) -> tuple[Any, ...]:
        own, bound, *others = honest(*given)
        return own, 1e-6 * bound, *others

    monkeypatch.setattr(proof, "_of_poses", short)
    row = held_pose(near_pose(4, nearest=1e-4, farthest=1e-4))
    findings = bounds().summary([{"part": "held", "number": 0, **row}])
    assert findings.status == ExitStatus.DISAGREE
    assert "bounds below the error: 1\n  number 0, " in text_of(findings.parts)


def test_a_claim_below_the_error_is_found_and_ends_with_status_1() -> None:
    """That claims hold says `formulations/test_stated_accuracy.py`."""
    study = claims(1)
    rows = worked_out(study)
    honest = study.summary(rows)
    assert honest.status == ExitStatus.AGREE
    assert "acceleration" in text_of(honest.parts)
    broken: Row = {"suspension": variants()[0].words, "kind": "regular", "quantity": "velocity"}
    findings = study.summary([*rows, {"number": 7, **broken, "error": 2.0, "claim": 1.0}])
    assert findings.status == ExitStatus.DISAGREE
    assert "7 (regular)" in text_of(findings.parts)
    assert 2.0 in [one["largest_error_over_claim"] for one in findings.data["quantities"]]
