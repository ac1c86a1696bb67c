"""The paper's algorithm with its formulas as printed, some of which are wrong at any tolerance."""

from __future__ import annotations

from functools import partial

from validate.cost.way import Way
from validate.cost.ways.point_coordinates import by_method
from validate.paper.printed import PRINTED

WAYS = (
    Way(
        "printed",
        "Newton's method with the paper's formulas as printed",
        partial(by_method, PRINTED),
        values=(1e-3, 1e-6, 1e-9, 1e-12),
    ),
)
