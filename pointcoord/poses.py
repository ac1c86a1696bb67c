"""Many poses of one car at inputs that have nothing to do with each other, each with a proven bound."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pointcoord.data_classes import dataclass
from pointcoord.errors import InputOutOfRange, PointcoordError, UnknownName
from pointcoord.linkage.carried_points import carried_gain
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.rounding import EPS
from pointcoord.results.closing import closing
from pointcoord.scene.scene_file import Scene
from pointcoord.simulation import require_scene, require_the_drawn_car, scene_mechanism
from pointcoord.solve.assembly import close_drawing
from pointcoord.solve.unrelated_poses import solve_unrelated

Array = NDArray[np.float64]

# Poses whose points are placed at a time: their coordinates stay in a cache.
BLOCK = 2048


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
        InputOutOfRange: a value that is not finite or has no meaning.
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
    found = solve_unrelated(mechanism, driving, wanted)
    shift: Array | None = None
    for name, along in topology.chassis_motion.items():
        if name in flat:
            part = flat[name][:, None] * mechanism.drawing.vectors[along]
            shift = part if shift is None else shift + part
    shifted = 0.0 if shift is None else 2.0 * EPS * np.abs(shift).max(axis=-1)
    places = _positions(mechanism, found.unknowns, shift)
    position = {name: place.reshape(*shape, 3) for name, place in places.items()}
    gain = max(
        (
            carried_gain(mechanism.carrier_weights[n], mechanism.drawing, c)
            for n, c in topology.carried.items()
        ),
        default=1.0,
    )
    # Products of the weights and of edges below the mechanism's size round some ten times.
    carried = gain * (found.bound + 16.0 * EPS * float(mechanism.unit)) + shifted
    return SolvedPoses(
        MappingProxyType(position),
        (found.bound + shifted).reshape(shape),
        carried.reshape(shape),
        MappingProxyType({number: _error(status.error()) for number, status in found.failures.items()}),
    )


def _error(error: PointcoordError | None) -> PointcoordError:
    assert error is not None  # a pose that fails says why
    return error


def _positions(mechanism: Mechanism, unknowns: Array, shift: Array | None) -> dict[str, Array]:
    """Every point from the unknowns, shape (N, unknowns), each (N, 3), mm."""
    topology, layout, unit = mechanism.topology, mechanism.layout, float(mechanism.unit)
    count = len(unknowns)
    found = {name: np.empty((count, 3)) for name in topology.points}
    places = {name: layout.vector(name)[0] for name in topology.moving}
    for low in range(0, count, BLOCK):
        here = slice(low, low + BLOCK)
        block, added = unknowns[here], mechanism.origin if shift is None else mechanism.origin + shift[here]
        lost = np.isnan(block[:, 0])
        some = bool(lost.any())
        rows = {name: block[:, first : first + 3] for name, first in places.items()}
        for name, carriers in topology.carried.items():
            rows[name] = _carried(mechanism.carrier_weights[name], *(rows[carrier].T for carrier in carriers))
        for name in topology.points:
            place = found[name][here]
            np.multiply(rows[name] if name in rows else mechanism.drawing.vectors[name], unit, out=place)
            place += added
            if some:
                place[lost] = np.nan
    return found


def _carried(weights: Array, base: Array, first: Array, second: Array) -> Array:
    """A point that rides on three, from their coordinates, (3, N) each, in rows, (N, 3)."""
    (x1, y1, z1), (x2, y2, z2) = e1, e2 = first - base, second - base
    a, b, c = weights
    normal = np.stack([y1 * z2 - z1 * y2, z1 * x2 - x1 * z2, x1 * y2 - y1 * x2])
    return np.asarray((base + a * e1 + b * e2 + c * normal).T)
