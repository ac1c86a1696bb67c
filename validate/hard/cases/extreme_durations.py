"""Scenes of extreme length, place in time or tolerance, and with one input only."""

from __future__ import annotations

from validate.hard.case import RIGHT, Case, decades
from validate.hard.cases.dead_points import inside, near_end
from validate.hard.cases.laws import OURS, law_cases
from validate.hard.family import SUBJECTS, Content, Subject
from validate.hard.last_values import ends_of, last_value

BY_25 = tuple(float(f"1e{-25 * k}") for k in range(13))


def _far_in_time(subject: Subject, start: float) -> Content:
    swings = ({"sine": {"amplitude": size, "angular_frequency": 1.0}} for size in (0.2, 20.0))
    return subject.content(*swings, start=start, stop=start + 1.0)


def _heaving(subject: Subject, value: float) -> Content:
    wave = {"amplitude": 100.0 * value, "angular_frequency": 3.0}
    return subject.content(heave={"sine": wave}, stop=1.0)


def _short(subject: Subject, value: float) -> Content:
    return subject.content([0.0, 0.3, 0.2], [0.0, 40.0, 5.0], stop=value, samples=4)


def _short_and_late(subject: Subject, value: float) -> Content:
    return subject.content([0.0, 0.3, 0.2], [0.0, 40.0, 5.0], start=1.0, stop=1.0 + value, samples=4)


def _before_a_lock(subject: Subject, value: float) -> Content:
    """The motion would lock right after its end: at time 1, and it stops this much earlier."""
    driven, ahead = ("rack", False) if subject.level else ends_of(subject)[0]
    way = float(last_value(subject, driven, ahead).value) - subject.home[driven]
    return subject.content([0.0, way], [0.0, way], only=driven, stop=1.0 - value)


def _tolerance(subject: Subject, value: float) -> Content:
    return subject.content([-0.1, 0.5], [0.0, 40.0], stop=0.4, tolerance=value)


CASES: tuple[Case, ...] = (
    *law_cases(
        "far-in-time",
        "time itself has few digits left for the swing",
        "start of a second of a sine, s",
        decades(0, 12)[::-1],
        _far_in_time,
    ),
    *law_cases(
        "only-heave",
        "the whole car moves while arm and rack rest: the knuckle must not turn",
        "amplitude of the heave, 100 mm",
        (*decades(-12, 0), 0.0),
        _heaving,
        needs_heave=True,
    ),
    *law_cases(
        "short-scene",
        "every instant must stay inside a scene however short",
        "duration, s",
        (*BY_25, 5e-324),
        _short,
    ),
    *law_cases(
        "short-scene-late",
        "a scene of a few roundings of its time",
        "duration after t = 1 s, s",
        (*decades(-15, -1), 2.0**-52),
        _short_and_late,
    ),
    *law_cases(
        "stop-before-a-lock",
        "the motion ends just before its links lock, and its law goes on beyond",
        "time left to the lock, s, of a way that takes one second",
        decades(-12, -1),
        _before_a_lock,
        inside("moving"),
        # As for `dead_points`: the lock is at the end of the whole way.
        near_end("moving") | {"pointcoord-newton": near_end("moving")["pointcoord"]},
        subjects=[one for one in SUBJECTS if one.level or ends_of(one)],
    ),
    *law_cases(
        "fine-tolerance",
        "a tolerance below what rounding allows",
        "tolerance of the scene, mm",
        BY_25[1:],
        _tolerance,
    ),
    *law_cases(
        "loose-tolerance",
        "a tolerance above the size of the car",
        "tolerance of the scene, mm",
        tuple(1.0 / x for x in BY_25),
        _tolerance,
        expected={**OURS, "pointcoord-as-asked": RIGHT},
    ),
)
