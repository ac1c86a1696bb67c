r"""The tolerance of each number of a file of results.

A number q of a file at an independent value x agrees with ours if they differ by at most

    T = h_q + S + a + b + 4 eps Q,    S = sum over the independent columns of max |q(x -+ h_x) - q(x)|,

- h_q, h_x: half a unit of the last digit as written.
- S: the effect of the rounding of x, from both ends of the interval of x. To first order it is |q'| h_x, and
  q is monotonic over such a width.
- a: the accuracy of the file that the user states.
- b: our error bound. Over time it is proven; over inputs it follows from the proven bound of the pose, and
  forces have none.
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

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from pointcoord.numerics.rounding import EPS
from validate.arrays import Array
from validate.comparison.pair import SMALLEST
from validate.formulations.asked_numbers import is_force
from validate.formulations.protocol import Accuracy, Solution
from validate.measured.mapping import Measured, Series
from validate.measured.meanings import TRAVEL
from validate.measured.poses import Driven, Found, columns_of, swings
from validate.plain_text import counted_as, gathered, shown, some_of
from validate.tables.errors import FileError
from validate.toml_written import key_of

OURS = "pointcoord"
NO_NUMBERS = "no row has a number of it that can be compared"
NOT_OVER_INPUTS = "rates need a column of time"
NO_WAY = "forces need a motion through the rows in their order, and there is none"
# A verdict may not depend on a rounding that is not stated and widens the tolerance by more than this factor.
WIDER = 10.0
# Largest number of rows or columns named in a note.
NAMED = 3


@dataclass(frozen=True)
class Held:
    """A column of a file with our numbers and tolerances.

    Attributes:
        ours, tolerance: (N,), NaN where there is nothing to compare.
        swing: the part S of the tolerance, from the rounding of the independent columns, (N,).
        supposed: the part of `swing` from columns whose rounding is not stated, (N,).
        bound: the part b, our error bound, (N,).
        unknown: why we have no numbers, in words.
    """

    series: Series
    ours: Array
    tolerance: Array
    swing: Array
    supposed: Array
    bound: Array
    unknown: str = ""

    @property
    def close(self) -> Array:
        """The tolerance, limited to WIDER times the tolerance without `supposed`, (N,)."""
        return np.asarray(np.minimum(self.tolerance, WIDER * (self.tolerance - self.supposed)))

    @property
    def gap(self) -> Array:
        """The difference of every number, (N,), NaN where there is none."""
        return np.abs(self.series.apart(self.ours, self.series.values))

    @property
    def share(self) -> Array:
        """The difference of every number over its tolerance, likewise."""
        return np.asarray(self.gap / (self.tolerance + SMALLEST))

    @property
    def counts(self) -> tuple[int, int]:
        """The number of its values that are compared, and the number of its values."""
        return int(np.isfinite(self.share).sum()), int(np.isfinite(self.series.values).sum())

    @property
    def few(self) -> bool:
        """Whether most of its values cannot be compared."""
        compared, there = self.counts
        return 2 * compared < there

    @property
    def blind(self) -> bool:
        """Whether the independent column is too coarse to test it."""
        ours, swing = (part[np.isfinite(part)] for part in (self.ours, self.swing))
        wide = float(np.ptp(ours)) if len(ours) else 0.0
        return bool(wide > 0.0 and len(swing) and (swing >= 0.5 * wide).all())


def held_of(
    measured: Measured, driven: Driven, accuracy: float | None
) -> tuple[list[Held], Solution, tuple[str, ...]]:
    """Every column with our numbers and tolerances, our solution, and notes.

    Raises:
        FileError: no row can be reached.
        MissingLibrary: full digits and numbers over inputs need the extra `validate`.
        PointcoordError: the scene cannot be solved.
    """
    values, least = [s.values for s in measured.independent], driven.scene.tolerance
    count = len(measured.rows)
    here = driven.at(values)
    notes = [*measured.notes, *driven.notes, *out_of_reach(measured, here)]
    if not here.reached.any():
        row = min(here.reasons)
        problem = f"none of its {counted_as(count, 'row')} can be reached ({here.reasons[row]})"
        raise FileError(measured.source, measured.rows[row], problem, "rows that the scene's car can have")
    unsaid = [s for s in measured.numbers if accuracy is None and s.accuracy is None and not s.off.any()]
    granted, reached_to = here, [s.off for s in measured.independent]
    if unsaid:
        granted = replace(here, bounds=driven.within(here, np.full(count, least)))
        notes.append(_granted(unsaid, measured, least))
        reached_to = [
            s.off + least if s.meaning.kind == TRAVEL and not s.off.any() else s.off
            for s in measured.independent
        ]
    ours, bounds = (columns_of(measured.numbers, of, count) for of in (here.numbers, here.bounds))
    stated = columns_of(measured.numbers, granted.bounds, count, absent=0.0)
    changes = swings(driven, measured, reached_to, ours)
    swing = changes.sum(axis=0)
    supposed = changes[[s.rounded_unasked for s in measured.independent]].sum(axis=0)
    largest: dict[str, float] = {}
    for s in measured.numbers:
        size = float(np.nanmax(np.abs(s.values), initial=0.0))
        largest[s.meaning.quantity] = max(largest.get(s.meaning.quantity, 0.0), size)
    found = list[Held]()
    for i, s in enumerate(measured.numbers):
        quantity, name = s.meaning.row
        own = stated[i] if s in unsaid else s.accuracy_or(accuracy or 0.0)
        allowed = s.off + swing[i] + 4.0 * EPS * largest[quantity] + own + bounds[i]
        tolerance = np.where(np.isfinite(ours[i]), allowed, np.nan)
        computed = all(name in of.get(quantity, {}) for of in (here.numbers, here.bounds))
        unknown = "" if computed else NO_NUMBERS
        if not (computed or driven.over_time):
            unknown = NOT_OVER_INPUTS if s.meaning.per_second else NO_WAY if is_force(quantity) else unknown
        found.append(Held(s, ours[i], tolerance, swing[i], supposed[i], bounds[i], unknown))
    reasons = gathered((h.unknown, shown(h.series.column)) for h in found if h.unknown)
    notes += [f"{', '.join(names)} is not tested: {why}" for why, names in reasons.items()]
    # The columns whose tolerance is larger by the rounding of an independent column than by their own digits.
    wide = [h for h in found if np.nanmax(h.supposed, initial=0.0) > np.nanmax(h.series.off, initial=0.0)]
    if wide:
        names = some_of([shown(h.series.column) for h in wide], NAMED)
        notes.append(f"{names}: tolerance widened because {rounded(measured)}")
    claims = {
        quantity: {name: np.nan_to_num(bound) for name, bound in here.bounds[quantity].items()}
        for quantity in here.bounds.keys() & here.numbers.keys()
    }
    instants = measured.instants
    own_accuracy = Accuracy(np.ones(len(instants)), claims, proven=True)
    return found, Solution(OURS, instants, here.numbers, own_accuracy), tuple(notes)


def rounded(measured: Measured) -> str:
    """The independent columns taken as rounded although this is not stated, and the line for a map."""
    some = [s for s in measured.independent if s.rounded_unasked]
    given = (f"{shown(s.column)} is given to +-{np.max(s.off) / s.factor:.3g}" for s in some)
    lines = ", ".join(f"columns.{key_of(shown(s.column))}.printed = 0" for s in some)
    return f"{' and '.join(given)}; if it is exact as written, add this line to a map: {lines}"


def _granted(unsaid: Sequence[Series], measured: Measured, tolerance: float) -> str:
    names = some_of([shown(s.column) for s in unsaid], NAMED)
    who = f"{names} {'are' if unsaid[1:] else 'is'}" if len(unsaid) < len(measured.numbers) else "the file is"
    return (
        f"tolerances are for points within {tolerance:g} mm, the scene's tolerance, because {who} in full "
        "digits and no --accuracy is given"
    )


def out_of_reach(measured: Measured, found: Found) -> list[str]:
    """Notes on rows that are left out, with the reasons of the first few."""
    lost = sorted(found.reasons)
    notes = [f"{measured.rows[i]} is left out: {found.reasons[i]}" for i in lost[:NAMED]]
    others = [measured.rows[i] for i in lost[NAMED:]]
    return [*notes, f"likewise left out: {some_of(others, NAMED)}"] if others else notes
