"""Points that a file does not have and that follow from what it has. What does not follow is asked for."""

from __future__ import annotations

from collections.abc import Mapping
from decimal import Decimal

from pointcoord.mechanism.structure import Structure
from validate.hardpoint_files.contents import Place, SpinAxis

# mm from the wheel centre to the inner point of an axis that is known by its direction only.
INWARD = 100.0
# A coordinate of that point is rounded to 1e-12 mm, which is 1e-14 rad of the axis's direction.
DIGITS = Decimal("1e-12")


def derived(
    name: str, structure: Structure, places: Mapping[str, Place], out: int, axis: SpinAxis | None
) -> tuple[Place, str] | None:
    """Where a point is that a file does not have, with how that follows; None if it does not.

    Args:
        places: of the points that there are, x rearward, y right, z up, mm.
        out: 1 if outboard is to the right, -1 if it is to the left.
        axis: where the wheel's spin axis points, if that is known.
    """
    role = structure.roles.get("wheel_axis")
    inner, centre = role if isinstance(role, tuple) else ("", "")
    if name == inner and axis is not None and centre in places:
        how = f"from {centre}: {INWARD:g} mm inboard on the spin axis, from {axis.words}"
        return _inboard(places[centre], out, axis), how
    for slide in structure.slides.values():
        # One of two points of a body that slide on a line through the other may be anywhere on that line.
        ends = slide.along, slide.through
        if name in slide.points and slide.along in slide.points and all(end in places for end in ends):
            x, y, z = ((a + b) / 2 for a, b in zip(*(places[end] for end in ends), strict=True))
            how = f"from {' and '.join(ends)}: halfway, for the file does not say where on this axis"
            return (x, y, z), f"{how}: nothing else hangs on it"
    return None


def _inboard(centre: Place, out: int, axis: SpinAxis) -> Place:
    """The point on the spin axis; only its direction counts, its place on the axis changes no angle."""
    forward, outboard, up = axis.direction
    length = sum(part * part for part in axis.direction) ** 0.5
    steps = (forward, -out * outboard, -up)
    x, y, z = (
        at + Decimal(INWARD / length * step).quantize(DIGITS) for at, step in zip(centre, steps, strict=True)
    )
    return x, y, z
