"""Inputs that are very fast, very slow, very long or not smooth."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import partial
from typing import Any

import numpy as np

from validate.formulations.input_rates import rates
from validate.hard.case import RIGHT, RIGHT_OR_REFUSED, Case, Expected, Trial, decades
from validate.hard.family import SOLVERS, Content, Subject, family, moved_by
from validate.hard.trial import Facts, Tried

GROUP = "Laws of the inputs"
OURS = dict.fromkeys(SOLVERS, RIGHT)
# A motion by series may take too many of them, or need steps below the rounding of time, and has to say
# so; solving at its instants needs no steps.
BY_STEPS = OURS | {"pointcoord": RIGHT_OR_REFUSED}
# Values of a table are rounded by 2e-16 rad, which within a jump of time h is an acceleration of 2e-16 / h^2.
# A step of a tenth of h about t = 0.5 s, known to 1e-16 s, keeps nine digits of itself down to h = 1e-6 s.
JUMP = BY_STEPS | {"pointcoord": Expected(("right", "refused"), right_from=1e-6)}
TURN = 2.0 * math.pi


def _scaled(subject: Subject, rate: float) -> Content:
    """The same way at any rate of an angle, rad/s, within its own time."""
    return subject.content([-0.1, rate], [0.0, 100.0 * rate], stop=0.2 / rate)


def _long_sine(subject: Subject, duration: float) -> Content:
    """One swing a second."""
    swing = {"amplitude": 0.2, "angular_frequency": TURN}
    other = {"amplitude": 30.0, "angular_frequency": 1.5 * TURN, "phase": 0.3}
    return subject.content({"sine": swing}, {"sine": other}, stop=duration, samples=4)


def _phase(subject: Subject, turns: float) -> Content:
    wave = {"amplitude": 0.2, "angular_frequency": TURN, "phase": TURN * turns + 0.3}
    if "rad" in subject.units.values():
        return subject.content({"sine": wave}, [0.0, 20.0], stop=0.5)
    return subject.content(mm={"sine": wave | {"amplitude": 20.0}}, stop=0.5)


# 16 t^2 (1 - t)^2: from rest to 1 and back to rest in a second.
STOPPING = (0.0, 0.0, 16.0, -32.0, 16.0)


def _at_rest(size: float = 1.0) -> tuple[list[float], list[float]]:
    """That way of an angle and of a length, of some size."""
    return [0.2 * size * c for c in STOPPING], [30.0 * size * c for c in STOPPING]


def _starting(subject: Subject, value: float) -> Content:
    return subject.content(*_at_rest(), start=0.0, stop=value)


def _stopping(subject: Subject, value: float) -> Content:
    return subject.content(*_at_rest(), start=1.0 - value, stop=1.0)


def _seen_at_rest(subject: Subject, size: float) -> Content:
    """The three instants are those where the rates are zero."""
    return subject.content(*_at_rest(size), stop=1.0)


def rate_rounding(tried: Tried) -> Facts:
    """What a rate of the last input is off in doubles, where the reference takes it; 0 is no error."""
    part, instants = list(tried.scene.inputs.values())[-1], tried.scene.instants
    slope = [k * Fraction(c) for k, c in enumerate(part.polynomial or ())][1:]
    given = rates(part, instants)[:, 1]
    worst = max(
        abs(Fraction(rate) - sum((c * Fraction(t) ** k for k, c in enumerate(slope)), Fraction(0)))
        for t, rate in zip(instants.tolist(), given.tolist(), strict=True)
    )
    return {"rounding of a rate": float(worst), "largest rate": float(np.abs(given).max())}


# Up, down and up again, with a sharp bend of the acceleration at each inner time.
KNOTS = (0.0, 0.2, 0.4, 0.5, 0.7, 1.0)
BENDS = (0.0, 1.0, -1.0, 1.0, -0.5, 0.0)


def _table(times: Sequence[float], values: Sequence[float]) -> dict[str, Any]:
    return {"table": {"times": list(times), "values": list(values)}}


def _about_a_kink(subject: Subject, value: float) -> Content:
    laws = (_table(KNOTS, [size * bend for bend in BENDS]) for size in (0.1, 20.0))
    return subject.content(*laws, start=0.4 - value, stop=0.4 + value)


def _close_knots(subject: Subject, value: float) -> Content:
    """A smooth way through two times that are close together: only rounding lies between their values."""
    times = (0.0, 0.2, 0.5, 0.5 + value, 0.8, 1.0)
    laws = (_table(times, [size * math.sin(3.0 * t) for t in times]) for size in (0.1, 20.0))
    return subject.content(*laws, stop=1.0, samples=5)


def _jerk(subject: Subject, value: float) -> Content:
    """A jump within this time, of the first input alone: acceleration bends up and down again."""
    times, first = (0.0, 0.2, 0.5, 0.5 + value, 0.8, 1.0), next(iter(subject.units))
    step = 0.01 if subject.units[first] == "rad" else 1.0
    jump = moved_by(_table(times, [step if t > 0.5 else 0.0 for t in times]), subject.home[first])
    whole = subject.content(0.0, [0.0, 20.0], start=0.5 - 0.5 * value, stop=0.5 + 1.5 * value, samples=5)
    return {**whole, "inputs": {**whole["inputs"], first: jump}}


def law_cases(
    name: str,
    why: str,
    parameter: str,
    values: tuple[float, ...],
    scene: Callable[[Subject, float], Content],
    behaviour: str = "right within the bound",
    expected: Mapping[str, Expected] = OURS,
    **options: Any,
) -> tuple[Case, ...]:
    """A case of this group for every mechanism; see `family`."""
    return family(
        name=name,
        group=GROUP,
        why=why,
        parameter=parameter,
        values=values,
        scene=scene,
        behaviour=behaviour,
        expected=expected,
        **options,
    )


def told_as_rough(trial: Trial, driven: str) -> Trial:
    """The trial with every refusal wrong that does not name the input as what the series cannot follow.

    The mechanism is nowhere near a singular pose, and must not be given as the reason.
    """
    expected = f"MotionTooRough: input '{driven}'"
    answers = tuple(
        replace(a, outcome="wrong", reason=f"refused for another reason: {a.reason}")
        if a.outcome == "refused" and (not a.reason.startswith(expected) or "singular" in a.reason)
        else a
        for a in trial.answers
    )
    return replace(trial, answers=answers)


def _jump_cases() -> Iterator[Case]:
    for case in law_cases(
        "jump-of-a-table",
        "an input moves within a very short time: accelerations grow as its inverse square",
        "time of the jump, s",
        decades(-12, -1),
        _jerk,
        "by series right, or refused as too rough, the input named; at its instants right",
        JUMP,
    ):
        yield replace(case, examine=partial(_told_as_rough_by, case))


def _told_as_rough_by(case: Case, value: float) -> Trial:
    assert case.content is not None  # a family's cases are scenes
    return told_as_rough(case.examine(value), next(iter(case.content(value)["inputs"])))


ARM_RATE = "rate of the arm, rad/s"
CASES: tuple[Case, ...] = (
    *law_cases(
        "slow-inputs",
        "the same way in ever longer time: rates lie far below the lengths",
        ARM_RATE,
        decades(-12, 0),
        _scaled,
    ),
    *law_cases(
        "fast-inputs",
        "the same way in ever shorter time: rates and their squares lie far above the lengths",
        ARM_RATE,
        decades(0, 12)[::-1],
        _scaled,
    ),
    *law_cases(
        "long-sine",
        "a swing a second for ever longer: a motion by series needs some segments for each swing",
        "duration, s",
        (1.0, 1e3, 1e6),  # few: each refusal takes two thousand segments
        _long_sine,
        "by series right, or refused as too long; at its instants right",
        BY_STEPS,
        second=(1e3,),
        others=(1.0,),
        also_answered=(1e2,),  # few enough swings for any solver
    ),
    *law_cases(
        "phase-of-many-turns",
        "added to the angle, a large phase would swallow the digits of time",
        "turns in the phase of a sine",
        decades(0, 12)[::-1],
        _phase,
    ),
    *law_cases(
        "start-from-rest",
        "the inputs start from rest: rates tend to zero, accelerations do not",
        "time since the start, s",
        decades(-12, -1),
        _starting,
    ),
    *law_cases(
        "come-to-rest",
        "the inputs come to rest: rates tend to zero as a difference of large terms",
        "time to the end, s",
        decades(-12, -1),
        _stopping,
        measure=rate_rounding,
    ),
    *law_cases(
        "seen-at-rest-only",
        "every instant of the scene is one where the inputs rest for a moment, between which they move",
        "size of the motion: 0.2 rad and 30 mm times this",
        decades(-12, 0),
        _seen_at_rest,
    ),
    *law_cases(
        "kink-of-a-table",
        "the third derivative jumps at a time of a spline",
        "time before and after the kink, s",
        decades(-12, -1),
        _about_a_kink,
    ),
    *law_cases(
        "close-times-of-a-table",
        "two times of a spline lie close together: rounding of their values is divided by their distance",
        "distance of the times, s",
        decades(-12, -1),
        _close_knots,
    ),
    *_jump_cases(),
)
