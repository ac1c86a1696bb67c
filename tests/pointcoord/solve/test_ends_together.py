"""Ends of many members are solved each from where its series leads, and held to what is left of them."""

import numpy as np
import pytest
from numpy.typing import NDArray

from pointcoord import Scene
from pointcoord.simulation import scene_mechanism
from pointcoord.solve.assembly import close_drawing
from pointcoord.solve.ends_together import Confirmed, confirm, noise
from pointcoord.solve.paths_together import columns_of
from pointcoord.solve.taylor import SOLVED

Array = NDArray[np.float64]


def solved(far: Array, tolerance: float) -> tuple[Confirmed, Array, Array]:
    """Ends that are so far off a closed drawing, the drawing, and Newton's first steps by plain solves."""
    mechanism = scene_mechanism(Scene.load("bounce"))
    closed, layout, n = close_drawing(mechanism).y, mechanism.layout, mechanism.map.unknowns
    driven = [layout.scalar(drive.coordinate) for drive in mechanism.topology.drives]
    columns = columns_of(mechanism.map, ((layout.zero, 0.0), (layout.one, 1.0)), driven, closed)
    assert columns is not None
    y = np.repeat(closed[:, None], len(far), axis=-1)
    begun = columns.factorise(columns.map.differences(y))
    y[:n] += far * np.random.default_rng(8).uniform(-1.0, 1.0, n)[:, None]
    matrices, rows = mechanism.map.jacobian(y.T), mechanism.map.residual(y.T)
    steps = np.abs(np.linalg.solve(matrices, rows[..., None])[..., 0]).max(axis=-1)
    return confirm(columns, y, begun, np.zeros(len(far)), tolerance), closed, steps


def test_every_end_is_solved_however_far_off_the_others_are() -> None:
    found, closed, first = solved(np.array([0.0, 1e-9, 1e-6, 1e-5]), 1e-12)
    assert found.good.all()
    np.testing.assert_allclose(found.first_step, first, rtol=1e-6, atol=1e-14)
    np.testing.assert_allclose(found.y, np.repeat(closed[:, None], 4, axis=-1), rtol=0, atol=1e-13)
    assert (found.left <= SOLVED * 1e-12).all()
    assert found.steps > 1


def test_an_end_that_is_solved_takes_one_step() -> None:
    found, _, _ = solved(np.zeros(3), 1e-9)
    assert found.good.all()
    assert found.steps == 1


def test_an_end_of_which_more_is_left_than_a_share_of_the_tolerance_is_not_confirmed() -> None:
    found, _, _ = solved(np.array([1e-9, 1e-6, 1e-5]), 1e-40)
    assert (found.left > SOLVED * 1e-40).all()
    assert not found.good.any()


def test_the_rounding_of_a_step_is_that_of_its_rows_through_the_inverse() -> None:
    mechanism = scene_mechanism(Scene.load("bounce"))
    closed, layout, n = close_drawing(mechanism).y, mechanism.layout, mechanism.map.unknowns
    driven = [layout.scalar(drive.coordinate) for drive in mechanism.topology.drives]
    columns = columns_of(mechanism.map, ((layout.zero, 0.0), (layout.one, 1.0)), driven, closed)
    assert columns is not None
    y, data = np.repeat(closed[:, None], 3, axis=-1), np.zeros((3, len(closed)))
    y[:n] += 1e-2 * np.random.default_rng(8).uniform(-1.0, 1.0, (n, 3))
    # The second one's arm is known to a micrometre or so only.
    data[1, driven[0]] = 1e-6
    found = noise(columns, y, data)
    for number in range(3):
        system = mechanism.map
        rows = system.uncertainty(y[:, number], data[number])
        inverse = np.linalg.inv(system.jacobian(y[:, number]))
        assert found[number] == pytest.approx(max(np.abs(inverse) @ rows), rel=1e-12)
    assert found[1] > 1e3 * found[0]
