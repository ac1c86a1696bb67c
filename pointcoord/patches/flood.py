r"""Covers a range of inputs with proven patches, outwards from a pose, on one branch.

A box is entered at a pose that is known to be on the branch. From this pose a straight path that cannot
change branch (see `solve.assembly`) leads to the middle of the box, where the series is expanded. A patch is
kept if it is proven and exact enough. Its neighbours are then entered where they touch the patch. A box that
fails is halved in the input that contributes most to the failure. Its two parts are entered at the middle of
the box. If the middle was not reached, the part with the pose where the box was entered is entered there, and
the other part waits for a neighbour. So boxes become smaller towards folds. A smallest box that fails is
given up, with the reason.

At the end neighbours are compared. The assembly of each patch is the only one within a proven distance. So it
is known whether two neighbours are the same assembly where they touch. Two paths around a point where folds
meet can lead to two assemblies at the same inputs. Then the patch that was reached later is given up, so that
no motion passes from one assembly to the other.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field

import numpy as np

from pointcoord.numerics.arrays import Array, Flags, Integers
from pointcoord.numerics.counters import Work
from pointcoord.numerics.linear import Factors, factorise
from pointcoord.numerics.multi_index import powers
from pointcoord.numerics.power_series import expand
from pointcoord.patches.domain import Domain
from pointcoord.patches.jet import Jet
from pointcoord.patches.lookup import Marked
from pointcoord.patches.patch_proof import prove_patches
from pointcoord.patches.patches import ProvenPatches
from pointcoord.patches.reported_points import reported_points
from pointcoord.solve.assembly import assemble
from pointcoord.solve.follower import follow
from pointcoord.solve.path import Path

Corner = tuple[int, ...]
Key = tuple[Corner, Corner]
Start = tuple[Integers, Array]
"""A place in units of half the smallest box, (p,), and the pose near this place, (size,)."""

# Boxes that are expanded and proven at once: their matrices take less than about 100 MB with two inputs.
BATCH = 32
# Most steps of a path to the middle of a box. Paths that arrive take about ten steps; a path that takes more
# leads to a fold, or through a region that no single patch covers.
STEPS = 32
# A part that uses at least this share of what the whole used is limited by rounding. A part that uses less
# may be limited by rounding too, because rounding errors of another box are half or twice as large by chance.
# Then its parts are tried, and for a smallest box `PatchProof.rounded` decides.
NO_BETTER = 0.9
# If the terms of the last order are this many tolerances large, the truncation error surely exceeds the
# tolerance, and no proof is tried.
COARSE = 1e3

FOLD = "no patch can be proven here, not even the smallest: a fold, where assemblies meet or end, is near"
ROUNDING = "rounding alone exceeds the tolerance here, near a fold or because the tolerance is too fine"
UNREACHED = "cannot be reached from the drawing without crossing a region that is not covered"
SEAM = "two paths from the drawing around a region that is not covered lead to different assemblies here"
TOO_MANY = "the limit of patches, or of attempts to prove them, was reached before this box"


@dataclass(frozen=True)
class Entry:
    """The pose at which a box is entered.

    Attributes:
        twice: place of the pose, in units of half the smallest box, (p,).
        y: coordinates of the pose, (size,).
        used: share of the tolerance that the halved box used, if it was proven but not exact enough.
    """

    twice: Integers
    y: Array
    used: float = np.inf


@dataclass(frozen=True)
class Failure:
    """Why an expanded box is not kept.

    Attributes:
        y: pose at the middle of the box, (size,).
        weights: contribution of each input to the failure, (p,).
        used: share of the tolerance that the box uses, if proven.
        rounded: whether rounding alone exceeds the tolerance.
    """

    y: Array
    weights: Array
    used: float = np.inf
    rounded: bool = False


@dataclass(frozen=True)
class Limits:
    """Limits of the error bound of a patch that is kept, and of the work of covering.

    Let s be the inputs from the middle of a patch in half widths, S_i = max |dY/ds_i| over all points in the
    middle, and L the mechanism's size. The size of a velocity is a sum of S_i s_i'. The size of an
    acceleration is a sum of S_i s_i'' and of S_i S_j / L s_i' s_j', as for a rotation with an arm of length
    L. The errors of the derivatives by the inputs may be the same share of these sizes as the error of a
    position of L.

    Attributes:
        tolerance: largest error bound of a reported point, mm.
        derivative: highest time derivative that will be evaluated; with 0 only positions are limited.
        keep_rounded: whether a patch is kept whose error bound exceeds the limit by rounding alone.
        most: most patches; 4,096 take a few hundred MB while they are made.
        effort: number of factorisations after which no further box is tried.
    """

    tolerance: float
    derivative: int = 0
    keep_rounded: bool = False
    most: int = 4096
    effort: float = np.inf

    def used(self, coefficients: Array, off: Jet, size: float) -> Array:
        """Share of the limits that the error bounds of patches use, (P,); a patch up to 1 is kept.

        Args:
            coefficients: coefficients of the reported points, shape (P, powers, 3 points), mm.
            off: error bounds of their sums.
            size: L, mm.
        """
        found = off.value.max(axis=-1) / self.tolerance
        inputs, part = off.first.shape[1], self.tolerance / size
        rates = np.maximum(np.abs(coefficients[:, 1 : 1 + inputs]).max(axis=-1), np.finfo(float).tiny)
        if self.derivative > 0:
            found = np.maximum(found, (off.first.max(axis=-1) / (part * rates)).max(axis=-1))
        if self.derivative > 1:
            allowed = part * rates[:, :, None] * rates[:, None] / size
            found = np.maximum(found, (off.second.max(axis=-1) / allowed).max(axis=(-1, -2)))
        return np.asarray(found)


@dataclass(frozen=True)
class Cover:
    """The patches that cover a domain, and the boxes that are not covered.

    Attributes:
        patches: the kept patches.
        given_up: corners of each box that is not covered, with the reason.
        work: work of covering.
    """

    patches: ProvenPatches
    given_up: tuple[tuple[Key, str], ...]
    work: Work

    @property
    def reasons(self) -> tuple[str, ...]:
        """The reasons why boxes are not covered, each once."""
        return tuple(dict.fromkeys(reason for _, reason in self.given_up))


@dataclasses.dataclass
class _Flood:
    """The state of covering a domain.

    Attributes:
        domain, order, limits: the domain, the order of the series and the limits of a patch.
        wanted: smallest boxes that are to be covered; all unless given.
        work: work so far.
        waiting: boxes for which no pose to enter is known yet.
        entered: boxes that are to be tried, each with the pose at which it is entered.
        given_up: boxes that failed, with the reason.
        kept: batches of proven patches, in the order in which they were reached.
    """

    domain: Domain
    order: int
    limits: Limits
    wanted: Marked | None = None
    work: Work = field(default_factory=Work)
    waiting: dict[Key, None] = field(default_factory=dict)
    entered: dict[Key, Entry] = field(default_factory=dict)
    given_up: dict[Key, str] = field(default_factory=dict)
    kept: list[ProvenPatches] = field(default_factory=list)

    @property
    def count(self) -> int:
        """Number of kept patches."""
        return sum(len(part.low) for part in self.kept)

    def try_boxes(self, boxes: list[tuple[Key, Entry]]) -> None:
        """Try to prove boxes: keep those that succeed and halve the others."""
        domain, mechanism = self.domain, self.domain.mechanism
        system = mechanism.map
        low, high = (np.array([key[end] for key, _ in boxes], dtype=np.int64) for end in (0, 1))
        middle, half = domain.middle_and_half(low, high)
        known, lacking, data = domain.known_over(middle, half, self.order)
        path = follow(system, np.array([entry.y for _, entry in boxes]), known[:, 0], steps=STEPS)
        self.work += path.work
        arrived = np.flatnonzero(path.done >= 1.0)
        for place in np.flatnonzero(path.done < 1.0).tolist():
            self._halve(*boxes[place], None)
        if not arrived.size:
            return
        y = path.y[arrived]
        y[:, system.unknowns :] = known[arrived, 0]
        factors = factorise(system.jacobian(y))
        count = len(domain.free)
        series = expand(system, factors, y, known[arrived], inputs=count)
        solves = len(arrived) * (powers(count, self.order).count - 1)
        self.work += Work(
            factorisations=len(arrived), rate_solves=solves, unknowns_solved=solves * system.unknowns
        )
        last, along = last_terms(series[..., : system.unknowns], count, self.order)
        coarse = last * float(mechanism.unit) > COARSE * self.limits.tolerance
        for place in np.flatnonzero(coarse).tolist():
            self._halve(*boxes[int(arrived[place])], Failure(y[place], along[place]))
        fine = np.flatnonzero(~coarse)
        if fine.size:
            self._prove(
                [boxes[int(place)] for place in arrived[fine]],
                y[fine],
                series[fine],
                factors.taken(fine),
                lacking[arrived[fine]],
                data.each(lambda part: part[arrived[fine]]),
            )

    def _prove(
        self,
        boxes: list[tuple[Key, Entry]],
        y: Array,
        series: Array,
        factors: Factors,
        lacking: Array,
        data: Jet,
    ) -> None:
        """Prove series about the middles of boxes, and keep those that are exact enough."""
        system, mechanism = self.domain.mechanism.map, self.domain.mechanism
        proof = prove_patches(system, factors, series, self.order, lacking, data)
        proven = np.flatnonzero(proof.proven)
        error = proof.error.each(lambda part: part[proven])
        points, off = reported_points(mechanism, series[proven], error, self.order)
        used = np.full(len(boxes), np.inf)
        used[proven] = self.limits.used(points, off, float(mechanism.unit))
        whole = np.array([entry.used for _, entry in boxes])
        smallest = np.array([np.subtract(high, low).max() == 1 for (low, high), _ in boxes])
        rounded = np.isfinite(used) & ((used > NO_BETTER * whole) | (smallest & proof.rounded))
        keep = (used <= 1.0) | (rounded & self.limits.keep_rounded)
        for place, box in enumerate(boxes):
            if not keep[place]:
                weights = (proof.left_out if proof.proven[place] else proof.change)[place]
                weights = np.nan_to_num(weights, nan=0.0, posinf=1e300)
                self._halve(*box, Failure(y[place], weights, float(used[place]), bool(rounded[place])))
        near = keep[proven]
        if near.any():
            good = proven[near]
            self.kept.append(
                ProvenPatches(
                    domain=self.domain,
                    order=self.order,
                    low=np.array([boxes[place][0][0] for place in good], dtype=np.int64),
                    high=np.array([boxes[place][0][1] for place in good], dtype=np.int64),
                    series=series[good, :, : system.unknowns],
                    error=proof.error.value[good],
                    unique_within=proof.unique_within[good],
                    coefficients=points[near],
                    off=off.each(lambda part: part[near]),
                )
            )
            self._enter_neighbours(self.kept[-1], list(self.waiting))

    def _halve(self, key: Key, entry: Entry, failure: Failure | None) -> None:
        """Halve a box that failed, or give it up.

        Args:
            entry: the pose at which the box was entered.
            failure: why the box failed; None if the pose at its middle was not reached.
        """
        low, high = np.array(key)
        sizes = high - low
        if failure is not None and failure.rounded:
            self.given_up[key] = ROUNDING
            return
        if not (sizes > 1).any():
            self.given_up[key] = FOLD
            return
        weights = sizes / self.domain.parts if failure is None else failure.weights
        along = int(np.argmax(np.where(sizes > 1, weights, -1.0)))
        cut = int(low[along] + sizes[along] // 2)
        parts = []
        for side in (0, 1):
            corners = [low.copy(), high.copy()]
            corners[1 - side][along] = cut
            parts.append(corners)
        for first, last in parts:
            part: Key = (tuple(first.tolist()), tuple(last.tolist()))
            if self.wanted is not None and not self.wanted.any_in(first[None], last[None])[0]:
                continue
            if failure is not None:
                self.entered[part] = Entry(low + high, failure.y, failure.used)
            elif (2 * first <= entry.twice).all() and (entry.twice <= 2 * last).all():
                self.entered[part] = entry
            else:
                self.waiting[part] = None
                for kept in self.kept:
                    if part in self.waiting:
                        self._enter_neighbours(kept, [part])

    def _enter_neighbours(self, patches: ProvenPatches, keys: list[Key]) -> None:
        """Enter those of some waiting boxes that touch patches, at the middle of the shared face."""
        if not keys:
            return
        low, high = (np.array([key[end] for key in keys], dtype=np.int64) for end in (0, 1))
        which, box = np.nonzero(touching(patches.low, patches.high, low, high))
        _, first = np.unique(box, return_index=True)
        which, box = which[first], box[first]
        if not box.size:
            return
        twice = shared_place(patches.low[which], patches.high[which], low[box], high[box])
        values = self.domain.inputs_at(twice)
        unknown = patches.unknowns_at(which, values)
        y = np.concatenate([unknown, self.domain.known_at(values)], axis=-1)
        for place, number in enumerate(box):
            del self.waiting[keys[number]]
            self.entered[keys[number]] = Entry(twice[place], y[place])


def flood(domain: Domain, limits: Limits, start: Start, wanted: Marked | None = None) -> Cover:
    """Cover a domain, starting at a pose.

    Args:
        wanted: smallest boxes that are to be covered; parts of boxes without any of them are skipped.
    """
    order = domain.order_for(limits.tolerance, limits.derivative)
    whole: Key = ((0,) * len(domain.free), (domain.parts,) * len(domain.free))
    state = _Flood(domain, order, limits, wanted)
    state.entered[whole] = Entry(*start)
    while state.entered and state.count < limits.most and state.work.factorisations < limits.effort:
        batch = list(state.entered.items())[:BATCH]
        for key, _ in batch:
            del state.entered[key]
        state.try_boxes(batch)
    for key in state.entered:
        state.given_up[key] = TOO_MANY
    for key in state.waiting:
        state.given_up[key] = TOO_MANY if state.entered else UNREACHED
    patches = ProvenPatches.none(domain, order).joined(state.kept)
    dropped = _seams(patches)
    for place in np.flatnonzero(dropped):
        key = (tuple(patches.low[place].tolist()), tuple(patches.high[place].tolist()))
        state.given_up[key] = SEAM
    return Cover(patches.taken(np.flatnonzero(~dropped)), tuple(state.given_up.items()), state.work)


def start_at_drawing(domain: Domain, closed: Path) -> Start:
    """The place in a domain nearest to the closed drawing, and the pose at this place.

    Raises:
        InputOutOfRange: an end of a range is outside the values that the input can have.
        AssemblyError: the place cannot be reached from the drawing.
    """
    domain.known_at(np.stack(domain.ends))
    drawn = domain.mechanism.input_values(closed.y[domain.mechanism.map.unknowns :])
    twice = domain.nearest_place(np.array([float(drawn[name]) for name in domain.free]))
    held = {name: np.array(low) for name, (low, high) in domain.ranges.items() if low == high}
    inputs = held | dict(zip(domain.free, domain.inputs_at(twice), strict=True))
    return twice, assemble(domain.mechanism, inputs, None, closed).y


def last_terms(series: Array, inputs: int, order: int) -> tuple[Array, Array]:
    """Largest sum of the terms of highest total degree, (P,), and its derivative by each input, (P, p)."""
    every = powers(inputs, order)
    first = every.first_of(order)
    sizes = Jet.of(series[:, first:], every.exponents[first:])
    return sizes.value.max(axis=-1), sizes.first.max(axis=-1)


def touching(low: Integers, high: Integers, other_low: Integers, other_high: Integers) -> Flags:
    """Which boxes (A, p) share a part of a face with which boxes (B, p), shape (A, B); none overlap."""
    first = np.maximum(low[:, None], other_low[None])
    last = np.minimum(high[:, None], other_high[None])
    return np.asarray(((first == last).sum(axis=-1) == 1) & (first <= last).all(axis=-1))


def shared_place(low: Integers, high: Integers, other_low: Integers, other_high: Integers) -> Integers:
    """Middle of the face that two boxes share, in units of half the smallest box, shape (..., p)."""
    return np.asarray(np.maximum(low, other_low) + np.minimum(high, other_high))


def _seams(patches: ProvenPatches) -> Flags:
    """Marks patches with another assembly than a neighbour that was reached earlier, shape (P,)."""
    dropped = np.zeros(len(patches.low), dtype=bool)
    one, other = np.nonzero(np.triu(touching(patches.low, patches.high, patches.low, patches.high)))
    twice = shared_place(patches.low[one], patches.high[one], patches.low[other], patches.high[other])
    values = patches.domain.inputs_at(twice)
    apart = np.abs(patches.unknowns_at(one, values) - patches.unknowns_at(other, values))
    # They agree if the assembly of one patch lies in the ball in which that of the other is the only one.
    alike = (apart + patches.error[one] < patches.unique_within[other]).all(axis=-1)
    alike |= (apart + patches.error[other] < patches.unique_within[one]).all(axis=-1)
    for first, second in zip(one[~alike], other[~alike], strict=True):
        if not dropped[first]:
            dropped[second] = True
    return dropped
