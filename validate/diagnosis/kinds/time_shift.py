"""A time shift: the same curves so many seconds earlier or later."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from pointcoord import Motion, PointcoordError, simulate
from pointcoord.numerics.rounding import EPS
from validate.diagnosis.evidence import Evidence, Row, kind_of, order
from validate.diagnosis.hypothesis import Hypothesis, Kind

Array = NDArray[np.float64]

STEPS, LAST = 8, 2
FEW = 256  # instants that a shift is found from first


class TimeShift(Kind):
    """Their numbers at t are ours at t + s: s from the grid of instants, then by least squares."""

    name, solves, of_time = "time shift", True, True

    def hypotheses(self, evidence: Evidence) -> Iterator[Hypothesis]:
        """The one of the whole car."""
        times, looked = evidence.times, _looked_at(evidence)
        if len(times) < 5 or not looked or evidence.solved.motion is None:
            return
        theirs = np.concatenate([evidence.given[row].reshape(len(times), -1) for row in looked], axis=1)
        ours = np.concatenate([evidence.held[row].reshape(len(times), -1) for row in looked], axis=1)
        if not np.isfinite(theirs).all():
            return
        spread = np.ptp(ours, axis=0)
        used = spread > 1e-9 * np.abs(ours).max(axis=0)
        if not used.any():
            return
        pad = 2.0 * float(np.diff(times).max())
        shift = _on_the_grid(times, theirs[:, used] / spread[used], ours[:, used] / spread[used])
        motion = self._motion(evidence, shift, pad) or evidence.solved.motion
        ends = (float(motion.times[0]), float(motion.times[-1]))
        # Some instants find it; what is left is found from all.
        some = np.unique(np.linspace(0, len(times) - 1, min(FEW, len(times))).astype(np.intp))
        for here, steps in ((evidence.at(some.tolist()), STEPS), (evidence, LAST)):
            for _ in range(steps):
                step = self._step(here, looked, shift, motion)
                if not np.isfinite(step) or abs(step) > pad:
                    return
                shift += step
                if abs(step) <= 1e-13 * float(np.ptp(times)):
                    break
        if abs(shift) <= 1e-9 * float(np.ptp(times)):
            return
        inside = (times + shift >= ends[0]) & (times + shift <= ends[1])
        if inside.sum() < 5:
            return
        found = _moved(evidence, shift, motion)
        late = "later" if shift < 0.0 else "earlier"
        words = f"the same curves {abs(shift):.6g} s {late}" + (
            "" if inside.all() else ", as far as ours reach"
        )
        numbers = {}
        for row in evidence.held:
            if row in found:
                # The instants are rounded too, and so moves what is read there.
                speed = np.abs(np.gradient(found[row], times, axis=0)).max()
                # What is claimed varies along the motion: the most of it, since it is read elsewhere.
                most = np.broadcast_to(evidence.rounded(row).max(axis=0), found[row].shape)
                allowed = most + 8.0 * EPS * speed * (abs(shift) + np.abs(times).max())
                allowed[~inside] = np.inf
                numbers[row] = (found[row], allowed)
        yield Hypothesis(self.name, "shift", words, numbers, 1, 2.0, whole=True)

    @staticmethod
    def _motion(evidence: Evidence, shift: float, pad: float) -> Motion | None:
        """The scene's motion over the instants that a shift needs; None where it has none there."""
        scene = evidence.solved.fine
        time = scene.time
        first, last = min(time.start, time.start + shift - pad), max(time.stop, time.stop + shift + pad)
        longer = time.model_copy(update={"start": first, "stop": last, "samples": 2})
        try:
            return simulate(scene.model_copy(update={"points": None, "time": longer}))
        except PointcoordError:
            return None

    @staticmethod
    def _step(evidence: Evidence, rows: tuple[Row, ...], shift: float, motion: Motion) -> float:
        """What least squares adds to a shift; not a number where the curves do not move."""
        first, last = float(motion.times[0]), float(motion.times[-1])
        h = 1e-5 * float(np.ptp(evidence.scene.instants))
        moved = evidence.times + shift
        inside = (moved - h >= first) & (moved + h <= last)
        less, here, more = (
            np.concatenate([part[row][inside].ravel() for row in rows])
            for part in (_moved(evidence, shift + e, motion) for e in (-h, 0.0, h))
        )
        theirs = np.concatenate([evidence.given[row][inside].ravel() for row in rows])
        slope = (more - less) / (2.0 * h)
        square = float(slope @ slope)
        return float(slope @ (theirs - here)) / square if square > 0.0 else np.nan


def _looked_at(evidence: Evidence) -> tuple[Row, ...]:
    """Numbers of one unit that disagree: positions if there are any, else what comes first."""
    best = [row for row in evidence.wrong if kind_of(row) == "point" and order(row) == 0]
    return tuple(best) or evidence.wrong_of(evidence.wrong[0][0])


def _on_the_grid(times: Array, theirs: Array, ours: Array) -> float:
    """The shift by whole instants under which both curves are nearest: a coarse one, then those about it."""
    coarse = -(-len(times) // FEW)
    half = len(times) // 2
    best = _nearest(theirs, ours, range(-half, half + 1, coarse), coarse)
    if coarse > 1:
        best = _nearest(theirs, ours, range(max(best - coarse, -half), min(best + coarse, half) + 1), coarse)
    return float(times[best] - times[0]) if best >= 0 else float(times[0] - times[-best])


def _nearest(theirs: Array, ours: Array, shifts: range, stride: int) -> int:
    """Of some shifts that under which both are nearest, at every so many instants."""
    most, found = np.inf, 0
    for k in shifts:
        mine, other = (ours[k:], theirs[: len(ours) - k]) if k >= 0 else (ours[:k], theirs[-k:])
        left = float(np.mean((mine[::stride] - other[::stride]) ** 2))
        if left < most:
            most, found = left, k
    return found


def _moved(evidence: Evidence, shift: float, motion: Motion) -> Mapping[Row, Array]:
    """Our numbers so much later; at the ends of our motion beyond these."""
    samples = motion.at(np.clip(evidence.times + shift, motion.times[0], motion.times[-1]))
    return {
        (quantity, name): np.asarray(numbers)
        for quantity, part in samples.numbers.items()
        for name, numbers in part.items()
    }


KIND = TimeShift()
