r"""Straight paths of many members at once, a member a column: what `assembly.follow` does one by one.

A step goes along a short series from where Newton's method has come to, y + e + y1 s + ... + yp s^p, and C is
quadratic, so that what it leaves is

    sum_{k > p} s^k sum_{i + j = k} B(y_i, y_j) + B(e, e) + 2 B(e, y1 s + ...)      exactly.

The proof is block by block (see `block_proof`), so that a step is as long as the block allows that bends
most, and not a tenth of that. It gives a tube of assemblies along the step, and how far about its middle
there is no other. What Newton's method then finds at the end is in the tube: that is checked block by block
as well. At the end of the path it goes on until what is left is proven to be below the tolerance.

A member whose pivots turn bad (see `elimination`), or whose steps become short, is given up: whoever asked
solves it by `assembly.follow`, which decides, and tells why.
"""

from __future__ import annotations

import dataclasses
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from pointcoord.data_classes import dataclass
from pointcoord.numerics.batch_last.block_proof import BlockProof, block_proof
from pointcoord.numerics.batch_last.column_map import ColumnMap, column_map
from pointcoord.numerics.batch_last.elimination import Eliminated, Elimination, eliminate_like
from pointcoord.numerics.batch_last.series import ColumnSeries
from pointcoord.numerics.quadratic import QuadraticMap

Array = NDArray[np.float64]
Numbers = NDArray[np.intp]

# Members at a time: what lies between the operations stays in a cache, and a call costs little beside its
# numbers.
CHUNK = 1024
# Fraction of the step that each block alone would allow, and what is left of it where the blocks together do
# not.
SAFETY, SHORTER, TRIALS = 0.9, 0.75, 6
GUESSES = tuple(0.75**k for k in range(16))
# Order of the series that a step follows, and the least weight of an unknown in the norm of its block.
ORDER, LEAST_WEIGHT = 8, 0.3
# Steps beyond which, and parts of the path below which, a member is given up.
STEPS, SHORTEST_STEP = 100, 1e-3
NEWTON = 6


@dataclass(frozen=True)
class Columns:
    """A system ready for members that are columns.

    Attributes:
        map: its rows. plan: how C_u is eliminated. proof: how the constants of the theorem are summed.
        owner: block of each unknown. driven: known coordinates that a path changes.
        least: the smallest weight of the proof's norms.
    """

    map: ColumnMap
    plan: Elimination
    proof: BlockProof
    owner: Numbers
    driven: list[int]
    least: float

    def factorise(self, d: Array) -> Eliminated:
        """C_u at coordinates with these differences."""
        return self.plan.factorise(self.map.jacobian(d))

    def step(self, factors: Eliminated, d: Array, wanted: Array | float = 0.0) -> Array:
        """Newton's, towards C(y) = wanted, shape (unknowns, members)."""
        step = factors.solve(self.map.residual(d) - wanted)
        return np.negative(step, out=step)


def columns_of(
    system: QuadraticMap, constants: tuple[tuple[int, float], ...], driven: list[int], like: Array
) -> Columns | None:
    """A system made ready for paths that change driven coordinates, like one pose, shape (size,).

    None where that is singular.
    """
    rows, blocks = column_map(system, constants), system.structure.blocks
    plan = eliminate_like(system.jacobian(like), rows.entries, blocks)
    if plan is None:
        return None
    owner = np.zeros(system.unknowns, dtype=np.intp)
    for number, block in enumerate(blocks):
        owner[list(block.unknowns)] = number
    weights = _weights(system, driven, like)
    proof = block_proof(rows, plan, system.structure, weights)
    return Columns(rows, plan, proof, owner, driven, float(weights.min()))


def _weights(system: QuadraticMap, driven: list[int], y: Array) -> Array:
    """How far unknowns of a block go together: the dominant eigenvector of |X C_b(y1)|, y1 the tangents."""
    n = system.unknowns
    inverse = np.linalg.inv(system.jacobian(y))
    turns = np.zeros((n, n))
    for place in driven:
        tangent = np.zeros_like(y)
        tangent[place] = 1.0
        tangent[:n] = -inverse @ (2.0 * system.polar(y, tangent))
        turns += np.abs(inverse @ system.jacobian(tangent))
    g = np.ones(n)
    for block in system.structure.blocks:
        own = list(block.unknowns)
        local = np.ones(len(own))
        for _ in range(20):
            local = turns[np.ix_(own, own)] @ local + 1e-3 * local
            local /= local.max()
        g[own] = np.maximum(local, LEAST_WEIGHT)
    return g


@dataclass(frozen=True)
class Reached:
    """Ends of paths.

    Attributes:
        y: coordinates, shape (size, members); of members that were given up they mean nothing.
        left: proven distance to the exact assembly, rounding apart, shape (members,).
        done: who is there.
        steps: along the path, and Newton's, all members together.
    """

    y: Array
    left: Array
    done: NDArray[np.bool_]
    steps: int


@dataclasses.dataclass
class _Travelling:
    """Members on their way, a column each.

    Attributes:
        remaining: part of the path. offset: residual that is taken back along it, if any.
        middle, alone: of the tube that leads here, and how far about it there is no other assembly, by block.
    """

    y: Array
    change: Array
    target: Array
    offset: Array | None
    remaining: Array
    middle: Array
    alone: Array
    numbers: Numbers

    def part(self, members: slice | NDArray[np.bool_]) -> _Travelling:
        """Some of them."""
        arrays = (self.y, self.change, self.target, self.middle, self.alone)
        y, change, target, middle, alone = (array[:, members] for array in arrays)
        offset = None if self.offset is None else self.offset[:, members]
        return _Travelling(
            y, change, target, offset, self.remaining[members], middle, alone, self.numbers[members]
        )


def follow_together(columns: Columns, y: Array, target: Array, tolerance: float, closing: bool) -> Reached:
    """Carry members along straight paths to other known coordinates.

    Args:
        y: start, shape (size, members); assembled to rounding unless it is a drawing to be closed.
        target: known coordinates at the end, shape (size - unknowns, members).
        tolerance: how far the end may be from the exact assembly, rounding apart, in units; above zero.
        closing: whether what the residual of the start is not zero by is to be taken back along the path.
    """
    n, members = columns.map.unknowns, y.shape[-1]
    ends, left, done = y.copy(), np.full(members, np.inf), np.zeros(members, dtype=bool)
    steps = 0
    travelling: list[_Travelling] = []
    arrived: list[_Travelling] = []
    blocks = len(columns.proof.couplings)
    for low in range(0, members, CHUNK):
        part = slice(low, min(low + CHUNK, members))
        count = part.stop - part.start
        here, there = y[:, part].copy(), target[:, part]
        offset = columns.map.residual(columns.map.differences(here)) if closing else None
        travelling.append(
            _Travelling(
                here,
                there - here[n:],
                there,
                offset,
                np.ones(count),
                here[:n].copy(),
                np.full((blocks, count), np.inf),
                np.arange(low, part.stop),
            )
        )
    for count in range(STEPS):
        going = []
        for group in travelling:
            steps += len(group.numbers) * (1 if count == 0 else 2)
            kept = _advance(columns, group, first=count == 0)
            arriving = kept & (group.remaining == 0.0)
            if arriving.any():
                arrived.append(group.part(arriving))
            if (kept & ~arriving).any():
                going.append(group.part(kept & ~arriving))
        travelling = _gathered(going)
        if not travelling:
            break
    for group in _gathered(arrived):
        steps += _finish(columns, group, tolerance, ends, left, done)
    return Reached(ends, left, done, steps)


def _gathered(groups: list[_Travelling]) -> list[_Travelling]:
    """Members in as few groups as they fill."""
    if sum(len(group.numbers) for group in groups) == 0:
        return []
    if all(len(group.numbers) == CHUNK for group in groups[:-1]):
        return groups

    def joined(arrays: list[Array]) -> Array:
        return np.concatenate(arrays, axis=-1)

    offsets = [group.offset for group in groups if group.offset is not None]
    whole = _Travelling(
        joined([g.y for g in groups]),
        joined([g.change for g in groups]),
        joined([g.target for g in groups]),
        joined(offsets) if offsets else None,
        joined([g.remaining for g in groups]),
        joined([g.middle for g in groups]),
        joined([g.alone for g in groups]),
        np.concatenate([g.numbers for g in groups]),
    )
    return [whole.part(slice(low, low + CHUNK)) for low in range(0, len(whole.numbers), CHUNK)]


def _advance(columns: Columns, group: _Travelling, first: bool) -> NDArray[np.bool_]:
    """Take members one step on; those for which it is proven."""
    rows, proof, n = columns.map, columns.proof, columns.map.unknowns
    here, members = group.y, len(group.numbers)
    wanted = None if group.offset is None else group.offset * group.remaining
    with np.errstate(all="ignore"):
        if not first:
            d = rows.differences(here)
            here[:n] += columns.step(columns.factorise(d), d, 0.0 if wanted is None else wanted)
        d = rows.differences(here)
        factors = columns.factorise(d)
        jacobian = np.abs(factors.entries)
        order = 1 if not columns.driven else ORDER
        series = ColumnSeries.begin(rows, factors, here, columns.driven, order)
        change = group.change[[i - n for i in columns.driven]] * group.remaining
        still = np.zeros(len(columns.driven))
        inverse = factors.inverse()
        turns = np.empty((order, len(proof.couplings), members))
        sizes = np.empty((order, members))
        for k in range(order):
            extra = -wanted if wanted is not None and k == 0 else None
            series.carry_on(change if k == 0 else still, extra)
            along = rows.jacobian_along(rows.differences(series.y[k + 1]))
            turns[k] = proof.turns(inverse, along)
            jacobian += np.abs(along)
            sizes[k] = np.abs(series.y[k + 1, :n]).max(axis=0)
        missed = np.stack(
            [np.abs(proof.times(inverse, series.sums(k))) for k in range(order + 1, 2 * order + 1)]
        )
        np.abs(inverse, out=inverse)
        omega = proof.lipschitz(inverse)
        sound = factors.sound.copy()
        off = Off(columns, proof.turning_of_all(inverse), np.zeros(members))
        if not first:
            correction = columns.step(factors, d, 0.0 if wanted is None else wanted)
            here[:n] += correction
            off = replace(off, correction=np.abs(correction).max(axis=0))
            # Newton's method has found the assembly of the tube that leads here, and no other.
            jacobian += np.abs(rows.jacobian_along(rows.differences(_padded(correction, len(here)))))
            radius, _ = proof.radii(inverse, omega, off.missed(0.0), off.turns, jacobian)
            sound &= (proof.largest(here[:n] - group.middle) + radius <= group.alone).all(axis=0)
        s = _first_guess(turns, np.stack([proof.by_block(part) for part in missed]), omega)
        for _ in range(TRIALS):
            off_by = off.missed(_sum(sizes, s, 1)) + _sum(missed, s, order + 1)
            turned = _sum(turns, s, 1) + off.turns
            radius, together = proof.radii(inverse, omega, off_by, turned, jacobian)
            proven = np.isfinite(radius).all(axis=0)
            if proven.all():
                break
            s = np.where(proven, s, SHORTER * s)
        ended = s >= 1.0
        kept = sound & proven & (ended | (s * group.remaining >= SHORTEST_STEP))
        here[:n] += _sum(series.y[1:, :n], s, 1)
        group.remaining = np.where(ended, 0.0, group.remaining * (1.0 - s))
        here[n:] = np.where(ended, group.target, group.target - group.change * group.remaining)
        group.middle = here[:n].copy()
        group.alone = np.where(omega > 0.0, (1.0 - together) / omega, np.inf)
    return np.asarray(kept & np.isfinite(here).all(axis=0))


def _padded(correction: Array, size: int) -> Array:
    """A correction of the unknowns as one of all coordinates, shape (size, members)."""
    return np.concatenate([correction, np.zeros((size - len(correction), correction.shape[-1]))])


def _sum(terms: Array, s: Array, first: int) -> Array:
    """sum_k terms_k s^(first + k), of shape (..., members)."""
    total = terms[-1] * s
    for term in terms[-2::-1]:
        total += term
        total *= s
    return np.asarray(total * s ** (first - 1))


def _first_guess(turns: Array, missed: Array, omega: Array) -> Array:
    """The longest trial step that each block alone allows, shape (members,)."""
    s = np.full(turns.shape[-1], SAFETY * GUESSES[-1])
    order = len(turns)
    for trial in reversed(GUESSES):
        at = np.full_like(s, trial)
        needed = _sum(turns, at, 1) + np.sqrt(2.0 * omega * _sum(missed, at, order + 1))
        s = np.where((needed <= SAFETY).all(axis=0), trial, s)
    return s


@dataclass(frozen=True)
class Off:
    """What a correction e adds to the constants of a step: little, so it is bounded by magnitudes alone.

    Attributes:
        turning: |X| sum |2 B| of each block. correction: largest component of e.
    """

    columns: Columns
    turning: Array
    correction: Array

    def missed(self, way: Array | float) -> Array:
        """|X (B(e, e) + 2 B(e, p))| at most, shape (unknowns, members), |p| at most a way."""
        each = self.turning * (self.correction * (0.5 * self.correction + way)) / self.columns.least
        return np.asarray(each.take(self.columns.owner, axis=0))

    @property
    def turns(self) -> Array:
        """|X C_b(e)| at most, shape (blocks, members)."""
        return self.turning * self.correction / self.columns.least


def _finish(
    columns: Columns, group: _Travelling, tolerance: float, ends: Array, left: Array, done: NDArray[np.bool_]
) -> int:
    """Newton's method at the ends of paths, until what is left is proven to be small; the steps it took."""
    rows, proof, n = columns.map, columns.proof, columns.map.unknowns
    y, numbers, count = group.y, group.numbers, 0
    for number in range(NEWTON):
        count += len(numbers)
        with np.errstate(all="ignore"):
            d = rows.differences(y)
            factors = columns.factorise(d)
            step = columns.step(factors, d)
            y[:n] += step
            if number < 2 and (np.abs(step) > 1e-6).any():
                continue
            inverse = factors.inverse()
            np.abs(inverse, out=inverse)
            off = Off(columns, proof.turning_of_all(inverse), np.abs(step).max(axis=0))
            jacobian = np.abs(rows.jacobian(rows.differences(y)))
            omega = proof.lipschitz(inverse)
            radius, _ = proof.radii(inverse, omega, off.missed(0.0), off.turns, jacobian)
            rest = radius.max(axis=0)
            sound = factors.sound & (proof.largest(y[:n] - group.middle) + radius <= group.alone).all(axis=0)
            ended = sound & (rest <= tolerance)
            if number < NEWTON - 1 and not ended.all() and (sound & ~ended).any():
                continue
        reached = numbers[ended]
        ends[:, reached], left[reached], done[reached] = y[:, ended], rest[ended], True
        break
    return count
