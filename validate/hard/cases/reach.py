"""How far the inputs go: each is driven beyond its last value, and the refusal is held to the true end.

Nothing is assembled beyond the end, so a formulation is `right` here when it refuses the motion and says what
it must: the last value to 1e-9 of the input's range, which input and value were asked for, the motion up to
there with right instants, and (pointcoord) the links that lie in line.

When both inputs differ from the drawing, a model takes them there together, and what it reaches lies on its
own way: straight in ball joint height and rack travel for pointcoord, in arm angle and rack travel for the
models in Pinocchio. A little back on that way there must be a pose, and a little further on there must be
none.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial

import numpy as np

from pointcoord import AssemblyError, Scene
from pointcoord.numerics.rounding import EPS
from validate.cars.scene_content import Law
from validate.formulations.input_rates import rates
from validate.formulations.protocol import FormulationError
from validate.formulations.reference_solution import inputs_at, reference_instant
from validate.hard.answer import Answer
from validate.hard.case import Case, Values, case, decades, family
from validate.hard.last_values import LastValue, last_value, reachable
from validate.hard.subjects import HEAVING, NAMED, PAPER, Content, Subject
from validate.hard.trial import Trial
from validate.reference import NoReferenceError

SHARE = 1e-9  # of the range, or of the way: how exactly its end must be found
Inputs = Mapping[str, float]
Lock = Callable[[tuple[str, ...]], bool]
"""Whether the links that limit a motion, the strongest first, are those that lie in line."""


def first_three(*links: str) -> Lock:
    """These links limit it, before all others."""
    return lambda limits: set(limits[:3]) >= set(links)


def tie_rod_within(first: int) -> Lock:
    """The tie rod does, and another link of its outer end."""
    rod = "link tie_rod_inner - tie_rod_outer"
    return lambda limits: (
        rod in limits[:3] and any("tie_rod_outer" in limit and limit != rod for limit in limits[:first])
    )


@dataclass(frozen=True)
class End:
    """An end of an input.

    Attributes:
        ahead: whether the upper one.
        where: what happens there, in words.
        lock: what lies in line there, as pointcoord names it; anything if not given.
        moving: whether the input is driven there from home within 1 s; else it is there at the only instant.
    """

    subject: Subject
    driven: str
    ahead: bool
    where: str = ""
    lock: Lock = bool
    moving: bool = True

    @property
    def home(self) -> Inputs:
        """Inputs from which it starts; without a motion the drawing's own, so that only one input differs."""
        return self.subject.home if self.moving else self.subject.drawn

    @property
    def last(self) -> LastValue:
        """Where it ends."""
        return last_value(self.subject, self.driven, self.ahead, self.home)

    @property
    def room(self) -> float:
        """The largest overshoot, rad or mm: as far as angles have a meaning, or the range again."""
        if self.subject.kinds[self.driven] == "angle":
            return float(abs(Fraction(np.pi if self.ahead else 0.0) - self.last.value))
        return self.last.reach

    def beyond(self, _: Subject, overshoot: float) -> Content:
        """The scene that asks for an overshoot, in parts of the room."""
        goal = self.last.beyond(overshoot * self.room / self.last.reach)
        if self.subject.kinds[self.driven] == "angle":
            # All of the room ends at 0 or pi but for a rounding, which must not lead beyond.
            goal = min(max(goal, 0.0), np.pi)
        start = self.home[self.driven]
        way: Law = (start, goal - start) if self.moving else goal
        stop, samples = (1.0, 5) if self.moving else (0.0, 1)
        return self.subject.absolute({**self.home, self.driven: way}, stop=stop, samples=samples)


def refused(trial: Trial, facts: Mapping[str, float], judge: Callable[[FormulationError], Answer]) -> Trial:
    """The trial of what no solver can reach, each refusal judged; others find nothing to answer there."""
    if trial.scene is None:
        return trial

    def answer(one: Answer) -> Answer:
        came = trial.came[one.formulation]
        if isinstance(came, FormulationError):
            return judge(came)
        lost = "the overshoot was lost in rounding: there is a pose"
        return replace(one, outcome="unjudged", reason=lost) if one.outcome == "right" else one

    return Trial(trial.value, tuple(map(answer, trial.answers)), facts)


def _with_faults(refusal: FormulationError, faults: list[str], **sizes: float) -> Answer:
    """A refusal that is right if nothing is wrong with it."""
    reason = refusal.reason
    said, condition = "; ".join(faults) or " ".join(str(reason).split()), getattr(reason, "condition", None)
    return Answer(refusal.formulation, "wrong" if faults else "right", said, condition=condition, **sizes)


def _does_not_say(refusal: FormulationError) -> Answer:
    reason = refusal.reason
    said = f"does not say how far it came: {type(reason).__name__}: {reason}"
    return Answer(refusal.formulation, "wrong", said)


def judged(end: End, _: Subject, overshoot: float, trial: Trial) -> Trial:
    """The trial of a value beyond the end."""
    if (scene := trial.scene) is None:
        return trial
    facts = {"end [mm or rad]": float(end.last.value)}
    return refused(trial, facts, lambda refusal: refusal_held(refusal, scene, end))


def refusal_held(refusal: FormulationError, scene: Scene, end: End) -> Answer:
    """A refusal held to the true end."""
    reached: Inputs = getattr(refusal.reason, "reached", {})
    if end.driven not in reached:
        return _does_not_say(refusal)
    last, here = end.last, reached[end.driven]
    error, bound = float(abs(Fraction(here) - last.value)), SHARE * last.reach
    faults = [*_faults_of_words(refusal.reason, reached, end)]
    if error > bound:
        faults.insert(0, f"stops at {end.driven} = {here!r}, not {float(last.value)!r}")
    if end.moving and (fault := fault_of_kept(refusal, scene, float(last.value), end.driven)):
        faults.append(fault)
    return _with_faults(refusal, faults, error=error, bound=bound, share=error / bound)


def _faults_of_words(reason: Exception, reached: Inputs, end: End) -> Iterator[str]:
    """What an error does not say, or says wrongly."""
    driven, last = end.driven, end.last
    for other, held in end.home.items():
        # The held input takes no part; it comes back through a cosine and its inverse.
        if other != driven and abs(reached[other] - held) > SHARE * max(1.0, abs(held)):
            yield f"{other} is said to stop at {reached[other]!r}, and is held at {held!r}"
    wanted: Inputs = getattr(reason, "wanted", getattr(reason, "inputs", {}))
    outward = 1.0 if end.ahead else -1.0
    if not outward * (wanted[driven] - float(last.value)) > -SHARE * last.reach:
        yield f"the value asked for, {wanted[driven]!r}, lies before the end"
    for values in (wanted, reached) if isinstance(reason, AssemblyError) else (wanted,):
        # The models print ten or twelve digits.
        if not any(f"{driven} = {values[driven]:.{digits}g}" in str(reason) for digits in (10, 12)):
            yield f"the message does not hold {driven} = {values[driven]:.10g}"
    if isinstance(reason, AssemblyError):
        if reason.reduce != driven:
            yield f"{reason.reduce!r} is to be reduced, and {driven!r} was driven"
        if not end.lock(reason.limits):
            yield f"what limits it is not what lies in line: {', '.join(reason.limits[:3])}"


def fault_of_kept(refusal: FormulationError, scene: Scene, end: float, driven: str) -> str:
    """What is wrong with the motion that a refusal keeps; nothing if it is right.

    It must hold every instant before the end, and every point of each within what is claimed of it, and the
    rounding of the reference to doubles.

    Args:
        end: last value of the driven input.
    """
    values = rates(scene.inputs[driven], scene.instants)[:, 0]
    before = scene.instants[np.abs(values - values[0]) < abs(end - values[0])]
    partial = refusal.partial
    if partial is None:
        return "the motion up to there is not kept" if len(before) else ""
    if len(partial.times) != len(before):
        return f"{len(partial.times)} instants are kept, and {len(before)} lie before the end"
    claims = partial.accuracy.claims["position"]
    for index, time in enumerate(before.tolist()):
        try:
            reference = reference_instant(scene, inputs_at(scene, time))
        except NoReferenceError as error:
            return f"the kept instant {index} has no reference: {error}"
        for name, places in partial.position.items():
            true = reference.position_as_float(name)
            off = np.abs(places[index] - true)
            if not (off <= claims[name][index] + EPS * np.abs(true)).all():
                return f"{name} of the kept instant {index} is off by {off.max():.3g} mm"
    return ""


_beyond = partial(case, group="Reachable range", beyond=True)
WHOLE = {"angle": "the way from the end to the upright arm", "turn": "its range"}


def driven_beyond(end: End, name: str, values: Values) -> Case:
    """The case of an input driven beyond its end, or there at the first instant."""
    kind = end.subject.kinds[end.driven]
    first = "" if end.moving else ", and the first instant lies beyond"
    return _beyond(
        end.beyond,
        f"overshoot beyond the last value, in parts of {WHOLE.get(kind, f'the range of {end.driven}')}",
        values,
        subject=end.subject,
        name=f"{'reach' if end.moving else 'start-beyond'}-{name}",
        suffix="",
        why=f"{end.where}{first}; beyond it there is no pose, and at it two assemblies meet.",
        judged=partial(judged, end),
        unit=end.subject.units[end.driven],
    )


# Both inputs at once: the way from the drawing to a first instant is blocked.
ARM_AT = 1.3  # rad: where the arm is to be, besides the rack beyond its end


def goal(overshoot: float, subject: Subject = PAPER) -> dict[str, float]:
    """An arm angle well inside its range, and a rack travel beyond what it can be at any such angle."""
    return {"arm_angle": ARM_AT, "rack": last_value(subject, "rack", True).beyond(0.5 + overshoot)}


def both(subject: Subject, overshoot: float) -> Content:
    """Arm and rack go from the drawing to the first instant together, and lock on the way."""
    return subject.absolute(goal(overshoot, subject))


def moved_on(
    name: str, here: Inputs, end: Inputs, share: float, subject: Subject = PAPER
) -> dict[str, float | Fraction]:
    """The inputs a share of the whole way further on, on the way that a model takes to the end."""
    start, (to, back) = subject.drawn, _straight_in(name)
    rack = Fraction(here["rack"]) + Fraction(share) * (Fraction(end["rack"]) - Fraction(start["rack"]))
    arm = to(here["arm_angle"]) + share * (to(end["arm_angle"]) - to(start["arm_angle"]))
    return {"arm_angle": back(arm), "rack": rack}


def _straight_in(name: str) -> tuple[Callable[[float], float], Callable[[float], float]]:
    """What a model's way is straight in, as a function of the arm angle, and back."""
    return (float, float) if name in ("absolute", "relative") else (math.cos, math.acos)


def blocked_held(refusal: FormulationError, end: Inputs, subject: Subject = PAPER) -> Answer:
    """Whether a refusal names the place where its own way ends."""
    name, here = refusal.formulation, getattr(refusal.reason, "reached", {})
    if set(here) < {"arm_angle", "rack"}:
        return _does_not_say(refusal)
    # How far along the way the arm is, and how far the rack: equal if the place lies on it.
    start, (to, _) = subject.drawn, _straight_in(name)
    arm, end_of_arm = (to(inputs["arm_angle"]) - to(start["arm_angle"]) for inputs in (here, end))
    arm, rack = arm / end_of_arm, (here["rack"] - start["rack"]) / (end["rack"] - start["rack"])
    faults = []
    if abs(arm - rack) > SHARE:
        faults.append(f"what is reached is not on the way: the arm at {arm!r} of it, the rack at {rack!r}")
    if not reachable(subject, moved_on(name, here, end, -SHARE, subject)):
        faults.append("there is no pose just before what is reached")
    if reachable(subject, moved_on(name, here, end, SHARE, subject)):
        faults.append("there is a pose just beyond what is reached")
    return _with_faults(refusal, faults)


def blocked(subject: Subject, overshoot: float, trial: Trial) -> Trial:
    """The trial of a first instant beyond what both inputs can reach together."""
    end = goal(overshoot, subject)
    return refused(trial, {}, lambda refusal: blocked_held(refusal, end, subject))


def heave_has_no_end(subject: Subject, value: float) -> Content:
    """The chassis carries all points, so heave alone has no last value; only digits are lost.

    Heave takes no part in any constraint: it is added to what was solved, the drawing itself.
    """
    return subject.content(heave=(0.0, 1.0 / value), stop=1.0)


CASES = (
    *(
        _beyond(
            both,
            "rack travel beyond one and a half of its range, in parts of it",
            values,
            subject=subject,
            name="start-beyond-both",
            judged=blocked,
        )
        for subject, values in ((PAPER, (1.0, 1e-6, 1e-12)), (NAMED["wishbone"], (1.0, 1e-12)))
    ),
    *family(heave_has_no_end, "1 mm over the heave", decades(), subjects=HEAVING, group="Reachable range"),
)
