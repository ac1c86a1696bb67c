"""The estimate of errors by matrices is the one point by point."""

import kinds
import numpy as np
import plain_estimate
import pytest
from numpy.typing import NDArray

import absolute
from absolute.estimate import BodyMotion, named, totals
from absolute.mechanism import Mechanism

Array = NDArray[np.float64]


def test_an_estimate_by_matrices_is_that_of_each_point_and_component(
    kind: kinds.Kind, model: absolute.Model, monkeypatch: pytest.MonkeyPatch
) -> None:
    inputs = kind.inputs(np.linspace(0.0, 1.0, 40))
    chassis = np.random.default_rng(5).normal(size=(40, 3, 3)) * 100.0
    compared = []

    def both(
        mechanism: Mechanism, motion: BodyMotion, series: Array, left: Array, conditions: bool
    ) -> tuple[Array, Array]:
        found = named(mechanism, motion, chassis, totals(mechanism, motion, series, left)[0])
        plain = plain_estimate.estimate(mechanism, motion, series, left, chassis)
        for quick, slow in zip(found, plain, strict=True):
            assert quick.keys() == slow.keys()
            for name, expected in slow.items():
                # Sums of some thirty magnitudes, none of which cancel, of numbers with some ten digits
                # to spare: the same terms in another order.
                assert np.allclose(quick[name], expected, rtol=1e-10, atol=0), name
                compared.append(name)
        return sampled(mechanism, motion, series, left, conditions)

    sampled = absolute.results.sampled
    monkeypatch.setattr(absolute.results, "sampled", both)
    absolute.solve(model, inputs, chassis, errors=True)
    assert {*model.points, *model.moving} <= set(compared)


def test_instants_of_a_long_motion_have_the_errors_they_have_alone(
    model: absolute.Model, kind: kinds.Kind
) -> None:
    # More of them than are estimated together, and the chassis moves.
    t = np.linspace(0.0, 1.0, 70)
    inputs = kind.inputs(t)
    random = np.random.default_rng(6)
    chassis = random.normal(size=(70, 3, 3)) * 100.0
    long = absolute.solve(model, inputs, chassis, errors=True, conditions=True)
    for k in (0, 31, 32, 33, 63, 64, 69):
        one = slice(k, k + 1)
        alone = absolute.solve(
            model,
            {name: column[one] for name, column in inputs.items()},
            chassis[one],
            errors=True,
            conditions=True,
        )
        assert long.condition is not None
        assert alone.condition is not None
        assert long.condition[k] == pytest.approx(alone.condition[0], rel=1e-9)
        for kind_of in ("position_error", "velocity_error", "acceleration_error", "rotation_error"):
            for name, error in getattr(alone, kind_of).items():
                # The same pose to rounding: a handful of the numbers that are left of an equation differ.
                assert np.allclose(getattr(long, kind_of)[name][k], error[0], rtol=0.5), name


def test_nothing_is_told_that_is_not_asked_for(model: absolute.Model, kind: kinds.Kind) -> None:
    motion = absolute.solve(model, kind.inputs(np.linspace(0.0, 1.0, 3)))
    assert motion.condition is None
    assert not motion.position_error
    assert not motion.velocity_error
    assert not motion.acceleration_error
    assert not motion.rotation_error
    assert not motion.effects
    assert not motion.effect_errors
    assert motion.velocity.keys() == motion.acceleration.keys() == model.points.keys()
    still = absolute.solve(model, kind.inputs(np.linspace(0.0, 1.0, 3)), rates=False, errors=True)
    assert not still.velocity
    assert not still.angular_acceleration
    assert not still.acceleration_error
    assert still.position_error.keys() == model.points.keys()


def test_the_residual_is_told_in_millimetres(
    model: absolute.Model, kind: kinds.Kind, monkeypatch: pytest.MonkeyPatch
) -> None:
    # As if rows were off by so much of the size, which is the furthest that a point is drawn from the mean.
    off = np.array([0.25, 0.5, 0.125])
    solver = absolute.solve.__globals__
    refine = solver["refine"]
    monkeypatch.setitem(solver, "refine", lambda *arguments: refine(*arguments)._replace(residual=off))
    motion = absolute.solve(model, kind.inputs(np.linspace(0.0, 1.0, 3)))
    points = np.array(list(model.points.values()))
    size = np.linalg.norm(points - points.mean(axis=0), axis=1).max()
    assert motion.residual == pytest.approx(off * size, rel=1e-12)


def test_rates_of_a_car_at_rest_are_not_off_at_all(model: absolute.Model) -> None:
    # No row has a rate that may be rounded, however far the pose itself is off.
    drawn = dict(zip(model.inputs, Mechanism(model).drawn_inputs.tolist(), strict=True))
    motion = absolute.solve(
        model,
        {name: np.array([[value, 0.0, 0.0]]) for name, value in drawn.items()},
        errors=True,
    )
    assert all((error > 0.0).all() for error in motion.position_error.values())
    for errors in (
        motion.velocity_error,
        motion.acceleration_error,
        motion.angular_velocity_error,
        motion.angular_acceleration_error,
    ):
        assert errors
        assert not any(error.any() for error in errors.values())
