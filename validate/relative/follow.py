"""From the drawing to its closed pose, to the first instant and on from instant to instant, on one branch.

A short step is predicted by a cubic through the four instants before, and taken where Newton's first step
from there is small against it. Any other step is travelled: the inputs go straight to where they are to be,
and a part of the way is taken where the second Newton step is a quarter of the first one at most, so that
there is a pose all along it (Deuflhard, Newton Methods for Nonlinear Problems, 2011, ch. 5), and where the
Jacobian's determinant keeps its sign; else half of it is tried. What every pose is held to in the end are
the signs by which the linkage tells its assemblies apart.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from validate.relative.linkage import Drive, Linkage
from validate.relative.tree import Places, Settled, Tree

Array = NDArray[np.float64]
Path = Callable[[float], tuple[Array, Sequence[Array] | None]]

LONGEST = 0.5  # of a step of joint coordinates, in rad and sizes of the car
CONTRACTED = 0.25
# A predicted step is taken where Newton's correction is no more than this part of it, or at most this size:
# no fold fits in there. What is left of the instants before makes a correction of its own.
CORRECTED, NEGLIGIBLE, LEFT_OVER = 0.1, 1e-6, 100.0
STEADY = 64.0  # sum of the predictor's weights: what it makes of errors of the instants before
COARSE = 1e-8  # sizes of the car: where more is left of the rows, a line through two instants predicts
SHORTEST = 2.0**-44  # of a way
FEW = 10  # Newton steps for a part of a way


@dataclass(frozen=True)
class Poses:
    """Solved poses; lengths in sizes of the car.

    Attributes:
        q: joint coordinates, (N, nq).
        rotations, translations: of the bodies, (N, bodies, 3, 3) and (N, bodies, 3).
        screws: of the joints in the world's axes about their origin, linear above angular, (N, 6, size).
        residual: what is left of the rows, (N, size).
        steps: of Newton's method, each with a Jacobian and a factorisation.
        evaluations: of the rows.
    """

    q: Array
    rotations: Array
    translations: Array
    screws: Array
    residual: Array
    steps: int
    evaluations: int

    def first(self, count: int) -> Poses:
        """The first ones."""
        return Poses(
            self.q[:count],
            self.rotations[:count],
            self.translations[:count],
            self.screws[:count],
            self.residual[:count],
            self.steps,
            self.evaluations,
        )


class Blocked(Exception):
    """A way that ends.

    Attributes:
        solved: poses before it. instant: the number of the one that it leads to.
        here: inputs where it ends, (drives,).
        condition: of the Jacobian there.
        problem: in words.
    """

    def __init__(
        self, problem: str, instant: int, here: Array, condition: float, solved: Poses | None = None
    ) -> None:
        self.problem, self.instant, self.here = problem, instant, here
        self.condition, self.solved = condition, solved
        super().__init__(problem)


def drive_values(drives: Sequence[Drive], inputs: Array) -> Array:
    """What the drives' rows are to be, from the axes' origin, (..., drives), at inputs (..., drives)."""
    return np.stack(
        [
            d.size * (np.cos(inputs[..., k]) if d.kind == "angle" else inputs[..., k])
            + float(d.foot @ d.direction)
            for k, d in enumerate(drives)
        ],
        axis=-1,
    )


def row_targets(tree: Tree, inputs: Array) -> Array:
    """What all rows are to be, (..., size), at inputs (..., drives)."""
    values = drive_values(tree.linkage.drives, inputs)
    return np.concatenate([np.zeros((*values.shape[:-1], tree.first_drive)), values], axis=-1)


def at_places(poses: Poses, places: Places) -> Array:
    """Where points of bodies are, (N, P, 3)."""
    found = np.empty((len(poses.q), *places.at.shape))
    found[...] = places.at
    body, moving = places.body[places.moving], places.moving
    turned = poses.rotations[:, body] @ places.at[moving][:, :, None]
    found[:, moving] = turned[..., 0] + poses.translations[:, body]
    return found


def sides(tree: Tree, poses: Poses) -> Array:
    """How far each side is from where it would lock, positive as drawn, in parts of its size, (N, sides)."""
    linkage_sides = tree.linkage.sides
    corners = at_places(poses, tree.corners).reshape(len(poses.q), len(linkage_sides), 4, 3)
    first, second, third = (corners[:, :, k] - corners[:, :, 0] for k in (1, 2, 3))
    flat = np.array([side.points[3] is None for side in linkage_sides])
    volume, along = (np.cross(first, second) * third).sum(axis=-1), (first * second).sum(axis=-1)
    # Vectors of no length have no side.
    scale = np.array([np.sign(side.drawn) / (side.size or 1.0) for side in linkage_sides])
    return np.asarray(np.where(flat, along, volume) * scale)


def room(tree: Tree, count: int) -> Poses:
    """Poses to be filled in."""
    bodies = len(tree.bodies)
    return Poses(
        np.zeros((count, len(tree.neutral))),
        np.zeros((count, bodies, 3, 3)),
        np.zeros((count, bodies, 3)),
        np.zeros((count, 6, tree.size)),
        np.zeros((count, tree.size)),
        0,
        0,
    )


def travel(tree: Tree, q: Array, path: Path, goal: float) -> tuple[Array, float, int, int]:
    """Follow a way from its beginning, which the pose solves, as far as it goes.

    Args:
        path: targets and gaps at a share of the way, from 0 to 1.
    Returns:
        The last pose, the share of the way, Newton steps and evaluations of the rows.
    """
    done, ahead, steps, evaluations = 0.0, 1.0, 0, 0
    tree.rows(q, *path(0.0))
    sign = np.sign(np.linalg.det(tree.jacobian(path(0.0)[1])))
    while done < 1.0:
        share = min(1.0, done + ahead)
        targets, gaps = path(share)
        found = tree.settle(q, targets, goal, gaps, FEW)
        steps, evaluations = steps + found.steps, evaluations + found.steps + 1
        if found.q is not None and _contracts(found) and np.sign(np.linalg.det(tree.jacobian(gaps))) == sign:
            q, done, ahead = found.q, share, 2.0 * ahead
        else:
            ahead = 0.5 * (share - done)
            if ahead < SHORTEST:
                break
    return q, done, steps, evaluations


def _contracts(found: Settled) -> bool:
    # Below 1e-9 a second step is made of rounding in the first.
    return found.first <= LONGEST and found.second <= CONTRACTED * found.first + 1e-9


def straight(tree: Tree, start: Array, end: Array) -> Path:
    """The way straight from inputs to others, (drives,)."""
    return lambda share: (row_targets(tree, end if share == 1.0 else start + share * (end - start)), None)


def closed(tree: Tree, goal: float) -> Poses:
    """The drawing, closed at its own inputs.

    Raises:
        Blocked: it does not close on its own branch.
    """
    linkage = tree.linkage
    drawn = np.array([drive.drawn for drive in linkage.drives])
    targets = row_targets(tree, drawn)
    gaps = [closure.gap for closure in linkage.closures]
    open_ = any(np.any(gap) for gap in gaps)

    def path(share: float) -> tuple[Array, Sequence[Array] | None]:
        return targets, [(1.0 - share) * gap for gap in gaps] if open_ else None

    q, done, _, _ = travel(tree, tree.neutral, path, goal)
    poses = room(tree, 1)
    poses.q[0] = q
    poses.residual[0] = tree.rows(q, targets)
    condition = float(np.linalg.cond(tree.jacobian()))
    tree.store(poses.rotations[0], poses.translations[0], poses.screws[0])
    if done < 1.0:
        raise Blocked("has no pose at its own inputs on the side that it is drawn on", -1, drawn, condition)
    locked = _locked(linkage, sides(tree, poses)[0])
    if locked:
        raise Blocked(f"lies on a fold: {locked}", -1, drawn, condition)
    return poses


def _locked(linkage: Linkage, values: Array) -> str:
    return "; ".join(
        side.lock for side, value in zip(linkage.sides, values.tolist(), strict=True) if not value > 0.0
    )


def follow(tree: Tree, home: Poses, inputs: Array, times: Array, goal: float) -> Poses:
    """The poses at instants one after the other, from the closed drawing.

    Args:
        inputs: (N, drives), rad and sizes of the car.
        times: increasing, (N,), s.
        goal: root of the rows' sum of squares at which Newton's method ends.
    Raises:
        Blocked: the way from one to the next ends.
    """
    count = len(inputs)
    targets, weights = row_targets(tree, inputs), _weights(times, 4 if goal < COARSE else 2)
    behind = weights.shape[1]
    negligible = max(NEGLIGIBLE, LEFT_OVER * goal)
    steady = (np.abs(weights).sum(axis=1) <= STEADY).tolist()
    poses = room(tree, count)
    q, residual = poses.q, poses.residual
    rotations, translations, screws = poses.rotations, poses.translations, poses.screws
    drawn = np.array([drive.drawn for drive in tree.linkage.drives])
    steps = evaluations = 0
    here, careful, i = home.q[0], -1, 0
    while i < count:
        found = None
        if steady[i] and i > careful:
            guess = tree.normalized(weights[i].dot(q[i - behind : i]))
            tried = tree.settle(guess, targets[i], goal)
            steps, evaluations = steps + tried.steps, evaluations + tried.steps + 1
            ahead = guess - here
            allowed = CORRECTED * math.sqrt(ahead.dot(ahead)) + negligible
            if tried.q is not None and tried.first <= allowed:
                found = tried.q
                residual[i] = tried.residual
        if found is None:
            start = drawn if i == 0 else inputs[i - 1]
            found, done, more, rows = travel(tree, here, straight(tree, start, inputs[i]), goal)
            steps, evaluations = steps + more, evaluations + rows
            residual[i] = tree.rows(found, targets[i])
            if done < 1.0:
                reached = start + done * (inputs[i] - start)
                raise _blocked(tree, found, reached, i, poses, steps, evaluations)
        q[i] = here = found
        tree.store(rotations[i], translations[i], screws[i])
        i += 1
        if i == count:
            left = np.flatnonzero(~(sides(tree, poses) > 0.0).all(axis=1))
            if len(left):
                # A predicted step has jumped: back to before it, and on with care. One that was travelled
                # has met a fold.
                i = int(left[0])
                here = home.q[0] if i == 0 else q[i - 1]
                if i <= careful:
                    reached = drawn if i == 0 else inputs[i - 1]
                    raise _blocked(tree, here, reached, i, poses, steps, evaluations)
                careful = i
    return Poses(q, rotations, translations, screws, residual, steps, evaluations)


def _blocked(
    tree: Tree, q: Array, here: Array, instant: int, poses: Poses, steps: int, evaluations: int
) -> Blocked:
    at_end = room(tree, 1)
    at_end.q[0] = q
    tree.rows(q, row_targets(tree, here))
    condition = float(np.linalg.cond(tree.jacobian()))
    tree.store(at_end.rotations[0], at_end.translations[0], at_end.screws[0])
    values = sides(tree, at_end)[0]
    lock = tree.linkage.sides[int(np.argmin(np.abs(values)))].lock
    before = poses.first(instant)
    solved = Poses(
        before.q, before.rotations, before.translations, before.screws, before.residual, steps, evaluations
    )
    return Blocked(f"cannot be reached, for {lock}", instant, here, condition, solved if instant else None)


def _weights(times: Array, count: int) -> Array:
    """Of instants before, for a polynomial's value at each, (N, count); infinite where there are too few."""
    weights = np.full((len(times), count), np.inf)
    if len(times) > count:
        nodes, at = np.lib.stride_tricks.sliding_window_view(times[:-1], count), times[count:]
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            for k in range(count):
                others = [j for j in range(count) if j != k]
                ratios = [(at - nodes[:, j]) / (nodes[:, k] - nodes[:, j]) for j in others]
                weights[count:, k] = np.prod(ratios, axis=0)
    return weights
