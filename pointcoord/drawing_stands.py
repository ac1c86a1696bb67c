"""State of a drawing: the drawn input values, the range of each input from there, and the wheel angles.

Each input is driven alone, with the others held as drawn, along a path that cannot change branch (see
`assembly`), until no pose exists beyond.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from pointcoord.effects.car_number import WHEEL
from pointcoord.effects.effect import Poses
from pointcoord.effects.registry import EFFECTS
from pointcoord.linkage.directions import CarAxes
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.arrays import Array
from pointcoord.results.closing import Closing, closing
from pointcoord.scene.scene_file import Scene
from pointcoord.simulation import require_scene, scene_mechanism
from pointcoord.solve.assembly import close_drawing, driven_to, limiting
from pointcoord.solve.follower import follow
from pointcoord.solve.path import Path

WHOLE = 2.0 * np.pi  # rad


@dataclass(frozen=True)
class End:
    """An end of an input's range.

    Attributes:
        value: the last reachable value, rad or mm; infinite where the input can turn through a whole turn.
        limits: the links and joints that block each other there; empty where the input's own range ends, or
            where there is no end.
    """

    value: float
    limits: tuple[str, ...]


@dataclass(frozen=True)
class Standing:
    """A closed drawing, the range of its inputs, and its wheel angles.

    Attributes:
        inputs: drawn value of each input, rad or mm.
        reach: lower and upper end of each input, with the others as drawn.
        angles: wheel angles of the closed drawing by name, rad.
        closing: how far its points moved when the drawing was closed.
    """

    inputs: Mapping[str, float]
    reach: Mapping[str, tuple[End, End]]
    angles: Mapping[str, float]
    closing: Closing


def standing(scene: Scene) -> Standing:
    """Close a scene's drawing and find how far each input can go.

    Raises:
        SceneError: the hardpoints make no mechanism.
        AssemblyError: the drawing cannot be closed.

    >>> standing(Scene.load("double-wishbone")).inputs["rack"]
    0.0
    """
    mechanism, closed = _closed(scene)
    drawn, part = _drawn(mechanism), scene.mechanism
    angles = drawn_angles(mechanism, part.axes, part.effects, closed.y)
    return Standing(
        inputs=drawn,
        reach={name: _ends(mechanism, closed, name) for name in drawn},
        angles={name: float(angle) for name, angle in angles.items()},
        closing=closing(mechanism, closed.y),
    )


def drawn_inputs(scene: Scene) -> dict[str, float]:
    """The inputs' values in the closed drawing, without their ranges, rad or mm.

    Raises:
        SceneError, AssemblyError: as `standing`.
    """
    mechanism, _ = _closed(scene)
    return _drawn(mechanism)


def reach_of(scene: Scene, name: str) -> tuple[End, End]:
    """The lower and the upper end of one input, with the others as drawn.

    Raises:
        SceneError, AssemblyError: as `standing`.
    """
    return _ends(*_closed(scene), name)


def _closed(scene: Scene) -> tuple[Mechanism, Path]:
    require_scene(scene)
    mechanism = scene_mechanism(scene)
    return mechanism, close_drawing(mechanism)


def _drawn(mechanism: Mechanism) -> dict[str, float]:
    return {name: float(value) + 0.0 for name, value in mechanism.drawn_inputs.items()}


def drawn_angles(mechanism: Mechanism, axes: CarAxes, effects: Iterable[str], y: Array) -> dict[str, Array]:
    """The wheel angles that `effects` give for poses y, (..., size); each (...,), rad."""
    unit = mechanism.unit[..., None]
    places = {name: place * unit for name, place in mechanism.places(y).items()}
    poses = Poses(mechanism, axes, (places,), (places,))
    found: dict[str, Array] = {}
    for effect in (EFFECTS[name] for name in effects):
        if effect.quantities == (WHEEL,):
            for numbers in effect.evaluate(poses).values():
                found |= numbers
    return found


def _ends(mechanism: Mechanism, closed: Path, name: str) -> tuple[End, End]:
    """Both ends of one input, the lower value first."""
    if name in mechanism.topology.turning:
        return _end_of_turn(mechanism, closed, name, -1.0), _end_of_turn(mechanism, closed, name, 1.0)
    first = mechanism.map.unknowns
    drive, *others = (drive for drive in mechanism.topology.drives if drive.input == name)
    place = mechanism.layout.scalar(drive.coordinate)
    found = []
    for farthest in drive.extremes(mechanism.drawing):
        # Straight in the driven coordinate: the extreme may lie outside the input's valid values.
        target = closed.y[first:].copy()
        target[place - first] = farthest
        there = drive.input_value(farthest, mechanism.drawing)[..., None]
        for other in others:
            own = other.series(there, mechanism.drawing)[0]
            target[mechanism.layout.scalar(other.coordinate) - first] = own
        path = follow(mechanism.map, closed.y, target)
        value = float(drive.input_value(path.y[place], mechanism.drawing))
        found.append(End(value, _limits(mechanism, path)))
    low, high = sorted(found, key=lambda end: end.value)
    return low, high


def _end_of_turn(mechanism: Mechanism, closed: Path, name: str, side: float) -> End:
    drawn = _drawn(mechanism)
    wanted = {one: np.array(value) for one, value in drawn.items()}
    wanted[name] += side * WHOLE
    _, path = driven_to(mechanism, wanted, closed, 0.0)
    if path.done == 1.0:
        return End(side * np.inf, ())
    return End(drawn[name] + side * WHOLE * float(path.done), _limits(mechanism, path))


def _limits(mechanism: Mechanism, path: Path) -> tuple[str, ...]:
    if float(path.done) == 1.0:
        return ()
    return limiting(mechanism, path.y, path.factors.matrix, path.factors.row_scale)[1]
