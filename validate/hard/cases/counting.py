"""How many assemblies a pose has, at the drawing and near the singular poses where two of them merge.

A search from a thousand starts lists those that it finds, each with its proof; closed forms say how many can
exist. The literature reduces this strut to a polynomial of degree 64, which bounds them from above.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import astuple, replace
from functools import cache, partial
from typing import Any

import numpy as np
from scipy.optimize import brentq, minimize_scalar

from validate.cars.input_limits import Linkage
from validate.cars.scene_content import SQUARE, scene_content
from validate.hard.cars import CARS, EVERY
from validate.hard.case import RIGHT, Case, Expected, Trial, decades
from validate.hard.cases.oriented import followed
from validate.hard.last_values import home, last_value
from validate.hard.trial import try_scene
from validate.reference import Choices, count_assemblies

SOLVERS = ("pointcoord", "pointcoord-newton", "absolute", "relative")
STARTS = 1000
DEGREE = 64  # of the polynomial of the collinear strut in the literature


@cache
def meeting(car: str = "paper") -> tuple[float, float]:
    """Arm angle and rack travel, rad and mm, at which the two sides of the tie rod just meet, near 35 deg.

    At less rack travel the arm cannot pass this angle, at more it can; there `spare` has a minimum of 0.
    """
    linkage = Linkage.of(CARS[car])

    def least(rack: float) -> tuple[float, float]:
        found = minimize_scalar(
            lambda angle: float(linkage.spare(np.array(angle), np.array(rack))),
            bounds=(0.58, 0.68),
            method="bounded",
            options={"xatol": 1e-12},
        )
        return float(found.fun), float(found.x)

    rack = float(brentq(lambda r: least(r)[0], -10.0, 10.0, xtol=1e-14))
    return least(rack)[1], rack


def near_greatest_rack(share: float, car: str) -> tuple[float, float]:
    """Arm angle and rack travel near the last value of the rack."""
    return SQUARE, last_value(car, "rack", True).beyond(-share)


def near_lowest_arm(share: float, car: str) -> tuple[float, float]:
    """Arm angle and rack travel near the last value of the arm angle."""
    return last_value(car, "arm_angle", True).beyond(-share), 0.0


def beside_meeting(share: float, car: str) -> tuple[float, float]:
    """Arm angle and rack travel where the two sides of the tie rod nearly meet."""
    angle, rack = meeting(car)
    return angle, rack + 10.0 * share


def beside_drawing(share: float, car: str) -> tuple[float, float]:
    """Arm angle and rack travel some ordinary way from those of the drawing, far from every singular pose."""
    drawn = home(car, level=False)
    return drawn["arm_angle"] - 0.2 * share, drawn["rack"] + 30.0 * share


def posed(share: float, pose: Callable[[float, str], tuple[float, float]], car: str) -> dict[str, Any]:
    """The scene of one pose."""
    return scene_content(CARS[car], *pose(share, car))


def counted(share: float, pose: Callable[[float, str], tuple[float, float]], car: str = "paper") -> Trial:
    """The assemblies of a pose near a singular one, beside what the solvers answer."""
    angle, rack = pose(share, car)
    there = CARS[car]
    trial = try_scene(share, posed(share, pose, car), SOLVERS, followed)
    listed = count_assemblies(
        there.points,
        {"arm_angle": (angle, 0, 0), "rack": (rack, 0, 0)},
        up=there.up,
        right=there.right,
        closure=there.closure,
        suspension=there.suspension,
        starts=STARTS,
    )
    facts: dict[str, float | str] = {
        "assemblies found, proven": float(len(listed.found)),
        "assemblies possible": float(listed.possible),
        "starts": float(listed.starts),
        "signs of their choices": "; ".join(signs(one.choices) for one in listed.found),
    }
    return replace(trial, facts={**trial.facts, **facts})


def signs(choices: Choices) -> str:
    """The name of an assembly: the signs of its choices."""
    return "".join("+" if sign > 0 else "-" for sign in astuple(choices))


def counting_cases(group: str, expected: Expected) -> tuple[Case, ...]:
    """One case for each singular pose that is approached, and one at the drawing.

    Args:
        expected: of the solvers near a singular pose.
    """
    return tuple(
        _case(group, where, why, parameter, pose, values, allowed, suffix)
        for where, why, parameter, pose, values, allowed, suffix in (
            ("drawing", *DRAWING, RIGHT, ""),
            ("rack", *RACK, expected, ""),
            ("arm", *ARM, expected, ""),
            ("meeting", *MEETING, expected, ""),
            ("drawing", *DRAWING[:-1], (1.0, 0.0), RIGHT, "-wishbone"),
            ("rack", *RACK[:-1], FEWER, expected, "-wishbone"),
            ("arm", *ARM[:-1], FEWER, expected, "-wishbone"),
        )
    )


NEAR = decades(-12, -1)[::3]
FEWER = (1e-1, 1e-10)  # each value is a search from a thousand starts
MERGING = "Closed forms say how many assemblies a pose may have, and near a singular pose two of them merge."
DRAWING = (
    "Of all assemblies of an ordinary pose, up to sixteen by closed forms, one is meant.",
    "arm and rack from the drawing, in parts of 0.2 rad and 30 mm; then at it",
    beside_drawing,
    (1.0, 0.1, 0.0),
)
RACK = (MERGING, "distance from the greatest rack travel, in parts of its range", near_greatest_rack, NEAR)
ARM = (MERGING, "distance from the greatest arm angle, in parts of its range", near_lowest_arm, NEAR)
MEETING = (MERGING, "rack travel beyond the meeting of two branches, in parts of 10 mm", beside_meeting, NEAR)


def _case(
    group: str,
    where: str,
    why: str,
    parameter: str,
    pose: Callable[[float, str], tuple[float, float]],
    values: tuple[float, ...],
    allowed: Expected,
    suffix: str,
) -> Case:
    return Case(
        name=f"assemblies-counted-{where}{suffix}",
        group=group,
        why=why,
        parameter=parameter,
        values=values,
        expected=dict.fromkeys(SOLVERS, allowed),
        behaviour="of all assemblies that a search finds, the one of the drawing",
        examine=partial(counted, pose=pose, car=EVERY[suffix]),
        content=partial(posed, pose=pose, car=EVERY[suffix]),
    )
