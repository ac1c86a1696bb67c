"""Mechanisms that are hard by nature: branches that cross, and rows that depend on others at every pose.

With cranks and couplers in one line, the parallelograms of a coupled four-bar meet the assemblies with
crossed cranks. Beyond that pose there are poses of both, and none that is reached from the drawing without
a singular one. Bricard's ring of six hinges has as many rows as coordinates and yet moves: a model that
cannot hold such a mechanism has to refuse it with the reason. Where no reference is to be had of it
nothing is judged here, and the tests of mechanisms hold it to its closed form.
"""

from __future__ import annotations

import math

from validate.hard.case import REFUSED, Case, Expected
from validate.hard.family import OTHERS, SOLVERS, Content, Subject, expected_of
from validate.hard.trial import scene_case

GROUP = "Mechanisms that are hard by nature"
NEAR = (1e-1, 1e-4)
RIGHT_DOWN_TO = Expected(("right", "refused"), right_from=1e-3)
# Turn of the drawing at which branches cross, or beyond which there is none; rad.
CROSSING = {"n_four_bar": -0.5 * math.pi}
END = {"bricard": -math.pi / 6.0}


def held_near(subject: Subject, turn: float, value: float) -> Content:
    """At rest, a share of the way from the drawing short of a turn; beyond it if that is negative."""
    (driven,) = subject.kinds
    return subject.absolute({driven: turn * (1.0 - value)})


def swept_to(subject: Subject, turn: float, value: float) -> Content:
    """From the drawing to there in a second."""
    (driven,) = subject.kinds
    return subject.absolute({driven: [0.0, turn * (1.0 - value)]}, stop=1.0, samples=3)


def _cases(subject: Subject, turn: float, where: str) -> tuple[Case, ...]:
    def case(name: str, why: str, beyond: bool, moving: bool) -> Case:
        sign, content = (-1.0 if beyond else 1.0), (swept_to if moving else held_near)

        def scene(value: float) -> Content:
            return content(subject, turn, sign * value)

        return scene_case(
            name=f"{name}{subject.suffix}",
            group=GROUP,
            why=f"{why} {where}",
            parameter="distance from it, in parts of the way from the drawing"
            + (", beyond" if beyond else ""),
            values=(1e-2,) if beyond else NEAR,
            scene=scene,
            expected=dict.fromkeys(SOLVERS, REFUSED)
            if beyond
            else expected_of(subject, dict.fromkeys(SOLVERS, RIGHT_DOWN_TO)),
            behaviour="refused: no pose there is reached from the drawing" if beyond else "right, or refused",
            # Up to where branches cross the reference needs a minute and more of ever shorter steps.
            proven=not beyond,
        )

    return (
        case("held-near-the-line", "It rests near the pose where", False, False),
        case("swept-near-the-line", "It moves from the drawing to near the pose where", False, True),
        case("held-beyond-the-line", "It is to be beyond the pose where", True, False),
        case("swept-through-the-line", "It is to move through the pose where", True, True),
    )


CASES: tuple[Case, ...] = tuple(
    case
    for subject in OTHERS
    for turns, where in (
        (CROSSING, "its branches cross."),
        (END, "its ring goes no further."),
    )
    if subject.name in turns
    for case in _cases(subject, turns[subject.name], where)
)
