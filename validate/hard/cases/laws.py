"""Inputs that are very fast, very slow, very long, not smooth, or small beside the terms they are made of.

Where terms all but cancel, the input itself is an ordinary one. The reference, and the absolute model, take
each law in many digits and round it once; pointcoord sums in twice the working precision and counts what that
may be off into its bound.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from pointcoord.numerics.rounding import UNIT_ROUNDOFF
from validate.cars.scene_content import Law
from validate.hard.case import RIGHT, RIGHT_OR_REFUSED, SOLVERS, Case, Expected, decades, family
from validate.hard.subjects import ALL, HEAVING, SUBJECTS, Content, Subject, hyphens, moved_by
from validate.hard.trial import Trial

OURS = dict.fromkeys(SOLVERS, RIGHT)
# A motion by series may take too many of them, or need steps below the rounding of time, and has to say
# so; solving at its instants needs no steps.
BY_STEPS = OURS | {"pointcoord": RIGHT_OR_REFUSED}
# Values of a table are rounded by 2e-16 rad, which within a jump of time h is an acceleration of 2e-16 / h^2.
# A step of a tenth of h about t = 0.5 s, known to 1e-16 s, keeps nine digits of itself down to h = 1e-6 s.
JUMP = BY_STEPS | {"pointcoord": Expected(("right", "refused"), right_from=1e-6)}
TURN = 2.0 * math.pi


def at_a_rate(subject: Subject, rate: float) -> Content:
    """The same way in another time."""
    return subject.content([-0.1, rate], [0.0, 100.0 * rate], stop=0.2 / rate)


def long_sine(subject: Subject, duration: float) -> Content:
    """A swing a second for ever longer: a motion by series needs some segments for each swing."""
    swing = {"amplitude": 0.2, "angular_frequency": TURN}
    other = {"amplitude": 30.0, "angular_frequency": 1.5 * TURN, "phase": 0.3}
    return subject.content({"sine": swing}, {"sine": other}, stop=duration, samples=4)


def phase_of_many_turns(subject: Subject, turns: float) -> Content:
    """Added to the angle, a large phase would swallow the digits of time."""
    wave = {"amplitude": 0.2, "angular_frequency": TURN, "phase": TURN * turns + 0.3}
    if "rad" in subject.units.values():
        return subject.content({"sine": wave}, [0.0, 20.0], stop=0.5)
    return subject.content(mm={"sine": wave | {"amplitude": 20.0}}, stop=0.5)


def stopping(subject: Subject, start: float, stop: float, size: float = 1.0) -> Content:
    """Part of the way 16 t^2 (1 - t)^2, from rest to 1 and back to rest in a second, times some size."""
    laws = ([amount * size * c for c in (0.0, 0.0, 16.0, -32.0, 16.0)] for amount in (0.2, 30.0))
    return subject.content(*laws, start=start, stop=stop)


def start_from_rest(subject: Subject, value: float) -> Content:
    """The inputs start from rest: rates tend to zero, accelerations do not."""
    return stopping(subject, 0.0, value)


def come_to_rest(subject: Subject, value: float) -> Content:
    """The inputs come to rest: rates tend to zero as a difference of large terms."""
    return stopping(subject, 1.0 - value, 1.0)


def seen_at_rest_only(subject: Subject, size: float) -> Content:
    """Every instant of the scene is one where the inputs rest for a moment, between which they move."""
    return stopping(subject, 0.0, 1.0, size)


# Up, down and up again, with a sharp bend of the acceleration at each inner time.
KNOTS = (0.0, 0.2, 0.4, 0.5, 0.7, 1.0)
BENDS = (0.0, 1.0, -1.0, 1.0, -0.5, 0.0)


def _table(times: Sequence[float], values: Sequence[float]) -> dict[str, Any]:
    return {"table": {"times": list(times), "values": list(values)}}


def kink_of_a_table(subject: Subject, value: float) -> Content:
    """The third derivative jumps at a time of a spline."""
    laws = (_table(KNOTS, [size * bend for bend in BENDS]) for size in (0.1, 20.0))
    return subject.content(*laws, start=0.4 - value, stop=0.4 + value)


def close_times_of_a_table(subject: Subject, value: float) -> Content:
    """Two times of a spline lie close together: rounding of their values is divided by their distance."""
    times = (0.0, 0.2, 0.5, 0.5 + value, 0.8, 1.0)
    laws = (_table(times, [size * math.sin(3.0 * t) for t in times]) for size in (0.1, 20.0))
    return subject.content(*laws, stop=1.0, samples=5)


def jump_of_a_table(subject: Subject, value: float) -> Content:
    """An input moves within a very short time: accelerations grow as its inverse square."""
    times, first = (0.0, 0.2, 0.5, 0.5 + value, 0.8, 1.0), next(iter(subject.units))
    step = 0.01 if subject.units[first] == "rad" else 1.0
    jump = moved_by(_table(times, [step if t > 0.5 else 0.0 for t in times]), subject.home[first])
    content = subject.content(0.0, [0.0, 20.0], start=0.5 - 0.5 * value, stop=0.5 + 1.5 * value, samples=5)
    return {**content, "inputs": {**content["inputs"], first: jump}}


def told_as_rough(subject: Subject, value: float, trial: Trial) -> Trial:
    """The trial with every refusal wrong that does not name the first input as what the series cannot follow.

    The mechanism is nowhere near a singular pose, and must not be given as the reason.
    """
    expected = f"MotionTooRough: input '{next(iter(subject.kinds))}'"
    answers = tuple(
        replace(a, outcome="wrong", reason=f"refused for another reason: {a.reason}")
        if a.outcome == "refused" and (not a.reason.startswith(expected) or "singular" in a.reason)
        else a
        for a in trial.answers
    )
    return replace(trial, answers=answers)


def far_in_time(subject: Subject, start: float) -> Content:
    """Time itself has few digits left for the swing."""
    swings = ({"sine": {"amplitude": size, "angular_frequency": 1.0}} for size in (0.2, 20.0))
    return subject.content(*swings, start=start, stop=start + 1.0)


def only_heave(subject: Subject, value: float) -> Content:
    """The whole car moves while arm and rack rest: the knuckle must not turn."""
    wave = {"amplitude": 100.0 * value, "angular_frequency": 3.0}
    return subject.content(heave={"sine": wave}, stop=1.0)


def short_scene(start: float, subject: Subject, value: float) -> Content:
    """Every instant must stay inside a scene however short."""
    return subject.content([0.0, 0.3, 0.2], [0.0, 40.0, 5.0], start=start, stop=start + value, samples=4)


def to_a_tolerance(subject: Subject, value: float) -> Content:
    """A motion to some tolerance."""
    return subject.content([-0.1, 0.5], [0.0, 40.0], stop=0.4, tolerance=value)


# Sums whose terms all but cancel.
PHASE = 0.5  # rad: neither the sine nor its slope is near zero
AMPLITUDES = (1.0, 1e3, 1e6, 1e9)
# How far from home each input is while its swing passes, and how fast: rad or mm, per s.
ORDINARY: Mapping[str, tuple[float, float]] = {"rad": (0.0, 0.1), "mm": (10.0, 20.0)}


def _cancelling_sine(unit: str, value: float) -> Law:
    """An offset that all but cancels the swing at time 0, by the reciprocal of the amplitude."""
    (wanted, rate), amplitude = ORDINARY[unit], 1.0 / value
    wave = {
        "amplitude": amplitude,
        "angular_frequency": rate / (amplitude * math.cos(PHASE)),
        "phase": PHASE,
        "offset": wanted - amplitude * math.sin(PHASE),
    }
    return {"sine": wave}


def cancelling_sine(driven: str, subject: Subject, value: float) -> Content:
    """A large swing is all but cancelled by its offset, and what is left drives the input."""
    if driven == "heave":
        return subject.content(heave=_cancelling_sine("mm", value), stop=0.5)
    laws = (_cancelling_sine(unit, value) for unit in ORDINARY)
    return subject.content(*laws, only=driven, stop=0.5)


def expanded(power: int, start: float) -> list[float]:
    """Coefficients of 16 (t - start)^power, which doubles hold exactly for a start that is a power of two."""
    return [16.0 * math.comb(power, k) * (-start) ** (power - k) for k in range(power + 1)]


def cancelling_polynomial(power: int, subject: Subject, value: float) -> Content:
    """16 mm, or 1/8 rad, in the second after a late start, all terms as large as that is late."""
    start, last = 1.0 / value, list(subject.kinds)[-1]
    law = expanded(power, start)
    # A power of two keeps every coefficient exact.
    angle = [c / 128.0 for c in law]
    return subject.content(angle, law, only=last, start=start, stop=start + 1.0)


def right_from(power: int) -> float:
    """The reciprocal of the latest start at which twice the precision leaves the law its digits.

    The sum of n terms is off by 4 n^2 u^2 of their magnitudes (Graillat, Langlois, Louvet), which add up to
    16 (2 start)^power: that must stay below a rounding of 16 mm.
    """
    count = power + 1
    latest = 0.5 * (1.0 / (4.0 * count**2 * UNIT_ROUNDOFF)) ** (1.0 / power)
    return 2.0 ** -math.floor(math.log2(latest))


def _cancelling_polynomials(power: int) -> tuple[Case, ...]:
    ours = Expected(("right", "refused"), right_from(power))
    latest = 20  # the power of two at which a motion starts at the latest
    times = math.floor(math.log10(2.0 ** ((latest + 1) * power)))
    return _laws(
        partial(cancelling_polynomial, power),
        "1 s over the start of a motion of 1 s",
        tuple(2.0**-k for k in (2, 6, 10, 15, latest)),
        {"pointcoord": ours, "pointcoord-newton": ours, "absolute": RIGHT, "relative": RIGHT},
        name=f"cancelling-polynomial-{power}",
        why=f"16 (t - start)^{power}, multiplied out: terms up to 1e{times} times their sum.",
    )


def _long(subject: Subject) -> tuple[float, ...]:
    """Few, as each refusal takes two thousand segments."""
    return {"paper": (1.0, 1e3, 1e6), "wishbone": (1e3,)}.get(subject.name, (1.0,))


_laws = partial(family, group="Laws of the inputs")
_paced = partial(_laws, at_a_rate, "rate of the arm, rad/s")
_tolerated = partial(_laws, to_a_tolerance, "tolerance of the scene, mm")
RISING, FALLING, WITHIN = decades(0, 12)[::-1], decades(-12, 0), decades(-12, -1)
BY_75 = (1.0, 1e-75, 1e-150, 1e-225, 1e-300)
SLOW = "The same way in ever longer time: rates lie far below the lengths."
FAST = "The same way in ever shorter time: rates and their squares lie far above the lengths."

CASES = (
    *_paced(FALLING, name="slow-inputs", why=SLOW),
    *_paced(RISING, name="fast-inputs", why=FAST),
    # A hundred swings are few enough for any solver.
    *_laws(long_sine, "duration, s", _long, BY_STEPS, also_answered=(1e2,)),
    *_laws(phase_of_many_turns, "turns in the phase of a sine", RISING),
    *_laws(start_from_rest, "time since the start, s", WITHIN, subjects=ALL),
    *_laws(come_to_rest, "time to the end, s", WITHIN, subjects=ALL),
    *_laws(seen_at_rest_only, "size of the motion: 0.2 rad and 30 mm times this", FALLING),
    *_laws(kink_of_a_table, "time before and after the kink, s", WITHIN),
    *_laws(close_times_of_a_table, "distance of the times, s", WITHIN),
    *_laws(jump_of_a_table, "time of the jump, s", WITHIN, JUMP, judged=told_as_rough),
    *_laws(far_in_time, "start of a second of a sine, s", RISING),
    *_laws(only_heave, "amplitude of the heave, 100 mm", (*FALLING, 0.0), subjects=HEAVING),
    *_laws(partial(short_scene, 0.0), "duration, s", (*BY_75, 5e-324)),
    *_laws(
        partial(short_scene, 1.0),
        "duration after t = 1 s, s",
        (*decades(-15, -1), 2.0**-52),
        name="short-scene-late",
        why="A scene of a few roundings of its time.",
    ),
    *_tolerated(BY_75[1:], name="fine-tolerance", why="A tolerance below what rounding allows."),
    *_tolerated(
        tuple(1.0 / x for x in BY_75),
        OURS | {"pointcoord-as-asked": RIGHT},
        name="loose-tolerance",
        why="A tolerance above the size of the car.",
    ),
    *(
        case
        for driven in dict.fromkeys(name for subject in SUBJECTS for name in (*subject.kinds, "heave"))
        for case in _laws(
            partial(cancelling_sine, driven),
            "1 rad or 1 mm over the amplitude",
            tuple(1.0 / amplitude for amplitude in AMPLITUDES),
            subjects=HEAVING if driven == "heave" else [one for one in SUBJECTS if driven in one.kinds],
            name=f"cancelling-sine-{hyphens(driven)}",
        )
    ),
    *(case for power in (4, 6) for case in _cancelling_polynomials(power)),
)
