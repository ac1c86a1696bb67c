"""Proven bounds against the reference on random cars, up to the poses where they lock."""

import math
from typing import Any

import pytest
from hypothesis import assume, given, settings, target
from hypothesis import strategies as st
from worked_out import worked_out

from validate.cars.input_limits import Linkage
from validate.cars.near_singular import approach, near_pose
from validate.cars.registry import VARIANTS
from validate.cars.strategies import cars
from validate.exit_status import ExitStatus
from validate.long_studies.bounds import (
    BoundsStudy,
    Check,
    FoundBounds,
    Refusal,
    bounds_data,
    bounds_parts,
    error_over_distance,
    error_over_rounding,
    fitted,
    found_in,
    held_pose,
    looseness,
    moving_instants,
    of_variant,
)
from validate.output.terminal import text_of
from validate.reference import InfeasibleError, solve_reference

EXAMPLES = settings.default.max_examples if settings.default else 100
# A pose takes 40 ms, so the short profile searches briefly and the deep one as long as any.
searched = settings(deadline=None, max_examples=EXAMPLES if EXAMPLES > 100 else 25)
NUMBERS = st.integers(0, 2**32 - 1)


@st.composite
def checks(draw: st.DrawFn) -> Check:
    """A random car held near the end of an input, at a distance that a search can move."""
    pose = approach(
        draw(cars()),
        driven=draw(st.sampled_from(["arm_angle", "rack"])),
        forward=draw(st.booleans()),
        aside=draw(st.floats(-1.0, 1.0)),
        distance=10.0 ** draw(st.floats(-12.0, -1.0)),
    )
    assume(pose is not None)
    assert pose is not None
    (found,) = held_pose(pose)
    assume(isinstance(found, Check))
    assert isinstance(found, Check)
    return found


@searched
@given(check=checks())
def test_no_search_finds_an_error_above_its_bound_or_a_sudden_loss_of_digits(check: Check) -> None:
    if 0.0 < check.share < math.inf:
        target(math.log10(check.share), label="error / bound")
        target(-math.log10(check.share), label="bound / error")
        target(math.log10(check.loss), label="error / rounding")
    assert check.share <= 1.0, check
    # Newton ends where its step is no larger than its own rounding: 6 u in each of 17 rows, C_u^-1 and the
    # size of the car, where eps is 2 u; the reported point is rounded once more.
    assert check.loss <= 17 * 6, check


@searched
@given(number=NUMBERS)
def test_bounds_hold_between_the_ends_of_the_segments_of_a_motion(number: int) -> None:
    found = [check for check in moving_instants(number, seed=1) if isinstance(check, Check)]
    if found:
        target(max(check.share for check in found), label="error / bound")
    for check in found:
        assert check.share <= 1.0, check


@pytest.fixture(scope="module")
def small() -> Any:
    return found_in(worked_out(BoundsStudy(60, motions=5, seed=0)), seed=0)


def test_bounds_are_loose_by_about_one_digit_and_errors_follow_the_condition_number(small: Any) -> None:
    ratio = sorted(looseness(small.held)["solved points"])
    assert ratio[len(ratio) // 2] < 20.0
    # 60 poses scattered by 0.6 decades over 6 decades of rounding and 9 of distances: slopes of a fit vary
    # by 0.6 / (sqrt(60) 1.7) = 0.05 and 0.6 / (sqrt(50) 2.6) = 0.03; five times that is held to.
    assert len(small.held) >= 57
    assert abs(error_over_rounding(small.held).slope - 1.0) < 0.25
    assert abs(error_over_distance(small.held).slope + 0.5) < 0.15


def test_every_pose_is_counted_once(small: Any) -> None:
    held = [c.number for c in small.held] + [r.number for r in small.refusals]
    assert len(small.held) + len(small.moving) + len(small.refusals) == 60 + 5 * 4
    assert set(range(60)) <= set(held)


def test_a_bound_below_the_error_is_found_and_ends_with_status_1(monkeypatch: pytest.MonkeyPatch) -> None:
    from pointcoord.bounds import proof

    honest = proof._reported_bound
    monkeypatch.setattr(proof, "_reported_bound", lambda *a: honest(*a) * 1e-6)
    study = BoundsStudy(5, motions=0)
    findings = study.findings(worked_out(study))
    assert findings.status == ExitStatus.DISAGREE
    assert "bounds below the error: 0" not in text_of(findings.parts)


def test_report_as_text_and_as_plain_data_say_the_same(small: Any) -> None:
    text, data = text_of(bounds_parts(small)), bounds_data(small)
    assert "bounds below the error: 0" in text
    for variant in VARIANTS:
        count = len(of_variant(small.held, variant))
        assert f"{count} poses of cars ({variant.words}), held" in text
        assert data["held"][variant.words]["count"] == count > 0
    assert sum(row["poses"] for row in data["refusals"]) == len(small.refusals)
    slope = data["held"][VARIANTS[0].words]["error_over_rounding"]["slope"]
    assert f"slope {slope:.3f}" in text


def test_numbers_give_the_same_poses_again() -> None:
    assert near_pose(7, seed=3) == near_pose(7, seed=3)
    assert near_pose(7, seed=3).car != near_pose(8, seed=3).car


@pytest.mark.parametrize("number", range(12))
def test_an_input_stepped_beyond_its_end_has_no_assembly(number: int) -> None:
    # The end is where the reference says so too, to 1e-12 of the range on either side.
    pose = near_pose(number, seed=5, nearest=1e-12, farthest=1e-11)
    step = pose.distance * pose.reach
    linkage = Linkage.of(pose.car)
    ahead = linkage.end(
        pose.home | {k: v for k, v in pose.inputs.items() if k != pose.driven}, pose.driven, True
    )
    assert ahead is not None
    upward = abs(ahead[0] - pose.inputs[pose.driven]) < 0.5 * pose.reach
    beyond = pose.inputs | {pose.driven: pose.inputs[pose.driven] + (2.0 if upward else -2.0) * step}
    car = pose.car
    laws = {name: (value, 0, 0) for name, value in beyond.items()}
    with pytest.raises(InfeasibleError) as caught:
        solve_reference(
            car.points,
            laws,
            up=car.up,
            right=car.right,
            side=car.side,
            closure=car.closure,
            suspension=car.suspension,
        )
    assert caught.value.closure == pose.lock


def test_power_laws_are_fitted() -> None:
    fit = fitted([1.0, 10.0, 100.0, 1000.0], [2.0, 0.2, 0.02, 0.0])
    assert fit.slope == pytest.approx(-1.0)
    assert fit.scatter < 1e-12
    assert fit.poses == 3
    assert math.isnan(fitted([1.0], [1.0]).slope)


def test_refusals_carry_their_reason() -> None:
    refusal = Refusal(3, VARIANTS[0], 1e-12, "pointcoord: AssemblyError; reference: answers")
    assert refusal.reason in text_of(bounds_parts(FoundBounds(0, (), (), (refusal,))))
