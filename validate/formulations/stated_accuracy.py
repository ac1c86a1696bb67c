r"""Error bounds of all numbers of a model or solver, from its stated accuracy of points, in mm.

This is the only source of error bounds for formulations that prove nothing: the model in Pinocchio, the trees
of joints, outside programs and users' solvers. Each states the accuracy of its points.

A solver of accuracy e returns a pose whose points are off by up to e in every coordinate. The residual of the
equations of the many-digit reference, C(y, t) = 0, at such a pose y + dy is at most

    rho_i = e sum_k |sum_j C'_ij dy_j/dx_k|,

with the coordinates x_k of the points from which the unknowns y_j are read. The reading is differentiated, so
the error of a body whose matrix is read from three points includes the errors of all three. For a link rho
is a length error of e to sqrt(3) e at each end, for a joint a gap of this size, for a body an error of its
shape. The solver's answer is the exact pose of a car whose lengths are off, or whose joints have gaps, by as
much. With links alone the toe of a double wishbone would have a tolerance 2.5 times smaller, but this
tolerance would not apply to a solver that places bodies.

The effect on the motion follows from C(y, t) = delta with a constant delta, |delta_i| <= rho_i:

    C' dy   = delta,      C' dy'  = -(C')' dy,      C' dy'' = -2 (C')' dy' - (C')'' dy,

with the rates of C' along the motion, and for every number q(y, y', y'') from its own derivative. The signs
are the worst: the sum over the rows i of |dq / d delta_i| rho_i. All of this uses the reference's own code of
its equations (`residual`, `jacobian`, `points_of`, `body_turns`, the angles), evaluated with dual numbers of
arrays instead of balls: a tolerance does not need 60 digits.

A number is also read from points that are themselves off by e, on bodies that turn with |omega| <= W and
|alpha| <= A. V and B are the largest speed and acceleration relative to the chassis, and L is the car's size,
for bodies that move without turning; the motion that the chassis adds to every point alike turns no body:

    position                e
    velocity                e_1 = sqrt(3) e (W + V / L)
    acceleration            e_2 = sqrt(3) e (A + W^2 + B / L)
    jerk                    e_3 = sqrt(3) e (|alpha'| + 3 A W + W^3 + J / L), J the largest jerk, and so on
    turning of a body       2 e_1 / h and 2 e_2 / h, h the least height of the triangle of its three points
    an angle                both ends of its line off by e, through the line's length

and each number is rounded once when it is returned, and once when the part of the chassis is added.

Some models are known to solve equations for their rates. These equations then have a residual as well: for
the order k it is e_k / e times the residual of the pose, as if delta changed. For the order d this adds

    sum_k C(d, k) (e_k / e) |dp^(d-k)|,      k = 1 .. d,

with dp^(j) the effect of a constant delta on the derivative of order j of a point. The rates of the numbers
of the car are treated likewise.

These derivatives hold at the pose itself. Within +-delta the Jacobian changes; let
r = |sum_i |C'^-1 dC'_i|| be the largest relative change (maximum norm). A first-order estimate may then be
too small. Near a fold, where an input reaches an extreme, y ~ sqrt(d) and d ~ delta, where r = delta / (2 d):
the derivatives of position, velocity and so on grow by (1 - 2 r) to the power -1/2, -3/2 and so on. By the
mean value theorem these factors cover the higher orders. At r = 1/2 the pose may be beyond the fold, or in
another assembly (as in Kantorovich's condition for Newton's method). From LIMIT on the accuracy gives no
bound at the instant, and the instant is not tested.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from itertools import combinations
from math import comb, sqrt

import numpy as np

from pointcoord import Scene
from pointcoord.effects.registry import QUANTITIES
from pointcoord.method import AUTO
from pointcoord.numerics.rounding import UNIT_ROUNDOFF
from validate.arrays import Array, Flags
from validate.formulations.accuracy_of_forces import claims_of_forces
from validate.formulations.asked_numbers import asked_numbers, asked_of_the_car, is_force, per_second
from validate.formulations.input_rates import laws_of
from validate.formulations.point_coordinates import PointCoordinates
from validate.formulations.protocol import NOTHING, Accuracy
from validate.reference import Design
from validate.reference.car_data import KNUCKLE, TIME
from validate.reference.design import Known, values_only
from validate.reference.effects.at_pose import drawn_car, driven_along, numbers_of
from validate.reference.effects.car import Car
from validate.reference.effects.registry import EFFECTS
from validate.reference.in_doubles import (
    by_doubles,
    inverse_of,
    jacobian_of,
    known_in_doubles,
    local_places,
    motion_of_a_miss,
    values_of,
    with_slopes,
)
from validate.reference.jet import Jet, part_of, slope_of, value_of
from validate.reference.kinematics import body_turns, with_rates
from validate.reference.mechanism import CHASSIS
from validate.reference.vectors import Scalar, Vector, each

LIMIT = 0.45  # of r: above it a first-order estimate gives no bound
FLATTEST = 1e-3  # least height of a body's triangle / size: a solver would use other points of a flatter body
OFF_THE_POSE = 1e-6  # of the size: if Newton's step is larger, the reference has no pose near the points
MOST_STEPS = 8  # of Newton's method, which doubles the digits in each step
AT_ONCE = 1024  # instants in a block: each needs a matrix for each row's change of the Jacobian
ROOT_3 = sqrt(3.0)
Way = tuple[str, str | None]
"""The prefix of a part of the mechanism, and the input or time by which derivatives are taken."""


def accuracy_for(scene: Scene, accuracy: float) -> Accuracy:
    """Error bounds of a solver with a stated accuracy, mm, in a scene, at pointcoord's poses.

    Raises:
        FormulationError: the scene cannot be solved.
    """
    return accuracy_at(scene, accuracy, places_in(scene), laws_of(scene, scene.instants))


def places_in(scene: Scene) -> Mapping[str, Array]:
    """Position of every point of a scene by pointcoord, (N, 3), mm.

    Raises:
        FormulationError: the scene cannot be solved.
    """
    every = scene.model_copy(update={"effects": (), "points": None})
    poses = PointCoordinates("pointcoord", AUTO).solve(every).numbers
    return next(arrays for q, arrays in poses.items() if QUANTITIES[q].of == "point" and not per_second(q))


def accuracy_at(
    scene: Scene,
    accuracy: float | Array,
    places: Mapping[str, Array],
    laws: Mapping[str, Array],
    solves_rates: bool = False,
) -> Accuracy:
    """Error bounds of a solver with a stated accuracy, at poses that are already solved.

    Args:
        accuracy: mm, for each instant, (N,), or one for all.
        places: position of every point, (N, 3), mm.
        laws: every input with its time derivatives, (N, orders); zero derivatives for poses alone.
        solves_rates: whether the rates are known to be solved from equations, whose residual is then added.
    """
    design = Design.from_plain(scene.mechanism.plain(tuple(scene.inputs)))
    held = _Held(scene, design, solves_rates)
    count = len(next(iter(places.values())))
    off = np.broadcast_to(accuracy, count)
    parts = []
    for low in range(0, count, AT_ONCE):
        some = slice(low, low + AT_ONCE)
        at = {name: place[some] for name, place in places.items()}
        # At instants without a pose the numbers, which get no bound, may divide by zero.
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            parts.append(held.at(off[some], at, {name: law[some] for name, law in laws.items()}))
    claims = {
        q: {n: np.concatenate([one.claims[q][n] for one in parts]) for n in of}
        for q, of in parts[0].claims.items()
    }
    blind = np.concatenate([one.blind for one in parts if one.blind is not None])
    condition = np.concatenate([one.condition for one in parts])
    if any(map(is_force, held.asked)):
        claims |= claims_of_forces(scene, off, condition)
    return Accuracy(condition, claims, blind=blind)


@dataclass(frozen=True)
class _Motion:
    """A motion through the poses, and the effect of a residual of each equation on it.

    Attributes:
        rates: the unknowns with their time derivatives, arrays (N,).
        off: the same as duals, with slopes by the residual of each row, (rows, N).
    """

    known: Known
    rates: Sequence[Jet]
    off: Sequence[Jet]

    @classmethod
    def of(cls, known: Known, values: Sequence[Array], inverse: Array, missed: Array) -> _Motion:
        """From the poses, the inverse of C' there, and the residual of each equation, (N, rows)."""
        rates = with_rates(values, known, by_doubles(inverse))
        # A residual of one row moves the unknowns along a column of the inverse.
        slopes = motion_of_a_miss(np.einsum("nij,nj->ijn", inverse, missed), rates, inverse, known)
        return cls(known, rates, with_slopes(rates, slopes))


class _Held:
    """A car whose points are slightly off.

    Attributes:
        size: size of the car, in units of the design.
        heights: greatest of the least heights of the triangles of a body's points, by body, in these units.
    """

    def __init__(self, scene: Scene, design: Design, solves_rates: bool) -> None:
        self.solves = solves_rates
        self.design = design
        self.unit = float(design.unit)
        self.origin = np.array([float(x) for x in design.origin])
        self.asked = asked_numbers(scene)
        known = [name for name in asked_of_the_car(scene) if name.rpartition(".")[2] in EFFECTS]
        self.of_car = numbers_of(design, known)
        needs = {(p, need) for number in self.of_car for p in number.corners for need in number.effect.needs}
        # Each point needs its own columns, so only points that enter a number are kept.
        whole = {prefix: drawn_car(design, float, prefix) for prefix, _ in sorted(needs)}
        self.drawn = {
            prefix: replace(
                car, ends={role: ends for role, ends in car.ends.items() if (prefix, role) in needs}
            )
            for prefix, car in whole.items()
        }
        drawn = {name: np.array([float(x) for x in place]) for name, place in design.table.items()}
        self.size = float(np.max(np.ptp(np.array(list(drawn.values())), axis=0)))
        bodies = {name: points for name, points in design.plain["bodies"].items() if name != CHASSIS}
        self.heights = {
            body: max(
                max(_height(*(drawn[name] for name in three)) for three in combinations(points, 3)),
                FLATTEST * self.size,
            )
            for body, points in bodies.items()
        }

    def at(self, accuracy: Array, places: Mapping[str, Array], laws: Mapping[str, Array]) -> Accuracy:
        """The error bounds at some instants, from the positions of all points, (N, 3), mm, and inputs."""
        off = accuracy / self.unit
        known = known_in_doubles(self.design, laws, len(off))
        still = values_only(known)
        values, inverse, matrix, blind = self._pose(places, still)
        missed = off[:, None] * self._missed(places, matrix, still)
        motion = _Motion.of(known, values, inverse, missed)
        change = _change(motion, inverse)
        blind |= ~(change < LIMIT)
        orders = range(known.derivatives + 1)
        growth = [(1.0 - 2.0 * np.where(blind, 0.0, change)) ** -(0.5 + d) for d in orders]
        ways = {(prefix, number.effect.along) for number in self.of_car for prefix in number.corners}
        along = {}
        for prefix, way in ways:
            if way is not None:
                driven = driven_along(self.design, known, prefix, way)
                moving = driven is not known
                along[prefix, way] = _Motion.of(driven, values, inverse, missed) if moving else motion
        claims = self._claims(off, motion, growth, along)
        condition = np.abs(matrix).sum(axis=-1).max(axis=-1) * np.abs(inverse).sum(axis=-1).max(axis=-1)
        said = {
            q: {
                n: np.where(blind.reshape(-1, *(1,) * (claim.ndim - 1)), NOTHING, claim)
                for n, claim in of.items()
            }
            for q, of in claims.items()
        }
        return Accuracy(np.nan_to_num(condition, posinf=NOTHING), said, blind=blind)

    def _pose(self, places: Mapping[str, Array], known: Known) -> tuple[list[Array], Array, Array, Flags]:
        """The unknowns, the inverse of their Jacobian, the Jacobian, and the instants without a pose nearby.

        The points of a faulty model are off; the bounds hold at the right pose, a few Newton steps away.
        """
        local = local_places(self.design, places, known)
        count = len(next(iter(places.values())))
        read = self.design.mechanism.unknown_of(local, known.numbers, float)
        values = drawn = np.array([np.broadcast_to(x, count) for x in read], dtype=float)
        matrix = jacobian_of(list(values), known)
        for _ in range(MOST_STEPS):
            before, inverse = matrix, inverse_of(matrix)
            step = np.array(by_doubles(inverse)(known.residual(list(values))))
            blind = ~(np.abs(step).max(axis=0) < OFF_THE_POSE * self.size)
            values = values + step
            matrix = jacobian_of(list(values), known)
            # Where a step changes the Jacobian so much, doubles do not determine the pose.
            blind |= ~(np.abs(inverse @ (matrix - before)).sum(axis=-1).max(axis=-1) < LIMIT)
            if not blind.any():
                break
        else:
            values = np.where(blind, drawn, values)
            matrix = jacobian_of(list(values), known)
        return list(values), inverse_of(matrix), matrix, blind

    def _missed(self, places: Mapping[str, Array], matrix: Array, known: Known) -> Array:
        """Residual of each equation if points are off by 1 in each coordinate, (N, rows).

        With the worst signs, in local lengths.
        """
        local = local_places(self.design, places, known)
        off = np.eye(3 * len(local))[:, :, None]
        points: dict[str, Vector] = {}
        for first, (name, (x, y, z)) in enumerate(local.items()):
            i = 3 * first
            points[name] = Jet(x, off[i]), Jet(y, off[i + 1]), Jet(z, off[i + 2])
        read = self.design.mechanism.unknown_of(points, known.numbers, float)
        shape = (len(off), len(matrix))
        slopes = np.array([np.broadcast_to(slope_of(x), shape) for x in read])
        return np.asarray(np.abs(matrix @ slopes.transpose(2, 0, 1)).sum(axis=-1))

    def _per_length(self, motion: _Motion, count: int) -> list[Array]:
        """Error of a place read from a point that is off by 1, and of its derivatives e_d / e, each (N,).

        For a rotation R with R' = Omega R, |R^(d+1)| <= sum_k C(d, k) |Omega^(k)| |R^(d-k)|.
        """
        known = motion.known
        points, turns = known.points_of(motion.rates), body_turns(motion.rates, known)
        found, turned, spins = [np.ones(count)], [np.ones(count)], list[Array]()
        base = points[self.design.plain["bodies"][CHASSIS][0]]
        for d in range(known.derivatives):
            spins.append(np.max([_lengths(values_of(turn[d], count)) for turn in turns.values()], axis=0))
            turned.append(np.asarray(sum(comb(d, k) * spins[k] * turned[d - k] for k in range(d + 1))))
            still = values_of(part_of(base, d + 1), count)
            speeds = [_lengths(values_of(part_of(p, d + 1), count) - still) for p in points.values()]
            found.append(ROOT_3 * (turned[-1] + np.max(speeds, axis=0) / self.size))
        return found

    def _claims(
        self, off: Array, motion: _Motion, growth: Sequence[Array], along: Mapping[tuple[str, str], _Motion]
    ) -> dict[str, dict[str, Array]]:
        known, count = motion.known, len(off)
        points, turns = known.points_of(motion.off), body_turns(motion.off, known)
        chassis = points[self.design.plain["bodies"][CHASSIS][0]]
        per_length = self._per_length(motion, count)

        @cache
        def moved(name: str, order: int) -> Array:
            """Error of a derivative of a point from a constant residual of the equations."""
            return _off(part_of(points[name], order), count) * growth[order][:, None]

        def solved_for(name: str, order: int) -> Array | float:
            """Further error of the derivative from the residual of the equations for rates."""
            orders = range(1, order + 1) if self.solves else ()
            return sum(comb(order, k) * per_length[k][:, None] * moved(name, order - k) for k in orders)

        far = UNIT_ROUNDOFF * np.abs(self.origin) / self.unit
        of_car = self._of_car(off, motion, growth, along)
        claims: dict[str, dict[str, Array]] = {}
        for quantity, names in self.asked.items():
            if is_force(quantity):
                continue  # `accuracy_of_forces`
            d, of = per_second(quantity), QUANTITIES[quantity].of
            if d >= len(growth):
                continue  # the inputs' own derivatives are not known so far
            if of == "point":
                # Rounded once when the number is returned, and once when the part of the chassis is added.
                added = UNIT_ROUNDOFF * np.abs(values_of(part_of(chassis, d), count)) if d else far
                claims[quantity] = {
                    n: self.unit
                    * (
                        moved(n, d)
                        + solved_for(n, d)
                        + (off * per_length[d])[:, None]
                        + UNIT_ROUNDOFF * np.abs(values_of(part_of(points[n], d), count))
                        + added
                    )
                    for n in names
                }
            elif of == "body":
                claims[quantity] = {
                    n: _off(turns[n][d - 1], count) * growth[d][:, None]
                    + 2.0 * (off * per_length[d])[:, None] / self.heights[n]
                    + UNIT_ROUNDOFF * np.abs(values_of(turns[n][d - 1], count))
                    for n in names
                }
            else:
                claims[quantity] = {n: of_car[n] for n in names if n in of_car}
        return claims

    def _of_car(
        self,
        off: Array,
        motion: _Motion,
        growth: Sequence[Array],
        along: Mapping[tuple[str, str], _Motion],
    ) -> dict[str, Array]:
        """Error bounds of the numbers of the car, from the error of the pose and of the points of each."""
        places = [jet.value for jet in motion.off]
        cars: dict[Way, Car] = {
            (p, None): self._car(p, off, places, motion.known, growth) for p in self.drawn
        }
        for (prefix, way), driven in along.items():
            pose = [Jet(jet.value, jet.part(1)) for jet in driven.off]
            moved = self._per_length(driven, len(off))[1]
            if way == TIME and self.solves:
                pose = [_with_missed_rates(y, moved) for y in pose]
            cars[prefix, way] = self._car(prefix, off, pose, driven.known, growth, moved)
        found = {}
        for number in self.of_car:
            value = number.value(lambda *way: cars[way], self.unit)
            claim = np.abs(slope_of(value)).sum(axis=0) + 2.0 * UNIT_ROUNDOFF * np.abs(value_of(value))
            # Where a number does not exist (0/0), a model may still give a quotient of rounding errors.
            found[number.name] = np.where(np.isfinite(claim), claim, NOTHING)
        return found

    def _car(
        self,
        prefix: str,
        off: Array,
        pose: Sequence[Scalar],
        known: Known,
        growth: Sequence[Array],
        per_length: Array | None = None,
    ) -> Car:
        """A part's car, with each point off independently; if the car moves, the rates of points are off too.

        The points of all parts have columns, so that a number can combine two parts.
        """
        places = tuple(dict.fromkeys(name for drawn in self.drawn.values() for name in drawn.points))
        bodies = [self.design.role(f"{one}{KNUCKLE}") for one in self.drawn]
        placed = known.equations.points_of(pose, places)
        count = 3 * (len(places) + 2 * len(bodies))

        def apart(place: Vector, number: int, off: Array, rate: Array) -> Vector:
            """A point, or a line of a body, off by `off` in each coordinate, and its rate by `rate`."""
            own = partial(_with_own, first=3 * number, count=count)
            if per_length is None:
                return own(place, off, growth=growth[0])
            values = own(each(value_of, place), off, growth=growth[0])
            slopes = own(each(slope_of, place), rate, growth=growth[1])
            x, y, z = (Jet(value, slope) for value, slope in zip(values, slopes, strict=True))
            return x, y, z

        rate = off * (0.0 if per_length is None else per_length)
        own = self.drawn[prefix].points
        held = {name: apart(placed[name], places.index(name), off, rate) for name in own}
        body, lines = self.design.role(f"{prefix}{KNUCKLE}"), []
        turns = per_length is not None and body in self.design.mechanism.frames
        first = len(places) + 2 * bodies.index(body)
        for i, line in enumerate(known.equations.frame_of(pose, body) if turns else (), first):
            # A body turns by the error of its points / its least height, at both ends.
            length = 2.0 * _lengths(values_of(each(value_of, line), len(off))) / self.heights[body]
            lines.append(apart(line, i, off * length, rate * length))
        frame = (lines[0], lines[1]) if lines else None
        chassis = known.chassis.still() if per_length is None else known.chassis
        return self.drawn[prefix].at(chassis, held, frame)


def _height(a: Array, b: Array, c: Array) -> float:
    """The least height of a triangle; 0 if its three points coincide."""
    area = float(np.linalg.norm(np.cross(b - a, c - a)))
    longest = max(float(np.linalg.norm(side)) for side in (b - a, c - a, c - b))
    return area / longest if longest > 0.0 else 0.0


def _change(motion: _Motion, inverse: Array) -> Array:
    """r of the top of this file, (N,)."""
    columns: dict[int, list[tuple[int, Array]]] = {}
    known = values_only(motion.known)
    for i, j, entry in known.equations.jacobian([jet.value for jet in motion.off], known.numbers):
        if isinstance(entry, Jet):
            columns.setdefault(j, []).append((i, np.asarray(entry.slope)))
    relative = np.zeros(inverse.shape[:2])
    # Few rows change in a column.
    for entries in columns.values():
        changes = np.stack([slope for _, slope in entries]).transpose(2, 0, 1)
        relative += np.abs(inverse[:, :, [i for i, _ in entries]] @ changes).sum(axis=-1)
    return np.asarray(relative.max(axis=-1))


def _with_missed_rates(unknown: Jet, per_length: Array) -> Jet:
    """With as many further slopes, of the rate alone: effects of residuals of the equations for rates."""
    value, rate = unknown.value, unknown.slope
    missed = [
        np.concatenate(both)
        for both in ((value.slope, 0.0 * value.slope), (rate.slope, per_length * value.slope))
    ]
    return Jet(*(Jet(one.value, slopes) for one, slopes in zip((value, rate), missed, strict=True)))


def _with_own(place: Vector, off: Array, first: int, count: int, growth: Array) -> Vector:
    """A point with `count` further slopes; the slopes of its coordinates, `off`, begin at number `first`."""
    coordinates = []
    for axis, coordinate in enumerate(place):
        value = np.broadcast_to(value_of(coordinate), growth.shape)
        slopes = np.broadcast_to(
            slope_of(coordinate) * growth, (np.shape(slope_of(coordinate))[0], len(growth))
        )
        more = np.zeros((count, len(growth)))
        more[first + axis] = off
        coordinates.append(Jet(value, np.concatenate([slopes, more])))
    x, y, z = coordinates
    return x, y, z


def _off(vector: Vector, count: int) -> Array:
    """The sum of the absolute values of the slopes, (N, 3)."""
    return np.stack([np.broadcast_to(np.sum(np.abs(slope_of(x)), axis=0), count) for x in vector], axis=-1)


def _lengths(vectors: Array) -> Array:
    # Squares of slow rates, such as 1e-175 mm/s, would underflow.
    return np.asarray(np.hypot.reduce(vectors, axis=-1))
