"""Another definition of an angle.

Ours is projected: atan2(p, q) with p and q the components of a line l along two directions of the car. Other
sources print arcsin(p / |l|) (camber: Adams' turning tables; toe: OptimumK), the sine p / |l| itself, its
arctangent, the sine of the projected angle, and the slope p / q.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import partial

import numpy as np
from numpy.typing import NDArray

from pointcoord.effects.corner import Wheel
from pointcoord.effects.registry import angle_called
from pointcoord.numerics.rounding import EPS
from validate.diagnosis.evidence import Evidence, Row, kind_of
from validate.diagnosis.hypothesis import Hypothesis

Array = NDArray[np.float64]

DEFINITIONS: Mapping[str, Callable[[Array, Array, Array], Array]] = {
    "arcsin of the component, not projected": lambda p, q, n: np.arcsin(p / n),
    "arctan of the component of a unit vector": lambda p, q, n: np.arctan(p / n),
    "the component of a unit vector, no angle": lambda p, q, n: p / n,
    "the slope, no angle": lambda p, q, n: p / q,
    "the sine, no angle": lambda p, q, n: p / np.hypot(p, q),
}
"""By words, from p, q and the line's length."""
BACK: Mapping[str, Callable[[Array], Array]] = {
    "the slope, no angle": np.arctan,
    "the sine, no angle": lambda sine: np.arcsin(np.clip(sine, -1.0, 1.0)),
}
"""Of those that need no line the projected angle."""


def other_definitions(evidence: Evidence) -> Iterator[Hypothesis]:
    """Each definition, of all angles that disagree."""
    topology = evidence.scene.mechanism.topology
    for row in evidence.wrong:
        angle, wheel = angle_called(row[1]), Wheel.of(topology, row[1])
        if kind_of(row) != "car" or angle is None:
            continue
        start, end = (evidence.places(point) for point in angle.ends(wheel))
        if start is None or end is None:
            continue
        length = np.linalg.norm(end - start, axis=-1)
        axes = evidence.axes.on(wheel.side)
        p, q = (axes.component(end - start, direction) for direction in (angle.sine, angle.cosine))
        # The line is a difference of coordinates that are each rounded; a few such roundings.
        size = max(float(np.abs(start).max()), float(np.abs(end).max()))
        for words, rule in DEFINITIONS.items():
            with np.errstate(divide="ignore", invalid="ignore"):
                value = rule(p, q, length)
            if np.isfinite(value).all():
                allowed = evidence.rounded(row, value) + 8.0 * EPS * size / length
                undo = partial(_projected, BACK[words]) if words in BACK else None
                yield Hypothesis(words, words, {row: (value, allowed)}, cost=1.2, undo=undo)


def _projected(back: Callable[[Array], Array], row: Row, numbers: Array) -> Array:
    """The angles that numbers of a row stand for; those of other rows are no such numbers."""
    return back(numbers) if kind_of(row) == "car" else numbers
