"""Errors and condition numbers that are interpolated between instants hold at each of them."""

from collections.abc import Callable

import kinds
import numpy as np
import pytest
from numpy.typing import NDArray

import absolute
from absolute import sampled_estimate
from absolute.estimate import BodyMotion, Sensitivity, totals
from absolute.mechanism import Mechanism
from absolute.sampled_estimate import BENT, DUST, MARGIN, sampled

Array = NDArray[np.float64]
Ways = dict[str, Callable[[Array], Array]]

# Seconds of the motions of `kinds` at which instants are, for an even parameter from 0 to 1.
WAYS: Ways = {
    "there": lambda s: s,
    "there and back": lambda s: np.sin(np.pi * s),
    "uneven": lambda s: np.clip(s + 0.3 * np.sin(40.0 * s) / 40.0, 0.0, 1.0),
    "standing": lambda s: np.clip(2.0 * s - 0.5, 0.0, 1.0),
}


class Compared:
    """Stands in for `sampled`; holds what it gives to what is computed at every instant."""

    def __init__(self) -> None:
        self.least, self.most, self.every, self.computed = np.inf, 0.0, 0, 0

    def __call__(
        self, mechanism: Mechanism, motion: BodyMotion, series: Array, left: Array, conditions: bool
    ) -> tuple[Array, Array]:
        found, numbers = sampled(mechanism, motion, series, left, conditions)
        exact, _ = totals(mechanism, motion, series, left)
        # Smaller numbers are made of the roundings of coefficients.
        kept = exact > DUST * exact.max(axis=-1, keepdims=True)
        shares = found[kept] / exact[kept]
        assert (
            found[~kept]
            <= exact[~kept]
            + 2.0 * DUST * np.broadcast_to(exact.max(axis=-1, keepdims=True), exact.shape)[~kept]
        ).all()
        stack = mechanism.stack
        shares = np.append(
            shares,
            numbers / np.linalg.cond(stack.jacobian(stack.place(motion.rotation, motion.origin))),
        )
        self.least, self.most = min(self.least, float(shares.min())), max(self.most, float(shares.max()))
        self.every += len(left)
        return found, numbers


def compared(
    model: absolute.Model, inputs: dict[str, Array], monkeypatch: pytest.MonkeyPatch, rates: bool = True
) -> Compared:
    """What solving a motion with errors leads to."""
    both, plain = Compared(), sampled_estimate.totals

    def counted(
        mechanism: Mechanism, motion: BodyMotion, series: Array, left: Array
    ) -> tuple[Array, Sensitivity]:
        both.computed += len(series)
        return plain(mechanism, motion, series, left)

    monkeypatch.setattr(sampled_estimate, "totals", counted)
    monkeypatch.setattr(absolute.results, "sampled", both)
    absolute.solve(model, inputs, rates=rates, conditions=True, errors=True)
    return both


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("rates", [True, False])
def test_an_interpolated_error_is_no_smaller_than_computed_and_little_larger(
    kind: kinds.Kind, model: absolute.Model, monkeypatch: pytest.MonkeyPatch, way: str, rates: bool
) -> None:
    both = compared(model, kind.inputs(WAYS[way](np.linspace(0.0, 1.0, 800))), monkeypatch, rates)
    assert both.every == 800
    assert both.computed < 0.5 * both.every
    # Another order of sums of positive numbers: some roundings.
    assert both.least >= 1.0 - 1e-12
    # MARGIN, what the middle allows, and dust on top of a number that is not much more.
    assert both.most <= 1.0 + MARGIN + 2.0 * BENT


def test_unrelated_instants_are_all_computed(
    kind: kinds.Kind, model: absolute.Model, monkeypatch: pytest.MonkeyPatch
) -> None:
    shuffled = np.random.default_rng(3).permutation(np.linspace(0.0, 1.0, 300))
    both = compared(model, kind.inputs(shuffled), monkeypatch)
    assert both.computed == both.every == 300
    assert both.least == both.most == 1.0


def test_an_instant_beside_the_others_is_computed(
    kind: kinds.Kind, model: absolute.Model, monkeypatch: pytest.MonkeyPatch
) -> None:
    # All but one stand still: a rate there, and a place there, are seen by no middle.
    for column, off in ((0, 1e-3), (1, 0.5), (2, 0.5)):
        inputs = kind.inputs(np.full(260, 0.5))
        inputs["arm_angle"][50, column] += off
        both = compared(model, inputs, monkeypatch)
        assert both.computed < 40
        assert both.least >= 1.0 - 1e-12
