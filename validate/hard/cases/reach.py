"""How far the inputs go: each is driven beyond its last value, and the refusal is held to the true end.

Nothing is assembled beyond the end, so a formulation is `right` here when it refuses the motion and says what
it must: the last value to 1e-9 of the input's range, which input and value were asked for, the motion up to
there with right instants, and (pointcoord) the links that lie in line.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from typing import Any

import numpy as np

from pointcoord import AssemblyError, Scene
from validate.adjudication.reference_solution import inputs_at, reference_instant
from validate.cars.scene_content import Law, scene_content
from validate.formulations.input_rates import rates
from validate.formulations.protocol import FormulationError
from validate.formulations.registry import formulation
from validate.hard.cars import CARS, EVERY
from validate.hard.case import RIGHT, Answer, Case, Trial, coarse, decades
from validate.hard.cases.blocked_ways import blocked_way
from validate.hard.last_values import LastValue, home, last_value
from validate.hard.partial_motion import fault_of_kept
from validate.hard.trial import scene_case
from validate.reference import InfeasibleError, NoReferenceError

GROUP = "Reachable range"
SHARE = 1e-9  # of the range: how exactly the last value must be found
SAMPLES = 5
SOLVERS = ("pointcoord", "pointcoord-newton", "absolute", "relative")
STRUT = {"strut_top on the strut axis"}
ROD = "link tie_rod_inner - tie_rod_outer"
ARM = {"link lower_ball_joint - lower_arm_front", "link lower_ball_joint - lower_arm_rear"}
UPPER_ARM = {
    "link upper_ball_joint - lower_ball_joint",
    "link upper_ball_joint - upper_arm_front",
    "link upper_ball_joint - upper_arm_rear",
}
LOCKED = {
    "arm": "ball joint, arm axis, up",
    "strut": "nothing: the top is at a right angle beside the ball joint",
    "upper_arm": "upper arm and kingpin, in one plane with the upper pivots",
    "tie_rod": "tie rod, steering arm",
}


@dataclass(frozen=True)
class Drive:
    """One input of one car, driven beyond one of its ends.

    Attributes:
        car: the name of one in `CARS`.
        moving: driven there from home within 1 s; else it is there at the only instant.
    """

    car: str
    driven: str
    ahead: bool
    moving: bool = True

    @property
    def end(self) -> LastValue:
        """Where it ends."""
        return last_value(self.car, self.driven, self.ahead, self.moving)

    @property
    def home(self) -> dict[str, float]:
        """Inputs from which it starts; without a motion the drawing's own, so that only one input differs."""
        return home(self.car, level=self.moving)

    @property
    def room(self) -> float:
        """The largest overshoot, rad or mm: as far as angles have a meaning, or the rack's range again."""
        if self.driven == "rack":
            return self.end.reach
        return float(abs(Fraction(np.pi if self.ahead else 0.0) - self.end.value))

    def content(self, overshoot: float) -> dict[str, Any]:
        """Of the scene that asks for an overshoot, in parts of the room."""
        goal = self.end.beyond(overshoot * self.room / self.end.reach)
        start = self.home[self.driven]
        laws: dict[str, Law] = dict(self.home)
        laws[self.driven] = (start, goal - start) if self.moving else goal
        return scene_content(
            CARS[self.car],
            laws["arm_angle"],
            laws["rack"],
            stop=1.0 if self.moving else 0.0,
            samples=SAMPLES if self.moving else 1,
        )

    def scene(self, overshoot: float) -> Scene:
        """The scene that asks for an overshoot, in parts of the room."""
        return Scene.from_mapping(self.content(overshoot))


def examine(drive: Drive, overshoot: float) -> Trial:
    """Ask every solver for a value beyond the end."""
    scene = drive.scene(overshoot)
    answers = []
    facts: dict[str, float | str] = {"end [mm or rad]": float(drive.end.value)}
    for name in SOLVERS:
        try:
            formulation(name).solve(scene)
        except FormulationError as error:
            answers.append(_refusal(error, scene, drive))
            if name == "absolute":
                said = (
                    "names" if _shown(error.reason, drive.driven, _reached(error.reason)) else "does not name"
                )
                facts["absolute"] = f"{type(error.reason).__name__}: its message {said} the last value"
        except Exception as error:
            answers.append(Answer(name, "wrong", f"fails: {type(error).__name__}: {error}"))
        else:
            answers.append(_answered(name, scene))
    facts["asked for [mm or rad]"] = _asked(scene, drive)
    facts["in line"] = LOCKED[drive.end.lock]
    return Trial(overshoot, tuple(answers), facts)


def _asked(scene: Scene, drive: Drive) -> float:
    return float(rates(scene.inputs[drive.driven], np.array([scene.time.stop]))[0, 0])


def _answered(name: str, scene: Scene) -> Answer:
    """A solver that answers a scene whose last instant should have no pose."""
    try:
        reference_instant(scene, inputs_at(scene, scene.time.stop))
    except InfeasibleError as error:
        return Answer(name, "wrong", f"answers beyond the end: {error}")
    except NoReferenceError as error:
        return Answer(name, "unjudged", f"{type(error).__name__}: {error}")
    return Answer(name, "unjudged", "the overshoot was lost in rounding: there is a pose")


def _refusal(refusal: FormulationError, scene: Scene, drive: Drive) -> Answer:
    """A refusal held to the true end."""
    name, reason = refusal.formulation, refusal.reason
    reached = _reached(reason)
    if drive.driven not in reached:
        return Answer(name, "wrong", f"does not say how far it came: {type(reason).__name__}: {reason}")
    error = float(abs(Fraction(reached[drive.driven]) - drive.end.value))
    bound = SHARE * drive.end.reach
    faults = _faults_of_words(reason, scene, drive)
    if error > bound:
        faults.insert(
            0, f"stops at {drive.driven} = {reached[drive.driven]!r}, not {float(drive.end.value)!r}"
        )
    if drive.moving and (fault := fault_of_kept(refusal, scene, float(drive.end.value), drive.driven)):
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


def _reached(reason: Exception) -> Mapping[str, float]:
    reached: Mapping[str, float] = getattr(reason, "reached", {})
    return reached


def _faults_of_words(reason: Exception, scene: Scene, drive: Drive) -> list[str]:
    """What an error does not say, or says wrongly."""
    faults = []
    reached = _reached(reason)
    for other, held in drive.home.items():
        # The held input takes no part; it comes back through a cosine and its inverse.
        if other != drive.driven and abs(reached[other] - held) > SHARE * max(1.0, abs(held)):
            faults.append(f"{other} is said to stop at {reached[other]!r}, and is held at {held!r}")
    wanted: Mapping[str, float] = getattr(reason, "wanted", getattr(reason, "inputs", {}))
    outward = 1.0 if drive.ahead else -1.0
    if not outward * (wanted[drive.driven] - float(drive.end.value)) > -SHARE * drive.end.reach:
        faults.append(f"the value asked for, {wanted[drive.driven]!r}, lies before the end")
    if not _shown(reason, drive.driven, wanted):
        faults.append(f"the message does not hold {drive.driven} = {wanted[drive.driven]:.10g}")
    if isinstance(reason, AssemblyError):
        if not _shown(reason, drive.driven, reached):
            faults.append(f"the message does not hold {drive.driven} = {reached[drive.driven]:.10g}")
        if reason.reduce != drive.driven:
            faults.append(f"{reason.reduce!r} is to be reduced, and {drive.driven!r} was driven")
        if not _in_line(reason.limits, drive):
            faults.append(f"what limits it is not what lies in line: {', '.join(reason.limits[:3])}")
    return faults


def _shown(reason: Exception, driven: str, values: Mapping[str, float]) -> bool:
    """Whether a message holds an input's value; the two models print ten and twelve digits."""
    return any(f"{driven} = {values[driven]:.{digits}g}" in str(reason) for digits in (10, 12))


def _in_line(limits: tuple[str, ...], drive: Drive) -> bool:
    """Whether the links that limit a motion the most are those that lock."""
    lock, first = drive.end.lock, set(limits[:3])
    if lock == "arm":
        return first >= ARM
    if lock == "strut":
        return set(limits) >= STRUT
    if lock == "upper_arm":
        return first >= UPPER_ARM
    # Where the arm drives, what holds the knuckle's upper end is under the same force as the steering arm.
    steered = limits[: 3 if drive.driven == "rack" else 5]
    return ROD in first and any("tie_rod_outer" in limit and limit != ROD for limit in steered)


def _case(drive: Drive, name: str, where: str, values: tuple[float, ...]) -> Case:
    unit = "rad" if drive.driven == "arm_angle" else "mm"
    part = "the way from the end to the upright arm" if unit == "rad" else "the rack's range"
    return Case(
        name=name,
        group=GROUP,
        why=f"{where}; beyond it there is no pose, and at it two assemblies meet.",
        parameter=f"overshoot beyond the last value, in parts of {part}",
        values=values,
        expected=dict.fromkeys(SOLVERS, RIGHT),
        behaviour=(
            "refused, with the last value to 1e-9 of the range, the input, what was asked for, the right "
            "motion up to there and (pointcoord) the links in line; absolute names no links"
        ),
        examine=lambda overshoot: examine(drive, overshoot),
        unit=unit,
        content=drive.content,
        without_pose=True,
    )


TIE_ROD = "Tie rod and steering arm lie in line"
ENDS = {
    ("arm_angle", False): ("arm-highest", "The ball joint is highest on its circle"),
    ("arm_angle", True): ("arm-lowest", "The ball joint is lowest on its circle"),
    ("rack", False): ("rack-least", TIE_ROD),
    ("rack", True): ("rack-greatest", TIE_ROD),
}
SLIDE = "The strut's slide has no more way"
UPPER = "Upper arm and kingpin come to lie in one plane with the upper pivots"
TIE = "The arm turns until tie rod and steering arm lie in line"
# Every refusal is a whole motion towards a fold, so few values must do.
SOME, EIGHT, FOUR, ENDS_ONLY = decades()[::4], (*decades()[::2], 1e-11), decades()[::4], decades()[::12]


def _ends(
    car: str, suffix: str, driven: tuple[str, ...], values: tuple[float, ...], more: str = ""
) -> list[Case]:
    return [
        _case(Drive(car, name, ahead), f"reach-{label}{suffix}", f"{where}{more}", values)
        for (name, ahead), (label, where) in ENDS.items()
        if name in driven
    ]


def _heaved(car: str, value: float) -> dict[str, Any]:
    return scene_content(CARS[car], heave=(0.0, 1.0 / value), stop=1.0)


BOTH = ("arm_angle", "rack")
TURNED = ", in a car mirrored, turned and 4e6 mm from the origin"

CASES: tuple[Case, ...] = (
    *_ends("paper", "", BOTH, SOME),
    *_ends("turned", "-turned", BOTH, ENDS_ONLY, TURNED),
    *_ends("short-arm", "-wishbone", ("arm_angle",), ENDS_ONLY),
    *_ends("wishbone", "-wishbone", ("rack",), ENDS_ONLY),
    _case(
        Drive("wishbone-turned", "rack", True),
        "reach-rack-greatest-wishbone-turned",
        TIE_ROD + TURNED,
        (1e-6,),
    ),
    *(
        _case(
            Drive("paper", driven, ahead, moving=False),
            f"start-beyond-{name}",
            f"{where}, and the first instant lies beyond",
            EIGHT,
        )
        for (driven, ahead), (name, where) in ENDS.items()
    ),
    *(
        case
        for name, where, drive, values in (
            ("slide-runs-out", SLIDE, Drive("wide", "arm_angle", False), SOME),
            ("upper-arm-locks", UPPER, Drive("wishbone", "arm_angle", True), ENDS_ONLY),
            ("tie-rod-locks-the-arm", TIE, Drive("wishbone", "arm_angle", False), ENDS_ONLY),
        )
        for case in (
            _case(drive, f"reach-{name}", where, values),
            _case(
                replace(drive, moving=False),
                f"start-beyond-{name}",
                f"{where}, and the first instant lies beyond",
                EIGHT if values == SOME else FOUR,
            ),
        )
    ),
    blocked_way(GROUP, EIGHT),
    blocked_way(GROUP, FOUR, "wishbone"),
    *(
        scene_case(
            name=f"heave-has-no-end{suffix}",
            group=GROUP,
            why="The chassis carries all points, so heave alone has no last value; only digits are lost.",
            parameter="1 mm over the heave",
            values=coarse(decades()) if suffix else decades(),
            scene=partial(_heaved, car),
            # Heave takes no part in any constraint: it is added to what was solved, the drawing itself.
            expected=dict.fromkeys(SOLVERS, RIGHT),
            behaviour="right at every heave",
        )
        for suffix, car in EVERY.items()
    ),
)
