"""The part of a motion that a refusal keeps, held to the reference."""

from __future__ import annotations

import numpy as np

from pointcoord import Scene
from pointcoord.numerics.rounding import EPS
from validate.adjudication.reference_solution import inputs_at, reference_instant
from validate.formulations.input_rates import rates
from validate.formulations.protocol import FormulationError
from validate.reference import NoReferenceError


def fault_of_kept(refusal: FormulationError, scene: Scene, end: float, driven: str) -> str:
    """What is wrong with the motion that a refusal keeps; nothing if it is right.

    It must hold every instant before the end, and every point of each within what is claimed of it, and the
    rounding of the reference to doubles.

    Args:
        end: last value of the driven input.
    """
    values = rates(scene.inputs[driven], scene.instants)[:, 0]
    before = scene.instants[np.abs(values - values[0]) < abs(end - values[0])]
    partial = refusal.partial
    if partial is None:
        return "the motion up to there is not kept" if len(before) else ""
    if len(partial.times) != len(before):
        return f"{len(partial.times)} instants are kept, and {len(before)} lie before the end"
    claims = partial.accuracy.claims["position"]
    for index, time in enumerate(before.tolist()):
        try:
            reference = reference_instant(scene, inputs_at(scene, time))
        except NoReferenceError as error:
            return f"the kept instant {index} has no reference: {error}"
        for name, places in partial.position.items():
            true = reference.position_as_float(name)
            off = np.abs(places[index] - true)
            if not (off <= claims[name][index] + EPS * np.abs(true)).all():
                return f"{name} of the kept instant {index} is off by {off.max():.3g} mm"
    return ""
