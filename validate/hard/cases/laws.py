"""Inputs that are very fast, very slow, very long or not smooth."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from fractions import Fraction
from functools import partial
from typing import Any

import numpy as np

from validate.cars.car import Car
from validate.cars.scene_content import SQUARE, scene_content
from validate.formulations.input_rates import rates
from validate.hard.cars import CARS, EVERY
from validate.hard.case import RIGHT, RIGHT_OR_REFUSED, Case, Expected, Trial, coarse, decades
from validate.hard.trial import Facts, Measure, Tried, scene_case

GROUP = "Laws of the inputs"
OURS: Mapping[str, Expected] = {
    "pointcoord": RIGHT,
    "pointcoord-newton": RIGHT,
    "absolute": RIGHT,
    "relative": RIGHT,
}
# A motion by series may take too many of them, or need steps below the rounding of time, and has to say
# so; solving at its instants needs no steps.
BY_STEPS = {"pointcoord": RIGHT_OR_REFUSED, "pointcoord-newton": RIGHT, "absolute": RIGHT, "relative": RIGHT}
# Values of a table are rounded by 2e-16 rad, which within a jump of time h is an acceleration of 2e-16 / h^2.
# A step of a tenth of h about t = 0.5 s, known to 1e-16 s, keeps nine digits of itself down to h = 1e-6 s.
JUMP = BY_STEPS | {"pointcoord": Expected(("right", "refused"), right_from=1e-6)}
TURN = 2.0 * math.pi
Content = Callable[[Car, float], dict[str, Any]]


def _scaled(car: Car, rate: float) -> dict[str, Any]:
    """The same way of arm and rack at any rate of the arm, rad/s, within its own time."""
    return scene_content(car, [SQUARE - 0.1, rate], [0.0, 100.0 * rate], stop=0.2 / rate)


def _long_sine(car: Car, duration: float) -> dict[str, Any]:
    """One swing a second."""
    arm = {"amplitude": 0.2, "angular_frequency": TURN, "offset": SQUARE}
    rack = {"amplitude": 30.0, "angular_frequency": 1.5 * TURN, "phase": 0.3}
    return scene_content(car, {"sine": arm}, {"sine": rack}, stop=duration, samples=4)


def _phase(car: Car, turns: float) -> dict[str, Any]:
    wave = {"amplitude": 0.2, "angular_frequency": TURN, "phase": TURN * turns + 0.3, "offset": SQUARE}
    return scene_content(car, {"sine": wave}, [0.0, 20.0], stop=0.5)


# 16 t^2 (1 - t)^2: from rest to 1 and back to rest in a second.
STOPPING = (0.0, 0.0, 16.0, -32.0, 16.0)


def _starting(car: Car, value: float) -> dict[str, Any]:
    return _stopping_scene(car, 0.0, value)


def _stopping(car: Car, value: float) -> dict[str, Any]:
    return _stopping_scene(car, 1.0 - value, 1.0)


def _stopping_scene(car: Car, start: float, stop: float) -> dict[str, Any]:
    arm = [0.2 * c for c in STOPPING]
    arm[0] = SQUARE
    return scene_content(car, arm, [30.0 * c for c in STOPPING], start=start, stop=stop)


def rate_rounding(tried: Tried) -> Facts:
    """What the rack's rate in double precision is off, where the reference takes it; 0 is no error."""
    part = tried.scene.inputs["rack"]
    exact = [Fraction(c) for c in part.polynomial or ()]
    worst = max(
        abs(
            Fraction(rate)
            - sum((k * c * Fraction(t) ** (k - 1) for k, c in enumerate(exact) if k), Fraction(0))
        )
        for t, rate in zip(
            tried.scene.instants.tolist(), rates(part, tried.scene.instants)[:, 1].tolist(), strict=True
        )
    )
    fastest = float(np.abs(rates(part, tried.scene.instants)[:, 1]).max())
    return {"rounding of the rack's rate [mm/s]": float(worst), "largest rate of the rack [mm/s]": fastest}


def _seen_at_rest(car: Car, size: float) -> dict[str, Any]:
    """The same way as for `STOPPING` of some size; its three instants are those where its rates are zero."""
    arm, rack = (
        [middle + reach * size * STOPPING[0], *(reach * size * c for c in STOPPING[1:])]
        for middle, reach in ((SQUARE, 0.2), (0.0, 30.0))
    )
    return scene_content(car, arm, rack, stop=1.0)


# Up, down and up again, with a sharp bend of the acceleration at each inner time.
KNOTS = (0.0, 0.2, 0.4, 0.5, 0.7, 1.0)
BENDS = (0.0, 1.0, -1.0, 1.0, -0.5, 0.0)


def _zigzag(times: tuple[float, ...], middle: float, size: float) -> dict[str, Any]:
    return {"table": {"times": list(times), "values": [middle + size * bend for bend in BENDS]}}


def _about_a_kink(car: Car, value: float) -> dict[str, Any]:
    laws = _zigzag(KNOTS, SQUARE, 0.1), _zigzag(KNOTS, 0.0, 20.0)
    return scene_content(car, *laws, start=0.4 - value, stop=0.4 + value)


def _close_knots(car: Car, value: float) -> dict[str, Any]:
    """A smooth way through two times that are close together: only rounding lies between their values."""
    times = (0.0, 0.2, 0.5, 0.5 + value, 0.8, 1.0)
    arm, rack = (
        [middle + size * math.sin(3.0 * t) for t in times] for middle, size in ((SQUARE, 0.1), (0.0, 20.0))
    )
    return scene_content(
        car,
        {"table": {"times": list(times), "values": arm}},
        {"table": {"times": list(times), "values": rack}},
        stop=1.0,
        samples=5,
    )


def _jerk(car: Car, value: float) -> dict[str, Any]:
    """A jump of 0.01 rad within this time: acceleration bends up and down again."""
    times = (0.0, 0.2, 0.5, 0.5 + value, 0.8, 1.0)
    return scene_content(
        car,
        {"table": {"times": list(times), "values": [SQUARE + (0.01 if t > 0.5 else 0.0) for t in times]}},
        [0.0, 20.0],
        start=0.5 - 0.5 * value,
        stop=0.5 + 1.5 * value,
        samples=5,
    )


def law_cases(
    name: str,
    why: str,
    parameter: str,
    values: tuple[float, ...],
    scene: Content,
    behaviour: str = "right within the bound",
    expected: Mapping[str, Expected] = OURS,
    measure: Measure | None = None,
    second: tuple[float, ...] | None = None,
    also_answered: tuple[float, ...] = (),
) -> tuple[Case, ...]:
    """A case of this group for every suspension; see `trial.scene_case`.

    Args:
        values: tried of the first suspension.
        second: tried of the others; every fourth of the first one's if not given.
        scene: the content at a value, of a car.
        also_answered: see `Case`.
    """
    return tuple(
        scene_case(
            name=f"{name}{suffix}",
            group=GROUP,
            why=why,
            parameter=parameter,
            values=(second or coarse(values)) if suffix else values,
            scene=partial(scene, CARS[car]),
            expected=expected,
            behaviour=behaviour,
            measure=measure,
            also_answered=also_answered,
        )
        for suffix, car in EVERY.items()
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
        yield replace(case, examine=partial(_told_as_rough_by, case.examine))


def _told_as_rough_by(examine: Callable[[float], Trial], value: float) -> Trial:
    return told_as_rough(examine(value), "arm_angle")


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
