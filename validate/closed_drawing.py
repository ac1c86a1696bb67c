"""Closes the drawing of a scene: moves its points to their positions in the assembled mechanism.

Drawn points often miss the joints a little. The solved car differs from the drawn car by this movement.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from pointcoord import AssemblyError, PointcoordError, Scene
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.mechanism.inputs import CHASSIS
from pointcoord.results.closing import Closing, closing
from pointcoord.simulation import scene_mechanism
from pointcoord.solve.assembly import close_drawing
from validate.arrays import Array


@dataclass(frozen=True)
class ClosedDrawing:
    """A drawing, solved at the drawn values of its inputs.

    Attributes:
        places: position of each point in the closed drawing, (3,), mm; empty if the drawing cannot be closed.
        closing: how far the points move; None if the drawing cannot be closed.
        words: the movement in words, or why the drawing cannot be closed.
    """

    scene: Scene
    mechanism: Mechanism
    places: Mapping[str, Array]
    closing: Closing | None
    words: str


def closed_drawing(scene: Scene) -> ClosedDrawing:
    """Close the drawing of a scene.

    Raises:
        SceneError: the hardpoints make no mechanism.
    """
    mechanism = scene_mechanism(scene)
    try:
        y = close_drawing(mechanism).y
    except AssemblyError as error:
        return ClosedDrawing(scene, mechanism, {}, None, f"this drawing cannot be closed: {error.problem}")
    unit, moved = float(mechanism.unit), closing(mechanism, y)
    places = {name: mechanism.origin + unit * place for name, place in mechanism.places(y).items()}
    return ClosedDrawing(scene, mechanism, places, moved, moved.words)


def closed_mechanism(drawing: ClosedDrawing) -> dict[str, Any]:
    """The flat mechanism with its points at their positions in the closed drawing.

    A slide along a fixed direction in a moving body turns with the body as the drawing closes. Such a slide
    is given a new point of the body to define its direction.
    """
    # Imported here: a plan and a picture do not need it.
    from scipy.spatial.transform import Rotation

    plain = drawing.scene.mechanism.plain(tuple(drawing.scene.inputs))
    drawn, places = plain["points"], dict(drawing.places)
    bodies, slides = dict(plain["bodies"]), dict(plain["slides"])
    for name, slide in slides.items():
        body, direction = slide["body"], drawing.mechanism.drawing.vectors.get(slide["along"])
        if body == CHASSIS or slide["along"] in drawn or direction is None:
            continue
        own, through = bodies[body], places[slide["through"]]
        before, now = (np.array([of[p] for p in own]) - of[slide["through"]] for of in (drawn, places))
        turn, _ = Rotation.align_vectors(now, before)
        end = f"{name}_end"
        places[end] = through + float(np.abs(now).max()) * turn.apply(direction)
        bodies[body], slides[name] = [*own, end], {**slide, "along": end}
    points = {point: place.tolist() for point, place in places.items()}
    return {**plain, "points": points, "bodies": bodies, "slides": slides}


def closing_of(scene: Scene) -> Closing | None:
    """How far the points move as the drawing closes; None if it makes no mechanism or cannot be closed."""
    try:
        return closed_drawing(scene).closing
    except PointcoordError:
        return None


def warnings_of(scene: Scene, moved: Closing | None) -> tuple[str, ...]:
    """Warnings about a drawing: a noticeable movement as it closes, and points that look wrong."""
    changed = (moved.words,) if moved is not None and moved.noticeable else ()
    return (*changed, *scene.mechanism.doubts)


def closing_data(moved: Closing | None) -> dict[str, Any] | None:
    """The movement of the points as plain data, mm."""
    if moved is None:
        return None
    return {"largest": moved.largest, "point": moved.point, "movements": dict(moved.movements)}
