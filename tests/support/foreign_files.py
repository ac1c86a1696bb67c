"""Our built-in cars written as other programs write theirs: small files of our own making, of their forms."""

from __future__ import annotations

import json
from collections.abc import Mapping
from decimal import Decimal
from pathlib import Path
from typing import Any

from pointcoord import Scene
from validate.hardpoint_files.importing import Imported, import_hardpoints

Points = Mapping[str, tuple[float, float, float]]

WISHBONE = Scene.load("double-wishbone")
STRUT = Scene.load("off-axis-strut")
CAR: Points = {n: place for n, place in WISHBONE.mechanism.points.items() if n != "rack_centre"}

LOTUS = {
    "lower_arm_front": "Lower wishbone front pivot",
    "lower_arm_rear": "Lower wishbone rear pivot",
    "lower_ball_joint": "Lower wishbone outer ball joint",
    "upper_arm_front": "Upper wishbone front pivot",
    "upper_arm_rear": "Upper wishbone rear pivot",
    "upper_ball_joint": "Upper wishbone outer ball joint",
    "tie_rod_outer": "Outer track rod ball joint",
    "tie_rod_inner": "Inner track rod ball joint",
    "wheel_axis_inner": "Wheel spindle point",
    "wheel_centre": "Wheel centre point",
}
OPTIMUMK = {
    "lower_arm_front": "CHAS_LowFor",
    "lower_arm_rear": "CHAS_LowAft",
    "lower_ball_joint": "UPRI_LowPnt",
    "upper_arm_front": "CHAS_UppFor",
    "upper_arm_rear": "CHAS_UppAft",
    "upper_ball_joint": "UPRI_UppPnt",
    "tie_rod_outer": "UPRI_TiePnt",
    "tie_rod_inner": "CHAS_TiePnt",
    "wheel_centre": "Wheel Center",
    "wheel_axis_inner": "Wheel Spindle Point",
}
ARMS = {
    "double_wishbone": {"lower": "Lower Control Arm", "upper": "Upper Control Arm"},
    "macpherson": {"lower": "Control Arm"},
}
# What Lotus prints of the built-in car, deg.
STATIC = {
    "CAMBER ANGLE": 0.0,
    "TOE ANGLE (SAE) (+ve TOE IN)": 0.0,
    "CASTOR ANGLE": 4.94,
    "KINGPIN ANGLE": 7.0,
}


# Of MuJoCo: crank, coupler and rocker in the plane of x and z.
FOUR_BAR = """
<mujoco>
  <default>
    <joint axis="0 0 1"/>
    <default class="pin"><joint axis="0 1 0"/></default>
  </default>
  <worldbody>
    <body name="crank" childclass="pin" euler="0 -60 0">
      <joint name="crank"/>
      <geom size="0.1"/>
      <body name="coupler" pos="0.1 0 0" euler="0 40 0">
        <joint name="knee"/>
        <geom size="0.1"/>
        <site name="end" pos="0.3 0 0"/>
      </body>
    </body>
    <body name="rocker" pos="0.35 0 0"><joint class="pin"/><geom size="0.1"/></body>
  </worldbody>
  <equality><connect body1="coupler" body2="rocker" anchor="0.3 0 0"/></equality>
  <actuator><position name="motor" joint="crank"/></actuator>
</mujoco>
"""

# The same with a body more, on the rocker's end: the coupler and it are one.
WELDED = FOUR_BAR.replace(
    '<joint class="pin"/><geom size="0.1"/>',
    '<joint class="pin"/><geom size="0.1"/><body name="tip" '
    'pos="-0.018092213764227 0 0.189208583376144"><joint class="pin"/><geom size="0.1"/></body>',
).replace('<connect body1="coupler" body2="rocker" anchor="0.3 0 0"/>', '<weld body1="coupler" body2="tip"/>')


def imported(folder: Path, text: str, name: str = "car.txt", **choices: Any) -> Imported:
    """What becomes of a file of such a text."""
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return import_hardpoints(path, **choices)


def drawn(found: Imported) -> dict[str, tuple[float, ...]]:
    """The points of an imported scene."""
    return {point.name: tuple(float(number) for number in point.place) for point in found.drawing.points}


def lotus_report(points: Points = WISHBONE.mechanism.points, static: Mapping[str, float] = STATIC) -> str:
    """A report of the right wheel, x rearward, y right, z up; mm."""
    rows = [
        f"{x:11.2f}{y:10.2f}{z:10.2f}    POINT ({number:4d} ) = {LOTUS[name]}"
        for number, (name, (x, y, z)) in enumerate(((n, points[n]) for n in LOTUS), 1)
    ]
    return "\n".join(
        [
            "*" * 80,
            "      LOTUS SUSPENSION ANALYSIS v4.03",
            "",
            "     FRONT SUSPENSION       FILENAME: own.dat",
            "     TYPE 1 Double Wishbone, damper to lower wishbone",
            "",
            "         X         Y         Z",
            "      (mm)      (mm)      (mm)",
            *rows,
            "     745.00      0.00    270.00    POINT (  20 ) = Part 1 C of G",
            "       1.00      2.00      3.00    POINT (  31 ) = Bracket of our own",
            "",
            "                             STATIC VALUES",
            *(f"{name:>33}  (deg):{value:9.2f}" for name, value in static.items()),
            "",
        ]
    )


def table(points: Points = WISHBONE.mechanism.points) -> str:
    """A table of points with OptimumK's names; x forward, y left, z up; mm."""
    rows = (f"{OPTIMUMK[name]},{-x},{-y},{z}" for name, (x, y, z) in points.items() if name in OPTIMUMK)
    return "\n".join(["Point,X,Y,Z", *rows, "NSMA_PPAttPnt,1,2,3", ""])


def chrono(kind: str, points: Points, out: int, camber: str = "", toe: str = "") -> str:
    """A suspension of Chrono, of its left wheel; m.

    Args:
        out: 1 if our points are of a right wheel, -1 if they are of a left one.
    """

    def place(name: str) -> list[Decimal]:
        x, y, z = (Decimal(repr(number)) / 1000 for number in points[name])
        return [-x, y * out, z]

    parts: dict[str, object] = {"Name": "our own", "Type": "Suspension"}
    parts["Template"] = "DoubleWishbone" if kind == "double_wishbone" else "MacPhersonStrut"
    for key, angle in (("Camber Angle (deg)", camber), ("Toe Angle (deg)", toe)):
        if angle:
            parts[key] = Decimal(angle)
    parts["Spindle"] = {"Mass": 10, "COM": place("wheel_centre")}
    for arm, called in ARMS[kind].items():
        parts[called] = {
            "COM": place(f"{arm}_ball_joint"),
            "Location Chassis Front": place(f"{arm}_arm_front"),
            "Location Chassis Back": place(f"{arm}_arm_rear"),
            "Location Upright": place(f"{arm}_ball_joint"),
        }
    parts["Tierod"] = {"Location Chassis": place("tie_rod_inner"), "Location Upright": place("tie_rod_outer")}
    if kind == "macpherson":
        parts["Spring"] = {"Location Chassis": place("strut_top"), "Location Upright": place("strut_lower")}
    return json.dumps(parts, indent=2, default=float)
