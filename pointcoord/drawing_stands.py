"""Where a drawing stands: the inputs' drawn values, how far each can go from there, and the wheel's angles.

Each input is driven alone, the others held as drawn, along a path that cannot change branch (see `assembly`),
until it meets a pose beyond which there is none.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from pointcoord.data_classes import dataclass
from pointcoord.effects.effect import Poses
from pointcoord.effects.registry import EFFECTS
from pointcoord.linkage.car_axes import CarAxes
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.linear import smallest_left_singular_vector
from pointcoord.results.closing import Closing, closing
from pointcoord.scene.scene_file import Scene
from pointcoord.simulation import require_scene, scene_mechanism
from pointcoord.solve.assembly import Path, close_drawing, follow

Array = NDArray[np.float64]


@dataclass(frozen=True)
class End:
    """An end of an input's range.

    Attributes:
        value: the last reachable value, rad or mm.
        limits: the links and joints that hold each other there; empty where the input itself ends.
    """

    value: float
    limits: tuple[str, ...]


@dataclass(frozen=True)
class Standing:
    """A drawing, closed, and what it can do.

    Attributes:
        inputs: drawn value of each input, rad or mm.
        reach: the lower and the upper end of each input, the others as drawn.
        angles: of the closed drawing, by name, rad.
        closing: how far its points moved to close.
    """

    inputs: Mapping[str, float]
    reach: Mapping[str, tuple[End, End]]
    angles: Mapping[str, float]
    closing: Closing


def standing(scene: Scene) -> Standing:
    """Close a scene's drawing and try how far its inputs go.

    Raises:
        SceneError: the hardpoints make no mechanism.
        AssemblyError: the drawing cannot be closed.

    >>> standing(Scene.load("double-wishbone")).inputs["rack"]
    0.0
    """
    require_scene(scene)
    mechanism = scene_mechanism(scene)
    closed = close_drawing(mechanism)
    first = mechanism.map.unknowns
    drawn = {name: float(value) + 0.0 for name, value in mechanism.input_values(closed.y[first:]).items()}
    return Standing(
        inputs=drawn,
        reach={name: _ends(mechanism, closed, name) for name in drawn},
        angles=_angles(mechanism, closed.y, CarAxes.of(mechanism.drawing, scene.mechanism.outboard)),
        closing=closing(mechanism, closed.y),
    )


def _angles(mechanism: Mechanism, y: Array, axes: CarAxes) -> dict[str, float]:
    """Every number of the whole car that a pose has by itself."""
    places = {name: place * mechanism.unit for name, place in mechanism.places(y).items()}
    poses = Poses(mechanism, axes, states=(places,), added=(None,))
    found: dict[str, float] = {}
    for effect in EFFECTS.values():
        if effect.derivative == 0:
            for numbers in effect.evaluate(poses).values():
                found |= {name: float(number) for name, number in numbers.items()}
    return found


def _ends(mechanism: Mechanism, closed: Path, name: str) -> tuple[End, End]:
    """Both ends of one input, the lower value first."""
    first = mechanism.map.unknowns
    (drive,) = (drive for drive in mechanism.topology.drives if drive.input == name)
    place = mechanism.layout.scalar(drive.coordinate)
    found = []
    for farthest in drive.extremes(mechanism.drawing):
        target = closed.y[first:].copy()
        target[place - first] = farthest
        path = follow(mechanism.map, closed.y, target)
        value = float(drive.input_value(path.y[place], mechanism.drawing))
        stopped = float(path.done) < 1.0
        forces = smallest_left_singular_vector(path.factors.matrix)
        limits = mechanism.topology.strongest(forces) if stopped else ()
        found.append(End(value, limits))
    low, high = sorted(found, key=lambda end: end.value)
    return low, high
