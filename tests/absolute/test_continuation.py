"""How a path is followed: by predictions of second order, and every way there is tried."""

import math
from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

import absolute
import absolute.continuation
import absolute.continue_to
from absolute.continuation import BlockedError, Path, follow
from absolute.continue_to import continue_to
from absolute.initial_assembly import assemble
from absolute.mechanism import Mechanism
from absolute.newton import Corrected, Pose, accelerations, correct

Array = NDArray[np.float64]


@pytest.mark.parametrize("goal", [(0.3, 0.0), (0.0, 35.0), (-0.25, -30.0)])
def test_each_step_of_a_path_is_predicted_to_the_second_order(
    model: absolute.Model, monkeypatch: pytest.MonkeyPatch, goal: tuple[float, float]
) -> None:
    mechanism = Mechanism(model)
    pose, _ = assemble(mechanism)
    start = mechanism.drawn_inputs.tolist()
    end = [a + b for a, b in zip(start, goal, strict=True)]
    steps = []

    def watched(within: Mechanism, q: Array, target: Array, rcond: float) -> Corrected:
        found = correct(within, q, target, rcond)
        assert found.pose is not None
        steps.append((float(np.linalg.norm(q - found.pose.q)), found.pose.q))
        return found

    off = []
    # The longest step allowed makes many of a path, or few.
    for longest in (0.2, 0.1, 0.05):
        steps.clear()
        with monkeypatch.context() as patch:
            patch.setattr(absolute.continuation, "correct", watched)
            patch.setattr(absolute.continuation, "LONGEST_STEP", longest)
            continue_to(mechanism, pose, start, end, 0)
        moved = [float(np.linalg.norm(b - a)) for a, b in pairwise([pose.q, *(q for _, q in steps)])]
        # A last step may be as short as rounding.
        off.append(max(e / size**3 for (e, _), size in zip(steps, moved, strict=True) if size > 1e-3))
    # What a prediction of first order leaves is twice as much of a cube at each half, and with a wrong first
    # order four times as much; here the fourth order and the way itself make the rest.
    assert max(off) < 1.3 * min(off)


class Blocked:
    """Stands in for `follow`: says which inputs each leg changes, and refuses those that change some."""

    def __init__(self, mechanism: Mechanism, refused: set[tuple[int, ...]]) -> None:
        self.mechanism, self.refused = mechanism, refused
        self.legs: list[tuple[int, ...]] = []

    def __call__(self, mechanism: Mechanism, start: Pose, path: Path) -> tuple[Pose, int]:
        change = path(1.0)[0] - path(0.0)[0]
        leg = tuple(np.flatnonzero(change[mechanism.joint_rows :]).tolist())
        self.legs.append(leg)
        if leg in self.refused:
            raise BlockedError(0.25, start, 7)
        return start, 100


def tried(
    model: absolute.Model,
    monkeypatch: pytest.MonkeyPatch,
    goal: tuple[float, float],
    *refused: tuple[int, ...],
) -> tuple[Blocked, Callable[[], tuple[Pose, int]]]:
    """Going so far from the drawing's inputs where some ways are blocked."""
    mechanism = Mechanism(model)
    pose, _ = assemble(mechanism)
    start = mechanism.drawn_inputs.tolist()
    end = [a + b for a, b in zip(start, goal, strict=True)]
    blocked = Blocked(mechanism, set(refused))
    monkeypatch.setattr(absolute.continue_to, "follow", blocked)
    return blocked, lambda: continue_to(mechanism, pose, start, end, 3)


def test_where_the_straight_way_is_blocked_inputs_go_one_by_one_and_all_work_counts(
    strut: absolute.Model, monkeypatch: pytest.MonkeyPatch
) -> None:
    blocked, go = tried(strut, monkeypatch, (0.1, 10.0), (0, 1))
    assert go()[1] == 7 + 100 + 100
    assert blocked.legs == [(0, 1), (0,), (1,)]


def test_inputs_one_by_one_go_in_either_order(strut: absolute.Model, monkeypatch: pytest.MonkeyPatch) -> None:
    blocked, go = tried(strut, monkeypatch, (0.1, 10.0), (0, 1), (0,))
    with pytest.raises(absolute.UnreachableError) as caught:
        go()
    assert blocked.legs == [(0, 1), (0,), (1,), (0,)]
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
    assert blocked.legs == [(1,)]


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
    count = 0

    def counted(mechanism: Mechanism, pose: Pose, rate: Array, second: Array) -> tuple[Array, Array]:
        nonlocal count
        count += 1
        return accelerations(mechanism, pose, rate, second)

    monkeypatch.setattr(absolute.continuation, "accelerations", counted)
    angle = float(Mechanism(strut).drawn_inputs[0])
    ends = []
    for goal in (200.0, far):
        inputs = {"arm_angle": np.array([[angle, 0.0, 0.0]]), "rack": np.array([[goal, 0.0, 0.0]])}
        with pytest.raises(absolute.UnreachableError) as caught:
            absolute.solve(strut, inputs)
        ends.append(caught.value.reached["rack"])
        assert caught.value.limit == "rack"
    assert ends[1] == pytest.approx(ends[0], abs=1e-9)
    # Halves down to the longest step. Then a step takes a quarter off the square root of the way to the fold,
    # which falls from 1 to sqrt(eps): log(1 / sqrt(eps)) / -log(3 / 4) = 63 steps, of which each second is
    # tried twice as long first, and 26 halves at last. Both goals.
    assert count < math.log2(far) + 2 * (26 + 2 * 63)


@pytest.mark.parametrize("way", [3.0, 30.0])
def test_a_way_that_no_step_leads_along_is_given_up_at_the_root_of_eps(
    strut: absolute.Model, monkeypatch: pytest.MonkeyPatch, way: float
) -> None:
    mechanism = Mechanism(strut)
    pose, _ = assemble(mechanism)
    begin = mechanism.drawn_inputs.tolist()
    sizes = []

    def watched(within: Mechanism, start: Pose, rate: Array, second: Array) -> tuple[Array, Array]:
        found = accelerations(within, start, rate, second)
        sizes.append(float(np.linalg.norm(found[0])))
        return found

    monkeypatch.setattr(absolute.continuation, "accelerations", watched)
    monkeypatch.setattr(absolute.continuation, "correct", lambda *_: Corrected(None, 2, 1.0))
    with pytest.raises(BlockedError) as caught:
        follow(
            mechanism,
            pose,
            lambda share: mechanism.targets([begin[0], begin[1] + share * way], [0.0, way]),
        )
    # Halves, the last of which is the first at or below it.
    root = math.sqrt(np.finfo(float).eps)
    assert sizes[-1] <= root < sizes[-2]
    assert sizes[-2] == pytest.approx(2.0 * sizes[-1], rel=1e-12, abs=0)
    assert caught.value.share == 0.0
    assert caught.value.pose is pose
    assert caught.value.corrections == 2 * len(sizes)
