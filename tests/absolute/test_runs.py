"""Instants predicted in runs are those reached one by one, and a wrong prediction is found out."""

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from kinds import Kind
from numpy.typing import NDArray

import absolute
import absolute.tracking
from absolute.expansion import Expansion, Line, between, expand, line_between
from absolute.initial_assembly import assemble
from absolute.mechanism import Mechanism
from absolute.newton import Pose
from absolute.tracking import LARGEST_BEND, LONGEST_RUN, Ahead, Tracking

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


def predictions(model: absolute.Model, inputs: Inputs) -> int:
    """How many instants of a motion are predicted."""
    mechanism = Mechanism(model)
    targets = mechanism.target_series(np.stack([inputs[name] for name in model.inputs], -1))
    values = np.stack([inputs[name][:, 0] for name in model.inputs], -1).tolist()
    return int(Tracking(mechanism, *assemble(mechanism)).advance(values, targets[0]).predicted.sum())


def one_by_one(monkeypatch: pytest.MonkeyPatch, model: absolute.Model, inputs: Inputs) -> absolute.Solution:
    """The plain way: no run is long enough."""
    with monkeypatch.context() as plain:
        plain.setattr(absolute.tracking, "SHORTEST_RUN", 10**9)
        return absolute.solve(model, inputs, conditions=True)


def assert_same(found: absolute.Solution, plain: absolute.Solution) -> None:
    """Two solutions of a car of 500 mm, each off by rounding magnified by the condition number, which the
    rates see once more each; the factor holds what of it the largest of their many numbers is off."""
    assert plain.condition is not None
    condition = plain.condition[:, None]
    for order, (a, b) in enumerate(
        (
            (found.position, plain.position),
            (found.velocity, plain.velocity),
            (found.acceleration, plain.acceleration),
        )
    ):
        size = max(500.0, *(float(np.abs(array).max()) for array in b.values()))
        for name in b:
            assert (np.abs(a[name] - b[name]) <= 2 * EPS * size * condition ** (1 + order)).all(), name


@pytest.mark.parametrize("racks", [1.0, 3.0])
@pytest.mark.parametrize("count", [150, 600])
def test_a_motion_in_runs_is_the_motion_instant_by_instant(
    kind: Kind, model: absolute.Model, monkeypatch: pytest.MonkeyPatch, count: int, racks: float
) -> None:
    inputs = swinging(kind, count, racks)
    assert predictions(model, inputs) > 0.25 * count
    assert_same(absolute.solve(model, inputs), one_by_one(monkeypatch, model, inputs))


def test_unrelated_inputs_make_no_runs_and_are_solved_all_the_same(
    kind: Kind, model: absolute.Model, monkeypatch: pytest.MonkeyPatch
) -> None:
    inputs = swinging(kind, 40, 3.0)
    order = np.random.default_rng(1).permutation(40)
    mixed = {name: series[order] for name, series in inputs.items()}
    assert predictions(model, mixed) < 10
    assert_same(absolute.solve(model, mixed), one_by_one(monkeypatch, model, mixed))


def test_a_run_ends_before_the_first_instant_that_is_too_far_or_bends_too_much() -> None:
    steps = np.linspace(0.1, 0.5, 5) * LONGEST_RUN
    far, bent = steps.copy(), np.zeros(5)
    far[3] = 1.1 * LONGEST_RUN
    bent[1] = 1.1 * LARGEST_BEND * steps[1]
    nothing = np.zeros(5)
    for size, bend, count in ((steps, nothing, 5), (far, nothing, 3), (steps, bent, 1), (far, bent, 1)):
        assert Ahead(np.zeros((5, 1)), size, bend, nothing).length() == count


def test_of_instants_the_first_of_which_has_no_pose_none_is_found(kind: Kind, model: absolute.Model) -> None:
    mechanism = Mechanism(model)
    inputs = swinging(kind, 6, 1.0)
    beyond = {name: series.copy() for name, series in inputs.items()}
    beyond["rack"][:, 0] = 100.0 * mechanism.drawing.size
    rows = [np.stack([given[name] for name in model.inputs], -1) for given in (inputs, beyond)]
    tracking = Tracking(mechanism, *assemble(mechanism))
    tracking.advance(rows[0][:, 0].tolist(), mechanism.target_series(rows[0])[0])
    assert len(tracking.found.q) == 6
    with pytest.raises(absolute.AbsoluteError):
        tracking.advance(rows[1][:, 0].tolist(), mechanism.target_series(rows[1])[0])
    assert len(tracking.found.q) == 0


def expansions(model: absolute.Model, changes: list[Array]) -> tuple[Mechanism, list[Expansion], list[Pose]]:
    """Expansions at poses whose targets are so far from those of the drawing."""
    mechanism = Mechanism(model)
    pose, _ = assemble(mechanism)
    drawn = mechanism.targets(mechanism.drawn_inputs.tolist())[0]
    found, poses = [], []
    for change in changes:
        target = drawn.copy()
        target[mechanism.joint_rows :] += change
        there = absolute.newton.correct(mechanism, pose.q, target, pose.rcond).pose
        assert there is not None
        poses.append(there)
        found.append(
            expand(mechanism, there.q, there.placed, there.factors, target[mechanism.joint_rows :].copy())
        )
    return mechanism, found, poses


WAY = np.array([0.04, 0.05])
ASIDE = np.array([0.05, -0.04])


def test_an_expansion_is_off_by_the_third_order(model: absolute.Model) -> None:
    shares = (1.0, 0.5, 0.25)
    _, found, poses = expansions(model, [0 * WAY, *(share * WAY for share in shares)])
    off = [
        float(np.abs(Ahead.of(found[0], (there.place - found[0].place)[None]).q[0] - pose.q).max())
        for there, pose in zip(found[1:], poses[1:], strict=True)
    ]
    # Halves of the way: eighths, but for the fourth order, which is a small share of the third.
    assert off[0] > 1e-6
    assert all(6.0 < large / small < 11.0 for large, small in pairwise(off))


def test_two_expansions_are_off_by_the_sixth_order_on_the_line_between_them(model: absolute.Model) -> None:
    off = []
    for scale in (2.0, 1.0):
        _, found, poses = expansions(model, [-scale * WAY, 0.3 * scale * WAY, scale * WAY])
        line = line_between(found[0].place, found[2].place, found[1].place[None])
        assert np.abs(line.beside).max() < 1e-15
        off.append(float(np.abs(between(found[0], found[2], line)[0] - poses[1].q).max()))
    # 2^6, but for the seventh order, by which a half more or less is left.
    assert off[1] > 1e-12
    assert 32.0 < off[0] / off[1] < 128.0


def test_beside_the_line_two_expansions_are_off_by_the_second_order_of_both(model: absolute.Model) -> None:
    # The second order of the way times the second of the distance beside it, and the third of this one.
    off = []
    for scale in (1.0, 0.5):
        _, found, poses = expansions(model, [-scale * WAY, 0.3 * scale * (WAY + 0.3 * ASIDE), scale * WAY])
        line = line_between(found[0].place, found[2].place, found[1].place[None])
        off.append(float(np.abs(between(found[0], found[2], line)[0] - poses[1].q).max()))
    assert off[1] > 1e-12
    # Third order at least: eighths or less are left of halves.
    assert off[0] / off[1] > 6.0


@pytest.mark.parametrize("by", [1e-4, 0.3])
def test_a_wrong_prediction_is_found_out(
    kind: Kind, model: absolute.Model, monkeypatch: pytest.MonkeyPatch, by: float
) -> None:
    inputs = swinging(kind, 150, 1.0)
    plain = one_by_one(monkeypatch, model, inputs)
    wrong = {"count": 0}

    def astray(start: Expansion, end: Expansion, line: Line) -> Array:
        found = between(start, end, line)
        if len(found) > 1 and wrong["count"] < 3:
            wrong["count"] += 1
            found[len(found) // 2] += by
        return found

    monkeypatch.setattr(absolute.tracking, "between", astray)
    assert_same(absolute.solve(model, inputs), plain)
    assert wrong["count"] == 3


def test_a_determinant_of_another_sign_is_found_out(
    kind: Kind, model: absolute.Model, monkeypatch: pytest.MonkeyPatch
) -> None:
    # What a prediction beyond a fold would show, however close to a pose it is.
    inputs = swinging(kind, 150, 1.0)
    plain = one_by_one(monkeypatch, model, inputs)
    solver = absolute.solve.__globals__
    refine, seen = solver["refine"], {"unsure": 0}

    def turned(mechanism: Mechanism, found: Any, *arguments: Any) -> Any:
        if not seen["unsure"]:
            found = found._replace(signs=-found.signs)
        refined = refine(mechanism, found, *arguments)
        seen["unsure"] += int((~refined.sure).sum())
        return refined

    monkeypatch.setitem(solver, "refine", turned)
    assert_same(absolute.solve(model, inputs), plain)
    assert seen["unsure"] > 0


def test_a_motion_to_its_limit_is_refused_at_the_same_instant_in_runs(
    kind: Kind, model: absolute.Model, monkeypatch: pytest.MonkeyPatch
) -> None:
    t = np.linspace(0.0, 1.0, 300)
    (low, high), _ = kind.span
    angle = np.radians(0.5 * (low + high))
    zero = np.zeros_like(t)
    inputs = {
        "arm_angle": np.stack([np.full_like(t, angle), zero, zero], -1),
        "rack": np.stack([1000.0 * t, zero + 1000.0, zero], -1),
    }
    refusals = []
    solve: tuple[Callable[[], object], ...] = (
        lambda: absolute.solve(model, inputs),
        lambda: one_by_one(monkeypatch, model, inputs),
    )
    for way in solve:
        with pytest.raises(absolute.PoseError) as caught:
            way()
        refusals.append(caught.value)
    runs, steps = refusals
    assert type(runs) is type(steps)
    assert runs.instant == steps.instant
    assert runs.limits == steps.limits
    assert runs.partial is not None
    assert len(runs.partial.residual) == runs.instant
