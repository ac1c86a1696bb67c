"""An offset: another origin, the static or first value subtracted, the chassis' motion left out."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from pointcoord.linkage.chassis import ChassisMotion
from pointcoord.simulation import scene_mechanism
from validate.diagnosis.evidence import Evidence, Row, kind_of, order
from validate.diagnosis.hypothesis import Hypothesis, Kind, WouldBe

Array = NDArray[np.float64]


class Offset(Kind):
    """What is subtracted beforehand, then what is found by least squares."""

    name, closes = "offset", True

    def hypotheses(self, evidence: Evidence) -> Iterator[Hypothesis]:
        """Known values first."""
        placed = [row for row in evidence.wrong if order(row) == 0]
        if evidence.over_time:
            yield from self._relative(evidence)
        if not placed:
            return
        first = {row: self._less(evidence, row, evidence.held[row][0]) for row in placed}
        yield Hypothesis(self.name, "first", "the value at the first instant is subtracted", first)
        drawn = {row: value for row in placed if (value := self._drawn(evidence, row)) is not None}
        if drawn:
            rows = {row: self._less(evidence, row, value) for row, value in drawn.items()}
            yield Hypothesis(self.name, "static", "the static value, as drawn, is subtracted", rows, cost=1.1)
        yield from self._origin(evidence, [row for row in placed if kind_of(row) == "point"])
        for row in placed:
            gap = np.mean(evidence.given[row] - evidence.held[row], axis=0)
            vector = np.ndim(gap) == 1
            clear = np.abs(gap).max() > 8.0 * evidence.rounded(row).max()
            if np.isfinite(gap).all() and clear and len(evidence.times) > 2:
                gap = np.where(np.abs(gap) <= evidence.rounded(row).max(), 0.0, gap)
                words = f"a constant offset of {evidence.in_words(row, gap)}"
                rows = {row: self._less(evidence, row, -gap)}
                fitted = 3 if vector else 1
                yield Hypothesis(self.name, (row, "constant"), words, rows, fitted, 1.0 + fitted)

    @staticmethod
    def _less(evidence: Evidence, row: Row, value: Array | float) -> WouldBe:
        return evidence.held[row] - value, evidence.rounded(row, value)

    @staticmethod
    def _drawn(evidence: Evidence, row: Row) -> Array | float | None:
        """A row's number in the drawing; of an angle in the closed drawing."""
        if kind_of(row) == "point":
            return np.array(evidence.scene.mechanism.points[row[1]])
        return evidence.solved.drawn.get(row[1])

    def _origin(self, evidence: Evidence, rows: list[Row]) -> Iterator[Hypothesis]:
        """One shift for all points; of another origin only where every given point has it."""
        if len(rows) < 2:
            return  # one point alone tells of no other
        shift = np.mean(np.concatenate([evidence.given[row] - evidence.held[row] for row in rows]), axis=0)
        if not np.isfinite(shift).all():
            return
        noise = max(float(evidence.rounded(row).max()) for row in rows)
        shift[np.abs(shift) < noise] = 0.0
        fitted = int(np.count_nonzero(shift))
        if not fitted:
            return
        moved = {row: self._less(evidence, row, -shift) for row in rows}
        points = [row for row in evidence.given if row[0] == rows[0][0]]
        every = set(points) == set(rows) and all(evidence.left(row, *moved[row]) <= 1.0 for row in rows)
        # The points that agree say where the origin is: what is off beside them is off by itself.
        told = evidence.in_words(rows[0], shift)
        words = f"another origin: every point is shifted by {told}" if every else f"shifted by {told}"
        yield Hypothesis(self.name, "origin", words, moved, fitted, 1.0 + 0.5 * fitted)

    def _relative(self, evidence: Evidence) -> Iterator[Hypothesis]:
        """Relative to the chassis, where an input displaces that and none turns it."""
        scene = evidence.scene
        chassis = ChassisMotion.of(scene_mechanism(scene), scene.functions)
        moved = () if chassis.turns else chassis.states(evidence.times, 2)
        rows: dict[Row, WouldBe] = {}
        for row in evidence.wrong:
            if kind_of(row) == "point" and moved:
                rows[row] = self._less(evidence, row, moved[order(row)])
        if rows:
            words = "relative to the chassis, whose own motion is left out"
            yield Hypothesis(self.name, "chassis", words, rows)


KIND = Offset()
