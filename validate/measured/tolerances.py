r"""The tolerance of each number of a file of results.

A number q of a file at an independent value x agrees with ours if they differ by at most

    T = h_q + S + a + b + 4 eps Q,    S = sum over the independent columns of max |q(x -+ h_x) - q(x)|,

- h_q, h_x: half a unit of the last digit as written.
- S: the effect of the rounding of x, from both ends of the interval of x. To first order it is |q'| h_x, and
  q is monotonic over such a width.
- a: the accuracy of the file that the user states.
- b: our error bound. Over time it is proven; over inputs it follows from the proven bound of the pose.
- 4 eps Q: at most four roundings by reading, unit and sign. Q is the largest number of the quantity, since a
  component is no more accurate than the largest one from which it is computed.

So T is 0 only if the car gives only zeros and the user states that these are exact.

Digits written in full do not show how accurate a program is. If a column is in full digits and neither the
user nor a map states an accuracy, the program is assumed to place every point within e, the scene's
tolerance, mm (1e-9 if the scene gives none). Then a is the effect of e on the number at that pose, with the
worst signs (`formulations.stated_accuracy`), and a travel in full digits also has the error e, which is added
to S. Rows where such an error may reach a singular pose are not tested.

A column is not tested if S is at least half of the quantity's range in the file, because a constant would
agree too. Independent columns in even steps are set values, h_x = 0. If the rounding of another independent
column is not stated, and its part of S makes T more than ten times wider, a number that agrees only because
of it is not tested. A number of the car that agrees is not tested either if fewer than half of its values in
the file can be compared.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pointcoord.numerics.rounding import EPS
from validate.arrays import Array
from validate.comparison.pair import SMALLEST
from validate.measured.mapping import Series
from validate.measured.meanings import TRAVEL
from validate.measured.poses import Found
from validate.plain_text import gathered
from validate.tables.errors import FileError

# A verdict may not depend on a rounding that is not stated and widens the tolerance by more than this factor.
WIDER = 10.0


@dataclass(frozen=True)
class Held:
    """A column of a file with our numbers and the parts of their tolerances, each (N,), NaN for no number.

    Attributes:
        ours: our numbers.
        own: the part of the file's numbers, h_q + a + 4 eps Q.
        swing: the part S, from the rounding of the independent columns.
        supposed: the part of `swing` from columns whose rounding is not stated.
        bound: the part b, our error bound.
    """

    series: Series
    ours: Array
    own: Array
    swing: Array
    supposed: Array
    bound: Array

    @property
    def tolerance(self) -> Array:
        """The tolerance of every number, (N,)."""
        return np.asarray(self.own + self.swing + self.bound)

    @property
    def gap(self) -> Array:
        """The difference of every number, (N,)."""
        return np.abs(self.series.apart(self.ours, self.series.values))

    @property
    def share(self) -> Array:
        """The difference of every number over its tolerance, (N,)."""
        return np.asarray(self.gap / (self.tolerance + SMALLEST))

    @property
    def compared(self) -> tuple[int, int]:
        """How many of its values are compared, and how many it has."""
        return int(np.isfinite(self.share).sum()), int(np.isfinite(self.series.values).sum())

    @property
    def blind(self) -> bool:
        """Whether the independent columns are too coarse to test it."""
        ours, swing = (part[np.isfinite(self.share)] for part in (self.ours, self.swing))
        wide = float(np.ptp(ours)) if len(ours) else 0.0
        return wide > 0.0 and bool((swing >= 0.5 * wide).all())

    def supposes(self, factor: float) -> bool:
        """Whether a number is within `factor` times its tolerance only because of `supposed`."""
        close = np.minimum(self.tolerance, WIDER * (self.tolerance - self.supposed))
        return bool((self.gap > factor * close).any())


def held_of(here: Found, accuracy: float | None) -> tuple[list[Held], list[str]]:
    """Every column of a file with our numbers and tolerances, and a note on an accuracy that is assumed.

    Args:
        accuracy: error of the file's numbers in addition to their rounding, in the unit of each; None: not
            stated.
    Raises:
        FileError: no row can be reached.
        MissingLibrary: full digits and numbers over inputs need the extra `validate`.
        PointcoordError: the scene cannot be solved.
    """
    driven = here.driven
    measured, e, notes = driven.measured, driven.scene.tolerance, list[str]()
    if not len(here.rows):
        row = min(here.reasons)
        problem = f"none of its rows can be reached ({here.reasons[row]})"
        raise FileError(measured.source, measured.rows[row], problem, "rows that the scene's car can have")
    unsaid = [accuracy is None and s.said.accuracy is None and not s.off.any() for s in measured.numbers]
    offs = [s.off for s in measured.independent]
    stated = np.array([0.0 * s.values + s.accuracy_or(accuracy or 0.0) for s in measured.numbers])
    if any(unsaid):
        of_points = here.columns(driven.within(here, np.full(len(here.rows), e)))
        stated[unsaid] = of_points[unsaid]
        for i, s in enumerate(measured.independent):
            offs[i] = s.off + e * (s.meaning.kind == TRAVEL and not s.off.any())
        notes.append(
            f"numbers in full digits are compared as if their points were within {e:g} mm, the scene's "
            "tolerance, because they are in full digits and no --accuracy is given"
        )
    ours, bounds = here.columns(here.numbers), here.columns(driven.bounds(here))
    changes, supposed = driven.swings(ours, offs), [s.rounded_unasked for s in measured.independent]
    sizes = gathered((s.meaning.quantity, np.abs(s.values)) for s in measured.numbers)
    largest = {quantity: float(np.nanmax(np.array(some), initial=0.0)) for quantity, some in sizes.items()}
    found = [
        Held(s, ours[i], s.off + own + 4.0 * EPS * largest[s.meaning.quantity], *swings, bounds[i])
        for i, (s, own) in enumerate(zip(measured.numbers, stated, strict=True))
        for swings in [(changes[:, i].sum(axis=0), changes[supposed, i].sum(axis=0))]
    ]
    return found, notes
