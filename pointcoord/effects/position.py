"""Where every point is: what every motion reports, whatever its scene asks for."""

from __future__ import annotations

from pointcoord.effects.effect import Quantity
from pointcoord.effects.point_states import PointStates

POSITION = PointStates(
    name="position",
    gives="position of every point, mm",
    sign="components along the user's axes",
    derivative=0,
    quantities=(Quantity("position", "position", "mm", "point"),),
)
