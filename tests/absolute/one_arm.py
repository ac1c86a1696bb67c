"""A wheel on one arm whose hinge stands on a carriage, on a car that rolls and pitches, in 40 digits.

The arm turns by t about the line from pivot to pivot_end and the carriage travels by s, so that a point of
the arm is at  P + R(t) (p - P) + s d;  then the car turns. Derivatives are mpmath's.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from mpmath import cos, diff, mp, mpf, nan, sin, sqrt
from written import Vector, cross, dot, lowest, numbers, vector

import absolute

DIGITS = 40
RADIUS = 310.0
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
    "wheel_axis": ["inner", "centre"],
    "steering_axis": ["lower", "upper"],
    "damper": ["damper_top", "damper_foot"],
}
# Roll about a point of the chassis, and pitch about another: axes forward and left.
TURNS = {"roll": ("forward", (-1, 0, 0), "damper_top"), "pitch": ("left", (0, -1, 0), "stop")}


def plain(
    points: Mapping[str, Any] = DRAWN, turns: tuple[str, ...] = ("roll", "pitch"), **changed: Any
) -> dict[str, Any]:
    """The mechanism as it is compiled."""
    return {
        "name": "one arm",
        "bodies": {
            "chassis": ["stop", "damper_top"],
            "carriage": ["guide", "guide_end", "pivot", "pivot_end"],
            "arm": ["pivot", "pivot_end", *RIDING],
        },
        "slides": {
            "guide": {
                "points": ["guide", "guide_end"],
                "body": "chassis",
                "through": "stop",
                "along": "guide_end",
                "turns": False,
            }
        },
        "inputs": {
            "turn": {"angle": "arm", "from": "drawing", "on": "carriage"},
            "steer": {"travel": ["guide"]},
            **{n: {"turns": "chassis", "along": TURNS[n][0], "about": TURNS[n][2]} for n in turns},
        },
        "roles": ROLES,
        "points": {**points, "stop": points["guide"]},
        "up": (0, 0, 1),
        "right": (0, 1, 0),
        "side": "left",
        "wheel_radius": RADIUS,
        **changed,
    }


def solved(
    names: Any, values: Mapping[str, Any] | None = None, points: Mapping[str, Any] = DRAWN, **changed: Any
) -> dict[str, float]:
    """Effects at one instant, at values of the inputs that are not 0."""
    described = plain(points, **changed)
    inputs = {name: np.array([[(values or {}).get(name, 0.0), 0.0, 0.0]]) for name in described["inputs"]}
    motion = absolute.solve(absolute.compile(described), inputs, rates=False, effects=names)
    return {name: float(number[0]) for name, number in motion.effects.items()}


def turned(axis: Vector, angle: Any, v: Vector) -> Vector:
    k = axis / sqrt(dot(axis, axis))
    return v * cos(angle) + cross(k, v) * sin(angle) + k * dot(k, v) * (1 - cos(angle))


def place(name: str, values: Mapping[str, Any], turns: tuple[str, ...] = ("roll", "pitch")) -> Vector:
    """Where a point is at values of the inputs, the car turned in this order."""
    p = vector(DRAWN["guide" if name == "stop" else name])
    pivot, end = vector(DRAWN["pivot"]), vector(DRAWN["pivot_end"])
    if name in RIDING:
        p = pivot + turned(end - pivot, values["turn"], p - pivot)
    if name not in ("stop", "damper_top"):
        way = vector(DRAWN["guide_end"]) - vector(DRAWN["guide"])
        p = p + way * (values["steer"] / sqrt(dot(way, way)))
    for turn in turns:
        _, axis, about = TURNS[turn]
        middle = vector(DRAWN["guide" if about == "stop" else about])
        p = middle + turned(vector(axis), values[turn], p - middle)
    return p


def written(effect: str, given: Mapping[str, float]) -> float:
    """An effect at values of the inputs that are not 0."""
    with mp.workdps(DIGITS):
        values = {name: mpf(given.get(name, 0.0)) for name in ("turn", "steer", *TURNS)}
        name, _, by = effect.partition("_by_")

        def number(name: str, **moved: Any) -> Any:
            there = values | moved
            places = (
                lambda p: place(p, there),
                lambda p: place(p, there, ()),
                lambda p: vector(DRAWN[p]),
            )
            return numbers(*places, ROLES, RADIUS, -1)[name]

        if effect == "roll_centre_height":
            pivot, end, inner, centre = (place(p, values) for p in ("pivot", "pivot_end", "inner", "centre"))
            c = lowest(inner, centre, RADIUS)
            v = cross(end - pivot, c - pivot)
            # From c along the normal of v in the front view until y = 0.
            return float(c[1] * v[1] / v[2])
        if by == "rack":
            return float(diff(lambda s: number(name, steer=s), values["steer"]))
        if not by:
            return float(number(name))
        slope, rise = (diff(lambda t, n=n: number(n, turn=t), values["turn"]) for n in (name, "travel"))
        return float(slope / rise if rise else nan)
