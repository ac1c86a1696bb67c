"""Another definition of an angle.

Ours is projected: atan2(p, q) with p and q the components of a line along two directions of the car. With l
the line and r its third component, sources also print arcsin(p / |l|) (camber: Adams' turning tables; toe:
OptimumK), the sine p / |l| itself, the slope p / q, and the angle to the plane's other direction.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from pointcoord.effects.angle import Angle, WheelAngles
from pointcoord.effects.registry import EFFECTS
from pointcoord.numerics.rounding import EPS
from validate.diagnosis.evidence import Evidence, kind_of
from validate.diagnosis.hypothesis import Hypothesis, Kind

Array = NDArray[np.float64]

DEFINITIONS: Mapping[str, Callable[[Array, Array, Array], Array]] = {
    "arcsin of the component, not projected": lambda p, q, n: np.arcsin(p / n),
    "the angle to its perpendicular": lambda p, q, n: np.arctan2(q, p),
    "the angle between the line and the axis, in space": lambda p, q, n: np.arccos(q / n),
    "the angle to the opposite direction": lambda p, q, n: np.arctan2(p, -q),
    "the component of a unit vector, no angle": lambda p, q, n: p / n,
    "the slope, no angle": lambda p, q, n: p / q,
}
"""By words, from p, q and the line's length."""


class Definition(Kind):
    """The same line measured by another rule; or another line measured by ours."""

    name, opens = "definition", True

    def hypotheses(self, evidence: Evidence) -> Iterator[Hypothesis]:
        """Every definition of each angle that disagrees."""
        angles = {
            angle.name: angle
            for effect in EFFECTS.values()
            if isinstance(effect, WheelAngles)
            for angle in effect.angles
        }
        topology = evidence.scene.mechanism.topology
        for row in evidence.wrong:
            angle = angles.get(row[1])
            if kind_of(row) != "car" or angle is None:
                continue
            for words, rule in DEFINITIONS.items():
                yield from self._measured(evidence, row, angle, angle.ends(topology), words, rule)

    def _measured(
        self,
        evidence: Evidence,
        row: tuple[str, str],
        angle: Angle,
        ends: tuple[str, str],
        words: str,
        rule: Callable[[Array, Array, Array], Array],
    ) -> Iterator[Hypothesis]:
        start, end = (evidence.places(point) for point in ends)
        if start is None or end is None:
            return
        line = end - start
        length = np.linalg.norm(line, axis=-1)
        p, q = (evidence.axes.component(line, side) for side in (angle.sine, angle.cosine))
        with np.errstate(divide="ignore", invalid="ignore"):
            value = rule(p, q, length)
        if np.isfinite(value).all():
            # The line is a difference of coordinates that are each rounded; a few such roundings.
            size = max(float(np.abs(start).max()), float(np.abs(end).max()))
            allowed = evidence.rounded(row, value) + 8.0 * EPS * size / length
            yield Hypothesis(self.name, (row, words), words, {row: (value, allowed)}, cost=1.2)


KIND = Definition()
