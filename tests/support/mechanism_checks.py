"""What the shipped mechanisms are held to: closed forms, and tables that other people's programs printed.

A check asks the reference for poses at some inputs, and says how far their points are from where they should
be. It knows nothing of the tables of a mechanism file, so it notices what is wrong in them.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path
from typing import Any

import lotus_front
import mpmath
import numpy as np
from exact_states import exact_states
from many_digits import DIGITS, Array, Points, number, unit, vector
from mechanism_closed_forms import closed_form
from mechanism_files import SCENES, Plain, Tables, mechanism_file, plain, scene_file
from mpmath import atan2, mp, mpf

from pointcoord import Scene
from validate.formulations.reference_solution import inputs_at

TABLES = Path(__file__).parents[1] / "mechanisms" / "tables"
MIRROR = vector([1, -1, 1])
# Of a pose in 45 digits, mm: what a few hundred operations on lengths of a metre may lose is below 1e-40.
EXACT = 1e-35

Inputs = Mapping[str, Any]


@dataclass(frozen=True)
class Check:
    """Poses and what they should be.

    Attributes:
        scene: the shipped scene whose drawing it is.
        path: inputs of the poses, in the order in which they are reached.
        deviations: by quantity, how far the points of the poses are off; mm and rad.
        limits: by quantity, how far they may be, because of what the other side rounds.
        wheel_radius: where an input needs one.
    """

    scene: str
    path: Sequence[Inputs]
    deviations: Callable[[Sequence[Points]], Mapping[str, float]]
    limits: Mapping[str, float]
    wheel_radius: float | None = None

    @property
    def type(self) -> str:
        """The mechanism."""
        return str(scene_file(self.scene)["mechanism"]["type"])

    def plain(self, change: Callable[[Tables, Tables], object] | None = None) -> Plain:
        """The mechanism; `change` may plant a fault in its tables or in the drawing."""
        part = {**scene_file(self.scene)["mechanism"], "wheel_radius": self.wheel_radius}
        tables = mechanism_file(part["type"])
        if change:
            change(tables, part)
        return plain(tables, part, self.path[0])

    def deviations_of(self, mechanism: Plain) -> Mapping[str, float]:
        """Of the poses that the reference says it has."""
        states = exact_states(mechanism, [{n: (v, 0, 0) for n, v in one.items()} for one in self.path])
        return self.deviations([position for position, *_ in states])


def scene_inputs(scene: str, count: int) -> list[Inputs]:
    """What a scene drives at some of its samples, the first and the last among them, in many digits."""
    asked = Scene.load(scene)
    places = np.linspace(0, len(asked.instants) - 1, count).round().astype(int)
    with mp.workdps(DIGITS):
        return [
            {name: number(law[0]) for name, law in inputs_at(asked, asked.instants[k]).items()}
            for k in places
        ]


def right_form(scene: str, path: Sequence[Inputs]) -> list[Points]:
    """The poses of a scene's mechanism by its closed form, as the ground sees them."""
    part = scene_file(scene)["mechanism"]
    type = f"{part['type']} collinear" if part.get("closure") == "collinear" else part["type"]
    if any("." in name for name in path[0]):
        found = _axle(part, path)
    else:
        found = closed_form(type, part["points"], path, part.get("wheel_radius"))
    with mp.workdps(DIGITS):
        return [
            {name: _on_the_ground(part, place, inputs) for name, place in points.items()}
            for points, inputs in zip(found, path, strict=True)
        ]


def _on_the_ground(part: Tables, place: Array, inputs: Inputs) -> Array:
    """A place in the chassis where the shipped cars' chassis is rolled about forward, -x, and then lifted."""
    if "roll" in inputs:
        axis = vector(part["points"]["roll_axis"])
        c, s = mpmath.cos(inputs["roll"]), mpmath.sin(inputs["roll"])
        x, y, z = place - axis
        place = axis + np.array([x, c * y + s * z, c * z - s * y])
    return place + vector([0, 0, inputs.get("heave", 0)])


def _axle(part: Tables, path: Sequence[Inputs]) -> list[Points]:
    """Each corner alone; the left one is the right one's mirror image, and so are rack and roll."""
    corners = {}
    for corner, way in (("left", -1), ("right", 1)):
        with mp.workdps(DIGITS):
            own = [{n.removeprefix(f"{corner}."): v for n, v in i.items()} for i in path]
            inputs = [
                {n: way * v if n in ("rack", "roll") else v for n, v in one.items() if "." not in n}
                for one in own
            ]
        corners[corner] = closed_form("double_wishbone", part["points"], inputs, part.get("wheel_radius"))
    with mp.workdps(DIGITS):
        return [
            {f"left.{name}": place * MIRROR for name, place in left.items()}
            | {f"right.{name}": place for name, place in right.items()}
            for left, right in zip(corners["left"], corners["right"], strict=True)
        ]


def farthest(found: Sequence[Points], right: Sequence[Points]) -> float:
    """The largest component of a difference of points, mm."""
    with mp.workdps(DIGITS):
        return max(
            float(np.max(np.abs(a[name] - b[name])))
            for a, b in zip(found, right, strict=True)
            for name in b
            if name in a
        )


@cache
def closed_form_check(scene: str) -> Check:
    """The points of a scene against its closed form."""
    path = scene_inputs(scene, 3)
    right, radius = right_form(scene, path), scene_file(scene)["mechanism"].get("wheel_radius")
    return Check(scene, path, lambda found: {"position": farthest(found, right)}, {"position": EXACT}, radius)


def _angles(points: Points) -> tuple[Any, Any]:
    """Camber and toe of a left wheel by the table's rules; its axes are ours after half a turn about z."""
    n = unit(points["wheel_centre"] - points["wheel_axis_inner"])
    return atan2(-n[2], -n[1]), atan2(-n[0], -n[1])


def table(name: str) -> Any:
    """A printed table, its numbers as they are written."""
    return json.loads((TABLES / f"{name}.json").read_text(encoding="utf-8"), parse_float=str, parse_int=str)


@cache
def vdsim_table(scene: str, name: str, camber: float, track: float) -> Check:
    """Angles and track over travel; how far camber and toe, rad, and the track, mm, may be off."""
    rows = [[mpf(number) for number in row] for row in table(name)["table"]]
    rows = [row for row in rows if row[0] <= 0][::-1] + [
        row for row in rows if row[0] > 0
    ]  # from the drawing

    def deviations(found: Sequence[Points]) -> Mapping[str, float]:
        static, off = scene_file(scene)["mechanism"]["points"]["wheel_centre"], []
        for points, (_, _, camber, toe, track) in zip(found, rows, strict=True):
            here = (*_angles(points), -(points["wheel_centre"][1] - static[1]))
            off.append([abs(float(a - b)) for a, b in zip(here, (camber, toe, track * 1000), strict=True)])
        return dict(zip(("camber", "toe", "track"), np.max(off, axis=0), strict=True))

    with mp.workdps(DIGITS):
        limits = {"camber": camber, "toe": camber, "track": track}
        return Check(scene, [{"wheel_travel": row[0] * 1000} for row in rows], deviations, limits)


@cache
def lotus_table() -> Check:
    """Bump by the height of the contact point; angles are printed to 1e-4 degrees."""
    rows = sorted(lotus_front.BUMP, key=lambda row: (row[0] > 0, abs(row[0])))

    def deviations(found: Sequence[Points]) -> Mapping[str, float]:
        off = []
        for points, (_, camber, toe, caster, kingpin) in zip(found, rows, strict=True):
            n = unit(points["wheel_centre"] - points["wheel_axis_inner"])
            k = unit(points["upper_ball_joint"] - points["lower_ball_joint"])
            here = (atan2(-n[2], n[1]), atan2(-n[0], n[1]), atan2(k[0], k[2]), atan2(-k[1], k[2]))
            printed = (camber, toe, caster, kingpin)
            off.append([abs(float(mpmath.degrees(a) - b)) for a, b in zip(here, printed, strict=True)])
        return dict(zip(("camber", "toe", "caster", "kingpin"), np.max(off, axis=0), strict=True))

    path = [{"contact_travel": row[0], "rack": 0} for row in rows]
    limits = dict.fromkeys(("camber", "toe", "caster", "kingpin"), 0.5e-4)
    return Check("double-wishbone", path, deviations, limits, wheel_radius=lotus_front.ROLLING_RADIUS)


def andrews_angles(p: Points) -> Array:
    """The benchmark's seven angles, each up to whole turns."""

    def angle(first: str, second: str) -> Any:
        apart = p[second] - p[first]
        return atan2(apart[1], apart[0])

    beta, quarter = angle("O", "F"), mp.pi / 2
    gamma, delta, epsilon = angle("B", "E") + quarter, angle("A", "G"), angle("A", "H") + quarter
    theta = angle("E", "F") - beta
    phi, omega = angle("G", "E") + quarter - delta, angle("H", "E") - epsilon
    return np.array([beta, theta, gamma, phi, delta, omega, epsilon], dtype=object)


@cache
def andrews_table() -> Check:
    """The drawing is rounded to doubles, and the end is printed to 16 digits of 15.8 rad."""
    data = table("andrews_squeezer")
    with mp.workdps(DIGITS):
        printed = [vector(data["q0"]), vector(data["q_t003"])]
        path = [{"crank": 0}, {"crank": mpf(data["q_t003"][0]) - mpf(data["q0"][0])}]

    def deviations(found: Sequence[Points]) -> Mapping[str, float]:
        with mp.workdps(DIGITS):
            off = [andrews_angles(points) - q for points, q in zip(found, printed, strict=True)]
            apart = [abs(float(a - 2 * mp.pi * mpmath.nint(a / (2 * mp.pi)))) for each in off for a in each]
        half = len(apart) // 2
        return {"angles at the start": max(apart[:half]), "angles at the end": max(apart[half:])}

    limits = {"angles at the start": 1e-15, "angles at the end": 1e-14}
    return Check("andrews-squeezer", path, deviations, limits)


@cache
def bricard_table() -> Check:
    """Own table, from the product of the six turns, 30 digits; turns of both ways from the drawing."""
    rows = table("bricard")["table"]
    with mp.workdps(DIGITS):
        path = [{"turn": mpmath.radians(mpf(row[0]))} for row in rows]
        places = [vector(row[2]) * 1000 for row in rows]

    def deviations(found: Sequence[Points]) -> Mapping[str, float]:
        with mp.workdps(DIGITS):
            return {
                "position": max(
                    float(np.max(np.abs(p["P3"] - q))) for p, q in zip(found, places, strict=True)
                )
            }

    return Check("bricard", path, deviations, {"position": 1e-26})


PRINTED: Mapping[str, Callable[[], Check]] = {
    # Its solver ends with residuals below 1e-12 m; 4.1e-15 rad were seen by whoever else tried.
    "five_link": partial(vdsim_table, "five-link", "vdsim_five_link_rear", 1e-14, 1e-12),
    # Its solver stopped early: the rotation itself is 2.95e-8 rad and 2.2e-6 mm away from it.
    "semi_trailing_arm": partial(vdsim_table, "semi-trailing-arm", "vdsim_trailing_arm_rear", 5e-8, 5e-6),
    "double_wishbone": lotus_table,
    "andrews_squeezer": andrews_table,
    "bricard": bricard_table,
}
CLOSED = tuple(scene for scene in SCENES if scene_file(scene)["mechanism"]["type"] != "five_link")
