"""The suspensions that the relative-coordinate model knows: a line for each."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from validate.relative.linkage import Linkage, Points
from validate.relative.suspensions.double_wishbone import double_wishbone
from validate.relative.suspensions.macpherson import macpherson
from validate.relative.suspensions.steered_arm import Axes

SUSPENSIONS: Mapping[str, Callable[[Points, Axes, str], Linkage]] = {
    "macpherson": macpherson,
    "double_wishbone": double_wishbone,
}
"""By type: hardpoints, axes and closure to a linkage."""
