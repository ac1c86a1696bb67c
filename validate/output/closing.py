"""The closing movement of a scene's drawing, for people and for machines.

A car that was drawn is another one than the car that is solved, by as much as its points move to close.
"""

from __future__ import annotations

from typing import Any

from pointcoord import PointcoordError, Scene
from pointcoord.results.closing import Closing, closing
from pointcoord.simulation import scene_mechanism
from pointcoord.solve.assembly import close_drawing


def closing_of(scene: Scene) -> Closing | None:
    """How far the drawing's points move; None for one that makes no mechanism or does not close at all."""
    try:
        mechanism = scene_mechanism(scene)
        return closing(mechanism, close_drawing(mechanism).y)
    except PointcoordError:
        return None


def warnings_of(moved: Closing | None) -> tuple[str, ...]:
    """What the user should know of it."""
    return (moved.words,) if moved is not None and moved.noticeable else ()


def closing_data(moved: Closing | None) -> dict[str, Any] | None:
    """The movement as plain data, mm."""
    if moved is None:
        return None
    return {"largest": moved.largest, "point": moved.point, "movements": dict(moved.movements)}
