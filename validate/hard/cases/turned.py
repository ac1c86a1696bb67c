"""Cars turned as a whole, which changes nothing about their mechanism: no axis of the frame is preferred."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from validate.cars.car import Car, any_rotation, rotation, turned
from validate.cars.scene_content import SQUARE, scene_content
from validate.hard.cars import CARS, EVERY, Array
from validate.hard.case import RIGHT, Case, coarse, decades
from validate.hard.trial import scene_case

GROUP = "Turned cars"
AXES = "xyz"
SOLVERS = ("pointcoord", "pointcoord-newton", "absolute", "relative")


def quarter_turn_less(axis: int, value: float) -> Array:
    """The turn by 90 degrees less `value` rad about a coordinate axis; at 0 a permutation, unrounded."""
    return rotation(axis, math.sin(value), math.cos(value))


def moving(car: Car, turn: Callable[[float], Array]) -> Callable[[float], dict[str, Any]]:
    """Arm and rack both move, with all rates."""

    def content(value: float) -> dict[str, Any]:
        return scene_content(turned(car, turn(value)), [SQUARE - 0.1, 0.4], [0.0, 40.0], stop=0.5)

    return content


def _cases(suffix: str, car: Car) -> tuple[Case, ...]:
    near, random = (*decades(-12, -1), 0.0), tuple(float(seed) for seed in range(1, 13))

    def case(name: str, why: str, parameter: str, values: tuple[float, ...], turn: Any) -> Case:
        return scene_case(
            name=f"{name}{suffix}",
            group=GROUP,
            why=why,
            parameter=parameter,
            values=coarse(values) if suffix else values,
            scene=moving(car, turn),
            expected=dict.fromkeys(SOLVERS, RIGHT),
            behaviour="right however the car is turned",
        )

    return (
        *(
            case(
                f"quarter-turn-about-{AXES[axis]}",
                "the car comes to lie along other axes of the frame, and coordinates change places",
                f"90 degrees about {AXES[axis]} less this, rad; then exactly 90",
                near,
                lambda value, axis=axis: quarter_turn_less(axis, value),
            )
            for axis in range(3)
        ),
        case(
            "turned-at-random",
            "no axis of the car lies along an axis of the frame, so nothing cancels by chance",
            "number of a random rotation",
            random,
            lambda seed: any_rotation(int(seed)),
        ),
    )


CASES: tuple[Case, ...] = tuple(case for suffix, car in EVERY.items() for case in _cases(suffix, CARS[car]))
