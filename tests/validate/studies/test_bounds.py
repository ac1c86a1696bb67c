"""Proven bounds against the reference on random cars, up to the poses where they lock."""

import math
from dataclasses import replace
from typing import Any

import pandas as pd
import pytest
from hypothesis import assume, given, settings, target
from hypothesis import strategies as st

from pointcoord import Scene
from validate.adjudication.reference_solution import inputs_at, reference_instant
from validate.cars.near_singular import NearPose, approach, near_pose
from validate.cars.scene_content import content_of
from validate.exit_status import ExitStatus
from validate.output.table import text_of
from validate.reference import InfeasibleError
from validate.strategies import cars
from validate.studies.bounds import (
    bounds,
    held_pose,
    measured,
)
from validate.studies.study import Row

EXAMPLES = settings.default.max_examples if settings.default else 100
# An end and its pose take a second, so the short profile searches briefly and the deep one as long as any.
searched = settings(deadline=None, max_examples=EXAMPLES if EXAMPLES > 100 else 5)
# Ends of four mechanisms whose way there is short, by their numbers.
ENDS = (4, 5, 7, 8)


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
    (row,) = held_pose(pose)
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


@pytest.fixture(scope="module")
def poses() -> list[NearPose]:
    return [near_pose(number) for number in ENDS]


@pytest.fixture(scope="module")
def held(poses: list[NearPose]) -> list[Row]:
    """Each end from seven distances, over the decades from 1e-8 to 1e-2."""
    near = [beside(pose, 10.0**-k) for pose in poses for k in range(2, 9)]
    common = {"part": "held", "seconds": 0.0, "worker": "here"}
    return [{**common, "number": i, **row} for i, pose in enumerate(near) for row in held_pose(pose)]


def test_a_bound_below_the_error_is_found_and_ends_with_status_1(
    poses: list[NearPose], monkeypatch: pytest.MonkeyPatch
) -> None:
    from pointcoord.bounds import proof

    honest = proof._of_poses

    def short(*given: Any) -> tuple[Any, ...]:
        own, bound, *others = honest(*given)
        return own, 1e-6 * bound, *others

    monkeypatch.setattr(proof, "_of_poses", short)
    (row,) = held_pose(beside(poses[0], 1e-4))
    findings = bounds().summary([{"part": "held", "number": 0, **row}])
    assert findings.status == ExitStatus.DISAGREE
    assert "bounds below the error: 1" in text_of(findings.parts)


@pytest.mark.parametrize("number", range(4))
def test_an_input_stepped_beyond_its_end_has_no_assembly(number: int, poses: list[NearPose]) -> None:
    # The end is where the reference says so too, to 1e-11 of the range on either side.
    for distance, there in ((1e-11, True), (-1e-11, False)):
        pose = beside(poses[number], distance)
        scene = Scene.from_mapping(content_of(pose.car, pose.inputs, effects=()))
        if there:
            reference_instant(scene, inputs_at(scene, 0.0))
        else:
            with pytest.raises(InfeasibleError):
                reference_instant(scene, inputs_at(scene, 0.0))
