"""The paper's algorithm with its formulas as printed, some of which are wrong."""

from __future__ import annotations

from validate.cost.ways.point_coordinates import AtInstants
from validate.paper.printed import PRINTED

WAYS = (AtInstants("printed", "Newton's method with the paper's formulas as printed", PRINTED),)
