"""Paths of many members end where each of them ends by itself, on its branch, and say how near."""

import numpy as np
import pytest
from numpy.typing import NDArray

from pointcoord import Scene
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.simulation import scene_mechanism
from pointcoord.solve import paths_together
from pointcoord.solve.assembly import close_drawing, follow
from pointcoord.solve.paths_together import Columns, columns_of, follow_together

Array = NDArray[np.float64]


def ready(name: str) -> tuple[Mechanism, Columns, Array]:
    mechanism = scene_mechanism(Scene.load(name))
    closed, layout = close_drawing(mechanism).y, mechanism.layout
    driven = [layout.scalar(drive.coordinate) for drive in mechanism.topology.drives]
    columns = columns_of(mechanism.map, ((layout.zero, 0.0), (layout.one, 1.0)), driven, closed)
    assert columns is not None
    return mechanism, columns, closed


def targets(mechanism: Mechanism, angles: Array, racks: Array) -> Array:
    inputs = {"arm_angle": angles[:, None], "rack": racks[:, None]}
    return mechanism.known_series(inputs)[:, 0]


@pytest.mark.parametrize("name", ["bounce", "steer", "off-axis-strut", "double-wishbone"])
def test_a_path_ends_where_it_ends_by_itself(name: str) -> None:
    mechanism, columns, closed = ready(name)
    own = mechanism.input_values(closed[mechanism.map.unknowns :])
    rng = np.random.default_rng(3)
    angles = float(own["arm_angle"]) + rng.uniform(-0.6, 0.4, 24)
    wanted = targets(mechanism, angles, float(own["rack"]) + rng.uniform(-40.0, 40.0, 24))
    alone = follow(mechanism.map, closed, wanted)
    y = np.repeat(closed[:, None], 24, axis=-1)
    together = follow_together(columns, y, np.ascontiguousarray(wanted.T), 1e-12, closing=False)
    assert together.done[alone.done == 1.0].mean() > 0.8
    done = together.done & (alone.done == 1.0)
    off = np.abs(together.y.T - alone.y)[done].max(axis=-1)
    # Both are rounded: by some eps times the condition.
    assert (off <= together.left[done] + 100 * np.finfo(float).eps * alone.factors.condition[done]).all()
    assert (together.left[done] <= 1e-12).all()


def test_no_path_is_said_to_end_where_there_is_no_assembly() -> None:
    mechanism, columns, closed = ready("bounce")
    angles = np.linspace(0.02, 3.1, 60)
    wanted = targets(mechanism, angles, np.zeros(60))
    alone = follow(mechanism.map, closed, wanted)
    assert 0 < np.count_nonzero(alone.done < 1.0) < 60
    y = np.repeat(closed[:, None], 60, axis=-1)
    together = follow_together(columns, y, np.ascontiguousarray(wanted.T), 1e-12, closing=False)
    assert not together.done[alone.done < 1.0].any()
    done = together.done
    assert np.abs(together.y.T - alone.y)[done].max() < 1e-9


def test_one_member_that_cannot_be_followed_disturbs_no_other() -> None:
    mechanism, columns, closed = ready("bounce")
    angles = np.array([1.4, 0.02, 1.7])
    wanted = targets(mechanism, angles, np.zeros(3))
    y = np.repeat(closed[:, None], 3, axis=-1)
    together = follow_together(columns, y, np.ascontiguousarray(wanted.T), 1e-13, closing=False)
    np.testing.assert_array_equal(together.done, [True, False, True])
    for number in (0, 2):
        one = follow_together(columns, closed[:, None], wanted[number][:, None], 1e-13, closing=False)
        np.testing.assert_allclose(one.y[:, 0], together.y[:, number], rtol=0, atol=1e-14)


def test_a_drawing_that_does_not_close_is_closed_as_by_itself() -> None:
    mechanism, columns, _ = ready("bounce")
    drawn, n = mechanism.drawn, mechanism.map.unknowns
    assert np.abs(mechanism.map.residual(drawn)).max() > 1e-3
    closed = follow_together(columns, drawn[:, None], drawn[n:, None], 1e-13, closing=True)
    assert closed.done.all()
    np.testing.assert_allclose(closed.y[:, 0], close_drawing(mechanism).y, rtol=0, atol=1e-13)


def test_a_place_on_the_way_is_brought_as_near_as_two_of_newton_s_steps_bring_it() -> None:
    mechanism, columns, closed = ready("bounce")
    n = mechanism.map.unknowns
    off = np.zeros((len(closed), 3))
    off[:n] = 3e-3 * np.random.default_rng(9).uniform(-1.0, 1.0, (n, 3))
    y = closed[:, None] + off
    wanted = y.T.copy()
    for _ in range(2):
        system = mechanism.map
        wanted[:, :n] -= np.linalg.solve(system.jacobian(wanted), system.residual(wanted)[..., None])[..., 0]
    blocks = len(columns.proof.couplings)
    target = np.repeat(closed[n:, None], 3, axis=-1)
    group = paths_together._Travelling(
        y, 0.0 * target, target, None, np.ones(3), y[:n].copy(), np.full((blocks, 3), np.inf), np.arange(3)
    )
    assert paths_together._advance(columns, group, first=False).all()
    # The first step leaves some 1e-5, and the second one the square of that.
    assert np.abs(group.y.T - wanted).max() < 1e-12


def test_a_step_goes_to_the_residual_that_is_wanted() -> None:
    mechanism, columns, closed = ready("bounce")
    system, rng = mechanism.map, np.random.default_rng(10)
    n = system.unknowns
    y = np.repeat(closed[:, None], 3, axis=-1)
    y[:n] += 1e-3 * rng.uniform(-1.0, 1.0, (n, 3))
    wanted = 1e-3 * rng.uniform(-1.0, 1.0, (n, 3))
    d = columns.map.differences(y)
    found = columns.step(columns.factorise(d), d, wanted)
    off = system.residual(y.T) - wanted.T
    right = -np.linalg.solve(system.jacobian(y.T), off[..., None])[..., 0]
    np.testing.assert_allclose(found.T, right, rtol=0, atol=1e-13)
