"""Where a drawing stands: the inputs' drawn values, how far each can go from there, and the wheel's angles.

Each input is driven alone, the others held as drawn, along a path that cannot change branch (see `assembly`),
until it meets a pose beyond which there is none.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pointcoord.effects.effect import Poses
from pointcoord.effects.registry import EFFECTS
from pointcoord.linkage.car_axes import CarAxes
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.linear import smallest_left_singular_vector
from pointcoord.results.closing import Closing, closing
from pointcoord.scene.scene_file import Scene
from pointcoord.simulation import require_scene, scene_mechanism
from pointcoord.solve.assembly import close_drawing, driven_to
from pointcoord.solve.follower import Path

Array = NDArray[np.float64]

WHOLE = 2.0 * np.pi  # rad


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
    mechanism, closed = _closed(scene)
    drawn = _drawn(mechanism, closed)
    return Standing(
        inputs=drawn,
        reach={name: _ends(mechanism, closed, name) for name in drawn},
        angles=_angles(scene, mechanism, closed.y, CarAxes.of(mechanism.drawing, scene.mechanism.outboard)),
        closing=closing(mechanism, closed.y),
    )


def drawn_inputs(scene: Scene) -> dict[str, float]:
    """The inputs' values in the closed drawing alone, rad or mm.

    Raises:
        SceneError, AssemblyError: as `standing`.
    """
    return _drawn(*_closed(scene))


def reach_of(scene: Scene, name: str) -> tuple[End, End]:
    """The lower and the upper end of one input alone, the others as drawn.

    Raises:
        SceneError, AssemblyError: as `standing`.
    """
    return _ends(*_closed(scene), name)


def _closed(scene: Scene) -> tuple[Mechanism, Path]:
    require_scene(scene)
    mechanism = scene_mechanism(scene)
    return mechanism, close_drawing(mechanism)


def _drawn(mechanism: Mechanism, closed: Path) -> dict[str, float]:
    known = closed.y[mechanism.map.unknowns :]
    return {name: float(value) + 0.0 for name, value in mechanism.input_values(known).items()}


def _angles(scene: Scene, mechanism: Mechanism, y: Array, axes: CarAxes) -> dict[str, float]:
    """Every number of the whole car that a pose has by itself."""
    places = {name: place * mechanism.unit for name, place in mechanism.places(y).items()}
    poses = Poses(mechanism, axes, states=(places,), added=(None,))
    found: dict[str, float] = {}
    for effect in EFFECTS.values():
        if effect.derivative == 0 and not effect.refusal(mechanism.topology, scene.mechanism.points):
            for numbers in effect.evaluate(poses).values():
                found |= {name: float(number) for name, number in numbers.items()}
    return found


def _ends(mechanism: Mechanism, closed: Path, name: str) -> tuple[End, End]:
    """Both ends of one input, the lower value first; of a turn a whole one to either side at most."""
    drawn = _drawn(mechanism, closed)
    drive = next(drive for drive in mechanism.topology.drives if drive.input == name)
    turns = name in mechanism.topology.turning
    place = mechanism.layout.scalar(drive.coordinate)
    if turns:
        farthest = [drawn[name] - WHOLE, drawn[name] + WHOLE]
    else:
        extremes = np.array(drive.extremes(mechanism.drawing))
        farthest = drive.input_value(extremes, mechanism.drawing).tolist()
    found = []
    for value in farthest:
        wanted = {**drawn, name: value}
        _, path = driven_to(mechanism, {one: np.array(number) for one, number in wanted.items()}, closed, 0.0)
        done = float(path.done)
        if turns:
            value = drawn[name] + done * (value - drawn[name])
        else:
            value = float(drive.input_value(path.y[place], mechanism.drawing))
        forces = smallest_left_singular_vector(path.factors.matrix)
        found.append(End(value, mechanism.topology.strongest(forces) if done < 1.0 else ()))
    low, high = sorted(found, key=lambda end: end.value)
    return low, high
