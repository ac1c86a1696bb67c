"""A wheel on one arm whose hinge stands on a carriage, on a car that rolls and pitches, in 40 digits.

The arm turns by t about the line from pivot to pivot_end and the carriage travels by s, so that a point of
the arm is at  P + R(t) (p - P) + s d;  then the car turns. Derivatives are mpmath's, and
instant centres are points of the hinge's line.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from mpmath import cos, diff, mp, mpf, nan, sin, sqrt
from written import Vector, cross, dot, lowest, numbers, vector

import absolute

DIGITS = 40
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
    "wheel_axis": ["inner", "centre"],
    "steering_axis": ["lower", "upper"],
    "damper": ["damper_top", "damper_foot"],
}
BY_TRAVEL = (
    "roll_centre_height",
    *(f"{view}_view_{number}" for view in ("front", "side") for number in ("swing_arm", "centre_height")),
    "anti_brake",
    "anti_drive",
    "arm_roll_centre_height",
)
OF_DAMPER = ("damper_per_wheel", "wheel_per_damper", "spring_force", "wheel_force", "wheel_rate")
# Of the inputs, rad/s and mm/s: of numbers by time.
RATES = {"turn": 0.7, "steer": 40.0, "roll": -0.3, "pitch": 0.2}
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
        "car": CAR,
        **changed,
    }


def solved(
    names: Any,
    values: Mapping[str, Any] | None = None,
    points: Mapping[str, Any] = DRAWN,
    rates: Mapping[str, float] = RATES,
    **changed: Any,
) -> dict[str, float]:
    """Effects at one instant, at values of the inputs that are not 0."""
    described = plain(points, **changed)
    inputs = {n: np.array([[(values or {}).get(n, 0.0), rates[n], 0.0]]) for n in described["inputs"]}
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
        name, by = effect, ""
        if effect.endswith(("_by_travel", "_by_rack", "_by_time")):
            name, _, by = effect.rpartition("_by_")

        def number(name: str, **moved: Any) -> Any:
            there = values | moved
            places = (
                lambda p: place(p, there),
                lambda p: place(p, there, ()),
                lambda p: vector(DRAWN[p]),
            )
            return numbers(*places, ROLES, RADIUS, -1)[name]

        if not by and name in BY_TRAVEL:
            return float(_by_travel(values, number("contact_travel"))[name])
        if effect in OF_DAMPER:
            length, rise = (
                diff(lambda t, n=n: number(n, turn=t), values["turn"]) for n in ("damper_length", "travel")
            )
            ratio, rate = -length / rise, mpf(CAR["spring_rate"])
            force = rate * (CAR["spring_free_length"] - number("damper_length"))
            of_damper = (ratio, 1 / ratio, force, force * ratio, rate * ratio**2)
            return float(dict(zip(OF_DAMPER, of_damper, strict=True))[effect])
        if by == "time":
            return float(diff(lambda t: number(name, **{n: values[n] + t * RATES[n] for n in RATES}), 0))
        if by == "rack":
            return float(diff(lambda s: number(name, steer=s), values["steer"]))
        if not by:
            return float(number(name))
        slope, rise = (diff(lambda t, n=n: number(n, turn=t), values["turn"]) for n in (name, "travel"))
        return float(slope / rise if rise else nan)


def _by_travel(values: Mapping[str, Any], rise: Any) -> dict[str, Any]:
    """What is made of how the arm turns about its hinge; `rise` is the travel of the contact point."""
    pivot, end, inner, centre = (place(p, values) for p in ("pivot", "pivot_end", "inner", "centre"))
    c = lowest(inner, centre, RADIUS)
    v = cross(end - pivot, c - pivot)

    def hinge_in_plane(p: Vector, normal: int) -> Vector:
        """From p to where the hinge's line meets the plane through p across x (0) or y (1)."""
        share = (p[normal] - pivot[normal]) / (end[normal] - pivot[normal])
        return pivot + (end - pivot) * share - p

    front, side, side_at_centre = (hinge_in_plane(*at) for at in ((c, 0), (c, 1), (centre, 1)))

    def about_no_axle() -> Vector:
        """How c goes where the arm turns about its steering axis too, so that it goes along no line."""
        lower, upper = (place(p, values) for p in ROLES["steering_axis"])
        hinge, axis = end - pivot, upper - lower
        up = cross(hinge, lower - pivot)
        w = hinge - axis * (dot(hinge, up) / dot(axis, up))
        return up + cross(w, c - lower)

    arms = about_no_axle()

    def anti(share: str, steepness: Any) -> Any:
        height = CAR["centre_of_gravity_height"] - rise
        return -100 * mpf(CAR[share]) * steepness * CAR["wheelbase"] / height

    return {
        # From c along the normal of v in the front view until y = 0.
        "roll_centre_height": c[1] * v[1] / v[2],
        "arm_roll_centre_height": c[1] * arms[1] / arms[2],
        "front_view_swing_arm": front[1],
        "front_view_centre_height": front[2],
        "side_view_swing_arm": side[0],
        "side_view_centre_height": side[2],
        # A point goes at a right angle to the line to its centre.
        "anti_brake": anti("brake_share", -side[2] / side[0]),
        "anti_drive": anti("drive_share", -side_at_centre[2] / side_at_centre[0]),
    }
