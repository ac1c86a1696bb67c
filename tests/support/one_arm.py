"""A wheel on one arm whose hinge stands on a carriage, on a car that rolls and pitches, in many digits.

The arm turns by t about the line from pivot to pivot_end and the carriage travels by s, so that a point of
the arm is at  P + R(t) (p - P) + s d;  then the car turns.
"""

from collections.abc import Mapping
from typing import Any

from many_digits import vector
from mechanism_closed_forms import turn
from mpmath import sqrt

RADIUS = 310.0
CAR: dict[str, Any] = {
    "axle": "front",
    "wheelbase": 2600.0,
    "centre_of_gravity_height": 520.0,
    "brake_share": 0.65,
    "drive_share": 0.4,
    "spring_rate": 27.5,
    "spring_free_length": 640.0,
}
# A left wheel.
DRAWN = {
    "guide": (-300.0, -420.0, 180.0),
    "guide_end": (-290.0, -500.0, 200.0),
    "pivot": (-240.0, -450.0, 220.0),
    "pivot_end": (-260.0, -650.0, 260.0),
    "inner": (-12.0, -640.0, 318.0),
    "centre": (2.0, -760.0, 310.0),
    "lower": (-15.0, -690.0, 190.0),
    "upper": (10.0, -655.0, 420.0),
    "damper_top": (-60.0, -580.0, 600.0),
    "damper_foot": (-80.0, -650.0, 240.0),
}
RIDING = ("inner", "centre", "lower", "upper", "damper_foot")
ROLES = {
    "knuckle": "arm",
    "wheel_axis": ["inner", "centre"],
    "steering_axis": ["lower", "upper"],
    "damper": ["damper_top", "damper_foot"],
}
# Roll about a point of the chassis, and pitch about another: axes forward and left.
TURNS = {"roll": ("forward", (-1, 0, 0), "damper_top"), "pitch": ("left", (0, -1, 0), "stop")}
BOTH = ("roll", "pitch")


def tables(
    points: Mapping[str, Any] = DRAWN, turns: tuple[str, ...] = BOTH, **changed: Any
) -> dict[str, Any]:
    """The mechanism as a scene has it."""
    return {
        "bodies": {
            "chassis": ["stop", "stop_end", "damper_top"],
            "carriage": ["guide", "guide_end", "pivot", "pivot_end"],
            "arm": ["pivot", "pivot_end", *RIDING],
        },
        "slides": {
            "guide": {
                "points": ["guide", "guide_end"],
                "body": "chassis",
                "through": "stop",
                "along": "stop_end",
                "turns": False,
            }
        },
        "inputs": {
            "turn": {"angle": "arm", "from": "drawing", "on": "carriage"},
            "steer": {"travel": ["guide"]},
            **{n: {"turns": "chassis", "along": TURNS[n][0], "about": TURNS[n][2]} for n in turns},
        },
        "roles": ROLES,
        "points": {**points, "stop": points["guide"], "stop_end": points["guide_end"]},
        "side": "left",
        "wheel_radius": RADIUS,
        "car": CAR,
        **changed,
    }


def plain(points: Mapping[str, Any] = DRAWN, turns: tuple[str, ...] = BOTH, **changed: Any) -> dict[str, Any]:
    """The mechanism as it is compiled."""
    return {"name": "one arm", "up": (0, 0, 1), "right": (0, 1, 0), **tables(points, turns, **changed)}


def place(name: str, values: Mapping[str, Any], turns: tuple[str, ...] = BOTH) -> Any:
    """Where a point is at values of the inputs, the car turned in this order."""
    p = vector(plain()["points"][name])
    pivot, end = vector(DRAWN["pivot"]), vector(DRAWN["pivot_end"])
    if name in RIDING:
        p = turn((pivot, end), values["turn"])(p)
    if name not in ("stop", "stop_end", "damper_top"):
        way = vector(DRAWN["guide_end"]) - vector(DRAWN["guide"])
        p = p + way * (values["steer"] / sqrt(way @ way))
    for name in turns:
        _, axis, about = TURNS[name]
        middle = vector(plain()["points"][about])
        p = turn((middle, middle + vector(axis)), values[name])(p)
    return p
