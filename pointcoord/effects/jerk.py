"""How fast the acceleration of every point changes."""

from __future__ import annotations

from pointcoord.effects.effect import Quantity
from pointcoord.effects.point_states import PointStates

JERK = PointStates(
    name="jerk",
    gives="jerk of every point, mm/s^3: how fast its acceleration changes",
    sign="components along the user's axes",
    derivative=3,
    quantities=(Quantity("jerk", "jerk", "mm/s^3", "point"),),
)
