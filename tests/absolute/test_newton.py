"""What Newton's method gives and when it gives up."""

import numpy as np
import pytest
from numpy.typing import NDArray

import absolute
from absolute.initial_assembly import assemble
from absolute.mechanism import Mechanism
from absolute.newton import Configurations, configurations_at, newton, rates, solved

Array = NDArray[np.float64]
EPS = float(np.finfo(float).eps)


def moved_away(mechanism: Mechanism, pose: Configurations, shares: Array) -> Array:
    """Configurations so far from a pose, in units of size and rad, each another way."""
    ways = np.random.default_rng(2).normal(size=(len(shares), mechanism.stack.count))
    ways *= (shares / np.linalg.norm(ways, axis=1))[:, None]
    return mechanism.moved(np.repeat(pose.q, len(shares), axis=0), pose.rotation, ways)


@pytest.mark.parametrize("off", [0.25, -0.5, 3.0, -7.0])
def test_the_residual_is_how_far_a_row_is_off_its_target_on_either_side(
    strut: absolute.Model, off: float
) -> None:
    mechanism = Mechanism(strut)
    drawn = mechanism.drawn_inputs
    # The pose of the drawing, and the rack's row misses by `off` mm.
    q = np.repeat(assemble(mechanism).q, 2, axis=0)
    found = configurations_at(mechanism, q, mechanism.targets(drawn + np.array([[0.0, 0.0], [0.0, off]]))[0])
    residual = found.residual * mechanism.drawing.size
    # The rows themselves are closed to a few roundings of the size.
    assert 0 <= residual[0] <= 16 * EPS * mechanism.drawing.size
    assert abs(residual[1] - abs(off)) <= 16 * EPS * mechanism.drawing.size
    assert found.closed.tolist() == [True, False]


def test_one_correction_is_enough_below_the_root_of_eps_over_the_condition(strut: absolute.Model) -> None:
    # After a correction s about s^2 condition is left: below eps nothing is.
    mechanism = Mechanism(strut)
    pose = assemble(mechanism)
    target = mechanism.targets(mechanism.drawn_inputs)[0]
    away = np.array([0.3, 3.0]) * np.sqrt(EPS / pose.condition)
    found = newton(
        mechanism, pose, moved_away(mechanism, pose, away), np.repeat(target[None], 2, axis=0), np.ones(2)
    )
    assert found.corrections.tolist() == [1, 2]
    assert found.closed.all()
    assert np.allclose(found.origin, pose.origin, rtol=0, atol=16 * EPS * pose.condition[0])


def test_of_many_each_is_corrected_to_what_it_is_alone_and_those_too_far_end_them(
    model: absolute.Model,
) -> None:
    mechanism = Mechanism(model)
    pose = assemble(mechanism)
    away = np.array([1e-12, 1e-3, 0.05, 1e-6, 0.2, 1e-4])
    starts, largest = moved_away(mechanism, pose, away), np.full(6, 0.1)
    target = np.repeat(mechanism.targets(mechanism.drawn_inputs)[0][None], 6, axis=0)
    many = newton(mechanism, pose, starts, target, largest)
    assert len(many.q) == 4
    assert many.closed.all()
    for k in range(4):
        alone = newton(mechanism, pose, starts[k : k + 1], target[:1], largest[:1])
        assert np.array_equal(alone.q[0], many.q[k])
        assert alone.corrections[0] == many.corrections[k]


def test_beyond_a_fold_nothing_closes(strut: absolute.Model) -> None:
    mechanism = Mechanism(strut)
    pose = assemble(mechanism)
    beyond = mechanism.targets(mechanism.drawn_inputs + np.array([[0.0, 500.0]]))[0]
    found = newton(mechanism, pose, pose.q, beyond, np.full(1, np.inf))
    assert not found.closed.any()
    assert found.corrections[0] > 1


def test_a_singular_matrix_has_no_solution_and_spoils_no_other() -> None:
    matrices, sides = np.random.default_rng(3).normal(size=(5, 4, 4)), np.ones((5, 4, 2))
    plain = solved(matrices.copy(), sides)
    matrices[2] = 0.0
    found = solved(matrices, sides)
    assert np.isnan(found[2]).all()
    others = [0, 1, 3, 4]
    assert np.array_equal(found[others], plain[others])


def test_the_condition_number_is_that_of_the_jacobian(model: absolute.Model) -> None:
    pose = assemble(Mechanism(model))
    assert pose.condition[0] == pytest.approx(np.linalg.cond(pose.jacobian[0], 1), rel=1e-12)


def test_rates_solve_their_equations_to_rounding(model: absolute.Model) -> None:
    mechanism = Mechanism(model)
    pose = assemble(mechanism)
    first, second = np.random.default_rng(7).normal(size=(2, 3, mechanism.stack.count))
    velocity, acceleration = rates(mechanism, pose, first, second)
    moving = np.zeros((3, pose.origin.shape[1], 2, 3))
    moving[:, 1:] = velocity.reshape(3, -1, 2, 3)
    drift = mechanism.stack.drift(pose.placed, moving)
    for found, side in ((velocity, first), (acceleration, second - drift)):
        left = np.abs(side - found @ pose.jacobian[0].T)
        assert (left <= 16 * EPS * (np.abs(found) @ np.abs(pose.jacobian[0]).T + np.abs(side))).all()
