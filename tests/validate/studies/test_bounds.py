"""Proven bounds against the reference on random cars, up to the poses where they lock."""

import math
from dataclasses import replace
from typing import Any

import pandas as pd
import pytest
from hypothesis import assume, given, settings, target
from hypothesis import strategies as st

from validate.cars.random_cars import NearPose, approach, near_pose
from validate.exit_status import ExitStatus
from validate.output.table import text_of
from validate.strategies import cars
from validate.studies.bounds import bounds, held_pose, measured

EXAMPLES = settings.default.max_examples if settings.default else 100
# An end and its pose take a second, so the short profile searches briefly and the deep one as long as any.
searched = settings(deadline=None, max_examples=EXAMPLES if EXAMPLES > 100 else 2)


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


@searched
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


def beside(pose: NearPose, distance: float) -> NearPose:
    """The same end from another distance."""
    outward = math.copysign(1.0, pose.inputs[pose.driven] - pose.home[pose.driven])
    near = pose.inputs[pose.driven] + outward * (pose.distance - distance) * pose.reach
    return replace(pose, inputs=pose.inputs | {pose.driven: near}, distance=distance)


def test_a_bound_below_the_error_is_found_and_ends_with_status_1(monkeypatch: pytest.MonkeyPatch) -> None:
    from pointcoord.results import proof

    honest = proof._of_poses

    def short(*given: Any) -> tuple[Any, ...]:
        own, bound, *others = honest(*given)
        return own, 1e-6 * bound, *others

    monkeypatch.setattr(proof, "_of_poses", short)
    row = held_pose(beside(near_pose(4), 1e-4))
    findings = bounds().summary([{"part": "held", "number": 0, **row}])
    assert findings.status == ExitStatus.DISAGREE
    assert "bounds below the error: 1\n  number 0, " in text_of(findings.parts)
