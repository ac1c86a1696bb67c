"""A front double wishbone and what Lotus Suspension Analysis prints of it.

Source: printed report of Lotus Suspension Analysis (SHARK) v4.03, in the source distribution of the Python
package voila-sus 0.2.0 (MIT licence), tests/fixtures/front_type1_report.txt; the car is `double-wishbone`,
mm, deg. The rules of the tables were found by reproducing them: angles are projected; bump is the vertical
travel of the contact point, the lowest point of a thin disc about the wheel centre; in the steering table
the rack moves the tie rod's inner end along y, and the height of the contact point is held.
"""

from __future__ import annotations

import csv
from pathlib import Path

from validate import published

ROLLING_RADIUS = 270


def _printed(name: str, *columns: str) -> tuple[tuple[float, ...], ...]:
    """Some columns of a printed table, row by row."""
    text = (Path(published.__file__).parent / f"lotus-{name}.csv").read_text(encoding="utf-8")
    return tuple(tuple(float(row[one]) for one in columns) for row in csv.DictReader(text.splitlines()))


# Printed to 1e-4 deg and to 1e-2 deg; the steering table is of the right wheel.
BUMP = _printed("bump", "bump [mm]", "camber [deg]", "toe [deg]", "castor [deg]", "kingpin [deg]")
STEERING = _printed("steering", "rack [mm]", "toe rhs [deg]", "camber rhs [deg]")
