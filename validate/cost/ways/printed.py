"""The paper's algorithm with its formulas as printed, some of which are wrong."""

from __future__ import annotations

from validate.cost.ways.point_coordinates import AtInstants, tolerance_settings
from validate.paper.printed import PRINTED

WAYS = (
    AtInstants(
        name="printed",
        words="Newton's method with the paper's formulas as printed",
        method=PRINTED,
        # What is wrong with them is wrong at any tolerance.
        settings=tolerance_settings((1e-3, 1e-6, 1e-9, 1e-12)),
    ),
)
