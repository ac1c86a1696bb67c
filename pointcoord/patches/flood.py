r"""Covering a range of inputs with proven patches, outwards from a pose, on one branch.

A box is entered at a pose that is known to be on the branch. From there a path goes straight to its middle
that cannot change branch (see `solve.assembly`), where the series starts. A patch that is proven, and near
enough, is kept, and its neighbours are entered where they touch it. A box that fails is halved in the input
that its failure depends on most, and its parts are entered at its middle, or where it was entered itself.
So boxes shrink towards folds, and beyond the smallest they are given up, with the reason.

In the end neighbours are compared: each is alone within a proven distance, so where they touch they are the
same assembly or are seen not to be. Two ways around a point where folds meet can lead to two assemblies at
the same inputs; the one that came later is then given up, so that nothing crosses from the one to the
other.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

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
from pointcoord.solve.place import Path

Array = NDArray[np.float64]
Whole = NDArray[np.int64]
Corner = tuple[int, ...]
Key = tuple[Corner, Corner]
Start = tuple[Whole, Array]
"""A place in halves of the smallest box, (p,), and the pose near there, (size,)."""

# Boxes that are expanded and proven at once: their matrices stay below some 100 MB in two inputs.
BATCH = 32
# Steps of a path to the middle of a box: those that arrive take some ten, and one that takes more leads to a
# fold or through what no patch will cover at once.
STEPS = 32
# A part that uses no less than this share of what the whole did is as exact as rounding lets it be. One that
# uses less may be so too, as what rounding makes is half or twice as much by chance in another box: its parts
# are tried, and the smallest box, which has none, is asked what it is off by (see `PatchProof.rounded`).
NO_BETTER = 0.9
# Terms of the last order that are so many tolerances large leave out more than one: no need to prove it.
COARSE = 1e3

FOLD = "no patch can be proven here down to the smallest: a fold, where assemblies meet or end, is near"
ROUNDING = "rounding alone exceeds the tolerance here, near a fold or because the tolerance is too fine"
UNREACHED = "not reached from the drawing without crossing what is not covered"
SEAM = "two ways from the drawing around a place that is not covered lead to different assemblies here"
TOO_MANY = "the most patches that are allowed, or tries at them, were used before this place was reached"


@dataclass(frozen=True)
class Entry:
    """Where a box is entered.

    Attributes:
        twice: the place, in halves of the smallest box, (p,).
        y: the pose there, (size,).
        used: of what is allowed by the patch that this box is a part of, where that was proven but not near
            enough.
    """

    twice: Whole
    y: Array
    used: float = np.inf


@dataclass(frozen=True)
class Failure:
    """Why a box that was expanded is not kept.

    Attributes:
        y: the pose at its middle, (size,).
        weights: how much each input takes part, (p,).
        used: of what is allowed, where it is proven. rounded: whether rounding alone makes that too much.
    """

    y: Array
    weights: Array
    used: float = np.inf
    rounded: bool = False


@dataclass(frozen=True)
class Limits:
    """How near to the assembly a patch must be proven to be, to be kept, and what covering may take.

    With S_i = max |dY/ds_i| over all points in its middle, s the inputs from there in half widths, and L the
    mechanism's size, a rate is a sum of S_i s_i' and an acceleration one of S_i s_i'' and of S_i S_j / L s_i'
    s_j', as of what turns about an arm of that length. Errors of the derivatives by the inputs are held to
    the same part of these as a position's is of L.

    Attributes:
        tolerance: largest bound of a reported point, mm.
        derivative: highest time derivative that will be evaluated; 0 holds positions only.
        keep_rounded: whether a patch is kept that rounding alone keeps from being nearer.
        most: patches; 4,096 take a few hundred MB while they are made.
        effort: factorisations after which nothing more is tried.
    """

    tolerance: float
    derivative: int = 0
    keep_rounded: bool = False
    most: int = 4096
    effort: float = np.inf

    def used(self, coefficients: Array, off: Jet, size: float) -> Array:
        """What patches take of what is allowed, (P,); up to 1 they are kept.

        Args:
            coefficients: of the reported points, shape (P, powers, 3 points), mm. off: errors of their sums.
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
    """What was covered, and what not: boxes by their corners, with the reason.

    Attributes:
        work: what it took.
    """

    patches: ProvenPatches
    given_up: tuple[tuple[Key, str], ...]
    work: Work

    @property
    def reasons(self) -> tuple[str, ...]:
        """Why something is not covered, each once."""
        return tuple(dict.fromkeys(reason for _, reason in self.given_up))


@dataclasses.dataclass
class _Flood:
    """Boxes on their way to being covered.

    Attributes:
        waiting: boxes that nothing has entered yet. entered: those that are to be tried.
        given_up: with reasons. kept: batches of proven patches, in the order in which they were reached.
        wanted: which of the smallest boxes are wanted; all if not given.
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
        """How many patches are kept."""
        return sum(len(part.low) for part in self.kept)

    def try_boxes(self, boxes: list[tuple[Key, Entry]]) -> None:
        """Prove boxes, keep those that can be, and halve the others."""
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
        """Prove series about the middles of boxes, and keep what is near enough."""
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
        """Cut a box that failed in two.

        Args:
            failure: if its middle was reached.
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
        """Enter boxes where they touch patches."""
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
    """Cover a domain from a pose on.

    Args:
        wanted: of the smallest boxes those that are to be covered; what has none of them is passed over.
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
    """The place of a domain that is nearest to the closed drawing, and the pose there.

    Raises:
        InputOutOfRange: an end of a range at which an input has no meaning.
        AssemblyError: that place cannot be reached from the drawing.
    """
    domain.known_at(np.stack(domain.ends))
    drawn = domain.mechanism.input_values(closed.y[domain.mechanism.map.unknowns :])
    twice = domain.nearest_place(np.array([float(drawn[name]) for name in domain.free]))
    held = {name: np.array(low) for name, (low, high) in domain.ranges.items() if low == high}
    inputs = held | dict(zip(domain.free, domain.inputs_at(twice), strict=True))
    return twice, assemble(domain.mechanism, inputs, None, closed).y


def last_terms(series: Array, inputs: int, order: int) -> tuple[Array, Array]:
    """Largest sum of terms of the highest total degree, (P,), and how much of it is by each input, (P, p)."""
    every = powers(inputs, order)
    first = every.first_of(order)
    sizes = Jet.of(series[:, first:], every.exponents[first:])
    return sizes.value.max(axis=-1), sizes.first.max(axis=-1)


def touching(low: Whole, high: Whole, other_low: Whole, other_high: Whole) -> NDArray[np.bool_]:
    """Which boxes (A, p) and (B, p) that do not overlap share a part of a face, shape (A, B)."""
    first = np.maximum(low[:, None], other_low[None])
    last = np.minimum(high[:, None], other_high[None])
    return np.asarray(((first == last).sum(axis=-1) == 1) & (first <= last).all(axis=-1))


def shared_place(low: Whole, high: Whole, other_low: Whole, other_high: Whole) -> Whole:
    """Middles of what boxes share, in halves of the smallest, shape (..., p)."""
    return np.asarray(np.maximum(low, other_low) + np.minimum(high, other_high))


def _seams(patches: ProvenPatches) -> NDArray[np.bool_]:
    """Patches that are another assembly than a neighbour that was reached before them, shape (P,)."""
    dropped = np.zeros(len(patches.low), dtype=bool)
    one, other = np.nonzero(np.triu(touching(patches.low, patches.high, patches.low, patches.high)))
    twice = shared_place(patches.low[one], patches.high[one], patches.low[other], patches.high[other])
    values = patches.domain.inputs_at(twice)
    apart = np.abs(patches.unknowns_at(one, values) - patches.unknowns_at(other, values))
    # The one's assembly is in the ball of the other's within which there is only one.
    alike = (apart + patches.error[one] < patches.unique_within[other]).all(axis=-1)
    alike |= (apart + patches.error[other] < patches.unique_within[one]).all(axis=-1)
    for first, second in zip(one[~alike], other[~alike], strict=True):
        if not dropped[first]:
            dropped[second] = True
    return dropped
