"""A motion is followed on the branch of its drawing, however it is sampled, and refused where that ends."""

from typing import Any

import numpy as np
import pytest
from kinds import Kind
from numpy.typing import NDArray

import absolute
import absolute.follow
from absolute.newton import Configurations, newton

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


@pytest.mark.parametrize("often", [1, 2])
@pytest.mark.parametrize("check", ["signs", "kept"])
def test_a_pose_that_left_the_branch_is_led_to_by_nearer_ones_or_refused(
    kind: Kind, model: absolute.Model, monkeypatch: pytest.MonkeyPatch, often: int, check: str
) -> None:
    """Planted: a determinant has another sign, or a joint is turned round, once or always."""
    inputs = swinging(kind, 20, 1.0)
    plain = absolute.solve(model, inputs, conditions=True)
    seen = 0

    def turned(*arguments: Any) -> Configurations:
        nonlocal seen
        found, seen = newton(*arguments), seen + 1
        if often == 1 and seen > 2:
            return found
        if check == "signs":
            return found._replace(signs=-found.signs)
        return found._replace(placed=found.placed._replace(world=np.zeros_like(found.placed.world)))

    assembled = absolute.Assembled(model)
    monkeypatch.setattr(absolute.follow, "newton", turned)
    if often == 1:
        assert_same(assembled.solve(inputs), plain)
        return
    with pytest.raises(absolute.PoseError):
        assembled.solve(inputs)


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
