r"""Assembly: from the drawing to a pose, along a path that cannot change branch (see `follower`).

The drawing is first assembled at its own inputs. Then the inputs move from there to the wanted inputs. Where
a path stops, a set of forces in the links is in balance with itself: the links that carry these forces are
reported as the limit.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from pointcoord.errors import AssemblyError
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.arrays import Array, Flags, Indices
from pointcoord.numerics.counters import Work
from pointcoord.numerics.linear import Factors, factorise, smallest_singular_vectors
from pointcoord.solve.follower import Law, follow
from pointcoord.solve.path import Path

# Largest rotation in one step, rad: above pi the two ends do not show which way round the input goes.
LONGEST = 1.0


@dataclass(frozen=True)
class Pose(Path):
    """One assembled pose or a batch of assembled poses.

    Attributes:
        mechanism: the assembled mechanism; lengths are in its units.
    """

    mechanism: Mechanism

    def taken(self, members: Indices) -> Pose:
        """Some members of a batch of one dimension."""
        return replace(super().taken(members), mechanism=self.mechanism.taken(members))

    @cached_property
    def residual(self) -> Array:
        """Largest row of C(y), shape (...,), in the mechanism's units (squared for links)."""
        return np.asarray(np.abs(self.mechanism.map.residual(self.y)).max(axis=-1))

    @property
    def condition(self) -> Array:
        """Condition number of the Jacobian, rows scaled, maximum norm, shape (...,)."""
        return self.factors.condition

    @cached_property
    def bound(self) -> Array:
        """Proven distance of every coordinate of the solved points to the exact assembly, shape (...,), mm.

        Infinite where nothing is proven. See `kantorovich` for the errors that it covers. Computed when read.
        """
        # Imported here, like all modules that prove: most runs read no bound of a pose.
        from pointcoord.bounds.certified_poses import pose_bound

        return pose_bound(self.mechanism, self.y, self.factors)


def close_drawing(mechanism: Mechanism, instant: float | None = None, tolerance: float = 0.0) -> Path:
    """The drawing assembled at its own inputs.

    Args:
        tolerance: see `follow`.
    Raises:
        AssemblyError: the drawing cannot be assembled, or two pieces of a line turn over on the way.
    """
    path, stopped = closed_drawings(mechanism, instant, tolerance)
    for error in stopped.values():
        raise error
    return path


def closed_drawings(
    mechanism: Mechanism, instant: float | None = None, tolerance: float = 0.0
) -> tuple[Path, dict[int, AssemblyError]]:
    """The drawings of a batch assembled at their own inputs, and the errors of those that stop, by number."""
    own = mechanism.drawn[..., mechanism.map.unknowns :]
    factors = mechanism.drawn_factors if mechanism.drawn.ndim == 1 else None
    path = follow(mechanism.map, mechanism.drawn, own, factors, tolerance)
    stopped = _stopped(mechanism, path, own, path.done < 1.0, "the drawing cannot be assembled", instant)
    turned, pair = mechanism.turned_over(path.y)
    if pair is not None:
        one, other = (" - ".join(piece) for piece in pair)
        problem = f"the drawing can close in two ways, {one} turns over against {other} on the way"
        stopped = _stopped(mechanism, path, own, turned & (path.done == 1.0), problem, instant) | stopped
    return path, dict(sorted(stopped.items()))


def assemble(
    mechanism: Mechanism,
    inputs: Mapping[str, Array],
    instant: float | None = None,
    closed: Path | None = None,
    tolerance: float = 0.0,
) -> Pose:
    """The pose for given inputs on the branch of the drawing.

    The drawing is first assembled at its own inputs. Then the driven coordinates move along a straight line
    to their values at the given inputs.

    Args:
        inputs: value of each input, shape (...,), rad or mm.
        instant: for messages, s.
        closed: the closed drawing, if available.
        tolerance: allowed distance of the pose to the exact assembly, without rounding, in units.
    Raises:
        AssemblyError: a pose on the way is singular; the error states where, and which input to reduce.
    """
    drawing = close_drawing(mechanism, instant) if closed is None else closed
    pose, stopped = assembled(mechanism, inputs, drawing, instant, tolerance)
    for error in stopped.values():
        raise error
    return pose


def assembled(
    mechanism: Mechanism, inputs: Mapping[str, Array], drawing: Path, instant: float | None, tolerance: float
) -> tuple[Pose, dict[int, AssemblyError]]:
    """The poses of a batch for given inputs, and the errors of members that have no pose, by number."""
    target, path = driven_to(mechanism, inputs, drawing, tolerance)
    stopped = _stopped(mechanism, path, target, path.done < 1.0, "the mechanism cannot be assembled", instant)
    work = drawing.work + path.work
    return Pose(path.y, path.factors, path.left, work, path.iterations, path.done, mechanism), stopped


def driven_to(
    mechanism: Mechanism, inputs: Mapping[str, Array], drawing: Path, tolerance: float
) -> tuple[Array, Path]:
    """Known coordinates at given inputs, (..., known coordinates), and the paths there from the drawing.

    The driven coordinates move on a straight line. An angle is driven by its cosine and its sine: if an angle
    changes, all inputs change in proportion instead.
    """
    wanted = {name: np.asarray(value, dtype=float) for name, value in inputs.items()}
    target = mechanism.known_series({name: value[..., None] for name, value in wanted.items()})[..., 0, :]
    n = mechanism.map.unknowns
    begun = mechanism.input_values(drawing.y[..., n:])
    turn = sum((np.abs(wanted[name] - begun[name]) for name in mechanism.topology.turning), np.zeros(()))
    if not turn.any():
        return target, follow(mechanism.map, drawing.y, target, drawing.factors, tolerance)
    batch = np.broadcast_shapes(drawing.y.shape[:-1], target.shape[:-1])

    def flat(values: Array) -> Array:
        return np.broadcast_to(values, batch).ravel()

    ends = {name: (flat(begun[name]), flat(value)) for name, value in wanted.items()}
    y = np.broadcast_to(drawing.y, (*batch, drawing.y.shape[-1])).reshape(-1, drawing.y.shape[-1])
    goals = np.broadcast_to(target, (*batch, target.shape[-1])).reshape(len(y), -1)
    factors = drawing.factors.reshaped((1,)) if len(y) == 1 else None
    law, longest = by_inputs(mechanism, ends, goals), LONGEST / max(float(turn.max()), LONGEST)
    path = follow(mechanism.map, y, law, factors, tolerance, longest=longest).reshaped(batch)
    return target, path


def by_inputs(mechanism: Mechanism, ends: Mapping[str, tuple[Array, Array]], goals: Array) -> Law:
    """The law of paths along which all inputs change in proportion from their first to their last values.

    Args:
        ends: first and last value of each input, each (members,), rad or mm.
        goals: known coordinates at the ends of the paths, (members, known coordinates).
    """
    cars = mechanism.drawn.ndim > 1

    def law(members: Indices, shares: Array, order: int) -> Array:
        inputs = {}
        for name, (first, last) in ends.items():
            change = last[members] - first[members]
            inputs[name] = np.zeros((len(members), order + 1))
            inputs[name][:, 0] = first[members] + change * shares
            inputs[name][:, 1:2] = change[:, None]
        known = (mechanism.taken(members) if cars else mechanism).known_series(inputs)
        known[:, 0] = np.where((shares == 1.0)[:, None], goals[members], known[:, 0])
        return known

    return law


def path_of_part(path: Path, whole: Mechanism, part: Mechanism) -> Path:
    """Poses of a mechanism, reduced to the coordinates of a part of it (see `needed_part`)."""
    if part is whole:
        return path
    y = path.y[..., part.layout.places_in(whole.layout)]
    work = path.work + Work(factorisations=int(np.prod(y.shape[:-1])))
    return replace(path, y=y, factors=factorise(part.map.jacobian(y)), work=work)


def _stopped(
    mechanism: Mechanism,
    path: Path,
    target: Array,
    which: Flags,
    problem: str,
    instant: float | None,
) -> dict[int, AssemblyError]:
    """The errors of those members of a batch that `which` marks, by number."""
    found: dict[int, AssemblyError] = {}
    for number in np.flatnonzero(which).tolist():
        one = (np.arange(which.size) == number).reshape(which.shape)
        found[number] = blocked(mechanism, problem, path.y, path.factors, target, one, instant)
    return found


def blocked(
    mechanism: Mechanism,
    problem: str,
    y: Array,
    factors: Factors,
    goal: Array,
    unfinished: Flags,
    instant: float | None,
    change: Array | None = None,
) -> AssemblyError:
    """The error of the first unfinished path of a batch: where it stops, and what stops it.

    Args:
        problem: what could not be done, in words.
        y: poses at which the paths stop, shape (..., size).
        factors: factorisation of C_u at y.
        goal: known coordinates at the ends of the paths, shape (..., known coordinates).
        unfinished: paths that stopped before their end, shape (...).
        change: remaining change of each known coordinate, with its sign; the way from y to the goal
            unless given.
    """
    member = tuple(np.argwhere(unfinished)[0])
    known = y[..., mechanism.map.unknowns :]

    def inputs_at(coordinates: Array) -> dict[str, float]:
        values = mechanism.input_values(np.broadcast_to(coordinates, known.shape))
        return {name: float(value[member]) for name, value in values.items()}

    forces, limits = limiting(mechanism, y[member], factors.matrix[member], factors.row_scale[member])
    left = np.broadcast_to(goal - known if change is None else change, known.shape)[member]
    pushes = _pushes(mechanism, y[member], forces, left)
    return AssemblyError(
        problem,
        reached=inputs_at(known),
        wanted=inputs_at(goal),
        condition=float(factors.condition[member]),
        reduce=max(pushes, key=pushes.__getitem__) if any(pushes.values()) else "",
        limits=limits,
        instant=instant,
    )


def limiting(
    mechanism: Mechanism, y: Array, matrix: Array, row_scale: Array
) -> tuple[Array, tuple[str, ...]]:
    r"""The balanced forces at the end of a path, and the constraints that stop the motion there.

    Where a path stops, C_u loses rank: forces l are in balance, l C_u = 0, and a motion v changes no row to
    first order, C_u v = 0. To second order the inputs must do the work l . B(v, v). A constraint counts by
    its part of this sum, which is zero if v only displaces its points, as in a link that transmits the force.

    Args:
        y: one pose. matrix, row_scale: C_u there, its rows scaled, and their scales.
    Returns:
        l, one for each unscaled row, and the names of the constraints.
    """
    balance, motion = smallest_singular_vectors(matrix)
    forces, along = balance * row_scale, np.zeros_like(y)
    along[: mechanism.map.unknowns] = motion
    return forces, mechanism.topology.largest(forces * mechanism.map.polar(along, along))


def _pushes(mechanism: Mechanism, y: Array, forces: Array, left: Array) -> dict[str, float]:
    """Work of each input against the balanced forces at the end of a path, with a sum that is not negative.

    There C_u loses rank. Forces in balance with each other do no work on any motion of the unknowns. So only
    the remaining change of the inputs, C_w dw, does work against them.

    Args:
        forces: the balanced forces, one for each unscaled row.
        left: remaining change of every known coordinate, with its sign.
    """
    work = dict.fromkeys(mechanism.topology.required_inputs, 0.0)
    for drive in mechanism.topology.drives:
        place = mechanism.layout.scalar(drive.coordinate)
        along = np.zeros_like(y)
        along[place] = left[place - mechanism.map.unknowns]
        work[drive.input] += float(forces @ (2.0 * mechanism.map.polar(y, along)))
    total = sum(work.values())
    return {name: part * (1.0 if total >= 0.0 else -1.0) for name, part in work.items()}
