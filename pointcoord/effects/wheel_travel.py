"""How the wheel moves from where it is drawn: its travel, and what it does to track and wheelbase.

Travel is counted in the chassis' frame, of the wheel centre and of the contact point by their own names: at
equal travel they leave some thousandths of a degree between the angles (Lotus drives the contact point).
"""

from __future__ import annotations

from pointcoord.effects.arithmetic import S
from pointcoord.effects.car_number import CarNumbers, Number
from pointcoord.effects.corner import Corner


def travel(corner: Corner[S]) -> S:
    """(W - drawn W) . up of the wheel centre W."""
    return corner.risen()


def contact_travel(corner: Corner[S]) -> S:
    """The same of the contact point of a disc that hangs along the chassis' up."""
    return corner.chassis.along(corner.moved_in_chassis(), "up")


def half_track_change(corner: Corner[S]) -> S:
    """(c - drawn c) . outboard of the contact point c."""
    return corner.seen.along(corner.moved(), "outboard")


def recession(corner: Corner[S]) -> S:
    """(c - drawn c) . rearward."""
    return corner.seen.along(corner.moved(), "rearward")


TRAVEL = Number(
    "travel", "travel of the wheel centre", "up", "(W - drawn W) . up", travel, needs_radius=False
)
WHEEL_TRAVEL = CarNumbers.of(
    "wheel_travel",
    "travel, half-track change and recession of the wheel, mm",
    TRAVEL,
    Number(
        "contact_travel",
        "travel of the contact point",
        "up",
        "(c - drawn c) . up, which Lotus calls bump",
        contact_travel,
        source="Lotus",
    ),
    Number(
        "half_track_change",
        "half-track change",
        "where the contact point goes out",
        "(c - drawn c) . outboard",
        half_track_change,
        source="Lotus",
    ),
    Number(
        "recession",
        "recession",
        "where the contact point goes rearward, which at a rear axle makes the wheelbase longer",
        "(c - drawn c) . rearward: the change of the wheelbase at a rear axle, minus it at a front one",
        recession,
        source="Lotus",
    ),
)
