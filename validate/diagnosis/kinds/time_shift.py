"""A time shift: the same curves so many seconds, or one sample, earlier or later."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from pointcoord import PointcoordError, simulate
from pointcoord.numerics.rounding import EPS
from validate.diagnosis.evidence import Evidence, numbers_in, some_of
from validate.diagnosis.hypothesis import Hypothesis
from validate.diagnosis.least import fitted

Array = NDArray[np.float64]

FEW = 256  # instants that a shift is found from, and shifts by whole instants that are tried


def shifted_in_time(evidence: Evidence) -> Iterator[Hypothesis]:
    """Their numbers at t are ours at t + s, of the whole car: s from the grid, then by least squares."""
    times, looked, scene = evidence.times, evidence.first_wrong, evidence.solved.fine
    if len(times) < 5 or evidence.solved.motion is None:
        return
    ours, theirs = (
        np.concatenate([part[row].reshape(len(times), -1) for row in looked], axis=1)
        for part in evidence.both
    )
    spread = np.ptp(ours, axis=0)
    used = spread > 1e-9 * np.abs(ours).max(axis=0)
    if not np.isfinite(theirs).all() or not used.any():
        return
    pad = 2.0 * float(np.diff(times).max())
    whole = _on_the_grid(times, theirs[:, used] / spread[used], ours[:, used] / spread[used])
    first, last = times[0] + min(0.0, whole - pad), times[-1] + max(0.0, whole + pad)
    try:
        longer = scene.time.model_copy(update={"start": float(first), "stop": float(last), "samples": 2})
        motion = simulate(scene.model_copy(update={"time": longer}))
    except PointcoordError:
        # The car does not go so far.
        motion, first, last = evidence.solved.motion, times[0], times[-1]
    some = some_of(len(times), FEW)
    some = some[(times[some] + whole - pad >= first) & (times[some] + whole + pad <= last)]
    if len(some) < 5:
        return

    def read(shifts: Array) -> Array:
        found = [motion.at(times[some] + whole + np.clip(shift, -pad, pad)).numbers for (shift,) in shifts]
        return np.stack([numbers_in(one, looked) for one in found])

    rest = fitted(read, [0.0], 1e-4 * pad, np.concatenate([evidence.given[r][some].ravel() for r in looked]))
    # Where whole instants leave nothing but rounding, there is nothing to find.
    shift = whole + (0.0 if rest is None else float(rest[0]))
    if abs(shift) <= 1e-9 * float(np.ptp(times)):
        return
    inside = (times + shift >= first) & (times + shift <= last)
    found = motion.at(np.clip(times + shift, first, last)).numbers
    rows = {}
    for row in evidence.held:
        if row[1] in found[row[0]]:
            value = np.asarray(found[row[0]][row[1]])
            # The instants are rounded too, and so moves what is read there.
            speed = np.abs(np.gradient(value, times, axis=0)).max()
            # What is claimed varies along the motion: the most of it, since it is read elsewhere.
            most = np.broadcast_to(evidence.rounded(row).max(axis=0), value.shape)
            allowed = most + 8.0 * EPS * speed * (abs(shift) + np.abs(times).max())
            allowed[~inside] = np.inf
            rows[row] = (value, allowed)
    reach = "" if inside.all() else ", as far as ours reach"
    words = f"the same curves {abs(shift):.6g} s {'later' if shift < 0.0 else 'earlier'}{reach}"
    yield Hypothesis("shift", words, rows, 1, 2.0, whole=True)


def _on_the_grid(times: Array, theirs: Array, ours: Array) -> float:
    """The shift by whole instants under which both curves are nearest; of many some, then those about it."""
    half, coarse = len(times) // 2, -(-len(times) // FEW)

    def left(k: int) -> float:
        mine, other = (ours[k:], theirs[: len(ours) - k]) if k >= 0 else (ours[:k], theirs[-k:])
        return float(np.mean((mine[::coarse] - other[::coarse]) ** 2))

    best = min(range(-half, half + 1, coarse), key=left)
    best = min(range(max(best - coarse, -half), min(best + coarse, half) + 1), key=left)
    return float(times[best] - times[0]) if best >= 0 else float(times[0] - times[-best])


REVERSED = "its rows in the reverse order"
SAMPLES: Mapping[str, Callable[[Array], Array]] = {
    "one sample late, the first one twice": lambda x: np.concatenate([x[:1], x[:-1]]),
    "one sample early, the last one twice": lambda x: np.concatenate([x[1:], x[-1:]]),
    "one sample late, the last one first": lambda x: np.roll(x, 1, axis=0),
    "one sample early, the first one last": lambda x: np.roll(x, -1, axis=0),
    REVERSED: lambda x: x[::-1],
}
"""In words, and what is then given of numbers."""


def one_sample_off(evidence: Evidence) -> Iterator[Hypothesis]:
    """Every number is in the row after or before its own, or as far from the other end; or two are exchanged.

    What two wheels have in the reverse order, but for numbers that agree, each has of the other one.
    """
    two_wheels = bool(evidence.scene.mechanism.topology.sides)
    for words, moved in (*SAMPLES.items(), *_exchanged(evidence)):
        # Rows that agree as well, so that it is known whether they would under the fault.
        looked = (*evidence.wrong, *evidence.beside)
        rows = {row: (moved(evidence.held[row]), moved(evidence.allowed[row])) for row in looked}
        yield Hypothesis(words, words, rows, cost=1.2, whole=two_wheels and words == REVERSED)


def _exchanged(evidence: Evidence) -> Iterator[tuple[str, Callable[[Array], Array]]]:
    """Two rows that stand in each other's place, where no other row is wrong."""
    off = np.zeros(len(evidence.times), bool)
    for row in evidence.wrong:
        apart = np.abs(evidence.given[row] - evidence.held[row])
        near = apart <= evidence.allowed[row] + evidence.own.get(row, 0.0)
        off |= ~near.reshape(len(off), -1).all(axis=1)
    if np.count_nonzero(off) == 2:
        order = np.arange(len(off))
        order[off] = order[off][::-1]
        one, two = np.flatnonzero(off) + 1
        yield f"its rows {one} and {two} in each other's place", lambda numbers: numbers[order]
