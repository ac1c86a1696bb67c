r"""Assembly: from the drawing to a pose, along a path that cannot change branch.

Between two sets of known coordinates the path is straight, and what is not yet assembled is taken back
in proportion. One step goes along the tangent y1 to y + s y1, where, because C is quadratic,

    C(y + s y1) - (1 - s) C(y) = s^2 B(y1, y1)      exactly.

So Kantorovich's condition (see `kantorovich`) along the step needs only three constants at its start,

    (1 - s z)^2 >= 2 omega q s^2,   z = |X C_u(y1)|,  q = |X B(y1, y1)|,  omega = Lipschitz(X C_u),

and solves in closed form: up to s = 1 / (z + sqrt(2 omega q)) there is exactly one assembly in a tube
about the tangent, and it is the continuation of the one that the step started from. The steps shrink on
their own towards a pose where the path ends.

A place on the way is corrected only until Newton's method is proven to converge from it, which is one step as
a rule; what it is still off, e = -X (C(y) - offset), is taken along with the next tangent, and the condition
along y + e + s y1 is

    (1 - omega |e| - s z)^2 >= 2 omega |X B(e + s y1, e + s y1)|,

which solves in closed form as well. Only the end is corrected to the tolerance. Rounding is not counted
here: within the root of EPS of a pose where two branches cross, it may hide that they do.

One pose on its way from the drawing takes longer steps, along a power series of the path (see `proven_path`);
tangents lead where no few of these are proven to reach the end, and tell where a path stops.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from pointcoord.data_classes import dataclass
from pointcoord.linkage.drawing_orientation import turned_over
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.block_inverse import product_of_few_entries
from pointcoord.numerics.branch import hidden, orientation, same_side
from pointcoord.numerics.counters import Work
from pointcoord.numerics.linear import Factors, factorise, smallest_left_singular_vector
from pointcoord.numerics.newton import newton_refine
from pointcoord.numerics.quadratic import QuadraticMap
from pointcoord.solve.curved_path import LONGEST, Path, along
from pointcoord.solve.proven_path import proven_end
from pointcoord.solve.status import Blocked

Array = NDArray[np.float64]

# Fraction of the proven step: at 1 Newton's convergence from the tangent would be only linear.
SAFETY = 0.8
# A path that advances less than this fraction in a step has met the end of what can be assembled: steps
# shrink in proportion to the distance to the end, which is then near 1e-12 of the path. The end is a fold,
# where two assemblies meet as the root of the distance: they are still 1e-6 of the path apart, and
# rounding, which grows as the inverse of that root, is near 1e-10.
SMALLEST_STEP = 1e-13
STEPS = 2000
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


def proven_step(
    system: QuadraticMap, factors: Factors, tangent: Array, correction: Array | None = None
) -> Array:
    """Largest s for which the tangent step is proven to stay on its branch, shape (...,).

    The condition holds if it holds in any weighted maximum norm. Three are tried: plain, and two that
    weigh each coordinate by the curvature of its own path, so that what hardly moves hardly counts.

    Args:
        factors: of C_u at the start. tangent: y1, shape (..., size).
        correction: e, shape (..., size); none if the start is exact.
    """
    n, inverse = system.unknowns, factors.preconditioner

    def bent(rows: Array) -> Array:
        return np.asarray(np.abs(inverse @ rows[..., None])[..., 0])

    bend = bent(system.residual(tangent))
    turn = np.abs(product_of_few_entries(inverse, system.jacobian(tangent)))
    largest = bend.max(axis=-1, keepdims=True)
    best = np.zeros(tangent.shape[:-1])
    if correction is not None:
        own, both = bent(system.residual(correction)), bent(2.0 * system.polar(correction, tangent))
    tried = np.stack([np.ones_like(bend), bend + 0.3 * largest, bend + 0.02 * largest])
    omegas = system.lipschitz(inverse, tried)
    for weights, omega in zip(tried, omegas, strict=True):
        q = (bend / weights).max(axis=-1)
        z = ((turn @ weights[..., None])[..., 0] / weights).max(axis=-1)
        if correction is None:
            best = np.fmax(best, 1.0 / (z + np.sqrt(2.0 * omega * q)))
            continue
        # The smaller root of (a - s z)^2 = 2 omega (q s^2 + c s + b), with a > 0 left after the correction.
        a = 1.0 - omega * (np.abs(correction[..., :n]) / weights).max(axis=-1)
        b, c = ((part / weights).max(axis=-1) for part in (own, both))
        room, slope = a * a - 2.0 * omega * b, a * z + omega * c
        root = np.sqrt(np.maximum(slope * slope - (z * z - 2.0 * omega * q) * room, 0.0))
        best = np.fmax(best, np.where((a > 0.0) & (room > 0.0), room / (slope + root), 0.0))
    return best


def follow(
    system: QuadraticMap,
    y: Array,
    target: Array,
    factors: Factors | None = None,
    tolerance: float = 0.0,
    steps: int = STEPS,
) -> Path:
    """Carry poses along straight paths to other known coordinates.

    Args:
        y: start, shape (..., size); what its residual is not zero by is taken back along the path.
        target: known coordinates at the end, shape (..., size - unknowns).
        factors: factorisation of C_u at y, if it is at hand.
        tolerance: how far the end may be from the exact assembly, rounding apart, in units.
        steps: at most so many.
    Returns:
        Poses at the ends of their paths, or where these stop.
    """
    n = system.unknowns
    batch = np.broadcast_shapes(y.shape[:-1], target.shape[:-1])
    y = np.broadcast_to(y, (*batch, y.shape[-1])).reshape(-1, y.shape[-1]).copy()
    target = np.broadcast_to(target, (*batch, target.shape[-1])).reshape(len(y), -1)
    start, offset = y[:, n:].copy(), system.residual(y)
    change = target - start
    remaining, rest = np.ones(len(y)), np.zeros(len(y))
    iterations = np.zeros(len(y), dtype=np.int64)
    work = Work(residuals=len(y))
    if factors is None or factors.condition.shape != batch:
        factors = factorise(system.jacobian(y))
        work += Work(factorisations=len(y))
    factors = factors.reshaped((len(y),))
    side = orientation(system, factors)
    active = np.flatnonzero(~factors.singular & ~(change.any(axis=-1) & hidden(system, y, factors)))
    for _ in range(steps):
        if not active.size:
            break
        left, local = remaining[active], factors.taken(active)
        here, wanted = y[active], offset[active] * left[:, None]
        tangent = _tangent(system, here, local, change[active] * left[:, None], wanted)
        correction = _correction(system, here, local, wanted) if rest[active].any() else None
        with np.errstate(all="ignore"):
            step = np.minimum(SAFETY * proven_step(system, local, tangent, correction), 1.0)
        # False for a NaN as well; a step that completes the path may be as short as it likes.
        able = (step * left >= SMALLEST_STEP) | (step >= 1.0)
        active, tangent, step, left = active[able], tangent[able], step[able], left[able]
        left = np.where(step >= 1.0, 0.0, left * (1.0 - step))
        guess = y[active] + step[:, None] * tangent
        if correction is not None:
            guess += correction[able]
        ahead = start[active] + change[active] * (1.0 - left)[:, None]
        guess[:, n:] = np.where((left == 0.0)[:, None], target[active], ahead)
        if not active.size:
            break
        # On the way it is enough to be where Newton's method is proven to converge.
        allowed = np.where(left == 0.0, tolerance, np.inf)
        reached = newton_refine(system, guess, offset[active] * left[:, None], allowed)
        work = work + reached.work
        # In exact arithmetic every correction converges and no path crosses a fold, where the determinant
        # changes its sign. One that does has run out of digits: a drawing on a fold, to within rounding. The
        # factors at hand are of the place before the last step, which may lie on the other side.
        there = factorise(system.jacobian(reached.y))
        work += Work(factorisations=len(active))
        good = reached.converged & same_side(system, reached.y, there, side[active], left == 0.0)
        active, left = active[good], left[good]
        y[active], remaining[active], iterations[active] = reached.y[good], left, reached.iterations[good]
        rest[active] = reached.left[good]
        factors = factors.replaced(active, there.taken(np.flatnonzero(good)))
        active = active[left > 0.0]
    stopped = np.flatnonzero((remaining > 0.0) & (rest > 0.0))
    if stopped.size:
        # Where a path ends is told as exactly as an assembly is.
        ends = newton_refine(system, y[stopped], offset[stopped] * remaining[stopped][:, None])
        there = factorise(system.jacobian(ends.y))
        work += ends.work + Work(factorisations=len(stopped))
        good = ends.converged & same_side(system, ends.y, there, side[stopped], True)
        stopped = stopped[good]
        y[stopped], rest[stopped] = ends.y[good], 0.0
        factors = factors.replaced(stopped, there.taken(np.flatnonzero(good)))
    return Path(
        y=y.reshape(*batch, -1),
        factors=factors.reshaped(batch),
        iterations=iterations.reshape(batch),
        left=rest.reshape(batch),
        done=(1.0 - remaining).reshape(batch),
        work=work,
    )


def led(
    system: QuadraticMap, y: Array, target: Array, factors: Factors | None = None, tolerance: float = 0.0
) -> Path:
    """What `follow` gives; one pose goes along a few series where these prove the whole path.

    Args, result: as of `follow`.
    """
    if y.ndim == 1 and target.ndim == 1:
        first = factorise(system.jacobian(y)) if factors is None else factors
        end = proven_end(system, y, target, first, system.residual(y), tolerance)
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
    tangent = _tangent(system, y[None], factors.reshaped((1,)), target[None] - y[system.unknowns :], 0.0)[0]
    guess = y + tangent
    guess[system.unknowns :] = target
    with np.errstate(all="ignore"):
        reached = newton_refine(system, guess)
        there = factorise(system.jacobian(reached.y))
        beside = np.abs(reached.y - guess).max() <= BESIDE * np.abs(tangent).max()
    kept = float(orientation(system, there)) == float(orientation(system, factors))
    return reached.y if bool(beside and reached.converged) and kept else None


def _correction(system: QuadraticMap, y: Array, factors: Factors, wanted: Array) -> Array:
    """What places are still off, e with C_u e = -(C(y) - wanted), shape (members, size)."""
    correction = np.zeros_like(y)
    with np.errstate(all="ignore"):
        correction[:, : system.unknowns] = -factors.solve(system.residual(y) - wanted)
    return correction


def _tangent(system: QuadraticMap, y: Array, factors: Factors, change: Array, offset: Array | float) -> Array:
    """What is left of a path if it went on straight, C_u u1 = -(C_w w1 + offset), shape (members, size).

    Args:
        change: of the known coordinates, w1. offset: residual that is still to be taken back.
    """
    tangent = np.zeros_like(y)
    tangent[:, system.unknowns :] = change
    with np.errstate(all="ignore"):
        tangent[:, : system.unknowns] = -factors.solve(2.0 * system.polar(y, tangent) + offset)
    return tangent


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

    path = along(mechanism.map, y, law, LONGEST / max(float(turn.max()), LONGEST), tolerance)
    return target, path.reshaped(batch)


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
