r"""Many poses of one car at unrelated inputs, each solved and proven by itself.

Boxes of inputs cover what is asked. The middle of each is reached from the closed drawing along a proven path
(see `paths_together`). With X = C_u^-1 there and the tangent T(x) to the inputs of a box, C is quadratic, so
that one test of Newton and Kantorovich's theorem, block by block (see `block_proof`), with

    |X B(T, T)| <= sum_ij |X B(T_i, T_j)|,      |X C_u(T)| <= sum_i |X C_u(T_i)|,

proves that at all inputs of the box there is one assembly near the tangent, and that these are one branch,
the drawing's. A box for which that is not so is divided. A pose then starts from a power series about the
middle of its box, takes one step of Newton's method or two, and is held to its box: it must lie where the
box's assembly is the only one, and by the theorem about itself it is off by little more than |X C(y)|,
rounding included. Whatever is not confirmed goes along a path of its own, and then the plain way, which says
what stops it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property
from itertools import combinations_with_replacement

import numpy as np
from numpy.typing import NDArray

from pointcoord.data_classes import dataclass
from pointcoord.errors import AssemblyError
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.batch_last.elimination import Eliminated
from pointcoord.numerics.batch_last.series import ColumnSeries
from pointcoord.numerics.rounding import EPS
from pointcoord.solve.assembly import assemble, close_drawing
from pointcoord.solve.paths_together import CHUNK, Columns, columns_of, follow_together
from pointcoord.solve.status import Status, blocked_by

Array = NDArray[np.float64]
Numbers = NDArray[np.intp]

# Order of the series from which poses start: what it leaves out of a box is squared by one Newton step.
ORDER = 5
# How often a box is divided, boxes at most, and poses for which a box is worth its proof.
DIVISIONS, MOST_BOXES, WORTH = 6, 20_000, 40
NEWTON = 3
# |I - X J| of an inverse by elimination: some eps times the condition; beyond 1e8 nothing would be proven.
INEXACT = 1e-6
# What a pose may be off the tangent at least, in units, where the tangent is exact.
NEAREST = 1e-9


@dataclass(frozen=True)
class UnrelatedPoses:
    """Poses of one car.

    Attributes:
        unknowns: coordinates, shape (unknowns, N), in the mechanism's units; NaN where there is no pose.
        bound: proven distance of every coordinate of a solved point to the exact assembly, (N,), mm, for what
            the inputs' values and the drawing mean; infinite where there is no pose.
        failures: by number, what stopped a pose.
    """

    unknowns: Array
    bound: Array
    failures: Mapping[int, Status]


@dataclass(frozen=True)
class _Boxes:
    """Proven boxes, a column each.

    Attributes:
        middle, half: of the driven coordinates, shape (driven, boxes).
        y: coordinates at the middle, shape (size, boxes).
        tangents, powers: coefficients of the unknowns by parts of the half widths, shapes (driven, unknowns,
            boxes) and (monomials, unknowns, boxes).
        inverse: entries of X. omega, contraction, alone: by block; |I - X C_b| within a distance of the
            tangent in which there is no other assembly, and that distance.
    """

    middle: Array
    half: Array
    y: Array
    tangents: Array
    powers: Array
    inverse: Array
    omega: Array
    contraction: Array
    alone: Array

    def part(self, kept: NDArray[np.bool_]) -> _Boxes:
        return _Boxes(
            *(np.ascontiguousarray(getattr(self, name)[..., kept]) for name in self.__dataclass_fields__)
        )


def solve_unrelated(mechanism: Mechanism, inputs: Mapping[str, Array], tolerance: float) -> UnrelatedPoses:
    """The poses of one car at any inputs, on the branch of its drawing.

    Args:
        inputs: value of each input that drives the linkage, each (N,), rad or mm.
        tolerance: bound that a pose should keep, mm; rounding may leave more.
    Raises:
        AssemblyError: the drawing cannot be closed.
        InputOutOfRange, UnknownName: as `Mechanism.known_series`.
    """
    topology, layout, n = mechanism.topology, mechanism.layout, mechanism.map.unknowns
    closed = close_drawing(mechanism)
    series = {name: np.asarray(value, dtype=float)[..., None] for name, value in inputs.items()}
    driven = [layout.scalar(drive.coordinate) for drive in topology.drives]
    mechanism.known_series({name: value[:1] for name, value in series.items()})
    asked = np.stack(
        [drive.series(series[drive.input], mechanism.drawing)[:, 0] for drive in topology.drives]
    )
    count = asked.shape[-1]
    found, bound = np.full((n, count), np.nan), np.full(count, np.inf)
    constants = ((layout.zero, 0.0), (layout.one, 1.0))
    columns = columns_of(mechanism.map, constants, driven, closed.y)
    rest = np.arange(count)
    if columns is not None:
        solver = _Solver(mechanism, columns, closed.y, asked, found, bound, tolerance)
        rest = solver.by_boxes(rest)
        rest = solver.by_paths(rest)
    failures: dict[int, Status] = {}
    for number in rest.tolist():
        values = {name: value[number] for name, value in inputs.items()}
        try:
            pose = assemble(mechanism, values, None, closed)
        except AssemblyError as error:
            failures[number] = blocked_by(error)
            continue
        found[:, number], bound[number] = pose.y[:n], float(pose.bound)
    return UnrelatedPoses(found, bound, failures)


@dataclass(frozen=True)
class _Solver:
    """What solving the poses needs.

    Attributes:
        closed: coordinates of the closed drawing. asked: driven coordinates, shape (driven, N).
        found, bound: to be filled in.
    """

    mechanism: Mechanism
    columns: Columns
    closed: Array
    asked: Array
    found: Array
    bound: Array
    tolerance: float

    def by_boxes(self, rest: Numbers) -> Numbers:
        """Solve poses from the middles of proven boxes; those that are left."""
        low, high = self.asked.min(axis=-1), self.asked.max(axis=-1)
        half = 0.5 * (high - low)
        half = np.where(half > 0.0, half, 1e-3)
        middle = (0.5 * (low + high))[:, None]
        # One box that holds everything, divided until it is proven.
        members = [rest]
        left: list[Numbers] = []
        for _ in range(DIVISIONS + 1):
            if not members:
                break
            boxes, proven = self._boxes(middle, half)
            self._solve(
                boxes, [own for own, good in zip(members, proven.tolist(), strict=True) if good], left
            )
            middle, half, members = self._divided(middle, half, members, proven, left)
            if len(members) > MOST_BOXES:
                break
        left += members
        return np.sort(np.concatenate([np.empty(0, dtype=np.intp), *left]))

    def by_paths(self, rest: Numbers) -> Numbers:
        """Solve poses along paths of their own; those that are left."""
        if not len(rest):
            return rest
        columns, n = self.columns, self.columns.map.unknowns
        y = np.repeat(self.closed[:, None], len(rest), axis=-1)
        target = y[n:].copy()
        target[[place - n for place in columns.driven]] = self.asked[:, rest]
        allowed = max(0.1 * self.tolerance / float(self.mechanism.unit), EPS)
        reached = follow_together(columns, y, target, allowed, closing=False)
        with np.errstate(all="ignore"):
            d = columns.map.differences(reached.y)
            factors = columns.factorise(d)
            inverse = factors.inverse()
            omega = columns.proof.lipschitz(np.abs(inverse))
            still = np.zeros_like(omega)
            off, _ = self._off(d, inverse, omega, still, np.abs(factors.entries))
        good = reached.done & (off <= self._reachable())
        self.found[:, rest[good]], self.bound[rest[good]] = reached.y[:n, good], off[good]
        return rest[~good]

    def _divided(
        self,
        middle: Array,
        half: Array,
        members: list[Numbers],
        proven: NDArray[np.bool_],
        left: list[Numbers],
    ) -> tuple[Array, Array, list[Numbers]]:
        """The boxes that are not proven, halved along every driven coordinate."""
        half = 0.5 * half
        middles, parts = [], []
        for number in np.flatnonzero(~proven).tolist():
            own = members[number]
            if len(own) < WORTH:
                left.append(own)
                continue
            above = self.asked[:, own] >= middle[:, number, None]
            code = (above * (1 << np.arange(len(half)))[:, None]).sum(axis=0)
            for corner in np.unique(code).tolist():
                signs = np.where([corner >> i & 1 for i in range(len(half))], 1.0, -1.0)
                middles.append(middle[:, number] + signs * half)
                parts.append(own[code == corner])
        return np.array(middles).T.reshape(len(half), -1), half, parts

    def _boxes(self, middle: Array, half: Array) -> tuple[_Boxes, NDArray[np.bool_]]:
        """Boxes of one size about middles, shape (driven, boxes), and which of them are proven."""
        columns, n = self.columns, self.columns.map.unknowns
        rows, proof, members = columns.map, columns.proof, middle.shape[-1]
        y = np.repeat(self.closed[:, None], members, axis=-1)
        target = y[n:].copy()
        target[[place - n for place in columns.driven]] = middle
        reached = follow_together(columns, y, target, EPS, closing=False)
        y = reached.y
        with np.errstate(all="ignore"):
            d = rows.differences(y)
            factors = columns.factorise(d)
            tangents = []
            for place, width in zip(columns.driven, half.tolist(), strict=True):
                tangent = np.zeros_like(y)
                tangent[place] = width
                u = factors.solve(rows.derivative(d, rows.differences(tangent)))
                tangent[:n] = -u
                tangents.append(tangent)
            along = [rows.differences(tangent) for tangent in tangents]
            inverse = factors.inverse()
            magnitude = np.abs(inverse)
            omega = proof.lipschitz(magnitude)
            turns = sum((proof.turns(inverse, rows.jacobian_along(e)) for e in along), np.zeros_like(omega))
            jacobian = np.abs(factors.entries) + sum(
                (np.abs(rows.jacobian_along(e)) for e in along), np.zeros_like(factors.entries)
            )
            missed = np.zeros((n, members))
            for i, j in combinations_with_replacement(range(len(along)), 2):
                times = rows.bilinear(along[i]) if i == j else rows.polar(along[i], along[j])
                missed += np.abs(proof.times(inverse, times))
            missed += np.abs(proof.times(inverse, rows.residual(d)))
            missed += proof.times(magnitude, rows.uncertainty(d, self._data))
            radius, turns = proof.radii(magnitude, omega, missed, turns + INEXACT, jacobian)
            # A computed pose is a little farther from the tangent than the exact one; nobody is taken beyond.
            reach = 2.0 * radius.max(axis=0) + NEAREST
            contraction = turns + proof.turning_of_all(magnitude) * reach
            alone = np.minimum(np.where(omega > 0.0, (1.0 - turns) / omega, np.inf), reach)
            proven = (
                reached.done
                & factors.sound
                & np.isfinite(radius).all(axis=0)
                & (contraction < 0.9).all(axis=0)
            )
            powers = self._powers(factors, y, half)
        boxes = _Boxes(
            middle,
            np.repeat(half[:, None], members, axis=-1),
            y,
            np.stack([tangent[:n] for tangent in tangents]),
            powers,
            inverse,
            omega,
            contraction,
            alone,
        )
        return boxes.part(proven), np.asarray(proven)

    def _powers(self, factors: Eliminated, y: Array, half: Array) -> Array:
        """Series of the unknowns in all driven coordinates, (monomials, unknowns, boxes), from series in
        lines.

        The terms of degree k along a direction v are sum over monomials of their coefficients times
        v^monomial, so series along as many directions as there are monomials of the highest degree give all
        of them.
        """
        columns, n, count = self.columns, self.columns.map.unknowns, len(half)
        directions = _directions(count)
        found: list[list[Array]] = [[] for _ in range(ORDER)]
        for direction in directions:
            series = ColumnSeries.begin(columns.map, factors, y, columns.driven, ORDER)
            for k in range(ORDER):
                series.carry_on(direction * half if k == 0 else np.zeros(count))
                found[k].append(series.y[k + 1, :n].copy())
        coefficients = []
        for k in range(1, ORDER + 1):
            table = np.array([[np.prod(v[list(m)]) for m in _monomials(count, k)] for v in directions])
            solved = np.linalg.pinv(table) @ np.stack(found[k - 1]).reshape(len(directions), -1)
            coefficients.append(solved.reshape(-1, *found[0][0].shape))
        return np.concatenate(coefficients)

    def _solve(self, boxes: _Boxes, members: list[Numbers], left: list[Numbers]) -> None:
        """Solve the poses of proven boxes, and add those that are not confirmed to what is left."""
        for number, own in enumerate(members):
            for low in range(0, len(own), CHUNK):
                part = own[low : low + CHUNK]
                y, off = self._in_box(boxes, number, self.asked[:, part])
                good = off <= self._reachable()
                self.found[:, part], self.bound[part] = y, off
                if not good.all():
                    self.found[:, part[~good]], self.bound[part[~good]] = np.nan, np.inf
                    left.append(part[~good])

    def _reachable(self) -> float:
        """The largest bound with which a pose is done, mm: the tolerance, or what rounding may leave."""
        return max(self.tolerance, 1e3 * EPS * float(self.mechanism.unit))

    def _in_box(self, boxes: _Boxes, number: int, asked: Array) -> tuple[Array, Array]:
        """Poses of one box and their bounds, mm, infinite where one is not confirmed."""
        columns, n = self.columns, self.columns.map.unknowns
        rows, proof, count = columns.map, columns.proof, asked.shape[-1]
        x = (asked - boxes.middle[:, number, None]) / boxes.half[:, number, None]
        y = np.repeat(boxes.y[:, number, None], count, axis=-1)
        y[columns.driven] = asked
        tangent = boxes.tangents[:, :, number].T @ x + y[:n]
        y[:n] += boxes.powers[:, :, number].T @ _powers_of(x)
        inverse, omega = (
            boxes.inverse[:, number, None],
            np.repeat(boxes.omega[:, number, None], count, axis=-1),
        )
        off = np.full(count, np.inf)
        with np.errstate(all="ignore"):
            for _ in range(NEWTON):
                d = rows.differences(y)
                factors = columns.factorise(d)
                y[:n] += columns.step(factors, d)
                d = rows.differences(y)
                contraction, jacobian = boxes.contraction[:, number, None], np.abs(rows.jacobian(d))
                off, radius = self._off(d, inverse, omega, contraction, jacobian)
                away = proof.largest(y[:n] - tangent) + radius
                off = np.where((away <= boxes.alone[:, number, None]).all(axis=0), off, np.inf)
                if (off <= self._reachable()).all():
                    break
        return y[:n], off

    def _off(
        self, d: Array, inverse: Array, omega: Array, contraction: Array, jacobian: Array
    ) -> tuple[Array, Array]:
        """Bound of poses with these differences, (members,), mm, and of each block in its norm."""
        columns, mechanism = self.columns, self.mechanism
        rows, proof = columns.map, columns.proof
        magnitude = np.abs(inverse)
        missed = np.abs(proof.times(inverse, rows.residual(d)))
        missed += proof.times(magnitude, rows.uncertainty(d, self._data))
        radius, _ = proof.radii(magnitude, omega, missed, contraction + INEXACT, jacobian)
        points = 3 * len(mechanism.topology.moving)
        each = radius.take(columns.owner[:points], axis=0) * proof.weights[:points, None]
        off = float(mechanism.unit) * each.max(axis=0) + EPS * float(np.abs(mechanism.origin).max())
        return np.where(np.isfinite(off), (1.0 + 1e-6) * off, np.inf), radius

    @cached_property
    def _data(self) -> Array:
        """Uncertainty of every coordinate for all that is asked, shape (size,)."""
        mechanism, columns = self.mechanism, self.columns
        y = self.closed.copy()
        y[columns.driven] = np.abs(self.asked).max(axis=-1)
        lacking, uncertainty = mechanism.known_data(y)
        return np.asarray(np.abs(lacking) + uncertainty)


def _monomials(count: int, degree: int) -> list[tuple[int, ...]]:
    return list(combinations_with_replacement(range(count), degree))


def _powers_of(x: Array) -> Array:
    """All monomials of degrees 1 to ORDER, in the order of the coefficients, (monomials, members)."""
    count = len(x)
    found: list[Array] = list(x)
    last: dict[tuple[int, ...], Array] = {(i,): x[i] for i in range(count)}
    for degree in range(2, ORDER + 1):
        last = {m: last[m[:-1]] * x[m[-1]] for m in _monomials(count, degree)}
        found += list(last.values())
    return np.array(found)


def _directions(count: int) -> list[Array]:
    """As many directions as there are monomials of the highest degree, well apart."""
    if count == 1:
        return [np.ones(1)]
    grid = [np.array(p, dtype=float) for p in _lattice(count, ORDER)]
    return [p / np.abs(p).max() for p in grid]


def _lattice(count: int, total: int) -> Iterator[tuple[float, ...]]:
    """Points of the simplex, every other coordinate with its sign turned, spread over directions."""
    angles = np.linspace(0.0, np.pi, total + 1, endpoint=False)
    if count == 2:
        yield from ((float(np.cos(a)), float(np.sin(a))) for a in angles)
        return
    rng = np.random.default_rng(1)
    for _ in range(len(_monomials(count, total))):
        yield tuple(rng.normal(size=count))
