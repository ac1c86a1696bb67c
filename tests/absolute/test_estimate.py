"""The estimate of errors by matrices is the one point by point."""

import kinds
import numpy as np
import plain_estimate
import pytest
from numpy.typing import NDArray

import absolute
from absolute.estimate import BodyMotion, estimate
from absolute.mechanism import Mechanism

Array = NDArray[np.float64]


@pytest.mark.parametrize("exact_inputs", [True, False])
def test_an_estimate_by_matrices_is_that_of_each_point_and_component(
    kind: kinds.Kind, model: absolute.Model, monkeypatch: pytest.MonkeyPatch, exact_inputs: bool
) -> None:
    t = np.linspace(0.0, 1.0, 40)
    inputs = kind.inputs(t)
    random = np.random.default_rng(5)
    chassis = random.normal(size=(40, 3, 3)) * 100.0
    doubts = None if exact_inputs else {"rack": 1e-9 * random.uniform(size=(40, 3))}
    compared = []

    def both(
        mechanism: Mechanism, motion: BodyMotion, series: Array, off: Array, carried: Array
    ) -> absolute.estimate.Errors:
        found = estimate(mechanism, motion, series, off, carried)
        plain = plain_estimate.estimate(mechanism, motion, series, off, carried)
        for quick, slow in zip(found, plain, strict=True):
            assert quick.keys() == slow.keys()
            for name, expected in slow.items():
                # Sums of some thirty magnitudes, none of which cancel, of numbers with some ten digits
                # to spare: the same terms in another order.
                assert np.allclose(quick[name], expected, rtol=1e-10, atol=0), name
                compared.append(name)
        return found

    def sampled(
        mechanism: Mechanism, motion: BodyMotion, series: Array, left: Array, conditions: bool
    ) -> tuple[Array, Array]:
        # Of exact inputs only some instants are computed: here all are.
        both(mechanism, motion, series, np.zeros_like(series), chassis)
        return plain_sampled(mechanism, motion, series, left, conditions)

    plain_sampled = absolute.results.sampled
    monkeypatch.setattr(absolute.results, "estimate", both)
    monkeypatch.setattr(absolute.results, "sampled", sampled)
    absolute.solve(model, inputs, chassis, errors=True, input_errors=doubts)
    assert {*model.points, *model.moving} <= set(compared)
