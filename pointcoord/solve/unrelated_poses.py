r"""Many poses of one car at unrelated inputs, each solved and proven by itself.

Boxes of inputs cover what is asked. The middle of each is reached from the closed drawing along a proven path
(see `paths_together`). With X_b = C_b^-1 there and the tangent T(x) to the inputs of a box, C is quadratic,
so that one test of Newton and Kantorovich's theorem, block by block (see `block_proof`), with

    |X_b B(T, T)| <= sum_ij |X_b B(T_i, T_j)|,      |X_b C_b(T)| <= sum_i |X_b C_b(T_i)|,

proves that at all inputs of the box there is one assembly u* near the tangent, and that these are one branch,
the drawing's. A box for which that is not so is divided. A pose then starts from a power series u about the
middle of its box, and takes one step with X = C_u^-1 of the middle, of all blocks. Since C is quadratic,

    C(u) = C_u(m) (u - u*),  m = (u + u*) / 2,      so      u - u* = X C(u) + (I - X C_u(m)) (u - u*),

and with Z >= |I - X C_u| element by element over the whole box, what is left after the step is proven to be

    |u - X C(u) - u*| <= Z |u - u*| <= Z (I - Z)^-1 |X C(u)|,

rounding apart, which is counted once for a box, by the largest numbers in it: (I - Z)^-1 is positive where
there is a positive g with Z g < g (an M-matrix). Boxes are divided until the step is expected to do.
Whatever is not confirmed goes along a path of its own, and then the plain way, which says what stops it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property
from itertools import combinations_with_replacement
from math import comb

import numpy as np
from numpy.typing import NDArray

from pointcoord.data_classes import dataclass
from pointcoord.errors import AssemblyError
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.batch_last.elimination import Eliminated
from pointcoord.numerics.batch_last.series import ColumnSeries
from pointcoord.numerics.kantorovich import INFLATION
from pointcoord.numerics.monomials import monomials
from pointcoord.numerics.rounding import EPS, UNIT_ROUNDOFF
from pointcoord.solve.assembly import assemble, close_drawing
from pointcoord.solve.paths_together import CHUNK, Columns, columns_of, follow_together
from pointcoord.solve.status import Status, blocked_by

Array = NDArray[np.float64]
Numbers = NDArray[np.intp]

# Order of the series from which poses start, by how many coordinates are driven: a higher one takes more than
# it saves.
ORDERS, LEAST_ORDER = {1: 12, 2: 8}, 5
# How often a box is divided, boxes at most, and poses for which a box is worth its proof, or another division
# for those that one step does not solve.
DIVISIONS, MOST_BOXES, WORTH, FEW = 6, 20_000, 40, 160
# A box's proof is taken for a little more than the box: its poses' places in it are rounded.
WIDER = 1.0 + 1e-9


@dataclass(frozen=True)
class UnrelatedPoses:
    """Poses of one car.

    Attributes:
        unknowns: coordinates, shape (N, unknowns), in the mechanism's units; NaN where there is no pose.
        bound: proven distance of every coordinate of a solved point to the exact assembly, (N,), mm, for what
            the inputs' values and the drawing mean; infinite where there is no pose.
        failures: by number, what stopped a pose.
    """

    unknowns: Array
    bound: Array
    failures: Mapping[int, Status]


@dataclass(frozen=True)
class _Boxes:
    """Proven boxes.

    Attributes:
        middle, half: of the driven coordinates, shape (boxes, driven).
        known: the known coordinates at the middle, shape (size - unknowns, boxes).
        series: coefficients of the unknowns by parts of the half widths, shape (boxes, monomials, unknowns).
        inverse: X, shape (boxes, unknowns, unknowns).
        left: Z (I - Z)^-1 of the points, mm for each unit, shape (boxes, points, unknowns).
        floor: what rounding and doubt of the data leave, mm, shape (boxes, points).
    """

    middle: Array
    half: Array
    known: Array
    series: Array
    inverse: Array
    left: Array
    floor: Array


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
    found, bound = np.full((count, n), np.nan), np.full(count, np.inf)
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
        found[number], bound[number] = pose.y[:n], float(pose.bound)
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
        # The poses of a box lie side by side in the order of the smallest boxes.
        order, code = self._in_order(middle[:, 0] - half, half)
        asked = self.asked[:, order]
        count, corners = len(half), 1 << len(half)
        # One box that holds everything, divided until it is proven; boxes by their number in their order.
        numbers, left = np.zeros(1, dtype=np.int64), []
        for division in range(DIVISIONS + 1):
            first = np.searchsorted(code, numbers << count * (DIVISIONS - division))
            last = np.searchsorted(code, (numbers + 1) << count * (DIVISIONS - division))
            worth = last - first >= WORTH
            left += [order[i:j] for i, j in zip(first[~worth], last[~worth], strict=True)]
            numbers, first, last = numbers[worth], first[worth], last[worth]
            if not len(numbers):
                break
            if len(numbers) > MOST_BOXES:
                left += [order[i:j] for i, j in zip(first, last, strict=True)]
                break
            ends = division == DIVISIONS
            boxes, good = self._boxes(middle, half, numbers, division, (last - first < FEW) | ends)
            for number, place in enumerate(np.flatnonzero(good).tolist()):
                part = slice(int(first[place]), int(last[place]))
                self._solve(boxes, number, asked[:, part], order[part], left)
            if ends:
                left += [order[i:j] for i, j in zip(first[~good], last[~good], strict=True)]
            numbers = (corners * numbers[~good][:, None] + np.arange(corners)).ravel()
        return np.sort(np.concatenate([np.empty(0, dtype=np.intp), *left]))

    def _in_order(self, low: Array, half: Array) -> tuple[Numbers, Numbers]:
        """The poses by the smallest boxes that they lie in, and the numbers of these, sorted.

        The number of a box's parts are its own with one more digit, a bit of each driven coordinate.
        """
        code = np.zeros(self.asked.shape[-1], dtype=np.int32)
        for i, (values, least, width) in enumerate(zip(self.asked, low, half, strict=True)):
            place = ((values - least) * (2**DIVISIONS / (2.0 * width))).astype(np.int32)
            np.clip(place, 0, 2**DIVISIONS - 1, out=place)
            for bit in range(DIVISIONS):
                code |= (place >> bit & 1) << (bit * len(half) + i)
        # Whole numbers of 16 bits are sorted in one pass over their digits.
        small = code.astype(np.int16) if DIVISIONS * len(half) < 16 else code
        order = np.argsort(small, kind="stable")
        return order, code[order].astype(np.int64)

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
            off = self._off(d, inverse, factors.entries)
        good = reached.done & (off <= self._reachable())
        self.found[rest[good]], self.bound[rest[good]] = reached.y[:n, good].T, off[good]
        return rest[~good]

    def _boxes(
        self, middle: Array, half: Array, numbers: Numbers, division: int, enough: NDArray[np.bool_]
    ) -> tuple[_Boxes, NDArray[np.bool_]]:
        """Boxes of a division of one box, and which of them are proven and will do.

        Args:
            middle, half: of the one box, shapes (driven, 1) and (driven,).
            enough: which will do if they are proven; of others one step must be expected to solve a pose.
        """
        columns, n, count = self.columns, self.columns.map.unknowns, len(half)
        rows, proof, members = columns.map, columns.proof, len(numbers)
        parts, half = 1 << division, half / (1 << division)
        bits = [[(numbers >> (bit * count + i)) & 1 for bit in range(division)] for i in range(count)]
        places = np.array([sum((b << k for k, b in enumerate(own)), 0 * numbers) for own in bits])
        middle = middle + (2 * places + 1 - parts) * half[:, None]
        y = np.repeat(self.closed[:, None], members, axis=-1)
        target = y[n:].copy()
        target[[place - n for place in columns.driven]] = middle
        reached = follow_together(columns, y, target, EPS, closing=False)
        y = reached.y
        with np.errstate(all="ignore"):
            d = rows.differences(y)
            factors = columns.factorise(d)
            tangents = []
            for place, width in zip(columns.driven, (WIDER * half).tolist(), strict=True):
                tangent = np.zeros_like(y)
                tangent[place] = width
                u = factors.solve(rows.derivative(d, rows.differences(tangent)))
                tangent[:n] = -u
                tangents.append(tangent)
            along = [rows.differences(tangent) for tangent in tangents]
            turned = [rows.jacobian_along(e) for e in along]
            inverse = factors.inverse()
            magnitude = np.abs(inverse)
            omega = proof.lipschitz(magnitude)
            turns = sum((proof.turns(inverse, e) for e in turned), np.zeros_like(omega))
            turns += proof.defect(inverse, factors.entries, rows.jacobian_uncertainty(d, self._data))
            jacobian = np.abs(factors.entries) + sum(
                (np.abs(e) for e in turned), np.zeros_like(factors.entries)
            )
            missed = np.zeros((n, members))
            for i, j in combinations_with_replacement(range(len(along)), 2):
                times = rows.bilinear(along[i]) if i == j else rows.polar(along[i], along[j])
                missed += np.abs(proof.times(inverse, times))
            missed += np.abs(proof.times(inverse, rows.residual(d)))
            missed += proof.times(magnitude, rows.uncertainty(d, self._data))
            radius, _ = proof.radii(magnitude, omega, missed, turns, jacobian)
            proven = np.asarray(reached.done & factors.sound & np.isfinite(radius).all(axis=0))
            good = np.flatnonzero(proven)
            series = self._series(factors, y, WIDER * half)[..., good]
            for i, tangent in enumerate(tangents):
                series[1 + i] = tangent[:n, good]
            near = radius.take(columns.owner, axis=0)[:, good] * proof.weights[:, None]
            entries = (factors.entries[:, good], [e[:, good] for e in turned])
            steps = self._steps(y[:, good], [e[:, good] for e in along], entries, series, near)
        inverse, left, floor, expected = steps
        will_do = np.isfinite(expected) & ((expected <= self._reachable()) | enough[good])
        proven[good[~will_do]] = False
        kept = good[will_do]
        boxes = _Boxes(
            np.ascontiguousarray(middle[:, kept].T),
            np.repeat(WIDER * half[None], len(kept), axis=0),
            y[n:, kept],
            np.ascontiguousarray(np.moveaxis(series[..., will_do], -1, 0)),
            inverse[will_do],
            left[will_do],
            floor[will_do],
        )
        return boxes, proven

    def _steps(
        self,
        y: Array,
        along: list[Array],
        entries: tuple[Array, list[Array]],
        series: Array,
        near: Array,
    ) -> tuple[Array, Array, Array, Array]:
        """What a step with one inverse leaves in boxes: X, what is left and the floor as `_Boxes` has them,
        and the bound that is expected of a pose, (boxes,); infinite where nothing is proven.

        Args:
            y: middles, shape (size, boxes). along: differences of the tangents.
            entries: of C_u at the middles, and along the tangents.
            series: see `_series`. near: how far the assemblies are from the tangents, shape (unknowns,
                boxes).
        """
        columns, mechanism, n = self.columns, self.mechanism, self.columns.map.unknowns
        rows, count = columns.map, len(along)
        reach = np.abs(y) + np.concatenate([np.abs(series[1 : 1 + count]).sum(axis=0), 0.0 * y[n:]])
        # Where a pose starts: the series' own rounding is less than one part in 1e12.
        begun = np.abs(series[1 + count :]).sum(axis=0) + 1e-12 * (reach[:n] + near)
        apart = np.zeros_like(y)
        apart[:n] = np.maximum(begun, near)
        apart += self._data[:, None]
        size = np.abs(rows.differences(y)) + sum((np.abs(e) for e in along), 0.0 * along[0])
        at_middle, turned = entries
        bend = rows.jacobian_uncertainty(size, apart)
        place = tuple(np.array(rows.entries).T)

        def full(part: Array) -> Array:
            """Entries as matrices, shape (boxes, unknowns, unknowns)."""
            found = np.zeros((part.shape[-1], n, n))
            found[(slice(None), *place)] = part.T
            return found

        matrix = full(at_middle)
        inverse = np.asarray(np.linalg.inv(matrix), dtype=np.float64)
        magnitude = np.abs(inverse)
        largest = full(np.abs(at_middle) + sum((np.abs(e) for e in turned), bend))
        z = np.abs(np.eye(n) - inverse @ matrix)
        for e in turned:
            z += np.abs(inverse @ full(e))
        gamma = (n + 2) * EPS
        z += magnitude @ (full(bend) + gamma * largest)
        confined = np.asarray(np.linalg.inv(np.eye(n) - z), dtype=np.float64)
        weights = confined.sum(axis=-1)
        # What rounds and is uncertain: C(y), its product with X, and the step's end.
        first, second = rows.ends
        residual = rows.uncertainty(size + apart[first] + apart[second], self._data).T
        residual += gamma * (largest @ (begun + near).T[..., None])[..., 0]
        doubt = (magnitude @ residual[..., None])[..., 0]
        rounded = UNIT_ROUNDOFF * (reach[:n] + apart[:n]).T
        left = z @ confined
        floor = (left @ doubt[..., None])[..., 0] + doubt + rounded
        points, unit = 3 * len(mechanism.topology.moving), INFLATION * float(mechanism.unit)
        left, floor = unit * left[:, :points], unit * floor[:, :points]
        floor += EPS * float(np.abs(mechanism.origin).max())
        # The terms of the last degree are about what those beyond it are.
        last = np.abs(series[-comb(_order(count) + count - 1, count - 1) :]).sum(axis=0)
        expected = ((left @ last.T[..., None])[..., 0] + floor).max(axis=-1)
        proven = (confined >= 0.0).all(axis=(-1, -2)) & (
            ((z @ weights[..., None])[..., 0] < weights - 0.5).all(axis=-1)
        )
        return inverse, left, floor, np.where(proven, expected, np.inf)

    def _series(self, factors: Eliminated, y: Array, half: Array) -> Array:
        """Series of the unknowns in all driven coordinates, (monomials, unknowns, boxes), from series in
        lines.

        The terms of degree k along a direction v are sum over monomials of their coefficients times
        v^monomial, so series along as many directions as there are monomials of the highest degree give all
        of them.
        """
        columns, n, count = self.columns, self.columns.map.unknowns, len(half)
        order, directions = _order(count), _directions(count)
        found: list[list[Array]] = [[] for _ in range(order)]
        for direction in directions:
            series = ColumnSeries.begin(columns.map, factors, y, columns.driven, order)
            for k in range(order):
                series.carry_on(direction * half if k == 0 else np.zeros(count))
                found[k].append(series.y[k + 1, :n].copy())
        coefficients = [y[None, :n]]
        for k in range(1, order + 1):
            table = np.array([[np.prod(v[list(m)]) for m in _monomials(count, k)] for v in directions])
            solved = np.linalg.pinv(table) @ np.stack(found[k - 1]).reshape(len(directions), -1)
            coefficients.append(solved.reshape(-1, *found[0][0].shape))
        return np.concatenate(coefficients)

    def _solve(self, boxes: _Boxes, number: int, asked: Array, own: Numbers, left: list[Numbers]) -> None:
        """Solve the poses of a box, and add those that are not confirmed to what is left.

        Args:
            asked: driven coordinates, shape (driven, poses). own: the poses' numbers.
        """
        columns, n, reachable = self.columns, self.columns.map.unknowns, self._reachable()
        rows, order = columns.map, _order(len(asked))
        series, inverse = boxes.series[number].T, boxes.inverse[number]
        for low in range(0, len(own), CHUNK):
            part, here = own[low : low + CHUNK], asked[:, low : low + CHUNK]
            x = (here - boxes.middle[number][:, None]) / boxes.half[number][:, None]
            y = np.empty((len(self.closed), len(part)))
            y[n:] = boxes.known[:, number, None]
            y[columns.driven] = here
            np.matmul(series, monomials([x], order)[0], out=y[:n])
            step = inverse @ rows.residual(rows.differences(y))
            y[:n] -= step
            off = boxes.left[number] @ np.abs(step, out=step)
            off += boxes.floor[number][:, None]
            bound = off.max(axis=0)
            bound[(np.abs(x) > 1.0).any(axis=0)] = np.inf
            self.found[part], self.bound[part] = y[:n].T, bound
            good = bound <= reachable
            if not good.all():
                self.found[part[~good]], self.bound[part[~good]] = np.nan, np.inf
                left.append(part[~good])

    def _reachable(self) -> float:
        """The largest bound with which a pose is done, mm: the tolerance, or what rounding may leave."""
        return max(self.tolerance, 1e3 * EPS * float(self.mechanism.unit))

    def _off(self, d: Array, inverse: Array, entries: Array) -> Array:
        """Bound of poses with these differences and entries of C_u, mm, shape (members,)."""
        columns, mechanism = self.columns, self.mechanism
        rows, proof = columns.map, columns.proof
        magnitude = np.abs(inverse)
        missed = np.abs(proof.times(inverse, rows.residual(d)))
        missed += proof.times(magnitude, rows.uncertainty(d, self._data))
        defect = proof.defect(inverse, entries, rows.jacobian_uncertainty(d, self._data))
        omega = proof.lipschitz(magnitude)
        radius, _ = proof.radii(magnitude, omega, missed, defect, np.abs(entries))
        points = 3 * len(mechanism.topology.moving)
        each = radius.take(columns.owner[:points], axis=0) * proof.weights[:points, None]
        off = float(mechanism.unit) * each.max(axis=0) + EPS * float(np.abs(mechanism.origin).max())
        return np.where(np.isfinite(off), INFLATION * off, np.inf)

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


def _order(count: int) -> int:
    """Of the series in so many driven coordinates."""
    return ORDERS.get(count, LEAST_ORDER)


def _directions(count: int) -> list[Array]:
    """As many directions as there are monomials of the highest degree, well apart."""
    if count == 1:
        return [np.ones(1)]
    grid = [np.array(p, dtype=float) for p in _lattice(count, _order(count))]
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
