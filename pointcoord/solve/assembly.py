r"""Assembly: from the drawing to a pose, along a path that cannot change branch.

Between two sets of known coordinates the path is straight, or a law leads from one to the other; what is not
yet assembled is taken back in proportion. It is followed in steps that are proven (see `curved_path`): about
the tangent of each there is exactly one assembly, and it is the continuation of the one that the step started
from. What a step takes up of the condition goes with its length, so one that is too long tells which is
proven, and the steps shrink on their own towards a pose where the path ends.

A place on the way is corrected only until Newton's method is proven to converge from it, which is one step as
a rule; what it is still off is taken along with the next tangent. Only the end is corrected to the tolerance.
Rounding is not counted here: within the root of EPS of a pose where two branches cross, it may hide that they
do.

One pose on its way from the drawing takes longer steps, along a power series of the path (see `proven_path`);
tangents lead where no few of these are proven to reach the end, and tell where a path stops.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from pointcoord.data_classes import dataclass
from pointcoord.linkage.drawing_orientation import turned_over
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.branch import hidden, orientation, same_side, same_signs
from pointcoord.numerics.counters import Work
from pointcoord.numerics.linear import Factors, factorise, smallest_left_singular_vector
from pointcoord.numerics.newton import factors_at, newton_refine
from pointcoord.numerics.quadratic import QuadraticMap
from pointcoord.solve.curved_path import SHARES, Path, beside_the_way, straight_way
from pointcoord.solve.proven_path import proven_end
from pointcoord.solve.status import Blocked

Array = NDArray[np.float64]
Law = Callable[[NDArray[np.intp], Array], Array]
"""Known coordinates of members, by number, at shares of their paths, both (m,): (m, size - unknowns)."""

# Part of a step that would just be proven, and how much longer the next one is at most.
SAFETY, LONGER = 0.8, 4.0
# Part of a step that is tried instead where it overflows, or where digits have run out at its end.
AGAIN = 0.1
# A path that advances less than this fraction in a step has met the end of what can be assembled: steps
# shrink in proportion to the distance to the end, which is then near 1e-12 of the path. The end is a fold,
# where two assemblies meet as the root of the distance: they are still 1e-6 of the path apart, and
# rounding, which grows as the inverse of that root, is near 1e-10.
SMALLEST_STEP = 1e-13
# Steps tried for a path, or for each part of it that is as long as a step may be.
STEPS = 2000
# Turn in one step, rad, at most: of more than half a turn the ends do not tell the way round.
LONGEST = 1.0
# How far the end of a step that is not proven may be beside its tangent, in parts of it. What bends is in
# proportion to the step: an end so near the tangent is far from where the step would double back.
BESIDE = 0.25


@dataclass(frozen=True)
class Pose:
    """One assembled configuration or a batch of them.

    Attributes:
        mechanism: what is assembled.
        y: coordinates, shape (..., size), in the mechanism's units.
        factors: factorisation of the Jacobian there.
        iterations: Newton steps that the last correction took, shape (...,).
        left: proven distance to the exact assembly, rounding apart, where a tolerance ended the correction,
            shape (...,), in the mechanism's units; zero where it went on to rounding.
        work: what it cost.
    """

    mechanism: Mechanism
    y: Array
    factors: Factors
    iterations: NDArray[np.int64]
    left: Array
    work: Work

    def taken(self, members: NDArray[np.intp]) -> Pose:
        """Some members of a batch of one dimension; what it cost is no part of them."""
        return Pose(
            self.mechanism.taken(members),
            self.y[members],
            self.factors.taken(members),
            self.iterations[members],
            self.left[members],
            Work(),
        )

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

        Infinite where nothing is proven. See `kantorovich` for what it covers; computed when it is read.
        """
        # Imported here, like all that proves: most poses are never asked for it.
        from pointcoord.bounds.proof import pose_bound

        return pose_bound(self.mechanism, self.y, self.factors)


def follow(
    system: QuadraticMap,
    y: Array,
    target: Array | Law,
    factors: Factors | None = None,
    tolerance: float = 0.0,
    steps: int = STEPS,
    longest: float = 1.0,
) -> Path:
    """Carry poses along paths of their known coordinates.

    Args:
        y: start, shape (..., size); what its residual is not zero by is taken back along the path.
        target: known coordinates at the end of a straight path, shape (..., size - unknowns), or a law.
        factors: factorisation of C_u at y, if it is at hand.
        tolerance: how far the end may be from the exact assembly, rounding apart, in units.
        steps: tried at most for each share `longest` of the path.
        longest: share of the path in one step, so short that SHARES of it show what a law does.
    Returns:
        Poses at the ends of their paths, or where these stop.
    """
    n = system.unknowns
    batch = y.shape[:-1] if callable(target) else np.broadcast_shapes(y.shape[:-1], target.shape[:-1])
    y = np.broadcast_to(y, (*batch, y.shape[-1])).reshape(-1, y.shape[-1]).copy()
    if callable(target):
        law, still, shares = target, np.zeros(len(y), dtype=bool), np.append(SHARES, 1.0)
    else:
        goals = np.broadcast_to(target, (*batch, target.shape[-1])).reshape(len(y), -1)
        law, still, shares = _straight(y[:, n:].copy(), goals), (goals == y[:, n:]).all(axis=-1), np.ones(1)
    offset = system.residual(y)
    done, step, rest = np.zeros(len(y)), np.full(len(y), min(longest, 1.0)), np.zeros(len(y))
    iterations, work = np.zeros(len(y), dtype=np.int64), Work(residuals=len(y))
    if factors is None or factors.condition.shape != batch:
        factors = factorise(system.jacobian(y))
        work += Work(factorisations=len(y))
    factors = factors.reshaped((len(y),))
    side = orientation(system, factors)
    active = np.flatnonzero(~factors.singular & (still | ~hidden(system, y, factors)))
    for _ in range(int(steps / min(longest, 1.0))):
        if not active.size:
            break
        here, begun, inverse = y[active], done[active], factors.taken(active).preconditioner
        end = np.minimum(begun + step[active], 1.0)
        places = np.where(shares == 1.0, end[:, None], begun[:, None] + (end - begun)[:, None] * shares)
        known = law(np.repeat(active, len(shares)), places.ravel()).reshape(*places.shape, -1)
        left_open = (1.0 - np.stack([begun, end]))[..., None] * offset[active]
        with np.errstate(all="ignore"):
            beside = None if len(shares) == 1 else beside_the_way(here[:, n:], known[:, :-1], known[:, -1])
            way = straight_way(system, inverse, here, known[:, -1], beside, left_open)
            proof = way.best_proof(system, inverse)
            able = np.flatnonzero(proof.holds)
            length = np.minimum(SAFETY / proof.used, LONGER) * (end - begun)
            # Of a step so long that it overflows nothing is known.
            shorter = np.where(np.isnan(length), AGAIN, SAFETY) * (end - begun)
        step[active] = np.fmin(length, shorter)
        if able.size:
            guess = (here + way.tangent)[able]
            guess[:, n:] = known[able, -1]
            # On the way it is enough to be where Newton's method is proven to converge.
            allowed = np.where(end[able] == 1.0, tolerance, np.inf)
            reached = newton_refine(system, guess, left_open[1, able], allowed)
            # In exact arithmetic every correction converges and no path crosses a fold, where the determinant
            # changes its sign. One that does has run out of digits: a drawing on a fold, to within rounding.
            there, factorised = factors_at(system, reached)
            work += reached.work + factorised
            apart = np.abs(reached.y - guess)[:, :n]
            good = reached.converged & proof.taken(able).within(apart)
            good &= same_side(system, reached.y, there, side[active[able]], end[able] == 1.0)
            kept, chosen = active[able[good]], np.flatnonzero(good)
            y[kept], done[kept], rest[kept] = reached.y[chosen], end[able[chosen]], reached.left[chosen]
            iterations[kept] = reached.iterations[chosen]
            factors = factors.replaced(kept, there.taken(chosen))
            step[active[able[~good]]] *= AGAIN
            step[kept] = np.minimum(length[able[chosen]], longest)
        # A step that completes a path may be as short as it likes.
        active = active[
            (done[active] < 1.0) & (step[active] >= np.minimum(SMALLEST_STEP, 1.0 - done[active]))
        ]
    stopped = np.flatnonzero((done < 1.0) & (rest > 0.0))
    if stopped.size:
        # Where a path ends is told as exactly as an assembly is.
        ends = newton_refine(system, y[stopped], offset[stopped] * (1.0 - done[stopped])[:, None])
        there, factorised = factors_at(system, ends)
        work += ends.work + factorised
        good = ends.converged & same_side(system, ends.y, there, side[stopped], True)
        stopped = stopped[good]
        y[stopped], rest[stopped] = ends.y[good], 0.0
        factors = factors.replaced(stopped, there.taken(np.flatnonzero(good)))
    return Path(y, factors, iterations, rest, done, work).reshaped(batch)


def _straight(start: Array, goals: Array) -> Law:
    """The straight paths between known coordinates, each (members, size - unknowns)."""
    change = goals - start

    def law(members: NDArray[np.intp], shares: Array) -> Array:
        share = shares[:, None]
        return np.where(share == 1.0, goals[members], start[members] + change[members] * share)

    return law


def led(
    system: QuadraticMap, y: Array, target: Array, factors: Factors | None = None, tolerance: float = 0.0
) -> Path:
    """What `follow` gives; one pose goes along a few series where these prove the whole path.

    Args, result: as of `follow`.
    """
    if y.ndim == 1 and target.ndim == 1:
        first = factorise(system.jacobian(y)) if factors is None else factors
        end = proven_end(system, y, target, first, tolerance)
        if end is not None:
            iterations, left = np.array(end.iterations), np.array(end.left)
            work = end.work if factors is not None else end.work + Work(factorisations=1)
            return Path(end.y, end.factors, iterations, left, np.array(1.0), work)
    return follow(system, y, target, factors, tolerance)


def stepped(system: QuadraticMap, y: Array, target: Array) -> Array | None:
    """The pose at other known coordinates, if Newton's method finds it close to the tangent; None if not.

    It is on the same side of a fold, and nothing else of it is proven: for telling what stops a motion, where
    a motion itself goes along proven steps.

    Args:
        y: an assembled pose, shape (size,). target: known coordinates.
    """
    factors = factorise(system.jacobian(y))
    if factors.singular:
        return None
    with np.errstate(all="ignore"):
        tangent = straight_way(system, factors.preconditioner, y, target).tangent
        guess = y + tangent
        guess[system.unknowns :] = target
        reached = newton_refine(system, guess)
        there = factorise(system.jacobian(reached.y))
        beside = np.abs(reached.y - guess).max() <= BESIDE * np.abs(tangent).max()
    kept = same_signs(orientation(system, there), orientation(system, factors))
    return reached.y if bool(beside and reached.converged) and kept else None


def close_drawing(mechanism: Mechanism, instant: float | None = None, tolerance: float = 0.0) -> Path:
    """The drawing assembled at its own inputs.

    Args:
        tolerance: as of `follow`.
    Raises:
        AssemblyError: it cannot be, or two pieces of a line turn over against each other on the way.
    """
    path, stopped = closed_drawings(mechanism, instant, tolerance)
    for status in stopped.values():
        raise status.error()
    return path


def closed_drawings(
    mechanism: Mechanism, instant: float | None = None, tolerance: float = 0.0
) -> tuple[Path, dict[int, Blocked]]:
    """The drawings of a batch assembled at their own inputs, and what stops those that are not, by number."""
    own = mechanism.drawn[..., mechanism.map.unknowns :]
    factors = mechanism.drawn_factors if mechanism.drawn.ndim == 1 else None
    path = led(mechanism.map, mechanism.drawn, own, factors, tolerance)
    stopped = _stopped(mechanism, path, own, path.done < 1.0, "the drawing cannot be assembled", instant)
    turned, pair = turned_over(mechanism, path.y)
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

    The drawing is first assembled at its own inputs, then the inputs are taken from there to the wanted
    ones along a straight line of the driven coordinates.

    Args:
        inputs: value of each input, shape (...,), rad or mm.
        instant: for messages, s.
        closed: the closed drawing, if it is at hand.
        tolerance: how far the pose may be from the exact assembly, rounding apart, in units.
    Raises:
        AssemblyError: a pose on the way is singular; tells where, and which input to reduce.
    """
    drawing = close_drawing(mechanism, instant) if closed is None else closed
    pose, stopped = assembled(mechanism, inputs, drawing, instant, tolerance)
    for status in stopped.values():
        raise status.error()
    return pose


def assembled(
    mechanism: Mechanism, inputs: Mapping[str, Array], drawing: Path, instant: float | None, tolerance: float
) -> tuple[Pose, dict[int, Blocked]]:
    """The poses of a batch for given inputs, and what stops those that have none, by number."""
    target, path = driven_to(mechanism, inputs, drawing, tolerance)
    stopped = _stopped(mechanism, path, target, path.done < 1.0, "the mechanism cannot be assembled", instant)
    work = drawing.work + path.work
    return Pose(mechanism, path.y, path.factors, path.iterations, path.left, work), stopped


def driven_to(
    mechanism: Mechanism, inputs: Mapping[str, Array], drawing: Path, tolerance: float
) -> tuple[Array, Path]:
    """Known coordinates of given inputs, (..., known coordinates), and the paths there from the drawing.

    The driven coordinates go straight there; but a turn, which is driven by its cosine and its sine, goes
    round, and with it every input in proportion.
    """
    wanted = {name: np.asarray(value, dtype=float) for name, value in inputs.items()}
    target = mechanism.known_series({name: value[..., None] for name, value in wanted.items()})[..., 0, :]
    n = mechanism.map.unknowns
    begun = mechanism.input_values(drawing.y[..., n:])
    turn = sum((np.abs(wanted[name] - begun[name]) for name in mechanism.topology.turning), np.zeros(()))
    if not turn.any():
        return target, led(mechanism.map, drawing.y, target, drawing.factors, tolerance)
    batch = np.broadcast_shapes(drawing.y.shape[:-1], target.shape[:-1])
    cars = mechanism.drawn.ndim > 1

    def flat(values: Array) -> Array:
        return np.broadcast_to(values, batch).ravel()

    ends = {name: (flat(begun[name]), flat(value)) for name, value in wanted.items()}
    y = np.broadcast_to(drawing.y, (*batch, drawing.y.shape[-1])).reshape(-1, drawing.y.shape[-1])
    goals = np.broadcast_to(target, (*batch, target.shape[-1])).reshape(len(y), -1)

    def law(members: NDArray[np.intp], shares: Array) -> Array:
        values = {
            name: (first[members] + (last[members] - first[members]) * shares)[:, None]
            for name, (first, last) in ends.items()
        }
        known = (mechanism.taken(members) if cars else mechanism).known_series(values)[..., 0, :]
        return np.where((shares == 1.0)[:, None], goals[members], known)

    longest = LONGEST / max(float(turn.max()), LONGEST)
    return target, follow(mechanism.map, y, law, None, tolerance, longest=longest).reshaped(batch)


def path_of_part(path: Path, whole: Mechanism, part: Mechanism) -> Path:
    """Poses of a mechanism as poses of a part of it (see `needed_part`)."""
    if part is whole:
        return path
    y = path.y[..., part.layout.places_in(whole.layout)]
    work = path.work + Work(factorisations=int(np.prod(y.shape[:-1])))
    return Path(y, factorise(part.map.jacobian(y)), path.iterations, path.left, path.done, work)


def _stopped(
    mechanism: Mechanism,
    path: Path,
    target: Array,
    which: NDArray[np.bool_],
    problem: str,
    instant: float | None,
) -> dict[int, Blocked]:
    """What stops members of a batch, by number."""
    found: dict[int, Blocked] = {}
    for number in np.flatnonzero(which).tolist():
        one = (np.arange(which.size) == number).reshape(which.shape)
        found[number] = blocked(mechanism, problem, path, target, one, instant)
    return found


class Place(Protocol):
    """Where a path stands: coordinates y, shape (..., size), and the factors of C_u there."""

    @property
    def y(self) -> Array:
        """Coordinates."""
        ...

    @property
    def factors(self) -> Factors:
        """Of C_u."""
        ...


def blocked(
    mechanism: Mechanism,
    problem: str,
    place: Place,
    goal: Array,
    unfinished: NDArray[np.bool_],
    instant: float | None,
    change: Array | None = None,
) -> Blocked:
    """What stops paths that end at a place on their way to `goal`, told for the first unfinished one.

    Where a path ends, C_u loses rank, and its left null vector is a set of forces in the links that hold
    each other in balance: the rows that take part are what limits the motion.

    Args:
        problem: what could not be done, in words.
        goal: known coordinates, shape (..., known coordinates).
        unfinished: shape (...).
        change: how far each known coordinate would still go, with its sign; from the place to the
            goal unless given.
    """
    member = tuple(np.argwhere(unfinished)[0])
    y, factors = place.y, place.factors
    known = y[..., mechanism.map.unknowns :]

    def told(coordinates: Array) -> dict[str, float]:
        values = mechanism.input_values(np.broadcast_to(coordinates, known.shape))
        return {name: float(value[member]) for name, value in values.items()}

    balance = smallest_left_singular_vector(factors.matrix[member])
    left = np.broadcast_to(goal - known if change is None else change, known.shape)[member]
    pushes = _pushes(mechanism, y[member], balance * factors.row_scale[member], left)
    return Blocked(
        problem,
        reached=told(known),
        wanted=told(goal),
        condition=float(factors.condition[member]),
        reduce=max(pushes, key=pushes.__getitem__) if any(pushes.values()) else "",
        limits=mechanism.topology.strongest(balance),
        instant=instant,
    )


def _pushes(mechanism: Mechanism, y: Array, forces: Array, left: Array) -> dict[str, float]:
    """How far each input pushes across the end of a path.

    There C_u loses rank: forces that hold each other in balance do no work on any motion of the unknowns, so
    what is left of the inputs' way, C_w dw, works against them alone.

    Args:
        forces: the balance, one per unscaled row. left: of every known coordinate, with its sign.
    """
    work = dict.fromkeys(mechanism.topology.required_inputs, 0.0)
    for drive in mechanism.topology.drives:
        place = mechanism.layout.scalar(drive.coordinate)
        along = np.zeros_like(y)
        along[place] = left[place - mechanism.map.unknowns]
        work[drive.input] += float(forces @ (2.0 * mechanism.map.polar(y, along)))
    total = sum(work.values())
    return {name: part * (1.0 if total >= 0.0 else -1.0) for name, part in work.items()}
