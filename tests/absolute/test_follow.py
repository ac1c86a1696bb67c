"""How a motion is followed: by predictions of second order, many instants at once, and every way is tried."""

import math
from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import absolute
import absolute.follow
from absolute.follow import BlockedError, follow, through
from absolute.initial_assembly import assemble
from absolute.mechanism import Mechanism
from absolute.newton import Configurations, newton

Array = NDArray[np.float64]
EPS = float(np.finfo(float).eps)


@pytest.mark.parametrize("goal", [(0.3, 0.0), (0.0, 35.0), (-0.25, -30.0)])
def test_each_step_of_a_way_is_predicted_to_the_second_order(
    model: absolute.Model, monkeypatch: pytest.MonkeyPatch, goal: tuple[float, float]
) -> None:
    mechanism = Mechanism(model)
    pose = assemble(mechanism)
    steps = []

    def watched(within: Mechanism, near: Configurations, q: Array, *rest: Array) -> Configurations:
        found = newton(within, near, q, *rest)
        assert len(found.q) == 1
        steps.append((float(np.linalg.norm(q - found.q)), found.q))
        return found

    off = []
    # The longest step allowed makes many of a way, or few.
    for longest in (0.2, 0.1, 0.05):
        steps.clear()
        with monkeypatch.context() as patch:
            patch.setattr(absolute.follow, "newton", watched)
            patch.setattr(absolute.follow, "LONGEST_STEP", longest)
            list(through(mechanism, pose, mechanism.drawn_inputs + np.array([goal])))
        moved = [float(np.linalg.norm(b - a)) for a, b in pairwise([pose.q, *(q for _, q in steps)])]
        # A last step may be as short as rounding.
        off.append(max(e / size**3 for (e, _), size in zip(steps, moved, strict=True) if size > 1e-3))
    # What a prediction of first order leaves is twice as much of a cube at each half, and with a wrong first
    # order four times as much; here the fourth order and the way itself make the rest.
    assert max(off) < 1.3 * min(off)


def test_instants_that_are_near_each_other_are_found_many_at_once_and_as_they_are_one_by_one(
    model: absolute.Model, monkeypatch: pytest.MonkeyPatch
) -> None:
    mechanism = Mechanism(model)
    pose = assemble(mechanism)
    goals = mechanism.drawn_inputs + np.linspace(0.0, 1.0, 200)[:, None] * [0.2, 30.0]
    together = list(through(mechanism, pose, goals))
    assert len(together) < 20
    monkeypatch.setattr(absolute.follow, "MOST_INSTANTS", 1)
    alone = list(through(mechanism, pose, goals))
    assert len(alone) == 200
    for name in ("q", "origin"):
        many, each = (np.concatenate([getattr(run, name) for run in runs]) for runs in (together, alone))
        # Both are closed to rounding; condition numbers are below 100.
        assert np.abs(many - each).max() <= 16 * EPS * 100


@pytest.mark.parametrize("place", [0, 1, 5])
def test_a_run_of_instants_ends_before_the_one_that_is_far(model: absolute.Model, place: int) -> None:
    mechanism = Mechanism(model)
    pose = assemble(mechanism)
    goals = mechanism.drawn_inputs + np.linspace(0.001, 0.01, 10)[:, None] * [1.0, 0.0]
    goals[place, 1] += 60.0
    runs = [len(run.q) for run in through(mechanism, pose, goals)]
    assert sum(runs) == 10
    # Those before, the far one, and back to those after it.
    ends = np.cumsum(runs).tolist()
    assert {place + 1} | ({place} if place else set()) <= set(ends)


class Blocked:
    """Stands in for `follow`: says which inputs each leg changes, and refuses those that change some."""

    def __init__(self, mechanism: Mechanism, refused: set[tuple[int, ...]]) -> None:
        self.mechanism, self.refused = mechanism, refused
        self.legs: list[tuple[int, ...]] = []

    def __call__(
        self, mechanism: Mechanism, start: Configurations, at: Array, goals: Array, targets: object
    ) -> Iterator[Configurations]:
        for goal in goals:
            leg = tuple(np.flatnonzero(goal != at).tolist())
            self.legs.append(leg)
            if leg in self.refused:
                raise BlockedError(at + 0.25 * (goal - at), start, 7)
            at = goal
            yield start._replace(corrections=np.array([100]))


def tried(
    model: absolute.Model,
    monkeypatch: pytest.MonkeyPatch,
    goal: tuple[float, float],
    *refused: tuple[int, ...],
) -> tuple[Blocked, Callable[[], list[Configurations]]]:
    """Going so far from the drawing's inputs where some ways are blocked, at the fourth instant."""
    mechanism = Mechanism(model)
    pose = assemble(mechanism)
    pose.corrections[:] = 0
    start = mechanism.drawn_inputs
    blocked = Blocked(mechanism, set(refused))
    monkeypatch.setattr(absolute.follow, "follow", blocked)
    goals = np.array([start, start, start, start + goal])
    return blocked, lambda: list(through(mechanism, pose, goals))


def test_where_the_straight_way_is_blocked_inputs_go_one_by_one_and_all_work_counts(
    strut: absolute.Model, monkeypatch: pytest.MonkeyPatch
) -> None:
    blocked, go = tried(strut, monkeypatch, (0.1, 10.0), (0, 1))
    assert go()[-1].corrections.tolist() == [7 + 100 + 100]
    assert blocked.legs[3:] == [(0, 1), (0,), (1,)]


def test_inputs_one_by_one_go_in_either_order(strut: absolute.Model, monkeypatch: pytest.MonkeyPatch) -> None:
    blocked, go = tried(strut, monkeypatch, (0.1, 10.0), (0, 1), (0,))
    with pytest.raises(absolute.UnreachableError) as caught:
        go()
    assert blocked.legs[3:] == [(0, 1), (0,), (1,), (0,)]
    # A quarter of the straight way, which is the one that is told.
    angle, rack = blocked.mechanism.drawn_inputs.tolist()
    assert caught.value.reached == pytest.approx({"arm_angle": angle + 0.025, "rack": rack + 2.5})
    assert caught.value.inputs == pytest.approx({"arm_angle": angle + 0.1, "rack": rack + 10.0})
    assert caught.value.instant == 3


def test_an_input_that_changes_alone_has_one_way(
    strut: absolute.Model, monkeypatch: pytest.MonkeyPatch
) -> None:
    blocked, go = tried(strut, monkeypatch, (0.0, 10.0), (1,))
    with pytest.raises(absolute.UnreachableError):
        go()
    assert blocked.legs[3:] == [(1,)]


def test_a_pose_that_stands_a_millimetre_from_its_goal_is_not_singular_but_out_of_reach(
    strut: absolute.Model, monkeypatch: pytest.MonkeyPatch
) -> None:
    # However small the numbers of the inputs are.
    _, go = tried(strut, monkeypatch, (0.0, 0.5), (1,))
    with pytest.raises(absolute.UnreachableError):
        go()


@pytest.mark.parametrize("far", [1e3, 1e30, 1e280])
def test_however_far_a_goal_is_the_way_ends_where_the_mechanism_locks(
    strut: absolute.Model, monkeypatch: pytest.MonkeyPatch, far: float
) -> None:
    steps = 0

    def counted(*arguments: Any) -> Configurations:
        nonlocal steps
        steps += 1
        return newton(*arguments)

    monkeypatch.setattr(absolute.follow, "newton", counted)
    angle = float(Mechanism(strut).drawn_inputs[0])
    ends = []
    for goal in (200.0, far):
        inputs = {"arm_angle": np.array([[angle, 0.0, 0.0]]), "rack": np.array([[goal, 0.0, 0.0]])}
        with pytest.raises(absolute.UnreachableError) as caught:
            absolute.solve(strut, inputs)
        ends.append(caught.value.reached["rack"])
        assert caught.value.limit == "rack"
    assert ends[1] == pytest.approx(ends[0], abs=1e-9)
    # A step takes a quarter off the square root of the way to the fold, which falls from 1 to sqrt(eps):
    # log(1 / sqrt(eps)) / -log(3 / 4) = 63 steps, of which each is tried twice as long first, and 26 halves
    # at last. Both goals.
    assert steps < 2 * (26 + 2 * 63)


@pytest.mark.parametrize("way", [3.0, 30.0])
def test_a_way_that_no_step_leads_along_is_given_up_at_the_root_of_eps(
    strut: absolute.Model, monkeypatch: pytest.MonkeyPatch, way: float
) -> None:
    mechanism = Mechanism(strut)
    pose = assemble(mechanism)
    begin, sizes = mechanism.drawn_inputs, []

    def failing(_: Mechanism, near: Configurations, q: Array, *rest: Array) -> Configurations:
        sizes.append(float(np.linalg.norm(q - near.q)))
        return near.part(slice(0))

    monkeypatch.setattr(absolute.follow, "newton", failing)
    with pytest.raises(BlockedError) as caught:
        list(follow(mechanism, pose, begin, begin + np.array([[0.0, way]]), mechanism.targets))
    # Halves, the last of which is the first at or below it; a quaternion turns by half the angle.
    root = math.sqrt(EPS)
    assert sizes[-1] <= root
    assert sizes[-2] == pytest.approx(2.0 * sizes[-1], rel=1e-6, abs=0)
    assert sizes[-2] > 0.5 * root
    assert caught.value.reached.tolist() == begin.tolist()
    assert caught.value.pose is pose
    assert caught.value.corrections == 0
