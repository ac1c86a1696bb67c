"""From the drawing to its closed pose, to the first instant and on from instant to instant, on one branch.

A short step is predicted by a cubic through the four instants before, and taken where Newton's first step
from there is small against it. Any other step is travelled: the inputs go straight to where they are to be,
and a part of the way is taken where the second Newton step is a quarter of the first one at most, so that
there is a pose all along it (Deuflhard, Newton Methods for Nonlinear Problems, 2011, ch. 5), and where the
determinants of the Jacobian's blocks keep their signs; else half of it is tried. Assemblies meet where such
a determinant is zero, so in the end every pose is held to the drawing's signs.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from validate.relative.tree import Places, Settled, Tree
from validate.spanning_tree.cut import Drive

Array = NDArray[np.float64]
Path = Callable[[float], Array]

LONGEST = 0.5  # of a step of joint coordinates, in rad and sizes of the car
CONTRACTED = 0.25
# A predicted step is taken where Newton's correction is no more than this part of it, or at most this size:
# no fold fits in there. What is left of the instants before makes a correction of its own.
CORRECTED, NEGLIGIBLE, LEFT_OVER = 0.1, 1e-6, 100.0
STEADY = 64.0  # sum of the predictor's weights: what it makes of errors of the instants before
COARSE = 1e-8  # sizes of the car: where more is left of the rows, a line through two instants predicts
SHORTEST = 2.0**-44  # of a way
FEW = 10  # Newton steps for a part of a way
# At a fold a rounding U moves the pose by its root: beyond this condition number its sides are one.
FOLDED = 2.0**26
# Poses whose Jacobians are made at once: what is made on the way, some 10 kB for each, stays in the cache.
BLOCK = 2**6


@dataclass(frozen=True)
class Poses:
    """Solved poses; lengths in sizes of the car.

    Attributes:
        q: joint coordinates, (N, nq).
        matrices: of the bodies, (N, 12 B), flat by row, body and column.
        screws: of the joints in the world's axes about their origin, linear before angular, (N, size, 6).
        residual: what is left of the rows, (N, size).
        jacobian: of the rows, (N, size, size).
        steps: of Newton's method, each with a Jacobian and a factorisation.
        evaluations: of the rows.
    """

    q: Array
    matrices: Array
    screws: Array
    residual: Array
    jacobian: Array
    steps: int
    evaluations: int

    def first(self, count: int) -> Poses:
        """The first ones."""
        return Poses(
            self.q[:count],
            self.matrices[:count],
            self.screws[:count],
            self.residual[:count],
            self.jacobian[:count],
            self.steps,
            self.evaluations,
        )


class Blocked(Exception):
    """A way that ends.

    Attributes:
        solved: poses before it. instant: the number of the one that it leads to.
        here: inputs where it ends, (drives,).
        condition: of the Jacobian there. links: what holds each other there, the strongest first.
        problem: in words.
    """

    def __init__(
        self,
        problem: str,
        instant: int,
        here: Array,
        condition: float,
        links: tuple[str, ...] = (),
        solved: Poses | None = None,
    ) -> None:
        self.problem, self.instant, self.here = problem, instant, here
        self.condition, self.links, self.solved = condition, links, solved
        super().__init__(problem)


def drive_rates(drive: Drive, series: Array) -> list[Array]:
    """What a drive's row is to be, and its rates, from those of the input, (..., 1 to 3), as many."""
    value, *rates = np.moveaxis(series, -1, 0)
    size, w, a = drive.size, rates[0] if rates else 0.0 * value, rates[1] if rates else 0.0 * value
    if drive.kind == "angle":
        sine, cosine = size * np.sin(value), size * np.cos(value)
        found = [cosine, -sine * w, -cosine * w * w - sine * a]
    elif drive.kind == "distance":
        found = [0.5 * value * value / size, value * w / size, (w * w + value * a) / size]
    else:
        scale = size if drive.kind in ("travel", "turn") else 1.0
        found = [scale * value, scale * w, scale * a]
    return found[: 1 + len(rates)]


def row_targets(tree: Tree, series: Array) -> Array:
    """What all rows are to be, with rates, (..., size, orders), from the drives', (..., drives, orders)."""
    found = np.zeros((*series.shape[:-2], tree.size, series.shape[-1]))
    found[..., 0] = tree.rows.target
    for row, k in zip(tree.rows.drives, tree.rows.drive_numbers, strict=True):
        for order, rate in enumerate(drive_rates(tree.drives[k], series[..., k, :])):
            found[..., row, order] += rate
    return found


def targets_at(tree: Tree, inputs: Array) -> Array:
    """What all rows are to be, (..., size), at inputs (..., drives)."""
    return np.asarray(row_targets(tree, inputs[..., None])[..., 0])


def at_places(poses: Poses, places: Places) -> Array:
    """Where points of bodies are, (N, P, 3)."""
    return places.now(poses.matrices)


def room(tree: Tree, count: int) -> Poses:
    """Poses to be filled in."""
    size = tree.size
    return Poses(
        np.zeros((count, len(tree.neutral))),
        np.zeros((count, 12 * len(tree.bodies))),
        np.zeros((count, size, 6)),
        np.zeros((count, size)),
        np.zeros((count, size, size)),
        0,
        0,
    )


def find_jacobians(tree: Tree, poses: Poses) -> None:
    """Fill in the Jacobians of poses."""
    for low in range(0, len(poses.q), BLOCK):
        some = slice(low, low + BLOCK)
        matrices = poses.matrices[some]
        poses.jacobian[some] = tree.rows.jacobian(
            matrices, tree.moved(tree.whole(matrices), poses.screws[some])
        )


def travel(tree: Tree, q: Array, path: Path, goal: float) -> tuple[Array, float, int, int]:
    """Follow a way from its beginning, which the pose solves, as far as it goes.

    Args:
        path: targets at a share of the way, from 0 to 1.
    Returns:
        The last pose, the share of the way, Newton steps and evaluations of the rows.
    """
    done, ahead, steps, evaluations = 0.0, 1.0, 0, 0
    tree.matrices(q)
    signs = tree.signs(tree.jacobian())
    while done < 1.0:
        share = min(1.0, done + ahead)
        found = tree.settle(q, path(share), goal, FEW)
        steps, evaluations = steps + found.steps, evaluations + found.steps + 1
        if found.q is not None and _contracts(found) and (tree.signs(tree.jacobian()) == signs).all():
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
    return lambda share: targets_at(tree, end if share == 1.0 else start + share * (end - start))


def closed(tree: Tree, goal: float) -> Poses:
    """The drawing, closed at its own inputs: what is left of its rows is taken back to zero.

    Raises:
        Blocked: it does not close on its own branch.
    """
    drawn = np.array([drive.drawn for drive in tree.drives])
    targets = targets_at(tree, drawn)
    neutral = tree.neutral
    gap = tree.rows.values(tree.matrices(neutral), neutral, targets)
    q, done, _, _ = travel(tree, neutral, lambda share: targets + (1.0 - share) * gap, goal)
    poses = _pose(tree, q, targets)
    condition = float(np.linalg.cond(poses.jacobian[0]))
    links = tree.holding(poses.jacobian[0])
    if done < 1.0:
        words = "has no pose at its own inputs on the side that it is drawn on"
        raise Blocked(words, -1, drawn, condition, links)
    if not condition < FOLDED:
        raise Blocked(f"lies on a fold: {_and(links)} hold each other", -1, drawn, condition, links)
    return poses


def _pose(tree: Tree, q: Array, targets: Array) -> Poses:
    """One pose with all that is known of it."""
    poses = room(tree, 1)
    poses.q[0] = q
    poses.residual[0] = tree.rows.values(tree.matrices(q), q, targets)
    tree.store(poses.matrices[0], poses.screws[0])
    poses.jacobian[0] = tree.jacobian()
    return poses


def _and(names: Sequence[str]) -> str:
    return " and ".join(", ".join(names).rsplit(", ", 1))


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
    targets, weights = targets_at(tree, inputs), _weights(times, 4 if goal < COARSE else 2)
    behind = weights.shape[1]
    negligible = max(NEGLIGIBLE, LEFT_OVER * goal)
    steady = (np.abs(weights).sum(axis=1) <= STEADY).tolist()
    poses = room(tree, count)
    q, residual, matrices, screws = poses.q, poses.residual, poses.matrices, poses.screws
    drawn, signs = np.array([drive.drawn for drive in tree.drives]), tree.signs(home.jacobian[0])
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
            residual[i] = tree.rows.values(tree.matrices(found), found, targets[i])
            if done < 1.0:
                reached = start + done * (inputs[i] - start)
                raise _blocked(tree, found, reached, i, poses, steps, evaluations)
        q[i] = here = found
        tree.store(matrices[i], screws[i])
        i += 1
        if i == count:
            find_jacobians(tree, poses)
            left = np.flatnonzero((tree.signs(poses.jacobian) != signs).any(axis=1))
            if len(left):
                # A predicted step has jumped: back to before it, and on with care. One that was travelled
                # has met a fold.
                i = int(left[0])
                here = home.q[0] if i == 0 else q[i - 1]
                if i <= careful:
                    reached = drawn if i == 0 else inputs[i - 1]
                    raise _blocked(tree, here, reached, i, poses, steps, evaluations)
                careful = i
    return replace(poses, steps=steps, evaluations=evaluations)


def _blocked(
    tree: Tree, q: Array, here: Array, instant: int, poses: Poses, steps: int, evaluations: int
) -> Blocked:
    at_end = _pose(tree, q, targets_at(tree, here)).jacobian[0]
    links = tree.holding(at_end)
    solved = replace(poses.first(instant), steps=steps, evaluations=evaluations)
    find_jacobians(tree, solved)
    words = f"cannot be reached, for {_and(links)} hold each other"
    condition = float(np.linalg.cond(at_end))
    return Blocked(words, instant, here, condition, links, solved if instant else None)


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
