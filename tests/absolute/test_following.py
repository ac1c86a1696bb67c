"""A motion is followed on the branch of its drawing, however it is sampled, and refused where that ends."""

from typing import Any

import numpy as np
import pytest
from kinds import Kind
from numpy.typing import NDArray

import absolute
from absolute.initial_assembly import assemble
from absolute.mechanism import Mechanism
from absolute.tracking import Tracking

Array = NDArray[np.float64]
Inputs = dict[str, Array]
EPS = float(np.finfo(float).eps)


def swinging(kind: Kind, count: int, racks: float) -> Inputs:
    """Arm and rack about the middle of what the car reaches, so often a motion as 1 and `racks`."""
    t = np.linspace(0.0, 1.0, count)
    (low, high), (left, right) = kind.span
    middle, swing = np.radians(0.5 * (low + high)), np.radians(0.3 * (high - low))
    motions = []
    for at, by, often in ((middle, swing, 1.0), (0.5 * (left + right), 0.3 * (right - left), racks)):
        w = 2.0 * np.pi * often
        motions.append(
            np.stack([at + by * np.sin(w * t), by * w * np.cos(w * t), -by * w * w * np.sin(w * t)], -1)
        )
    return {"arm_angle": motions[0], "rack": motions[1]}


def assert_same(found: absolute.Solution, plain: absolute.Solution, at: Any = slice(None)) -> None:
    """Two solutions of a car of 500 mm, each off by rounding magnified by the condition number, which the
    rates see once more each; the factor holds what of it the largest of their many numbers is off."""
    assert plain.condition is not None
    condition = plain.condition[at, None]
    for order, (a, b) in enumerate(
        (
            (found.position, plain.position),
            (found.velocity, plain.velocity),
            (found.acceleration, plain.acceleration),
        )
    ):
        size = max(500.0, *(float(np.abs(array).max()) for array in b.values()))
        for name in b:
            assert (np.abs(a[name] - b[name][at]) <= 2 * EPS * size * condition ** (1 + order)).all(), name


def test_a_pose_is_the_same_whichever_instants_lead_to_it(kind: Kind, model: absolute.Model) -> None:
    inputs = swinging(kind, 60, 3.0)
    plain = absolute.solve(model, inputs, conditions=True)
    order = np.random.default_rng(1).permutation(60)[:40]
    some = absolute.solve(model, {name: series[order] for name, series in inputs.items()})
    assert_same(some, plain, order)


def test_of_instants_the_first_of_which_has_no_pose_none_is_found(kind: Kind, model: absolute.Model) -> None:
    mechanism = Mechanism(model)
    inputs = swinging(kind, 6, 1.0)
    beyond = {name: series.copy() for name, series in inputs.items()}
    beyond["rack"][:, 0] = 100.0 * mechanism.drawing.size
    near, far = (
        np.stack([given[name][:, 0] for name in model.inputs], -1).tolist() for given in (inputs, beyond)
    )
    tracking = Tracking(mechanism, *assemble(mechanism))
    tracking.advance(near)
    assert len(tracking.found.q) == 6
    with pytest.raises(absolute.AbsoluteError):
        tracking.advance(far)
    assert len(tracking.found.q) == 0


@pytest.mark.parametrize("often", [1, 2])
def test_a_pose_that_left_the_branch_is_tried_once_more_from_the_drawing_and_then_refused(
    kind: Kind, model: absolute.Model, monkeypatch: pytest.MonkeyPatch, often: int
) -> None:
    """Planted: a determinant has another sign, as beyond a fold."""
    inputs = swinging(kind, 20, 1.0)
    plain = absolute.solve(model, inputs, conditions=True)
    solver = absolute.solve.__globals__
    refine, seen = solver["refine"], {"turned": 0}

    def turned(mechanism: Mechanism, found: Any, *arguments: Any) -> Any:
        if seen["turned"] < often:
            seen["turned"] += 1
            found = found._replace(signs=-found.signs)
        return refine(mechanism, found, *arguments)

    monkeypatch.setitem(solver, "refine", turned)
    if often == 1:
        assert_same(absolute.solve(model, inputs), plain)
        return
    with pytest.raises(absolute.BranchError, match="not on the branch"):
        absolute.solve(model, inputs)


def test_a_motion_to_its_limit_is_refused_where_it_ends_and_keeps_what_was_solved(
    kind: Kind, model: absolute.Model
) -> None:
    t = np.linspace(0.0, 1.0, 100)
    (low, high), _ = kind.span
    zero = np.zeros_like(t)
    inputs = {
        "arm_angle": np.stack([np.full_like(t, np.radians(0.5 * (low + high))), zero, zero], -1),
        "rack": np.stack([1000.0 * t, zero + 1000.0, zero], -1),
    }
    with pytest.raises(absolute.PoseError) as caught:
        absolute.solve(model, inputs)
    refused = caught.value
    assert refused.limits
    assert refused.partial is not None
    assert len(refused.partial.residual) == refused.instant
