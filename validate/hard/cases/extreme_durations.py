"""Scenes of extreme length, place in time or tolerance, and with one input only."""

from __future__ import annotations

from typing import Any

from validate.cars.car import Car
from validate.cars.input_limits import Linkage
from validate.cars.scene_content import SQUARE, scene_content
from validate.hard.case import RIGHT, Case, decades
from validate.hard.cases.dead_points import inside, near_end
from validate.hard.cases.laws import OURS, law_cases

BY_25 = tuple(float(f"1e{-25 * k}") for k in range(13))


def _far_in_time(car: Car, start: float) -> dict[str, Any]:
    wave = {"amplitude": 0.2, "angular_frequency": 1.0, "offset": SQUARE}
    swing = wave | {"amplitude": 20.0, "offset": 0.0}
    return scene_content(car, {"sine": wave}, {"sine": swing}, start=start, stop=start + 1.0)


def _heaving(car: Car, value: float) -> dict[str, Any]:
    wave = {"amplitude": 100.0 * value, "angular_frequency": 3.0}
    return scene_content(car, SQUARE, 0.0, {"sine": wave}, stop=1.0)


def _short(car: Car, value: float) -> dict[str, Any]:
    return scene_content(car, [SQUARE, 0.3, 0.2], [0.0, 40.0, 5.0], stop=value, samples=4)


def _short_and_late(car: Car, value: float) -> dict[str, Any]:
    return scene_content(car, [SQUARE, 0.3, 0.2], [0.0, 40.0, 5.0], start=1.0, stop=1.0 + value, samples=4)


def _before_a_lock(car: Car, value: float) -> dict[str, Any]:
    """The motion would lock right after its end: at time 1, and it stops this much earlier."""
    low = min(end for end, _ in Linkage.of(car).ends({"arm_angle": SQUARE, "rack": 0.0}, "rack"))
    return scene_content(car, SQUARE, [0.0, low], stop=1.0 - value)


def _tolerance(car: Car, value: float) -> dict[str, Any]:
    return scene_content(car, [SQUARE - 0.1, 0.5], [0.0, 40.0], stop=0.4, tolerance=value)


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
