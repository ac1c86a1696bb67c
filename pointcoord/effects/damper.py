"""The damper: how long it is."""

from __future__ import annotations

from pointcoord.effects.arithmetic import S, dot, root
from pointcoord.effects.car_number import CarNumbers, Number
from pointcoord.effects.corner import Corner


def damper_length(corner: Corner[S]) -> S:
    """The distance of the damper's two ends."""
    line = corner.seen.role("damper")
    return root(dot(line, line))


DAMPER = CarNumbers.of(
    "damper",
    "length of the damper, mm",
    Number("damper_length", "length of the damper", "", damper_length, ("damper",), needs_radius=False),
)
