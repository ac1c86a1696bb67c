r"""Many poses of one car at unrelated input values, each with a proven error bound.

Patches cover the requested inputs outwards from the drawing's pose (see `patches.flood`). A pose on a patch
is a sum of the patch's series, within the patch's proven bound. Poses that no patch covers, and all poses
where there are few, are each followed along a separate path from the closed drawing and proven singly (see
`numerics.kantorovich`). Where a path ends early, the error says what stops it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from pointcoord.effects.registry import EFFECTS, plan_effects
from pointcoord.errors import AssemblyError, InputOutOfRange, PointcoordError, UnknownName
from pointcoord.linkage.chassis import SPREAD, ChassisMotion
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.mechanism.freedoms import locked
from pointcoord.numerics.arrays import Array, Flags, Indices
from pointcoord.numerics.rounding import EPS
from pointcoord.patches.domain import Domain, widened
from pointcoord.patches.flood import Limits, flood, start_at_drawing
from pointcoord.patches.lookup import Marked
from pointcoord.patches.reported_points import moving_points
from pointcoord.patches.way_map import HALVINGS, MOST
from pointcoord.results.closing import closing
from pointcoord.results.readout import Laws, Readout
from pointcoord.results.samples import Channel, Named
from pointcoord.scene.scene_file import Scene
from pointcoord.simulation import require_scene, require_the_drawn_car, scene_mechanism
from pointcoord.solve.assembly import assemble, assembled, close_drawing
from pointcoord.solve.path import Path

# From FEW poses on a map pays, with one factorisation per WORTH poses. For a strut, an off-axis strut and a
# double wishbone, 100 poses on separate paths took 40, 44 and 24 ms, and maps 40 to 90 ms.
FEW, WORTH = 200, 2
# Separate paths followed at a time: their factors take some 10 MB.
PATHS = 256


@dataclass(frozen=True, repr=False)
class SolvedPoses(Named):
    """Poses for inputs of shape (...).

    Attributes:
        numbers: by quantity and name, (..., 3), mm, for points and (...) for numbers of the car. Positions of
            every point, and those of the scene's effects that depend on positions only; NaN without a pose.
        bound: error bound of every coordinate of the solved points against the exact assembly, (...), mm;
            infinite where there is no pose. carried_bound: error bound of the points fixed to a body.
        failures: index in the flattened inputs -> why there is no pose.
    """

    numbers: Mapping[str, Channel]
    bound: Array
    carried_bound: Array
    failures: Mapping[int, PointcoordError]

    @property
    def solved(self) -> Flags:
        """Where there is a pose, (...)."""
        return np.isfinite(self.bound)

    def __repr__(self) -> str:
        largest = float(np.max(self.bound, initial=0.0, where=self.solved))
        failed = f", {len(self.failures)} failed" if self.failures else ""
        return f"<SolvedPoses: {int(self.solved.sum())} within {largest:.2g} mm{failed}>"


def solve_poses(scene: Scene, inputs: Mapping[str, ArrayLike], tolerance: float | None = None) -> SolvedPoses:
    """Solve a scene's suspension at any inputs, whatever the scene's own laws and instants.

    Inputs that broadcast to two dimensions are a grid, such as travel by rack. Results are positions and
    those of the scene's effects that depend on positions only, including gradients.

    Every pose is proven to lie on the branch of the drawing. For poses in the order of a motion `simulate` is
    quicker, and for very many poses of one car `kinematic_map`.

    Args:
        inputs: values of every input, rad or mm, of any shapes that broadcast; chassis inputs are zero
            unless given.
        tolerance: error bound wanted for positions, mm; the scene's unless given. Rounding may make the bound
            larger.
    Raises:
        SceneError: the hardpoints do not make a mechanism, or closing the drawing changes the car too much.
        UnknownName: an input that the suspension does not have, or a missing input.
        InputOutOfRange: an input value or a tolerance that is not finite or out of range.
        AssemblyError: the drawing cannot be closed.

    >>> angles, racks = np.linspace(1.5, 1.8, 7)[:, None], np.linspace(-10.0, 10.0, 5)
    >>> solve_poses(Scene.load("bounce"), {"arm_angle": angles, "rack": racks}).position["wheel_centre"].shape
    (7, 5, 3)
    """
    require_scene(scene)
    solver = PoseSolver(scene, scene_mechanism(scene))
    topology = solver.mechanism.topology
    for name in inputs:
        if name not in topology.inputs:
            raise UnknownName("input", name, topology.inputs)
    for name in topology.required_inputs:
        if name not in inputs:
            raise UnknownName("given input", name, inputs)
    return solver.solve(inputs, tolerance)


@dataclass(frozen=True, eq=False)
class PoseSolver:
    """Solves poses of one car at any inputs, more than once; its drawing is closed only once."""

    scene: Scene
    mechanism: Mechanism

    @cached_property
    def closed(self) -> Path:
        """The closed drawing, from which every pose is reached.

        Raises:
            AssemblyError: it cannot be closed.
        """
        return close_drawing(self.mechanism)

    @cached_property
    def readout(self) -> Readout:
        """Evaluates the effects that need positions only."""
        plan = plan_effects(name for name in self.scene.effects if EFFECTS[name].derivative == 0)
        chassis = ChassisMotion.of(self.mechanism, {})
        return Readout(self.mechanism, plan, chassis, self.scene.mechanism.axes)

    def laws(self, inputs: Mapping[str, Array]) -> Laws:
        """The values of those inputs that move the chassis."""
        directions = self.readout.chassis.directions
        return {name: [value] for name, value in inputs.items() if name in directions}

    def solve(self, inputs: Mapping[str, ArrayLike], tolerance: float | None = None) -> SolvedPoses:
        """As `solve_poses`, without checking the names of the inputs."""
        scene, mechanism = self.scene, self.mechanism
        topology = mechanism.topology
        values = {name: np.asarray(value, dtype=float) for name, value in inputs.items()}
        for name, value in values.items():
            if not np.isfinite(value).all():
                raise InputOutOfRange(name, float(value[~np.isfinite(value)].flat[0]), "finite values")
        shape = np.broadcast_shapes(*(value.shape for value in values.values()))
        flat = {name: np.broadcast_to(value, shape).ravel() for name, value in values.items()}
        wanted = scene.tolerance if tolerance is None else tolerance
        if not (np.isfinite(wanted) and wanted > 0.0):
            raise InputOutOfRange("tolerance", wanted, "a finite number of mm above 0")
        closed, readout = self.closed, self.readout
        require_the_drawn_car(scene, closing(mechanism, closed.y))

        count = int(np.prod(shape))
        rows, bounds = readout.room(count), np.full((2, count), np.inf)
        states = readout.states(rows)
        # The first rows of the table belong to the points that move.
        moving = rows[: 3 * len(moving_points(topology))]
        moving[...] = np.nan
        driving = {name: flat[name] for name in topology.required_inputs}
        # A map gives positions but not the coordinates that effects need for derivatives along a path.
        y = np.tile(closed.y, (count, 1)) if readout.plan.along_ways else None
        rest = np.arange(count)
        # Redundant rows that are left out of the equations must be checked pose by pose.
        if count >= FEW and y is None and not topology.left_out:
            rest = rest[~_by_patches(mechanism, closed, driving, wanted, moving, bounds)]
        failures: dict[int, PointcoordError] = {}
        for low in range(0, len(rest), PATHS):
            failures |= _by_paths(mechanism, closed, driving, rest[low : low + PATHS], moving, bounds, y)

        farthest = np.max([np.sqrt((place**2).sum(axis=-1)) for place in states[0].values()], axis=0)
        laws = self.laws(flat)
        readout.complete(laws, states, rows, y)
        rows[:, ~np.isfinite(bounds[0])] = np.nan
        rounded, spread = _rounded(readout.chassis, laws, farthest, float(np.abs(mechanism.origin).max()))
        solved, carried = ((spread * bound + rounded).reshape(shape) for bound in bounds)
        numbers = readout.table.named(np.zeros(count), rows).shaped(shape).numbers
        return SolvedPoses(numbers, solved, carried, dict(sorted(failures.items())))

    def coordinates(self, inputs: Mapping[str, Array]) -> Array:
        """Coordinates y of poses, each reached on its own path from the drawing, (N, size).

        Args:
            inputs: those that drive the linkage, each (N,), rad or mm.
        Raises:
            AssemblyError: a pose on a path is singular.
        """
        parts = []
        for low in range(0, len(next(iter(inputs.values()))), PATHS):
            some = {name: value[low : low + PATHS] for name, value in inputs.items()}
            parts.append(assemble(self.mechanism, some, closed=self.closed).y)
        return np.concatenate(parts)


def _by_patches(
    mechanism: Mechanism,
    closed: Path,
    inputs: Mapping[str, Array],
    tolerance: float,
    rows: Array,
    bounds: Array,
) -> Flags:
    """Write the poses that patches cover into rows (3 points, N) and bounds (2, N); returns which, (N,)."""
    count = rows.shape[1]
    nobody = np.zeros(count, dtype=bool)
    ranges = {name: (float(values.min()), float(values.max())) for name, values in inputs.items()}
    ranges = {name: widened(*ends) if ends[0] < ends[1] else ends for name, ends in ranges.items()}
    free = sum(low < high for low, high in ranges.values())
    if free not in HALVINGS:
        return nobody
    domain = Domain(mechanism, ranges, HALVINGS[free])
    values = np.stack([inputs[name] for name in domain.free], axis=-1)
    limits = Limits(tolerance, most=MOST, effort=count // WORTH)
    try:
        start = start_at_drawing(domain, closed)
        patches = flood(domain, limits, start, Marked.touched_by(domain, values, values)).patches
    except (AssemblyError, InputOutOfRange):
        # Following each pose separately will tell which one fails.
        return nobody
    number = patches.lookup.at(values)
    covered = np.flatnonzero(number >= 0)
    if covered.size:
        number, off = number[covered], patches.off.value
        (rows[:, covered],) = patches.sums(patches.coefficients, [values[covered]], number)
        solved = 3 * len(mechanism.topology.moving)
        origin = EPS * float(np.abs(mechanism.origin).max())
        bounds[0, covered] = off[:, :solved].max(axis=-1)[number] + origin
        bounds[1, covered] = off.max(axis=-1)[number] + origin
    return np.asarray(np.isfinite(bounds[0]))


def _by_paths(
    mechanism: Mechanism,
    closed: Path,
    inputs: Mapping[str, Array],
    some: Indices,
    rows: Array,
    bounds: Array,
    y: Array | None,
) -> dict[int, PointcoordError]:
    """Write the poses that separate paths reach into rows and bounds; returns the errors of the others."""
    topology, unit = mechanism.topology, float(mechanism.unit)
    wanted = {name: values[some] for name, values in inputs.items()}
    pose, blocked = assembled(mechanism, wanted, closed, None, 0.0)
    stopped: dict[int, PointcoordError] = {**blocked}
    whole = np.array([place for place in range(len(some)) if place not in stopped], dtype=np.intp)
    violated = locked(mechanism, pose.y[whole], pose.bound[whole] / unit)
    stopped |= {int(whole[place]): error for place, error in violated.items()}
    done = np.array([place not in stopped for place in range(len(some))])
    own, places = some[done], mechanism.places(pose.y[done])
    rows[:, own] = unit * np.concatenate([places[name] for name in moving_points(topology)], axis=-1).T
    bounds[0, own] = pose.bound[done]
    if y is not None:
        y[own] = pose.y[done]
    # Products of weights and edges, which are shorter than the mechanism, take about ten roundings.
    bounds[1, own] = max(1.0, mechanism.carried_gain) * (pose.bound[done] + 16.0 * EPS * unit)
    return {int(some[place]): error for place, error in stopped.items()}


def _rounded(chassis: ChassisMotion, laws: Laws, farthest: Array, origin: float) -> tuple[Array, float]:
    """Rounding error of moving points with the chassis, (N,), mm; and the factor by which rotation may
    enlarge the error of a coordinate.

    Args:
        farthest: distance of the farthest point from the mechanism's origin, (N,), mm.
        origin: largest coordinate of the mechanism's origin, mm.
    """
    shift = np.abs(sum(chassis.shifts(laws), np.zeros(3))).max(axis=-1)
    # The displacement is a sum of products, added to the origin and then to a position.
    rounded = np.where(shift > 0.0, 2.0 * EPS * shift + EPS * (farthest + origin), 0.0)
    centres = [chassis.centres[name] for name in laws if name in chassis.centres]
    if not centres:
        return rounded, 1.0
    # A rotation takes some 40 roundings of an arm from its centre, which is no longer than this. Later
    # rotations turn the rounding error of earlier ones.
    arm = farthest + 2.0 * sum(float(np.linalg.norm(centre)) for centre in centres)
    return rounded + 64.0 * EPS * len(centres) * arm, SPREAD
