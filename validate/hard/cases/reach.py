"""Inputs driven to their last values and beyond: each refusal is held to the true end.

Nothing is assembled beyond the end, so a formulation is `right` here when it refuses the motion and says what
it must: the last value to 1e-9 of the input's range, which input and value were asked for, the motion up to
there with right instants, and (pointcoord) the links that lie in line.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np

from pointcoord import AssemblyError, Scene
from pointcoord.numerics.rounding import EPS
from validate.cars.car import Law
from validate.formulations.input_rates import rates
from validate.formulations.protocol import FormulationError
from validate.formulations.reference_solution import inputs_at, reference_instant
from validate.hard.answer import Answer, Trial
from validate.hard.case import Case, Values, family
from validate.hard.last_values import LastValue, last_value
from validate.hard.subjects import Content, Subject
from validate.reference import NoReferenceError

SHARE = 1e-9  # of the range, or of the way: how exactly its end must be found
Inputs = Mapping[str, float]
Lock = Callable[[tuple[str, ...]], bool]
"""Whether the links that limit a motion, the strongest first, are those that lie in line."""


@dataclass(frozen=True)
class End:
    """An end of an input.

    Attributes:
        ahead: whether the upper one.
        where: what happens there, in words.
        lock: what lies in line there, as pointcoord names it; anything if not given.
        moving: whether the input moves towards it within 1 s; else there is one instant only.
    """

    subject: Subject
    driven: str
    ahead: bool
    where: str = ""
    lock: Lock = bool
    moving: bool = True

    @property
    def start(self) -> Inputs:
        """Inputs from which it is passed; without a motion the drawing's, so that only one input differs."""
        return self.subject.home if self.moving else self.subject.drawn

    @property
    def last(self) -> LastValue:
        """Where it ends."""
        return last_value(self.subject, self.driven, self.ahead, self.start)

    def near(self, _: Subject, value: float) -> Content:
        """The scene of an input held short of its end, or moving from amid its range to there."""
        last = last_value(self.subject, self.driven, self.ahead)
        goal, middle = last.beyond(-value), last.beyond(-0.5)
        way: Law = [middle, goal - middle] if self.moving else goal
        inputs = {**self.subject.home, self.driven: way}
        return self.subject.absolute(inputs, stop=1.0 if self.moving else None)

    def beyond(self, _: Subject, overshoot: float) -> Content:
        """The scene that asks for an overshoot, in parts of the range, or as far as angles have a meaning."""
        last, start = self.last, self.start[self.driven]
        goal = last.beyond(overshoot)
        if self.subject.is_a("arm", self.driven):
            room = float(abs(Fraction(np.pi if self.ahead else 0.0) - last.value))
            # All of the room ends at 0 or pi but for a rounding, which must not lead beyond.
            goal = min(max(last.beyond(overshoot * room / last.reach), 0.0), np.pi)
        way: Law = (start, goal - start) if self.moving else goal
        stop, samples = (1.0, 5) if self.moving else (0.0, 1)
        return self.subject.absolute({**self.start, self.driven: way}, stop=stop, samples=samples)

    def judge(self, _: Subject, overshoot: float, trial: Trial, answer: Answer) -> Answer:
        """An answer beyond the end, a refusal held to it; others find nothing to answer there."""
        came = trial.came.get(answer.formulation)
        if trial.scene is not None and isinstance(came, FormulationError):
            return refusal_held(came, trial.scene, self)
        lost = "the overshoot was lost in rounding: there is a pose"
        return replace(answer, outcome="unjudged", reason=lost) if answer.outcome == "right" else answer

    def driven_beyond(self, cases: list[Case], name: str, values: Values) -> None:
        """Add the case of an input driven beyond its end, or there at the first instant."""
        subject, driven = self.subject, self.driven
        whole = "its range" if subject.is_a("turn", driven) else f"the range of {driven}"
        whole = "the way from the end to the upright arm" if subject.is_a("arm", driven) else whole
        first = "" if self.moving else ", and the first instant lies beyond"
        family(
            *(cases, "Reachable range", f"overshoot beyond the last value, in parts of {whole}", values),
            subjects=[subject],
            name=f"{'reach' if self.moving else 'start-beyond'}-{name}",
            suffix="",
            why=f"{self.where}{first}; beyond it there is no pose, and at it two assemblies meet.",
            judge=self.judge,
            facts=lambda *_: {"end [mm or rad]": float(self.last.value)},
            unit=subject.units[driven],
            beyond=True,
        )(self.beyond)


def refusal_held(refusal: FormulationError, scene: Scene, end: End) -> Answer:
    """A refusal held to the true end: right if nothing is wrong with it."""
    reason: Any = refusal.reason
    reached: Inputs = getattr(reason, "reached", {})
    sizes = dict[str, float]()
    if end.driven in reached:
        last = end.last
        error, bound = float(abs(Fraction(reached[end.driven]) - last.value)), SHARE * last.reach
        sizes = {"error": error, "bound": bound, "share": error / bound}
        stops = f"stops at {end.driven} = {reached[end.driven]!r}, not {float(last.value)!r}"
        kept = fault_of_kept(refusal, scene, float(last.value), end.driven) if end.moving else ""
        faults = (
            [stops] * (error > bound) + list(_faults_of_words(reason, reached, end)) + [kept] * bool(kept)
        )
    else:
        faults = [f"does not say how far it came: {type(reason).__name__}: {reason}"]
    told, condition = "; ".join(faults) or " ".join(str(reason).split()), getattr(reason, "condition", None)
    return Answer(refusal.formulation, "wrong" if faults else "right", told, condition=condition, **sizes)


def _faults_of_words(reason: Any, reached: Inputs, end: End) -> Iterator[str]:
    """What an error does not say, or says wrongly."""
    driven, last = end.driven, end.last
    wanted: Inputs = getattr(reason, "wanted", getattr(reason, "inputs", {}))
    for other, held in end.start.items():
        # The held input takes no part; it comes back through a cosine and its inverse.
        if other != driven and abs(reached[other] - held) > SHARE * max(1.0, abs(held)):
            yield f"{other} is said to stop at {reached[other]!r}, and is held at {held!r}"
    if (wanted[driven] - float(last.value)) * (1.0 if end.ahead else -1.0) <= -SHARE * last.reach:
        yield f"the value asked for, {wanted[driven]!r}, lies before the end"
    of_pointcoord = isinstance(reason, AssemblyError)
    for values in (wanted, reached) if of_pointcoord else (wanted,):
        # The models print ten or twelve digits.
        if not any(f"{driven} = {values[driven]:.{digits}g}" in str(reason) for digits in (10, 12)):
            yield f"the message does not hold {driven} = {values[driven]:.10g}"
    if of_pointcoord and reason.reduce != driven:
        yield f"{reason.reduce!r} is to be reduced, and {driven!r} was driven"
    if of_pointcoord and not end.lock(reason.limits):
        yield f"what limits it is not what lies in line: {', '.join(reason.limits[:3])}"


def fault_of_kept(refusal: FormulationError, scene: Scene, end: float, driven: str) -> str:
    """What is wrong with the motion that a refusal keeps; nothing if it is right.

    It must hold every instant before the end, the last value of the driven input, and every point of each
    within what is claimed of it and the rounding of the reference to doubles.
    """
    values = rates(scene.inputs[driven], scene.instants)[:, 0]
    before = scene.instants[np.abs(values - values[0]) < abs(end - values[0])]
    kept = refusal.partial
    if kept is None:
        return "the motion up to there is not kept" if len(before) else ""
    if len(kept.times) != len(before):
        return f"{len(kept.times)} instants are kept, and {len(before)} lie before the end"
    for index, time in enumerate(before.tolist()):
        try:
            reference = reference_instant(scene, inputs_at(scene, time))
        except NoReferenceError as error:
            return f"the kept instant {index} has no reference: {error}"
        for name, places in kept.position.items():
            true = reference.position_as_float(name)
            off = np.abs(places[index] - true)
            if not (off <= kept.accuracy.claims["position"][name][index] + EPS * np.abs(true)).all():
                return f"{name} of the kept instant {index} is off by {off.max():.3g} mm"
    return ""
