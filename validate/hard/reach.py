"""The ends of inputs: the last values that can be reached, and refusals compared with them.

An end is a fold, at which the reference proves that a path cannot continue. To find it, the mechanism is
redrawn at the values of the other inputs, to many digits. The reference then drives the one input beyond the
end that pointcoord finds.

There is no pose beyond the end. So a formulation is `right` there if it refuses the motion and its error
gives: the last value to 1e-9 of the input's range, the input and the value asked for, the motion up to the
end with right positions, and, for pointcoord, the links that lie in line.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np

from pointcoord import AssemblyError, Scene
from pointcoord.drawing_stands import End as SeenEnd
from pointcoord.drawing_stands import reach_of
from validate.cars.car import Law
from validate.formulations.input_rates import rates
from validate.formulations.protocol import FormulationError
from validate.formulations.reference_solution import reference_instant, reference_solution
from validate.hard.answer import Answer, Outcome, Trial, judged_answer
from validate.hard.case import Setup
from validate.hard.subjects import Content, Subject, drawn_at
from validate.plain_text import named
from validate.reference import Design, InfeasibleError
from validate.reference.exact import as_fraction
from validate.reference.route import CLEAR, reached

FIRST = 5  # the links that lie in line are among so many that an error names first
NEAR = 1e-6  # largest error of pointcoord's end, as a share of the range
BEYOND = 1e-3  # how far beyond pointcoord's end the reference is driven, as a share of the range
SHARE = 1e-9  # accuracy of the end that a refusal gives, as a share of the range


@dataclass(frozen=True)
class LastValue:
    """One end of an input, with the other inputs held.

    Attributes:
        value: the end, rad or mm; poses exist up to this value.
        reach: distance from this end to the opposite end, rad or mm.
        ahead: whether it is the upper end.
    """

    value: Fraction
    reach: float
    ahead: bool

    def beyond(self, share: float) -> float:
        """The value beyond this end by a share of the reach, rad or mm; before it for a negative share."""
        return float(self.value + (1 if self.ahead else -1) * Fraction(share) * Fraction(self.reach))


@cache
def last_value(subject: Subject, driven: str, ahead: bool, held: tuple[float, ...] = ()) -> LastValue:
    """The end of an input.

    Args:
        ahead: whether the upper end is wanted.
        held: value of each input within its range, from which this input is driven; `home` if not given.
    Raises:
        ValueError: the reference finds no end near pointcoord's end.
    """
    held = held or tuple(subject.home.values())
    low, high = _seen(subject, driven, held)
    reach, seen = high.value - low.value, Fraction((low, high)[ahead].value)
    inputs: dict[str, Any] = dict(zip(subject.driven, held, strict=True))
    # Redrawn at the pose of the held inputs, to many digits, so that one input alone leads from there to its
    # end.
    plain = subject.plain
    if inputs != subject.drawn:
        pose = reference_instant(subject.scene, {name: (value, 0, 0) for name, value in inputs.items()})
        plain["points"] = {name: pose.position[name] for name in plain["points"]}
    design = Design.from_plain(plain)
    inputs[driven] = seen + Fraction(BEYOND * (reach if ahead else -reach))
    try:
        reached(design, CLEAR, design.driven({name: (value, 0, 0) for name, value in inputs.items()}))
    except InfeasibleError as fold:
        end = as_fraction(fold.inputs[driven], driven)
        if abs(end - seen) <= Fraction(NEAR * reach):
            return LastValue(end, reach, ahead)
    raise ValueError(f"{driven} of {subject.name!r} has no end near {float(seen)!r}")


def ends_of(subject: Subject) -> tuple[tuple[str, bool], ...]:
    """The ends of a mechanism's inputs, with the others as drawn: the input, and whether it is the upper end.

    Inputs of the kind `turn` are left out: they have no end, or end where something else locks.
    """
    return tuple(
        (name, bool(ahead))
        for name in subject.driven
        if subject.inputs[name].kind != "turn"
        for ahead, end in enumerate(_seen(subject, name, tuple(subject.drawn.values())))
        if end.limits
    )


@cache
def _seen(subject: Subject, driven: str, held: tuple[float, ...]) -> tuple[SeenEnd, SeenEnd]:
    """Both ends of an input as pointcoord finds them, with the other inputs held at these values."""
    inputs = dict(zip(subject.driven, held, strict=True))
    there = subject.car if inputs == subject.drawn else drawn_at(subject.car, inputs)
    return reach_of(Scene.from_mapping(subject.absolute(inputs, there)), driven)


@dataclass(frozen=True)
class End:
    """An end of an input.

    Attributes:
        ahead: whether it is the upper end.
        where: what happens there, in words.
        links: links that lie in line there; if not given, an error may name any link.
        moving: whether the input moves towards the end within 1 s; otherwise there is only one instant.
    """

    subject: Subject
    driven: str
    ahead: bool
    where: str = ""
    links: tuple[str, ...] = ()
    moving: bool = True

    @property
    def start(self) -> Mapping[str, float]:
        """The inputs from which the end is passed; without a motion the drawn ones, so that one differs."""
        return self.subject.home if self.moving else self.subject.drawn

    @property
    def last(self) -> LastValue:
        """The true last value."""
        return last_value(self.subject, self.driven, self.ahead, tuple(self.start.values()))

    def near(self, _: Subject, value: float) -> Content:
        """The scene of an input held short of its end, or moving there from the middle of its range."""
        last = last_value(self.subject, self.driven, self.ahead)
        goal, middle = last.beyond(-value), last.beyond(-0.5)
        way: Law = [middle, goal - middle] if self.moving else goal
        inputs = {**self.subject.home, self.driven: way}
        return self.subject.absolute(inputs, stop=1.0 if self.moving else None)

    def beyond(self, _: Subject, overshoot: float) -> Setup:
        """The scene that drives the input beyond its end by a share of its range, an arm to 0 or pi."""
        last, start = self.last, self.start[self.driven]
        goal = last.beyond(overshoot)
        if self.subject.inputs[self.driven].kind == "arm":
            room = float(abs(Fraction(np.pi if self.ahead else 0.0) - last.value))
            # The whole room ends at 0 or pi, and rounding must not lead beyond.
            goal = min(max(last.beyond(overshoot * room / last.reach), 0.0), np.pi)
        way: Law = (start, goal - start) if self.moving else goal
        stop, samples = (1.0, 5) if self.moving else (0.0, 1)
        content = self.subject.absolute({**self.start, self.driven: way}, stop=stop, samples=samples)
        return Setup(content, {"end [mm or rad]": float(last.value)}, self.judge)

    def judge(self, trial: Trial, answer: Answer) -> Answer:
        """Compare a refusal with the true end; an answer that the reference confirms is unjudged."""
        came, scene = trial.came.get(answer.formulation), trial.scene
        if scene is None or not isinstance(came, FormulationError):
            lost = "rounding removed the overshoot: there is a pose"
            return replace(answer, outcome="unjudged", reason=lost) if answer.outcome == "right" else answer
        faults = "; ".join(self._faults(came, scene))
        outcome: Outcome = "wrong" if faults else "right"
        words, condition = " ".join(str(came.reason).split()), getattr(came.reason, "condition", None)
        judged = replace(answer, outcome=outcome, reason=faults or words, condition=condition)
        if (stop := getattr(came.reason, "reached", {}).get(self.driven)) is None:
            return judged
        error, bound = float(abs(Fraction(stop) - self.last.value)), SHARE * self.last.reach
        return replace(judged, error=error, bound=bound, share=error / bound)

    def _faults(self, refusal: FormulationError, scene: Scene) -> Iterator[str]:
        """What a refusal does not state, or states wrongly; and the fault of the motion that it keeps."""
        reason: Any = refusal.reason
        driven, last, reached = self.driven, self.last, getattr(reason, "reached", {})
        if driven not in reached:
            yield f"does not say how far it came: {named(reason)}"
            return
        if abs(Fraction(reached[driven]) - last.value) > SHARE * last.reach:
            yield f"stops at {driven} = {reached[driven]!r}, not {float(last.value)!r}"
        for other, held in self.start.items():
            # A held input does not move; its value is computed back through a cosine and its inverse.
            if other != driven and abs(reached[other] - held) > SHARE * max(1.0, abs(held)):
                yield f"the error gives {other} = {reached[other]!r} at the end, but it is held at {held!r}"
        wanted = getattr(reason, "wanted", getattr(reason, "inputs", {}))
        if (wanted[driven] - float(last.value)) * (1.0 if self.ahead else -1.0) <= -SHARE * last.reach:
            yield f"the value asked for, {wanted[driven]!r}, lies before the end"
        of_pointcoord = isinstance(reason, AssemblyError)
        for values in (wanted, reached) if of_pointcoord else (wanted,):
            # The models print ten or twelve digits.
            if not any(f"{driven} = {values[driven]:.{digits}g}" in str(reason) for digits in (10, 12)):
                yield f"the message does not contain {driven} = {values[driven]:.10g}"
        if of_pointcoord and reason.reduce != driven:
            yield f"the error advises to reduce {reason.reduce!r}, but {driven!r} was driven"
        if of_pointcoord and not (reason.limits and {*self.links} <= {*reason.limits[:FIRST]}):
            yield f"the links named are not those that lie in line: {', '.join(reason.limits[:3])}"
        if self.moving and (fault := fault_of_kept(refusal, scene, float(last.value), driven)):
            yield fault


def fault_of_kept(refusal: FormulationError, scene: Scene, end: float, driven: str) -> str:
    """The fault of the motion that a refusal keeps; empty if there is none.

    The kept motion must have every instant before the end of the driven input, with right numbers.
    """
    values = rates(scene.inputs[driven], scene.instants)[:, 0]
    before = scene.instants[np.abs(values - values[0]) < abs(end - values[0])]
    kept = refusal.partial
    if kept is None or len(kept.times) != len(before):
        return f"{len(kept.times) if kept else 0} instants are kept, and {len(before)} lie before the end"
    time = scene.time.model_copy(update={"stop": float(before[-1]), "samples": len(before)})
    there = scene.model_copy(update={"time": time})
    answer = judged_answer(there, kept, reference_solution(there, exact_sides=True))
    return "" if answer.outcome == "right" else f"of the kept motion: {answer.reason}"
