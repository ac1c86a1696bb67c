"""pointcoord as a formulation: by series, by Newton's method at instants, and as the paper prints it.

A comparison cannot show a fault that is smaller than the truncation error of one side. So a scene is solved
as finely as rounding allows, however coarse its own tolerance, unless the formulation is made with
`as_asked`. The error bounds include the truncation error in both cases.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pointcoord import (
    Motion,
    NotFollowed,
    PointcoordError,
    Scene,
    SceneError,
    SingularConfiguration,
    simulate,
)
from pointcoord.effects.registry import QUANTITIES
from pointcoord.method import Method
from pointcoord.results.proof import Proof
from pointcoord.simulation import finest_tolerance
from validate.arrays import Array, Flags
from validate.formulations.protocol import Accuracy, FormulationError, Solution, largest_at

UNKNOWN = 1e-9  # relative rounding error of an input above which fewer than nine of its digits are known


@dataclass(frozen=True)
class PointCoordinates:
    """pointcoord with one of its methods.

    Attributes:
        as_asked: whether to solve to the scene's own tolerance, as `simulate` does.
    """

    name: str
    method: Method
    as_asked: bool = False

    def solve(self, scene: Scene) -> Solution:
        """Solve a scene; the error bound of each number is proven (see `_bounds`).

        Raises:
            FormulationError: pointcoord refuses the scene, or cannot bound the error of a number.
            SceneError: the scene file itself is wrong.
        """
        try:
            motion = self._solved(scene)
        except SceneError:
            raise
        except PointcoordError as error:
            before = error.partial
            partial = None if before is None else (lambda: self._solution(scene, before))
            raise FormulationError(self.name, error, partial) from error
        return self._solution(scene, motion)

    def _solved(self, scene: Scene) -> Motion:
        """The motion, solved as finely as rounding allows, or as the scene asks with `as_asked`."""
        fine = min(scene.tolerance, finest_tolerance(scene))
        if self.as_asked or fine == scene.tolerance:
            return simulate(scene, self.method)
        try:
            return simulate(scene.model_copy(update={"tolerance": fine}), self.method)
        except NotFollowed:
            # A rough law may be solvable at the tolerance of the scene, but not at a finer one.
            return simulate(scene, self.method)

    def _solution(self, scene: Scene, motion: Motion) -> Solution:
        proof = motion.proof(rates=True)
        # A number without an error bound would agree with anything, so it is refused.
        _refuse_unproven(self.name, motion, proof, "pose", proof.bound + proof.carried_bound)
        uncertain = _uncertain_laws(scene, motion.times)
        bounds = {q: self._bounds(motion, proof, q, uncertain) for q in motion.numbers}
        accuracy = Accuracy(
            condition=proof.condition,
            claims={quantity: claims for quantity, (claims, _) in bounds.items()},
            proven=True,
            usual={quantity: usual for quantity, (_, usual) in bounds.items()},
        )
        return Solution(self.name, motion.times, motion.numbers, accuracy, motion.notes)

    def _bounds(
        self, motion: Motion, proof: Proof, quantity: str, uncertain: Flags
    ) -> tuple[dict[str, Array], Array]:
        """The error bound of each number, and the largest expected error at each instant, (N,).

        A bound is the smaller of the proven and the expected error: the proven error includes any fault of
        the method, so a fault would widen its own tolerance until it passed. Exception: if the terms of an
        input cancel until few digits are left, only the proof includes the effect, and is used alone.

        Args:
            uncertain: the instants of this exception, (N,).
        """
        claims, usual = dict[str, Array](), np.zeros(len(motion.times))
        for name, proven in proof.proven[quantity].items():
            expected = proof.expected[quantity][name]
            # NaN has no error; the comparison reports it.
            number = np.isfinite(motion.numbers[quantity][name])
            words = f"{QUANTITIES[quantity].words} of {name}"
            _refuse_unproven(self.name, motion, proof, words, largest_at(np.where(number, proven, 0.0)))
            capped = np.where(uncertain.reshape(-1, *[1] * (number.ndim - 1)), proven, expected)
            claims[name] = np.where(number, np.minimum(proven, capped), 0.0)
            known = np.where(number & np.isfinite(expected), expected, 0.0)
            np.maximum(usual, largest_at(known), out=usual)
        return claims, usual


def _uncertain_laws(scene: Scene, times: Array) -> Flags:
    """The times at which an input is known to fewer than nine digits of its largest value, (N,)."""
    uncertain = np.zeros(len(times), dtype=bool)
    for function in scene.functions.values():
        largest = float(np.abs(function.series(scene.instants, 0)).max())
        uncertain |= function.rounding(times) > UNKNOWN * largest
    return uncertain


def _refuse_unproven(who: str, motion: Motion, proof: Proof, what: str, bound: Array) -> None:
    unproven = ~np.isfinite(bound)
    if unproven.any():
        first = int(np.argmax(unproven))
        condition, when = float(proof.condition[first]), f"at t = {motion.times[first]:.10g} s"
        reason = SingularConfiguration(f"no error bound of the {what} can be proven", condition, when)
        raise FormulationError(who, reason)
