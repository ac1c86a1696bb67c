"""Points that a file does not have and that follow from what it has. What does not follow is asked for."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from decimal import Decimal

from validate.hardpoint_files.contents import Place, SpinAxis

# mm from the wheel centre to the inner point of an axis that is known by its direction only.
INWARD = 100.0
# A coordinate of that point is rounded to 1e-12 mm, which is 1e-14 rad of the axis's direction.
DIGITS = Decimal("1e-12")


def on_the_spin_axis(places: Sequence[Place], out: int, axis: SpinAxis | None) -> tuple[Place, str] | None:
    """The point 100 mm inboard of the wheel centre on the spin axis; None if its direction is not known.

    Only the direction of an axis counts: the place of its inner point on it changes no angle.

    Args:
        places: the wheel centre, x rearward, y right, z up, mm.
        out: 1 if outboard is to the right, -1 if it is to the left.
    """
    if axis is None:
        return None
    forward, outboard, up = axis.direction
    length = sum(part * part for part in axis.direction) ** 0.5
    steps = (forward, -out * outboard, -up)
    x, y, z = (
        at + Decimal(INWARD / length * step).quantize(DIGITS)
        for at, step in zip(places[0], steps, strict=True)
    )
    return (x, y, z), f"{INWARD:g} mm inboard on the spin axis, from {axis.words}"


def halfway(places: Sequence[Place], out: int, axis: SpinAxis | None) -> tuple[Place, str] | None:
    """The middle of two points, for a point of their line that may lie anywhere on it."""
    x, y, z = ((one + other) / 2 for one, other in zip(*places, strict=True))
    return (x, y, z), "halfway, for the file does not say where on this axis: nothing else hangs on it"


RULES: Mapping[str, Callable[[Sequence[Place], int, SpinAxis | None], tuple[Place, str] | None]] = {
    "spin axis": on_the_spin_axis,
    "halfway": halfway,
}
"""Every rule by the name that formats give it."""
