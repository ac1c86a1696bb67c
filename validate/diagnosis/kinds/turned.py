"""Axes turned by any angle: one rotation for all points, without and with a shift."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from validate.diagnosis.evidence import Evidence, kind_of, order
from validate.diagnosis.hypothesis import Hypothesis, Kind
from validate.diagnosis.kinds.axes import in_axes


class Turned(Kind):
    """The rotation of least squares between both sides' positions (Kabsch)."""

    name, opens = "turned axes", True

    def hypotheses(self, evidence: Evidence) -> Iterator[Hypothesis]:
        """About the origin, and about the middle of all positions."""
        placed = [row for row in evidence.wrong if kind_of(row) == "point" and order(row) == 0]
        if not placed:
            return
        ours = np.concatenate([evidence.held[row] for row in placed])
        theirs = np.concatenate([evidence.given[row] for row in placed])
        if not np.isfinite(theirs).all():
            return
        for shifted in (False, True):
            middle = (ours.mean(axis=0), theirs.mean(axis=0)) if shifted else (np.zeros(3), np.zeros(3))
            left, sizes, right = np.linalg.svd((theirs - middle[1]).T @ (ours - middle[0]))
            if sizes[1] <= 1e-9 * sizes[0]:
                continue
            matrix = left @ np.diag([1.0, 1.0, np.linalg.det(left @ right)]) @ right
            turn = np.array(
                [matrix[2, 1] - matrix[1, 2], matrix[0, 2] - matrix[2, 0], matrix[1, 0] - matrix[0, 1]]
            )
            sine = 0.5 * float(np.linalg.norm(turn))
            angle = float(np.degrees(np.arctan2(sine, 0.5 * (np.trace(matrix) - 1.0))))
            if sine < 1e-12:
                continue
            axis = ", ".join(f"{c:.4g}" for c in turn / (2.0 * sine) + 0.0)
            shift = middle[1] - matrix @ middle[0]
            moved = in_axes(evidence, matrix, evidence.wrong, False)
            for row in placed:
                moved[row] = (moved[row][0] + shift, moved[row][1])
            words = f"turned by {angle:.6g} degrees about ({axis})"
            if shifted:
                words += f" and shifted by ({', '.join(f'{c:.4g}' for c in shift)}) mm"
            yield Hypothesis(self.name, words, words, moved, 6 if shifted else 3, 6.0 if shifted else 3.0)


KIND = Turned()
