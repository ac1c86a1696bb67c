"""Other axes: permuted and turned round, or turned by any angle; the same for all points."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import permutations, product

import numpy as np
from numpy.typing import NDArray

from validate.diagnosis.evidence import Evidence, Row, kind_of, order
from validate.diagnosis.hypothesis import Hypothesis, Kind, WouldBe

Array = NDArray[np.float64]


def in_axes(evidence: Evidence, matrix: Array, rows: tuple[Row, ...], exact: bool) -> dict[Row, WouldBe]:
    """Vectors in other axes; what a body turns by keeps its sense only where the axes stay right-handed."""
    found: dict[Row, WouldBe] = {}
    for row in rows:
        if kind_of(row) != "car":
            axial = np.linalg.det(matrix) if kind_of(row) == "body" else 1.0
            allowed = evidence.allowed[row] if exact else evidence.rounded(row)
            found[row] = (evidence.held[row] @ (np.sign(axial) * matrix).T, allowed @ np.abs(matrix).T)
    return found


class Axes(Kind):
    """Axes swapped, with or without other signs; then one rotation, found from all positions."""

    name, opens = "axes", True

    def hypotheses(self, evidence: Evidence) -> Iterator[Hypothesis]:
        """All permutations with signs, and the rotation that brings the positions closest."""
        if all(kind_of(row) == "car" for row in evidence.wrong):
            return
        for places in permutations(range(3)):
            for signs in product((1.0, -1.0), repeat=3):
                matrix = np.zeros((3, 3))
                matrix[range(3), places] = signs
                if places == (0, 1, 2) and (np.prod(signs) < 0.0 or all(s > 0.0 for s in signs)):
                    continue  # nothing, or a matter of signs or of sides
                named = ["-" * (s < 0.0) + "xyz"[p] for s, p in zip(signs, places, strict=True)]
                words = f"other axes: its x, y, z are our {', '.join(named)}"
                rows = in_axes(evidence, matrix, evidence.wrong, True)
                yield Hypothesis(
                    self.name, tuple(named), words, rows, cost=1.5 + 0.01 * sum(s < 0.0 for s in signs)
                )
        yield from self._turned(evidence)

    def _turned(self, evidence: Evidence) -> Iterator[Hypothesis]:
        """The rotation of least squares between both sides' positions (Kabsch), without and with a shift."""
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


KIND = Axes()
