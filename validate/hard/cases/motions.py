"""Inputs that are very fast, very slow, very long, not smooth, or small compared with their terms.

Where terms nearly cancel, the input itself is an ordinary one. The reference and the absolute model evaluate
each law in many digits and round it once; pointcoord sums in twice the working precision and adds the error
of the sum to its error bound.

Body rates: the paper prints omega = v65 x v75 / (v65 . r75). As v = omega x r, the divisor is
omega . (r65 x r75). It is zero whenever omega lies in the plane of the knuckle's three points: while the arm
is held, and at one angle of the turning arm. pointcoord divides by the square of the vector product of the
two edges instead. Rates that are exactly zero must stay so.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from pointcoord import NotFollowed
from validate.cars.car import Law
from validate.hard.answer import Answer, Trial
from validate.hard.case import RIGHT, SOLVERS, Case, Setup, decades, family, right_from
from validate.hard.subjects import HEAVING, NAMED, PAPER, SUBJECTS, Content, Subject, hyphens, moved_by

CASES: list[Case] = []
_rates = partial(family, CASES, "Body rates")
_laws = partial(family, CASES, "Laws of the inputs")

PLANE_ANGLE = 1.760964175417552  # rad: arm angle at which omega lies in the knuckle's plane
SLOW = (1e-1, 1e-7, 0.0)


@_rates("rate of the arm while the rack is driven, rad/s; then the arm is held", SLOW, RIGHT, [PAPER])
def arm_all_but_held(subject: Subject, value: float) -> Content:
    """Two points of the knuckle hardly move while the rack moves: the paper's formula is nearly 0/0."""
    # The rate of the rack is that of the paper's steering scene.
    return subject.content([0.0, value], [0.0, 150.0, 25.0], stop=0.4)


@_rates("distance of the turning arm from the angle at which it does, rad; then at it", SLOW, RIGHT, [PAPER])
def omega_in_the_knuckle_plane(subject: Subject, value: float) -> Content:
    """Omega lies in the plane of the knuckle's points: the divisor of the paper's formula is zero."""
    return subject.absolute({**subject.home, "arm_angle": [PLANE_ANGLE + value, 1.0]})


def hardly_moves(driven: str, subject: Subject, rate: float) -> Content:
    """One input moves at this rate, all others are at rest."""
    return subject.absolute({**subject.home, driven: [subject.home[driven], rate]})


for driven, unit in {name: one.inputs[name].unit for one in SUBJECTS for name in one.driven}.items():
    label = driven.removesuffix("_angle")
    _rates(
        f"rate of the {label}, {unit}/s; then at rest",
        lambda _: (1e-25, 1e-175, 0.0),
        subjects=[one for one in SUBJECTS if driven in one.driven],
        name=f"{hyphens(label)}-hardly-moves",
        why=f"Only the {label} moves, very slowly: rates must keep their relative accuracy down to zero.",
    )(partial(hardly_moves, driven))


@_rates("arm angle from a right angle, rad; then at it", SLOW)
def at_rest(subject: Subject, value: float) -> Content:
    """All inputs are at rest, so every rate is zero: rounding must not produce a motion."""
    still = (
        [value, 0.0, 0.0],
        [20.0 if "arm_angle" in subject.home else value, 0.0],
        0.0 if "heave" in subject.inputs else None,
    )
    # The strut is turned about an oblique axis.
    return subject.content(*still, car=NAMED["other"].car if subject is PAPER else None, stop=1.0)


OURS = dict.fromkeys(SOLVERS, RIGHT)
TURN = 2.0 * math.pi
# The first, the middle and the last value.
RISING, FALLING, WITHIN = decades(0, 12)[::-2], decades(-12, 0)[::2], decades(-12, -1)[::2]


def at_a_rate(subject: Subject, rate: float) -> Content:
    """The same path of the inputs in another time."""
    return subject.content([-0.1, rate], [0.0, 100.0 * rate], stop=0.2 / rate)


for name, values, why in (
    ("slow", FALLING, "A motion gets ever slower: rates are far smaller than lengths."),
    ("fast", RISING, "A motion gets ever faster: rates and their squares are far larger than lengths."),
):
    _laws("rate of the arm, rad/s", values, name=f"{name}-inputs", why=why)(at_a_rate)


def stopping(subject: Subject, start: float, stop: float, size: float = 1.0) -> Content:
    """Part of the motion 16 t^2 (1 - t)^2, from rest to 1 and back to rest in one second, times a size."""
    laws = ([amount * size * c for c in (0.0, 0.0, 16.0, -32.0, 16.0)] for amount in (0.2, 30.0))
    return subject.content(*laws, start=start, stop=stop)


@_laws("time since the start, s", WITHIN)
def start_from_rest(subject: Subject, value: float) -> Content:
    """The inputs start from rest: rates tend to zero, accelerations do not."""
    return stopping(subject, 0.0, value)


@_laws("time to the end, s", WITHIN)
def come_to_rest(subject: Subject, value: float) -> Content:
    """The inputs come to rest: rates tend to zero as the difference of large terms."""
    return stopping(subject, 1.0 - value, 1.0)


@_laws("size of the motion: 0.2 rad and 30 mm times this", FALLING)
def seen_at_rest_only(subject: Subject, size: float) -> Content:
    """At every instant of the scene the inputs are momentarily at rest; between the instants they move."""
    return stopping(subject, 0.0, 1.0, size)


def sine(amplitude: float, angular_frequency: float = TURN, **more: float) -> Law:
    """The law of a sine."""
    return {"sine": {"amplitude": amplitude, "angular_frequency": angular_frequency, **more}}


@_laws("duration, s", lambda one: (1.0, 1e6) if one is PAPER else (1.0,))
def long_sine(subject: Subject, duration: float) -> Content:
    """One swing per second for a very long time: a motion by series needs several segments per swing."""
    return subject.content(sine(0.2), sine(30.0, 1.5 * TURN, phase=0.3), stop=duration, samples=4)


@_laws("turns in the phase of a sine", RISING)
def phase_of_many_turns(subject: Subject, turns: float) -> Content:
    """A large phase, added to the angle of a sine, would take the digits of the time."""
    phase = TURN * turns + 0.3
    if any(subject.inputs[name].unit == "rad" for name in subject.driven):
        return subject.content(sine(0.2, phase=phase), [0.0, 20.0], stop=0.5)
    return subject.content(mm=sine(20.0, phase=phase), stop=0.5)


@_laws("start of a second of a sine, s", RISING)
def far_in_time(subject: Subject, start: float) -> Content:
    """Late times have few digits left for the swing."""
    return subject.content(sine(0.2, 1.0), sine(20.0, 1.0), start=start, stop=start + 1.0)


@_laws("amplitude of the heave, 100 mm", (1.0, 1e-9, 0.0), RIGHT, HEAVING)
def only_heave(subject: Subject, value: float) -> Content:
    """The whole car moves while arm and rack are at rest: the knuckle must not turn."""
    return subject.content(heave=sine(100.0 * value, 3.0), stop=1.0)


def table(times: Sequence[float], values: Sequence[float]) -> dict[str, Any]:
    """The law of a spline through these values."""
    return {"table": {"times": list(times), "values": list(values)}}


@_laws("time before and after the kink, s", WITHIN)
def kink_of_a_table(subject: Subject, value: float) -> Content:
    """The third derivative jumps at an inner time of a spline."""
    # Up, down and up again, with a sharp bend of the acceleration at each inner time.
    times, bends = (0.0, 0.2, 0.4, 0.5, 0.7, 1.0), (0.0, 1.0, -1.0, 1.0, -0.5, 0.0)
    laws = (table(times, [size * bend for bend in bends]) for size in (0.1, 20.0))
    return subject.content(*laws, start=0.4 - value, stop=0.4 + value)


@_laws("distance of the times, s", WITHIN)
def close_times_of_a_table(subject: Subject, value: float) -> Content:
    """Two times of a spline are close together: the rounding of their values is divided by their distance."""
    times = (0.0, 0.2, 0.5, 0.5 + value, 0.8, 1.0)
    laws = (table(times, [size * math.sin(3.0 * t) for t in times]) for size in (0.1, 20.0))
    return subject.content(*laws, stop=1.0, samples=5)


# Values of a table are rounded by 2e-16 rad, which in a jump of duration h changes the acceleration by 2e-16
# / h^2. A step of a tenth of h about t = 0.5 s, known to 1e-16 s, has nine digits down to h = 1e-6 s. For a
# shorter jump a motion by series may need steps below the rounding of time, and must be refused with this
# reason; methods that solve at the instants need no steps.
@_laws("time of the jump, s", WITHIN, OURS | {"pointcoord": right_from(1e-6)})
def jump_of_a_table(subject: Subject, value: float) -> Setup:
    """An input moves within a very short time: accelerations grow as the inverse square of this time."""
    times, first = (0.0, 0.2, 0.5, 0.5 + value, 0.8, 1.0), subject.driven[0]
    step = 0.01 if subject.inputs[first].unit == "rad" else 1.0
    jump = moved_by(table(times, [step if t > 0.5 else 0.0 for t in times]), subject.home[first])
    content = subject.content(0.0, [0.0, 20.0], start=0.5 - 0.5 * value, stop=0.5 + 1.5 * value, samples=5)
    content["inputs"][first] = jump
    return Setup(content, judge=partial(refused_as_rough, first))


def refused_as_rough(driven: str, trial: Trial, answer: Answer) -> Answer:
    """A refusal must name the input as the law that the series cannot follow; otherwise it is wrong.

    The mechanism is not near a singular pose, so singularity must not be given as the reason.
    """
    reason = getattr(trial.came.get(answer.formulation), "reason", None)
    if answer.outcome != "refused" or (isinstance(reason, NotFollowed) and reason.name == driven):
        return answer
    return replace(answer, outcome="wrong", reason=f"refused for another reason: {answer.reason}")


def short(subject: Subject, start: float, duration: float) -> Content:
    """A very short scene of an ordinary motion."""
    return subject.content([0.0, 0.3, 0.2], [0.0, 40.0, 5.0], start=start, stop=start + duration, samples=4)


@_laws("duration, s", (1.0, 1e-225, 5e-324))
def short_scene(subject: Subject, value: float) -> Content:
    """Every instant must stay inside the scene, however short it is."""
    return short(subject, 0.0, value)


@_laws("duration after t = 1 s, s", (1e-1, 1e-10, 2.0**-52))
def short_scene_late(subject: Subject, value: float) -> Content:
    """A scene whose duration is a few roundings of its time."""
    return short(subject, 1.0, value)


def to_a_tolerance(subject: Subject, value: float) -> Content:
    """A motion with the scene's tolerance set to the value."""
    return subject.content([-0.1, 0.5], [0.0, 40.0], stop=0.4, tolerance=value)


AS_ASKED = OURS | {"pointcoord-as-asked": RIGHT}
for name, values, expected, why in (
    ("fine", (1e-75, 1e-225, 1e-300), OURS, "The tolerance is far below rounding errors."),
    ("loose", (1.0, 1e150, 1e300), AS_ASKED, "The tolerance is larger than the car."),
):
    _laws("tolerance of the scene, mm", values, expected, name=f"{name}-tolerance", why=why)(to_a_tolerance)


def _cancelling(value: float, wanted: float, rate: float) -> Law:
    """A sine with the value `wanted` and this rate at time 0; its amplitude is the reciprocal of `value`."""
    phase, amplitude = 0.5, 1.0 / value  # rad: neither the sine nor its slope is near zero
    offset = wanted - amplitude * math.sin(phase)
    return sine(amplitude, rate / (amplitude * math.cos(phase)), phase=phase, offset=offset)


@_laws("1 rad or 1 mm over the amplitude", (1.0, 1e-6, 1e-9))
def cancelling_sine(subject: Subject, value: float) -> Content:
    """A large swing is nearly cancelled by its offset; the difference drives every input."""
    length = _cancelling(value, 10.0, 20.0)
    return subject.content(
        _cancelling(value, 0.0, 0.1), length, length if "heave" in subject.inputs else None, stop=0.5
    )


# The error of the sum of the seven terms is 4 7^2 u^2 times their magnitudes (Graillat, Langlois, Louvet),
# which add up to 16 (2 start)^6: it is below a rounding of 16 mm up to the start 2^6 s.
LATE = OURS | dict.fromkeys(("pointcoord", "pointcoord-newton"), right_from(2.0**-6))
STARTS = [2.0**-k for k in (6, 10, 20)]


@_laws("1 s over the start of a motion of 1 s", STARTS, LATE, name="cancelling-polynomial-6")
def cancelling_polynomial(subject: Subject, value: float) -> Content:
    """16 (t - start)^6, multiplied out: terms up to 1e37 times their sum.

    The last input moves by 16 mm, or 1/8 rad, in the second after a late start. Doubles hold the coefficients
    exactly for a start that is a power of two.
    """
    start, last = 1.0 / value, subject.driven[-1]
    size = 16.0 if subject.inputs[last].unit == "mm" else 0.125
    law = [size * math.comb(6, k) * (-start) ** (6 - k) for k in range(7)]
    inputs = {**subject.home, last: moved_by(law, subject.home[last])}
    return subject.absolute(inputs, start=start, stop=start + 1.0)
