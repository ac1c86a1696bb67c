"""Where the way from the drawing to a first instant is blocked, held to the reference on both sides.

When both inputs differ from the drawing, a model takes them there together, and what it reaches lies on its
own way: straight in ball joint height and rack travel for pointcoord, in arm angle and rack travel for the
models in Pinocchio. A little back on that way there must be a pose, and a little further on there must be
none.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from fractions import Fraction
from functools import partial
from typing import Any

from pointcoord import Scene
from validate.formulations.protocol import FormulationError
from validate.formulations.registry import formulation
from validate.hard.case import RIGHT, Answer, Case, Trial
from validate.hard.family import NAMED, SOLVERS
from validate.hard.last_values import last_value, reachable

SHARE = 1e-9  # of the way: how exactly its end must be found
BY_ANGLE = ("absolute", "relative")
ARM = 1.3  # rad: where the arm is to be, besides the rack beyond its end
Values = Mapping[str, float]


def goal(overshoot: float, car: str = "paper") -> dict[str, float]:
    """An arm angle well inside its range, and a rack travel beyond what it can be at any such angle."""
    return {"arm_angle": ARM, "rack": last_value(NAMED[car], "rack", True).beyond(0.5 + overshoot)}


def moved_on(
    name: str, here: Values, end: Values, share: float, car: str = "paper"
) -> dict[str, float | Fraction]:
    """The inputs a share of the whole way further on, on the way that a model takes to the end."""
    start = NAMED[car].drawn
    rack = Fraction(here["rack"]) + Fraction(share) * (Fraction(end["rack"]) - Fraction(start["rack"]))
    if name in BY_ANGLE:
        return {
            "arm_angle": here["arm_angle"] + share * (end["arm_angle"] - start["arm_angle"]),
            "rack": rack,
        }
    height = math.cos(here["arm_angle"]) + share * (math.cos(end["arm_angle"]) - math.cos(start["arm_angle"]))
    return {"arm_angle": math.acos(height), "rack": rack}


def share_of_way(name: str, here: Values, end: Values, car: str = "paper") -> tuple[float, float]:
    """How far along the way the arm is, and how far the rack; equal if the place lies on it."""
    start = NAMED[car].drawn

    def measure(values: Values) -> float:
        return values["arm_angle"] if name in BY_ANGLE else math.cos(values["arm_angle"])

    arm = (measure(here) - measure(start)) / (measure(end) - measure(start))
    return arm, (here["rack"] - start["rack"]) / (end["rack"] - start["rack"])


def content(overshoot: float, car: str = "paper") -> dict[str, Any]:
    """Of the scene that asks for it."""
    return NAMED[car].absolute(goal(overshoot, car))


def examine(overshoot: float, car: str = "paper") -> Trial:
    """Ask every solver for a first instant that it cannot reach."""
    end = goal(overshoot, car)
    scene = Scene.from_mapping(content(overshoot, car))
    answers = []
    for name in SOLVERS:
        try:
            formulation(name).solve(scene)
        except FormulationError as error:
            answers.append(judged(name, error.reason, end, car))
        except Exception as error:
            answers.append(Answer(name, "wrong", f"fails: {type(error).__name__}: {error}"))
        else:
            answers.append(Answer(name, "wrong", "answers beyond the end"))
    return Trial(overshoot, tuple(answers))


def judged(name: str, reason: Exception, end: Values, car: str = "paper") -> Answer:
    """Whether a refusal names the place where its own way ends."""
    here: Values = getattr(reason, "reached", {})
    if set(here) < {"arm_angle", "rack"}:
        return Answer(name, "wrong", f"does not say how far it came: {type(reason).__name__}: {reason}")
    arm, rack = share_of_way(name, here, end, car)
    faults = []
    if abs(arm - rack) > SHARE:
        faults.append(
            f"what is reached does not lie on the way: the arm at {arm!r} of it, the rack at {rack!r}"
        )
    if not reachable(NAMED[car], moved_on(name, here, end, -SHARE, car)):
        faults.append("there is no pose just before what is reached")
    if reachable(NAMED[car], moved_on(name, here, end, SHARE, car)):
        faults.append("there is a pose just beyond what is reached")
    return Answer(
        name,
        "wrong" if faults else "right",
        "; ".join(faults) or " ".join(str(reason).split()),
        condition=getattr(reason, "condition", None),
    )


def blocked_way(group: str, values: tuple[float, ...], car: str = "paper") -> Case:
    """The case, for the group of reachable ranges."""
    return Case(
        name="start-beyond-both" if car == "paper" else f"start-beyond-both-{car}",
        group=group,
        why="Arm and rack go from the drawing to the first instant together, and lock on the way.",
        parameter="rack travel beyond one and a half of its range, in parts of it",
        values=values,
        expected=dict.fromkeys(SOLVERS, RIGHT),
        behaviour="refused, with the end of the way to 1e-9 of the way: a pose before it, none beyond",
        examine=partial(examine, car=car),
        content=partial(content, car=car),
        without_pose=True,
    )
