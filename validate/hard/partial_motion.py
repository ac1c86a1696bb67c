"""The part of a motion that an error keeps, held to the reference."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from pointcoord import Motion, Scene
from pointcoord.numerics.rounding import EPS
from validate.adjudication.reference_solution import inputs_at, reference_instant
from validate.formulations.input_rates import rates
from validate.reference import NoReferenceError

Array = NDArray[np.float64]

ROUNDINGS = 8.0  # of the estimate ROUNDINGS * eps * condition * size of a model without proven bounds


class Kept(Protocol):
    """What the absolute model keeps, apart from rates."""

    @property
    def position(self) -> Mapping[str, Array]:
        """Of every point, (N, 3), mm."""
        ...

    @property
    def condition(self) -> Array:
        """Condition number at each kept instant, (N,)."""
        ...


def fault_of_kept(reason: Exception, scene: Scene, end: float, driven: str) -> str:
    """What is wrong with the motion that an error keeps; nothing if it is right.

    It must hold every instant before the end, and every point of each within its bound of the reference.

    Args:
        reason: an error with the attribute `partial`.
        end: last value of the driven input.
    """
    partial: Motion | Kept | None = getattr(reason, "partial", None)
    values = rates(scene.inputs[driven], scene.instants)[:, 0]
    before = scene.instants[np.abs(values - values[0]) < abs(end - values[0])]
    if partial is None:
        return "the motion up to there is not kept" if len(before) else ""
    position = partial.position
    count = len(next(iter(position.values())))
    if count != len(before):
        return f"{count} instants are kept, and {len(before)} lie before the end"
    bounds = _bounds(partial, scene)
    for index, time in enumerate(before.tolist()):
        try:
            reference = reference_instant(scene, inputs_at(scene, time))
        except NoReferenceError as error:
            return f"the kept instant {index} has no reference: {error}"
        for name, place in position.items():
            off = float(np.abs(place[index] - reference.position_as_float(name)).max())
            if not off <= bounds[name][index]:
                return f"{name} of the kept instant {index} is off by {off:.3g} mm"
    return ""


def _bounds(partial: Motion | Kept, scene: Scene) -> dict[str, Array]:
    """Bound of every point at every kept instant, mm; the reference's own rounding added."""
    position = partial.position
    rounding = EPS * max(float(np.abs(place).max()) for place in position.values())
    corners = np.array(list(scene.mechanism.points.values()))
    size = float((corners.max(axis=0) - corners.min(axis=0)).max())
    if not isinstance(partial, Motion):
        return dict.fromkeys(position, ROUNDINGS * EPS * partial.condition * size + 2.0 * rounding)
    # A proven bound holds what lies between the solved and the reported places, so it would cover a
    # report that is wrong by itself: no more than rounding and the scene's tolerance may lie there.
    proof = partial.proof()
    estimate = ROUNDINGS * EPS * proof.condition * size + scene.tolerance
    return {
        name: np.minimum(proof.carried_bound, estimate * proof.carried_gain) + rounding
        if name in scene.mechanism.topology.carried
        else np.minimum(proof.bound, estimate) + rounding
        for name in position
    }
