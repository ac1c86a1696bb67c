"""How fast the velocity of every point changes."""

from __future__ import annotations

from pointcoord.effects.effect import Quantity
from pointcoord.effects.point_states import PointStates

ACCELERATION = PointStates(
    name="acceleration",
    gives="acceleration of every point, mm/s^2",
    sign="components along the user's axes",
    derivative=2,
    quantities=(Quantity("acceleration", "acceleration", "mm/s^2", "point"),),
)
