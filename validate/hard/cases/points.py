"""Cars in motion whose points have extreme proportions: nearly in line, nearly coincident, or far away.

Links between close points lose digits when coordinates are subtracted, and rounding turns directions through
them. A case takes an assembled car and changes only these points; the changes are in `points.toml`.

A strut's axis is fixed in the knuckle, so it may have any position relative to the three points that carry
the knuckle: through any of them, in their plane or at right angles to it, with its two points far away or
close together. None of these makes the mechanism singular. It is singular when the slide reaches its end: the
ball joint is as near to the strut's top as it lies beside the axis, and two positions of the top on the axis
meet.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from importlib.resources import files
from typing import Any

import numpy as np

from validate.arrays import Array
from validate.cars.car import unit
from validate.hard.case import RIGHT, Case, family, right_from
from validate.hard.subjects import NAMED, Content, Subject, drawn_angle, scene_content

Points = Mapping[str, Array]
BALL, OUTER, INNER = "lower_ball_joint", "tie_rod_outer", "tie_rod_inner"
LOWER, TOP, ROD_END = "strut_lower", "strut_top", "strut_rod_end"


def put(
    p: Points, value: float, *, points: Sequence[str], power: int = 1, times: float = 1.0, **at: str
) -> Points:
    """Points moved along their lines through another point, to `times value^power` of their distance."""
    start = p[at["from"]]
    return {n: start + times * value**power * (x - start) if n in points else x for n, x in p.items()}


def aside(p: Points, value: float, *, point: str, way: Sequence[float]) -> Points:
    """A point moved off its line by `value` times a direction, mm."""
    return {**p, point: p[point] + value * np.array(way)}


def thin_knuckle(p: Points, value: float, *, upper: str) -> Points:
    """The tie rod's outer end moved towards the line through the knuckle's other two points."""
    line = unit(p[upper] - p[BALL])
    foot = p[BALL] + ((p[OUTER] - p[BALL]) @ line) * line
    return {**p, OUTER: foot + value * (p[OUTER] - foot)}


def upper_arm_flat(p: Points, value: float) -> Points:
    """The upper ball joint moved towards the plane of its pivots and the lower ball joint."""
    front, upper = p["upper_arm_front"], p["upper_ball_joint"]
    normal = unit(np.cross(p["upper_arm_rear"] - front, p[BALL] - front))
    return {**p, "upper_ball_joint": upper - (1.0 - value) * float((upper - front) @ normal) * normal}


def tie_rod_short(p: Points, value: float) -> Points:
    """The tie rod's inner end, with the rack centre, moved towards the outer end."""
    inner = p[OUTER] + value * (p[INNER] - p[OUTER])
    return {**p, INNER: inner, "rack_centre": inner}


def axis(p: Points, value: float, *, weights: Mapping[str, float], off: float, way: str) -> Points:
    """The strut axis through a weighted mean of points, moved from it by `value` times `off` mm in a
    direction.

    Directions `way`: `foot` is from the ball joint to strut_lower; `inboard` is its component normal to the
        line
    from ball joint to top; `upright` is normal to the plane of ball joint, top and tie rod end.
    """
    mean: Array = np.add.reduce([share * p[name] for name, share in weights.items()])
    foot, along = p[LOWER] - p[BALL], unit(p[TOP] - p[BALL])
    ways = {
        "foot": foot,
        "inboard": unit(foot - (foot @ along) * along),
        "upright": unit(np.cross(p[TOP] - p[BALL], p[OUTER] - p[BALL])),
    }
    lower = mean + value * off * ways[way]
    return {**p, LOWER: lower, ROD_END: p[TOP] + 0.4 * (lower - p[TOP])}


def slide_run_out(p: Points, value: float) -> Points:
    """The strut axis at a right angle to the line from top to ball joint, except for `value`, rad."""
    down = unit(p[BALL] - p[TOP])
    along = unit(unit(np.cross(down, (1.0, 0.0, 0.0))) + value * down)
    return {**p, LOWER: p[TOP] + 300.0 * along, ROD_END: p[TOP] + 100.0 * along}


DRAWN = (put, aside, thin_knuckle, upper_arm_flat, tie_rod_short, axis, slide_run_out)
DRAWS: Mapping[str, Callable[..., Points]] = {draw.__name__: draw for draw in DRAWN}


def in_motion(row: Mapping[str, Any], subject: Subject, value: float) -> Content:
    """The scene of a row: its car in motion, starting at zero rack travel."""
    ((draw, given),) = row["draw"].items()
    there = subject.car.drawn_as(DRAWS[draw](subject.assembled.array, value, **given))
    size, angle = value if row.get("shrinks") else 1.0, subject.drawn["arm_angle"]
    if row["motion"] == "mixed":
        law = (angle, 0.1 * size, 0.05 * size)
        return scene_content(there, law, (0.0, 10.0 * size, 5.0 * size), stop=1.0)
    angle = angle if subject.name == "paper" else drawn_angle(there)
    arm, rack = 0.05 * size, 10.0 * size
    return scene_content(there, (angle, arm, arm), (0.0, rack, rack), stop=1.0)


CASES: list[Case] = []
TABLE = tomllib.loads(files("validate.hard.cases").joinpath("points.toml").read_text(encoding="utf-8"))
for row in (group | row for group in TABLE["group"] for row in group["row"]):
    family(
        *(CASES, row["group"], row["parameter"], row["values"]),
        right_from(row["right_from"]) if row["right_from"] else RIGHT,
        [NAMED[row["car"]]],
        **{key: row[key] for key in ("name", "why", "suffix") if key in row},
    )(partial(in_motion, row))
