"""A wheel on one arm whose hinge stands on a carriage, and its numbers written out in 40 digits.

The arm turns by t about the line from pivot to pivot_end and the carriage travels by s, so that a point of
the arm is at  P + R(t) (p - P) + s d;  then the car turns. Axes x rearward, y right, z up. Numbers are made
of coordinates another way than in the model: points on lines by their height, the tyre's forward by the angle
of its axle, the wheel's lowest point by two directions in its plane, instant centres as points of the hinge's
line. Derivatives are mpmath's.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from mpmath import atan2, cos, diff, mp, mpf, nan, sin, sqrt
from numpy.typing import NDArray

import absolute

Array = NDArray[np.float64]
Vector = Any

DIGITS = 40
RADIUS = 310.0
CAR = {
    "axle": "front",
    "wheelbase": 2600.0,
    "centre_of_gravity_height": 520.0,
    "brake_share": 0.65,
    "drive_share": 0.4,
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
    "front_view_swing_arm",
    "front_view_centre_height",
    "side_view_swing_arm",
    "side_view_centre_height",
    "anti_brake",
    "anti_drive",
)
# Roll about a point of the chassis, and pitch about another: axes forward and left.
TURNS = {"roll": ("forward", (-1, 0, 0), "damper_top"), "pitch": ("left", (0, -1, 0), "stop")}


def plain(points: Mapping[str, Any] = DRAWN, **changed: Any) -> dict[str, Any]:
    """The mechanism as it is compiled."""
    turns = {
        n: {"turns": "chassis", "along": along, "about": about} for n, (along, _, about) in TURNS.items()
    }
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
            **turns,
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
    names: Any, values: Mapping[str, Any] | None = None, points: Mapping[str, Any] = DRAWN, **changed: Any
) -> dict[str, float]:
    """Effects at one instant, at values of the inputs that are not 0."""
    described = plain(points, **changed)
    given = {name: (values or {}).get(name, 0.0) for name in described["inputs"]}
    inputs = {name: np.array([[value, 0.0, 0.0]]) for name, value in given.items()}
    motion = absolute.solve(absolute.compile(described), inputs, rates=False, effects=names)
    return {name: float(number[0]) for name, number in motion.effects.items()}


def vector(values: Any) -> Vector:
    return mp.matrix([mpf(float(value)) for value in values])


def dot(a: Vector, b: Vector) -> Any:
    return sum(x * y for x, y in zip(a, b, strict=True))


def cross(a: Vector, b: Vector) -> Vector:
    return mp.matrix([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def turned(axis: Vector, angle: Any, v: Vector) -> Vector:
    k = axis / sqrt(dot(axis, axis))
    return v * cos(angle) + cross(k, v) * sin(angle) + k * dot(k, v) * (1 - cos(angle))


class Written:
    """The arm at values of its inputs; `out` is y outboard, -1 of a left wheel."""

    def __init__(self, points: Mapping[str, Any] = DRAWN, out: int = -1, **values: float) -> None:
        self.points, self.out, self.values = points, out, values

    def place(self, name: str, t: Any, s: Any, turns: bool = True) -> Vector:
        p = vector(self.points[name])
        pivot, end = vector(self.points["pivot"]), vector(self.points["pivot_end"])
        if name in RIDING:
            p = pivot + turned(end - pivot, t, p - pivot)
        if name in RIDING or name in ("pivot", "pivot_end"):
            way = vector(self.points["guide_end"]) - vector(self.points["guide"])
            p = p + way * (s / sqrt(dot(way, way)))
        for turn, (_, axis, name) in TURNS.items() if turns else ():
            about = vector(self.points["guide" if name == "stop" else name])
            p = about + turned(vector(axis), mpf(self.values.get(turn, 0.0)), p - about)
        return p

    def lowest(self, inner: Vector, centre: Vector) -> Vector:
        a = centre - inner
        across = mp.matrix([a[1], -a[0], 0])
        level = across / sqrt(dot(across, across))
        steep = cross(a, level)
        steep = steep / sqrt(dot(steep, steep))
        return centre - steep * (mpf(RADIUS) * (1 if steep[2] > 0 else -1))

    def contact(self, t: Any, s: Any, turns: bool = True) -> Vector:
        return self.lowest(*(self.place(name, t, s, turns) for name in ("inner", "centre")))

    def number(self, name: str, t: Any, s: Any) -> Any:
        out = self.out
        inner, centre, lower, upper, top, foot = (
            self.place(point, t, s)
            for point in ("inner", "centre", "lower", "upper", "damper_top", "damper_foot")
        )
        c, drawn = (
            self.contact(t, s),
            self.lowest(vector(self.points["inner"]), vector(self.points["centre"])),
        )

        def at_height(z: Any) -> Vector:
            share = (z - lower[2]) / (upper[2] - lower[2])
            return mp.matrix([(1 - share) * a + share * b for a, b in zip(lower, upper, strict=True)])

        g, w = at_height(c[2]), at_height(centre[2])
        spin, steer = centre - inner, upper - lower
        # From outboard toward rearward.
        heading = atan2(spin[0], out * spin[1])
        return {
            "camber": lambda: atan2(-spin[2], out * spin[1]),
            "toe": lambda: -heading,
            "kingpin": lambda: atan2(-out * steer[1], steer[2]),
            "caster": lambda: atan2(steer[0], steer[2]),
            "travel": lambda: self.place("centre", t, s, False)[2] - mpf(float(self.points["centre"][2])),
            "contact_travel": lambda: self.contact(t, s, False)[2] - drawn[2],
            "half_track_change": lambda: out * (c[1] - drawn[1]),
            "recession": lambda: c[0] - drawn[0],
            "kingpin_offset": lambda: out * (c[1] - g[1]),
            "scrub_radius": lambda: sqrt((c[0] - g[0]) ** 2 + (c[1] - g[1]) ** 2),
            "mechanical_trail": lambda: (g[0] - c[0]) * -cos(heading) + out * (g[1] - c[1]) * sin(heading),
            "castor_offset": lambda: c[0] - g[0],
            "kingpin_offset_at_wheel": lambda: out * (centre[1] - w[1]),
            "hub_trail": lambda: w[0] - centre[0],
            "damper_length": lambda: sqrt(dot(foot - top, foot - top)),
        }[name]()

    def effect(self, effect: str) -> float:
        """Any effect of the model, by its name."""
        with mp.workdps(DIGITS):
            t, s = mpf(self.values.get("turn", 0.0)), mpf(self.values.get("steer", 0.0))
            if effect in BY_TRAVEL:
                return float(self.by_travel(effect, t, s))
            name, _, by = effect.partition("_by_")
            if by == "rack":
                return float(diff(lambda s: self.number(name, t, s), s))
            value = self.number(name, t, s) if not by else diff(lambda t: self.number(name, t, s), t)
            rate = diff(lambda t: self.number("travel", t, s), t) if by else 1
            return float(value / rate if rate else nan)

    def by_travel(self, effect: str, t: Any, s: Any) -> Any:
        if effect == "roll_centre_height":
            return self.roll_centre(t, s)
        c, w = self.contact(t, s), self.place("centre", t, s)
        front, side, side_at_centre = (self.hinge_in_plane(*at, t, s) for at in ((c, 0), (c, 1), (w, 1)))

        def anti(share: str, steepness: Any) -> Any:
            height = CAR["centre_of_gravity_height"] - self.number("contact_travel", t, s)
            return -100 * mpf(CAR[share]) * steepness * CAR["wheelbase"] / height

        return {
            "front_view_swing_arm": lambda: -self.out * front[1],
            "front_view_centre_height": lambda: front[2],
            "side_view_swing_arm": lambda: side[0],
            "side_view_centre_height": lambda: side[2],
            # A point goes at a right angle to the line to its centre.
            "anti_brake": lambda: anti("brake_share", -side[2] / side[0]),
            "anti_drive": lambda: anti("drive_share", -side_at_centre[2] / side_at_centre[0]),
        }[effect]()

    def hinge_in_plane(self, p: Vector, normal: int, t: Any, s: Any) -> Vector:
        """From p to where the hinge's line meets the plane through p across x (0) or y (1)."""
        pivot, end = self.place("pivot", t, s), self.place("pivot_end", t, s)
        share = (p[normal] - pivot[normal]) / (end[normal] - pivot[normal])
        return pivot + (end - pivot) * share - p

    def roll_centre(self, t: Any, s: Any) -> Any:
        c, pivot = self.contact(t, s), self.place("pivot", t, s)
        v = cross(self.place("pivot_end", t, s) - pivot, c - pivot)
        # From c along the normal of v in the front view until y = 0.
        return c[1] * v[1] / v[2]
