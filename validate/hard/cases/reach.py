"""How far the inputs go: each is driven beyond its last value, and the refusal is held to the true end.

Nothing is assembled beyond the end, so a formulation is `right` here when it refuses the motion and says what
it must: the last value to 1e-9 of the input's range, which input and value were asked for, the motion up to
there with right instants, and (pointcoord) the links that lie in line.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from typing import Any

import numpy as np

from pointcoord import AssemblyError, Scene
from validate.adjudication.reference_solution import inputs_at, reference_instant
from validate.cars.scene_content import Law
from validate.formulations.input_rates import rates
from validate.formulations.protocol import FormulationError
from validate.formulations.registry import formulation
from validate.hard.case import RIGHT, Answer, Case, Trial, decades
from validate.hard.cases.blocked_ways import blocked_way
from validate.hard.cases.dead_points import HIGHEST, LEAST, WAYS
from validate.hard.family import NAMED, OTHERS, SOLVERS, Subject, family, hyphens
from validate.hard.last_values import LastValue, ends_of, last_value
from validate.hard.partial_motion import fault_of_kept
from validate.reference import InfeasibleError, NoReferenceError

GROUP = "Reachable range"
SHARE = 1e-9  # of the range: how exactly the last value must be found
SAMPLES = 5


@dataclass(frozen=True)
class Lock:
    """What lies in line at an end.

    Attributes:
        words: as the facts of a trial have it.
        holds: whether the links that limit a motion, the strongest first, are those.
    """

    words: str
    holds: Callable[[tuple[str, ...]], bool]


def _are_first(*links: str) -> Callable[[tuple[str, ...]], bool]:
    return lambda limits: set(limits[:3]) >= set(links)


def _tie_rod_within(first: int) -> Callable[[tuple[str, ...]], bool]:
    rod = "link tie_rod_inner - tie_rod_outer"
    return lambda limits: (
        rod in limits[:3] and any("tie_rod_outer" in limit and limit != rod for limit in limits[:first])
    )


ARM = Lock(
    "ball joint, arm axis, up",
    _are_first("link lower_ball_joint - lower_arm_front", "link lower_ball_joint - lower_arm_rear"),
)
SLIDE = Lock(
    "nothing: the top is at a right angle beside the ball joint",
    lambda limits: "strut_top on the strut axis" in limits,
)
UPPER_ARM = Lock(
    "upper arm and kingpin, in one plane with the upper pivots",
    _are_first(
        "link upper_ball_joint - lower_ball_joint",
        "link upper_ball_joint - upper_arm_front",
        "link upper_ball_joint - upper_arm_rear",
    ),
)
TIE_ROD = Lock("tie rod, steering arm", _tie_rod_within(3))
# Where the arm drives, what holds the knuckle's upper end is under the same force as the steering arm.
TIE_ROD_OF_ARM = replace(TIE_ROD, holds=_tie_rod_within(5))
ANY = Lock("as pointcoord names it", bool)


@dataclass(frozen=True)
class Drive:
    """One input of a mechanism, driven beyond one of its ends.

    Attributes:
        moving: driven there from home within 1 s; else it is there at the only instant.
    """

    subject: Subject
    driven: str
    ahead: bool
    lock: Lock
    moving: bool = True

    @property
    def end(self) -> LastValue:
        """Where it ends."""
        return last_value(self.subject, self.driven, self.ahead, self.home)

    @property
    def home(self) -> Mapping[str, float]:
        """Inputs from which it starts; without a motion the drawing's own, so that only one input differs."""
        return self.subject.home if self.moving else self.subject.drawn

    @property
    def room(self) -> float:
        """The largest overshoot, rad or mm: as far as angles have a meaning, or the range again."""
        if self.subject.kinds[self.driven] == "angle":
            return float(abs(Fraction(np.pi if self.ahead else 0.0) - self.end.value))
        return self.end.reach

    def content(self, overshoot: float) -> dict[str, Any]:
        """Of the scene that asks for an overshoot, in parts of the room."""
        goal = self.end.beyond(overshoot * self.room / self.end.reach)
        if self.subject.kinds[self.driven] == "angle":
            # All of the room ends at 0 or pi but for a rounding, which must not lead beyond.
            goal = min(max(goal, 0.0), np.pi)
        start = self.home[self.driven]
        way: Law = (start, goal - start) if self.moving else goal
        there = {**self.home, self.driven: way}
        stop, samples = (1.0, SAMPLES) if self.moving else (0.0, 1)
        return self.subject.absolute(there, stop=stop, samples=samples)


def examine(drive: Drive, overshoot: float) -> Trial:
    """Ask every solver for a value beyond the end."""
    scene = Scene.from_mapping(drive.content(overshoot))
    asked = rates(scene.inputs[drive.driven], np.array([scene.time.stop]))[0, 0]
    facts: dict[str, float | str] = {
        "end [mm or rad]": float(drive.end.value),
        "asked for [mm or rad]": float(asked),
        "in line": drive.lock.words,
    }
    return Trial(overshoot, tuple(_answer(name, scene, drive) for name in SOLVERS), facts)


def _answer(name: str, scene: Scene, drive: Drive) -> Answer:
    try:
        formulation(name).solve(scene)
    except FormulationError as error:
        return refusal_held(error, scene, drive)
    except Exception as error:
        return Answer(name, "wrong", f"fails: {type(error).__name__}: {error}")
    # The last instant should have no pose.
    try:
        reference_instant(scene, inputs_at(scene, scene.time.stop))
    except InfeasibleError as error:
        return Answer(name, "wrong", f"answers beyond the end: {error}")
    except NoReferenceError as error:
        return Answer(name, "unjudged", f"{type(error).__name__}: {error}")
    return Answer(name, "unjudged", "the overshoot was lost in rounding: there is a pose")


def refusal_held(refusal: FormulationError, scene: Scene, drive: Drive) -> Answer:
    """A refusal held to the true end."""
    name, reason, driven = refusal.formulation, refusal.reason, drive.driven
    reached: Mapping[str, float] = getattr(reason, "reached", {})
    if driven not in reached:
        return Answer(name, "wrong", f"does not say how far it came: {type(reason).__name__}: {reason}")
    end = drive.end
    error, bound = float(abs(Fraction(reached[driven]) - end.value)), SHARE * end.reach
    faults = _faults_of_words(reason, reached, drive)
    if error > bound:
        faults.insert(0, f"stops at {driven} = {reached[driven]!r}, not {float(end.value)!r}")
    if drive.moving and (fault := fault_of_kept(refusal, scene, float(end.value), driven)):
        faults.append(fault)
    return Answer(
        name,
        "wrong" if faults else "right",
        "; ".join(faults) or " ".join(str(reason).split()),
        error=error,
        bound=bound,
        share=error / bound,
        condition=getattr(reason, "condition", None),
    )


def _faults_of_words(reason: Exception, reached: Mapping[str, float], drive: Drive) -> list[str]:
    """What an error does not say, or says wrongly."""
    faults, driven, end = [], drive.driven, drive.end
    for other, held in drive.home.items():
        # The held input takes no part; it comes back through a cosine and its inverse.
        if other != driven and abs(reached[other] - held) > SHARE * max(1.0, abs(held)):
            faults.append(f"{other} is said to stop at {reached[other]!r}, and is held at {held!r}")
    wanted: Mapping[str, float] = getattr(reason, "wanted", getattr(reason, "inputs", {}))
    outward = 1.0 if drive.ahead else -1.0
    if not outward * (wanted[driven] - float(end.value)) > -SHARE * end.reach:
        faults.append(f"the value asked for, {wanted[driven]!r}, lies before the end")
    ours = isinstance(reason, AssemblyError)
    for values in (wanted, reached) if ours else (wanted,):
        # The models print ten or twelve digits.
        if not any(f"{driven} = {values[driven]:.{digits}g}" in str(reason) for digits in (10, 12)):
            faults.append(f"the message does not hold {driven} = {values[driven]:.10g}")
    if isinstance(reason, AssemblyError):
        if reason.reduce != driven:
            faults.append(f"{reason.reduce!r} is to be reduced, and {driven!r} was driven")
        if not drive.lock.holds(reason.limits):
            faults.append(f"what limits it is not what lies in line: {', '.join(reason.limits[:3])}")
    return faults


def _case(drive: Drive, name: str, where: str, values: tuple[float, ...]) -> Case:
    whole = {
        "angle": "the way from the end to the upright arm",
        "turn": "its range",
        "length": f"the {drive.driven}'s range",
    }
    more = "" if drive.moving else ", and the first instant lies beyond"
    return Case(
        name=f"{'reach' if drive.moving else 'start-beyond'}-{name}",
        group=GROUP,
        why=f"{where}{more}; beyond it there is no pose, and at it two assemblies meet.",
        parameter=f"overshoot beyond the last value, in parts of {whole[drive.subject.kinds[drive.driven]]}",
        values=values,
        expected=dict.fromkeys(SOLVERS, RIGHT),
        behaviour=(
            "refused, with the last value to 1e-9 of the range, the input, what was asked for, the right "
            "motion up to there and (pointcoord) the links in line; absolute names no links"
        ),
        examine=partial(examine, drive),
        unit=drive.subject.units[drive.driven],
        content=drive.content,
        without_pose=True,
    )


# Every refusal is a whole motion towards a fold, so few values must do.
EIGHT, FOUR, ENDS_ONLY = (*decades()[::2], 1e-11), decades()[::4], decades()[::12]
TURNED = ", in a car mirrored, turned and 4e6 mm from the origin"


def _ends_of_arm(
    car: str, suffix: str, values: tuple[float, ...], more: str = "", moving: bool = True
) -> list[Case]:
    return [
        _case(
            Drive(NAMED[car], "arm_angle", ahead, ARM, moving),
            f"arm-{HIGHEST[ahead]}{suffix}",
            f"The ball joint is {HIGHEST[ahead]} on its circle{more}",
            values,
        )
        for ahead in WAYS
    ]


def _ends_of_rack(
    car: str,
    suffix: str,
    values: tuple[float, ...],
    more: str = "",
    moving: bool = True,
    ways: tuple[bool, ...] = WAYS,
) -> list[Case]:
    return [
        _case(
            Drive(NAMED[car], "rack", ahead, TIE_ROD, moving),
            f"rack-{LEAST[ahead]}{suffix}",
            f"Tie rod and steering arm lie in line{more}",
            values,
        )
        for ahead in ways
    ]


def _both(
    name: str, where: str, drive: Drive, values: tuple[float, ...], held: tuple[float, ...]
) -> tuple[Case, ...]:
    return _case(drive, name, where, values), _case(replace(drive, moving=False), name, where, held)


CASES: tuple[Case, ...] = (
    *_ends_of_arm("paper", "", FOUR),
    *_ends_of_rack("paper", "", FOUR),
    *_ends_of_arm("turned", "-turned", ENDS_ONLY, TURNED),
    *_ends_of_rack("turned", "-turned", ENDS_ONLY, TURNED),
    *_ends_of_arm("short-arm", "-wishbone", ENDS_ONLY),
    *_ends_of_rack("wishbone", "-wishbone", ENDS_ONLY),
    *_ends_of_rack("wishbone-turned", "-wishbone-turned", (1e-6,), TURNED, ways=(True,)),
    *_ends_of_arm("paper", "", EIGHT, moving=False),
    *_ends_of_rack("paper", "", EIGHT, moving=False),
    *_both(
        "slide-runs-out",
        "The strut's slide has no more way",
        Drive(NAMED["wide"], "arm_angle", False, SLIDE),
        FOUR,
        EIGHT,
    ),
    *_both(
        "upper-arm-locks",
        "Upper arm and kingpin come to lie in one plane with the upper pivots",
        Drive(NAMED["wishbone"], "arm_angle", True, UPPER_ARM),
        ENDS_ONLY,
        FOUR,
    ),
    *_both(
        "tie-rod-locks-the-arm",
        "The arm turns until tie rod and steering arm lie in line",
        Drive(NAMED["wishbone"], "arm_angle", False, TIE_ROD_OF_ARM),
        ENDS_ONLY,
        FOUR,
    ),
    *(
        case
        for subject in OTHERS
        for driven, ahead in ends_of(subject)
        for case in _both(
            f"{hyphens(driven)}-{LEAST[ahead]}{subject.suffix}",
            f"{driven} is at its {LEAST[ahead]}, the other inputs as drawn",
            Drive(subject, driven, ahead, ANY),
            (1e-3,),
            (1e-3,),
        )
    ),
    blocked_way(GROUP, EIGHT),
    blocked_way(GROUP, FOUR, "wishbone"),
    *family(
        name="heave-has-no-end",
        group=GROUP,
        why="The chassis carries all points, so heave alone has no last value; only digits are lost.",
        parameter="1 mm over the heave",
        values=decades(),
        scene=lambda subject, value: subject.content(heave=(0.0, 1.0 / value), stop=1.0),
        # Heave takes no part in any constraint: it is added to what was solved, the drawing itself.
        expected=RIGHT,
        behaviour="right at every heave",
        needs_heave=True,
    ),
)
