"""A scene's drawing put together: where its points are then, and how far that is from where they are drawn.

A car that was drawn is another one than the car that is solved, by as much as its points move to close.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pointcoord import AssemblyError, PointcoordError, Scene
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.mechanism.inputs import CHASSIS
from pointcoord.results.closing import Closing, closing
from pointcoord.simulation import scene_mechanism
from pointcoord.solve.assembly import close_drawing

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ClosedDrawing:
    """A drawing, solved at its own inputs.

    Attributes:
        places: where its points are then, (3,), mm; empty if it cannot be closed.
        closing: how far they move; None if it cannot be closed.
        words: what closing does, or why it cannot be done.
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
    """The flat mechanism with its points where they are when the drawing is closed.

    A slide along a direction of the car that is fixed in a moving body turns with it as the drawing closes;
    so it runs towards a further point of that body.
    """
    # Imported here: a plan and a picture do without it.
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
    """How far the drawing's points move; None for one that makes no mechanism or does not close at all."""
    try:
        return closed_drawing(scene).closing
    except PointcoordError:
        return None


def warnings_of(scene: Scene, moved: Closing | None) -> tuple[str, ...]:
    """What the user should know of a drawing: a car that closing changes, and what looks odd in it."""
    changed = (moved.words,) if moved is not None and moved.noticeable else ()
    return (*changed, *scene.mechanism.doubts)


def closing_data(moved: Closing | None) -> dict[str, Any] | None:
    """The movement as plain data, mm."""
    if moved is None:
        return None
    return {"largest": moved.largest, "point": moved.point, "movements": dict(moved.movements)}
