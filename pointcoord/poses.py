"""Many poses of one car at inputs that have nothing to do with each other, each with a proven bound."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pointcoord.errors import InputOutOfRange, PointcoordError, UnknownName
from pointcoord.linkage.chassis import SPREAD, ChassisMotion
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.rounding import EPS
from pointcoord.numerics.vectors import lengths
from pointcoord.patches.unrelated_poses import solve_unrelated
from pointcoord.results.closing import closing
from pointcoord.scene.scene_file import Scene
from pointcoord.simulation import require_scene, require_the_drawn_car, scene_mechanism
from pointcoord.solve.assembly import close_drawing

Array = NDArray[np.float64]


@dataclass(frozen=True)
class SolvedPoses:
    """Poses for inputs of shape (...).

    Attributes:
        position: of every point, (..., 3), mm; NaN where there is no pose.
        bound: how far any coordinate of a point that is solved for may be from the exact assembly, (...), mm;
            infinite where there is no pose. carried_bound: the same of points that ride on a body.
        failures: by place in the flattened inputs, why there is no pose.
    """

    position: Mapping[str, Array]
    bound: Array
    carried_bound: Array
    failures: Mapping[int, PointcoordError]

    @property
    def solved(self) -> NDArray[np.bool_]:
        """Where there is a pose, (...)."""
        return np.isfinite(self.bound)

    def __repr__(self) -> str:
        """In a line: how many poses, and the largest bound."""
        largest = float(np.max(self.bound, initial=0.0, where=self.solved))
        failed = f", {len(self.failures)} failed" if self.failures else ""
        return f"<SolvedPoses: {int(self.solved.sum())} within {largest:.2g} mm{failed}>"


def solve_poses(scene: Scene, inputs: Mapping[str, ArrayLike], tolerance: float | None = None) -> SolvedPoses:
    """Solve a scene's suspension at any inputs, whatever the scene's own laws and instants.

    Every pose is on the branch of the drawing, by proof. For poses in the order of a motion `simulate` is
    quicker, and for very many of one car `kinematic_map`.

    Args:
        inputs: values of every input, rad or mm, of any shapes that broadcast; what moves the chassis is zero
            unless given.
        tolerance: bound that positions should keep, mm; the scene's own unless given. Rounding may leave
            more.
    Raises:
        SceneError: the hardpoints do not make a mechanism, or closing the drawing makes another car of it.
        UnknownName: an input that the suspension does not have, or one that is missing.
        InputOutOfRange: a value that is not finite or has no meaning; a tolerance too.
        AssemblyError: the drawing cannot be closed.

    >>> angles, racks = np.linspace(1.5, 1.8, 7)[:, None], np.linspace(-10.0, 10.0, 5)
    >>> solve_poses(Scene.load("bounce"), {"arm_angle": angles, "rack": racks}).position["wheel_centre"].shape
    (7, 5, 3)
    """
    require_scene(scene)
    mechanism = scene_mechanism(scene)
    topology = mechanism.topology
    for name in inputs:
        if name not in topology.inputs:
            raise UnknownName("input", name, topology.inputs)
    for name in topology.required_inputs:
        if name not in inputs:
            raise UnknownName("given input", name, inputs)
    values = {name: np.asarray(value, dtype=float) for name, value in inputs.items()}
    for name, value in values.items():
        if not np.isfinite(value).all():
            raise InputOutOfRange(name, float(value[~np.isfinite(value)].flat[0]), "finite values")
    shape = np.broadcast_shapes(*(value.shape for value in values.values()))
    flat = {name: np.broadcast_to(value, shape).ravel() for name, value in values.items()}
    require_the_drawn_car(scene, closing(mechanism, close_drawing(mechanism).y))
    driving = {name: flat[name] for name in topology.required_inputs}
    wanted = scene.tolerance if tolerance is None else tolerance
    if not (np.isfinite(wanted) and wanted > 0.0):
        raise InputOutOfRange("tolerance", wanted, "a finite number of mm above 0")
    found = solve_unrelated(mechanism, driving, wanted)
    unit = float(mechanism.unit)
    local = {
        name: found.places.get(
            name, np.broadcast_to(mechanism.drawing.vectors[name] * unit, (len(found.bound), 3))
        )
        for name in topology.points
    }
    added, rounded, spread = _moved(mechanism, flat, local)
    lost = ~np.isfinite(found.bound)
    position = {}
    for name, place in local.items():
        there = place + added
        there[lost] = np.nan
        position[name] = there.reshape(*shape, 3)
    return SolvedPoses(
        MappingProxyType(position),
        (spread * found.bound + rounded).reshape(shape),
        (spread * found.carried_bound + rounded).reshape(shape),
        MappingProxyType(dict(sorted(found.failures.items()))),
    )


def _moved(
    mechanism: Mechanism, inputs: Mapping[str, Array], local: dict[str, Array]
) -> tuple[Array, Array, float]:
    """Turn points with the chassis, in place; what is then to be added to them.

    Args:
        inputs: values of every input, each (N,). local: points, each (N, 3), mm from the mechanism's origin.
    Returns:
        What is added, (N, 3) or (3,), mm; what turning and adding rounds, (N,), mm; and how many times as far
        turning makes a coordinate be off.
    """
    chassis = ChassisMotion.of(mechanism, {})
    moving = {name: value for name, value in inputs.items() if name in chassis.directions}
    shift = sum(chassis.shifts({name: [value] for name, value in moving.items()}), np.zeros(3))
    rounded = 2.0 * EPS * np.abs(shift).max(axis=-1)
    centres = [chassis.centres[name] for name in moving if name in chassis.centres]
    if not centres:
        return mechanism.origin + shift, rounded, 1.0
    (turned,) = chassis.turned_by({name: [value] for name, value in moving.items()}, [local])
    local |= turned
    farthest = np.max([lengths(place) for place in local.values()], axis=0)
    # A turn takes some 40 roundings of an arm from its centre, which is no longer than this; what it leaves
    # is turned on by those after it.
    arm = farthest + 2.0 * sum(float(np.linalg.norm(centre)) for centre in centres)
    return mechanism.origin + shift, rounded + 64.0 * EPS * len(centres) * arm, SPREAD
