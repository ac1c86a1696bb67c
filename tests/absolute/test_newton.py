"""What Newton's method reports and when it stops."""

import numpy as np
import pytest
from numpy.typing import NDArray

import absolute
from absolute.initial_assembly import assemble
from absolute.mechanism import Mechanism
from absolute.newton import correct, inverse
from absolute.refine import refine
from absolute.tracking import Found

Array = NDArray[np.float64]
EPS = float(np.finfo(float).eps)


@pytest.mark.parametrize("off", [0.25, -0.5, 3.0, -7.0])
def test_the_residual_reported_is_how_far_a_row_is_off_its_target_on_either_side(
    strut: absolute.Model, monkeypatch: pytest.MonkeyPatch, off: float
) -> None:
    mechanism = Mechanism(strut)
    pose, _ = assemble(mechanism)
    # No correction at all: the pose of the drawing stays, and the rack's row misses by `off` mm.
    monkeypatch.setattr(absolute.refine, "MOST_CORRECTIONS", 0)
    angle, rack = mechanism.drawn_inputs.tolist()
    series = np.array([[[angle, rack], [0, 0], [0, 0]], [[angle, rack + off], [0, 0], [0, 0]]])
    found = Found(np.array([pose.q] * 2), np.zeros(2, dtype=np.int64), pose.signs)
    refined = refine(mechanism, found, mechanism.target_series(series), False)
    residual = refined.residual * mechanism.drawing.size
    # The rows themselves are closed to a few roundings of the size.
    assert 0 <= residual[0] <= 16 * EPS * mechanism.drawing.size
    assert abs(residual[1] - abs(off)) <= 16 * EPS * mechanism.drawing.size


@pytest.mark.parametrize(("share", "corrections"), [(0.3, 1), (3.0, 2)])
def test_one_correction_is_enough_below_the_root_of_eps_rcond(
    strut: absolute.Model, share: float, corrections: int
) -> None:
    # After a correction s about s^2 / rcond is left: below eps nothing is.
    mechanism = Mechanism(strut)
    pose, _ = assemble(mechanism)
    inputs = mechanism.drawn_inputs.tolist()
    target = mechanism.targets(inputs)[0]
    way = np.random.default_rng(2).normal(size=mechanism.stack.count)
    away = share * np.sqrt(EPS * pose.rcond) * way / np.linalg.norm(way)
    outcome = correct(mechanism, mechanism.moved(pose.q, pose.poses.rotation, away), target, pose.rcond)
    assert outcome.corrections == corrections
    assert outcome.pose is not None
    assert np.allclose(outcome.pose.poses.origin, pose.poses.origin, rtol=0, atol=16 * EPS / pose.rcond)


def test_corrections_that_led_nowhere_are_counted_too(
    strut: absolute.Model, monkeypatch: pytest.MonkeyPatch
) -> None:
    mechanism = Mechanism(strut)
    pose, _ = assemble(mechanism)
    angle, rack = mechanism.drawn_inputs.tolist()
    made = []

    def watched(q: Array, rotation: Array, step: Array) -> Array:
        made.append(step)
        return moved(q, rotation, step)

    moved = mechanism.moved
    monkeypatch.setattr(mechanism, "moved", watched)
    # Rows that are called straight: one correction would be enough, but the next is far above rounding.
    outcome = correct(mechanism, pose.q, mechanism.targets([angle, rack + 20.0])[0], np.inf)
    assert outcome.pose is None
    assert outcome.corrections == len(made) == 1


def test_a_condition_number_is_one_over_its_reciprocal_and_infinite_where_that_is_none() -> None:
    assert inverse(0.25) == 4.0
    assert inverse(1e-300) == pytest.approx(1e300, rel=2 * EPS)
    assert inverse(0.0) == inverse(float("nan")) == np.inf


@pytest.mark.parametrize("moved", ["arm_angle", "rack"])
def test_an_instant_that_corrections_do_not_close_is_refused_with_the_input_that_leads_there(
    strut: absolute.Model, monkeypatch: pytest.MonkeyPatch, moved: str
) -> None:
    drawn = dict(zip(strut.inputs, Mechanism(strut).drawn_inputs.tolist(), strict=True))
    asked = {**drawn, moved: drawn[moved] + 0.5}
    monkeypatch.setattr(absolute.refine, "MOST_CORRECTIONS", 0)
    with pytest.raises(absolute.SingularError, match="instant 0: Newton's corrections stall") as caught:
        absolute.solve(strut, {name: np.array([[value, 0.0, 0.0]]) for name, value in asked.items()})
    assert caught.value.instant == 0
    assert caught.value.inputs == asked
    assert caught.value.limit == moved
