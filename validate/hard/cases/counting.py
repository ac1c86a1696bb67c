"""How many assemblies a pose has, at the drawing and near the singular poses where two of them merge.

A search from a thousand starts lists those that it finds, each with its proof; closed forms say how many can
exist. The literature reduces this strut to a polynomial of degree 64, which bounds them from above.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial

from pointcoord import Scene
from validate.adjudication.reference_solution import design_of, inputs_at
from validate.hard.cars import SQUARE
from validate.hard.case import RIGHT, Case, Expected, Trial, decades
from validate.hard.family import NAMED, SOLVERS, Content, Subject
from validate.hard.last_values import last_value
from validate.hard.trial import try_scene
from validate.reference import count_assemblies

STARTS = 1000
DEGREE = 64  # of the polynomial of the collinear strut in the literature


# Arm angle, rad, and rack travel, mm, at which the two sides of the tie rod just meet, by car: at less rack
# travel the arm cannot pass this angle, at more it can.
MEETINGS: Mapping[str, tuple[float, float]] = {
    "paper": (0.6129246396239625, -0.00292320063271574),
    "beside": (0.6117454829993613, -3.0987778880673007),
}


def near_greatest_rack(subject: Subject, share: float) -> tuple[float, float]:
    """Arm angle and rack travel near the last value of the rack."""
    return SQUARE, last_value(subject, "rack", True).beyond(-share)


def near_lowest_arm(subject: Subject, share: float) -> tuple[float, float]:
    """Arm angle and rack travel near the last value of the arm angle."""
    return last_value(subject, "arm_angle", True).beyond(-share), 0.0


def beside_meeting(subject: Subject, share: float) -> tuple[float, float]:
    """Arm angle and rack travel where the two sides of the tie rod nearly meet."""
    angle, rack = MEETINGS[subject.name]
    return angle, rack + 10.0 * share


def beside_drawing(subject: Subject, share: float) -> tuple[float, float]:
    """Arm angle and rack travel some ordinary way from those of the drawing, far from every singular pose."""
    return subject.drawn["arm_angle"] - 0.2 * share, subject.drawn["rack"] + 30.0 * share


Pose = Callable[[Subject, float], tuple[float, float]]


def posed(share: float, pose: Pose, subject: Subject) -> Content:
    """The scene of one pose."""
    return subject.absolute(dict(zip(subject.kinds, pose(subject, share), strict=True)))


def counted(share: float, pose: Pose, subject: Subject = NAMED["paper"]) -> Trial:
    """The assemblies of a pose near a singular one, beside what the solvers answer."""
    content = posed(share, pose, subject)
    trial, scene = try_scene(share, content, SOLVERS), Scene.from_mapping(content)
    listed = count_assemblies(design_of(scene), inputs_at(scene, 0.0), starts=STARTS)
    facts: dict[str, float | str] = {
        "assemblies found, proven": float(len(listed.found)),
        "starts": float(listed.starts),
    }
    return replace(trial, facts={**trial.facts, **facts})


NEAR = decades(-12, -1)[::3]
FEWER = (1e-1, 1e-10)  # each value is a search from a thousand starts
MERGING = "Closed forms say how many assemblies a pose may have, and near a singular pose two of them merge."
DRAWING = "Of all assemblies of an ordinary pose, up to sixteen by closed forms, one is meant."
# Name, why, parameter, pose, values of the strut and of the wishbone.
POSES: tuple[tuple[str, str, str, Pose, tuple[float, ...], tuple[float, ...]], ...] = (
    (
        "drawing",
        DRAWING,
        "arm and rack from the drawing, in parts of 0.2 rad and 30 mm; then at it",
        beside_drawing,
        (1.0, 0.1, 0.0),
        (1.0, 0.0),
    ),
    (
        "rack",
        MERGING,
        "distance from the greatest rack travel, in parts of its range",
        near_greatest_rack,
        NEAR,
        FEWER,
    ),
    (
        "arm",
        MERGING,
        "distance from the greatest arm angle, in parts of its range",
        near_lowest_arm,
        NEAR,
        FEWER,
    ),
    (
        "meeting",
        MERGING,
        "rack travel beyond the meeting of two branches, in parts of 10 mm",
        beside_meeting,
        NEAR,
        (),
    ),
)


def counting_cases(group: str, expected: Expected) -> tuple[Case, ...]:
    """One case for each singular pose that is approached, and one at the drawing.

    Args:
        expected: of the solvers near a singular pose.
    """
    return tuple(
        Case(
            name=f"assemblies-counted-{where}{subject.suffix}",
            group=group,
            why=why,
            parameter=parameter,
            values=values,
            expected=dict.fromkeys(SOLVERS, RIGHT if where == "drawing" else expected),
            behaviour="of all assemblies that a search finds, the one of the drawing",
            examine=partial(counted, pose=pose, subject=subject),
            content=partial(posed, pose=pose, subject=subject),
        )
        for where, why, parameter, pose, *both in POSES
        for subject, values in zip((NAMED["paper"], NAMED["wishbone"]), both, strict=True)
        if values
    )
