"""A front double wishbone and what Lotus Suspension Analysis prints of it.

Source: printed report of Lotus Suspension Analysis (SHARK) v4.03, in the source distribution of the Python
package voila-sus 0.2.0 (MIT licence), tests/fixtures/front_type1_report.txt; the car is `double-wishbone`,
mm, deg. The rules of the tables were found by reproducing them: angles are projected; bump is the vertical
travel of the contact point, the lowest point of a thin disc about the wheel centre.
"""

from __future__ import annotations

import csv
from pathlib import Path

from validate import published

ROLLING_RADIUS = 270


# Printed to 1e-4 deg.
COLUMNS = ("bump [mm]", "camber [deg]", "toe [deg]", "castor [deg]", "kingpin [deg]")
with (Path(published.__file__).parent / "lotus-bump.csv").open(encoding="utf-8") as _file:
    BUMP = [tuple(float(row[one]) for one in COLUMNS) for row in csv.DictReader(_file)]
