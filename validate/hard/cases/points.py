"""Cars in motion whose points are drawn out of proportion: nearly in line, nearly coincident, or far away.

Links between near points lose digits when coordinates are subtracted, and directions through them turn by
rounding. A case takes an assembled car and changes nothing else; the ways to draw it are in `points.toml`.

A strut's axis is fixed in the knuckle, and so it may stand in any way to the three points that carry the
knuckle: through any of them, in their plane or at right angles to it, with its own two points far off or
close together. None of this makes the mechanism singular. What does is a slide that runs out: the ball joint
comes as near to the strut's top as it lies beside the axis, and two places of the top on the axis meet.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping, Sequence
from functools import cache, partial
from importlib.resources import files
from typing import Any

import numpy as np
from numpy.typing import NDArray

from validate.cars.car import unit
from validate.hard.cars import CARS, drawn_angle, drawn_at, scene_content
from validate.hard.case import RIGHT, Case, family, right_from
from validate.hard.subjects import NAMED, Content, Subject

Array = NDArray[np.float64]
Points = Mapping[str, Array]
BALL, OUTER, INNER = "lower_ball_joint", "tie_rod_outer", "tie_rod_inner"
LOWER, TOP, ROD_END = "strut_lower", "strut_top", "strut_rod_end"


@cache
def assembled(car: str = "paper") -> dict[str, Array]:
    """A car at its own inputs, each coordinate the nearest number to the true one, mm."""
    if CARS[car].closure == "drawn":
        return CARS[car].array
    return drawn_at(CARS[car], NAMED[car].drawn).array


def put(
    p: Points, value: float, *, points: Sequence[str], power: int = 1, times: float = 1.0, **at: str
) -> Points:
    """Points at a share of their distance from another, on their lines through it."""
    start = p[at["from"]]
    return {n: start + times * value**power * (x - start) if n in points else x for n, x in p.items()}


def aside(p: Points, value: float, *, point: str, way: Sequence[float]) -> Points:
    """A point that the drawing has beside its line, mm."""
    return {**p, point: p[point] + value * np.array(way)}


def thin_knuckle(p: Points, value: float, *, upper: str) -> Points:
    """The tie rod's outer end nearly on the line through the knuckle's other two points."""
    line = unit(p[upper] - p[BALL])
    foot = p[BALL] + ((p[OUTER] - p[BALL]) @ line) * line
    return {**p, OUTER: foot + value * (p[OUTER] - foot)}


def upper_arm_flat(p: Points, value: float) -> Points:
    """The upper ball joint near the plane of its pivots and the lower one."""
    front, upper = p["upper_arm_front"], p["upper_ball_joint"]
    normal = unit(np.cross(p["upper_arm_rear"] - front, p[BALL] - front))
    return {**p, "upper_ball_joint": upper - (1.0 - value) * float((upper - front) @ normal) * normal}


def tie_rod_short(p: Points, value: float) -> Points:
    """The tie rod's inner end, and the rack's middle there, near the outer one."""
    inner = p[OUTER] + value * (p[INNER] - p[OUTER])
    return {**p, INNER: inner, "rack_centre": inner}


def axis(p: Points, value: float, *, weights: Mapping[str, float], off: float, way: str) -> Points:
    """The axis through a weighed mean of points, and `off` mm along a way from it at the value 1.

    Ways are from the ball joint to strut_lower, of that what is off the line to the top, and off the plane.
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
    """The line from top to ball joint is at a right angle to the axis, but for this."""
    down = unit(p[BALL] - p[TOP])
    along = unit(unit(np.cross(down, (1.0, 0.0, 0.0))) + value * down)
    return {**p, LOWER: p[TOP] + 300.0 * along, ROD_END: p[TOP] + 100.0 * along}


DRAWN = (put, aside, thin_knuckle, upper_arm_flat, tie_rod_short, axis, slide_run_out)
DRAWS: Mapping[str, Callable[..., Points]] = {draw.__name__: draw for draw in DRAWN}


def in_motion(row: Mapping[str, Any], subject: Subject, value: float) -> Content:
    """The car of a row, driven from no rack travel."""
    ((draw, given),) = row["draw"].items()
    there = subject.car.drawn_as(DRAWS[draw](assembled(subject.name), value, **given))
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
