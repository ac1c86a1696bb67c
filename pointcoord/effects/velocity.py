"""How fast every point goes."""

from __future__ import annotations

from pointcoord.effects.effect import Quantity
from pointcoord.effects.point_states import PointStates

VELOCITY = PointStates(
    name="velocity",
    gives="velocity of every point, mm/s",
    sign="components along the user's axes",
    derivative=1,
    quantities=(Quantity("velocity", "velocity", "mm/s", "point"),),
)
