"""Scenes of cars as plain data, written briefly: every scene that is made here is made by this function."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from pointcoord import Scene
from pointcoord.effects.registry import EFFECTS
from validate.cars.car import Car

# A number is held constant, a sequence is a polynomial from t^0 up, a mapping is a law as a scene has it.
Law = float | Sequence[float] | Mapping[str, Any]

SQUARE = 1.5707963267948966  # rad: the arm angle at which rise and angle are most nearly proportional


def scene_content(
    car: Car,
    arm_angle: Law = SQUARE,
    rack: Law = 0.0,
    heave: Law | None = None,
    *,
    start: float = 0.0,
    stop: float | None = None,
    samples: int | None = None,
    tolerance: float = 1e-9,
    effects: Sequence[str] = tuple(EFFECTS),
    title: str = "",
) -> dict[str, Any]:
    """The content of a scene.

    Args:
        arm_angle, rack, heave: laws of the inputs, rad and mm over s.
        start, stop: s; without a stop there is a single instant.
        samples: instants; three of a motion if not given.
        tolerance: mm.
        effects: all that there are if not given.
    """
    laws = {"arm_angle": arm_angle, "rack": rack} | ({} if heave is None else {"heave": heave})
    stop = start if stop is None else stop
    return {
        **({"title": title} if title else {}),
        "effects": list(effects),
        "tolerance": tolerance,
        "mechanism": {
            "type": car.suspension,
            "closure": car.closure,
            "side": car.side,
            "up": [float(x) for x in car.up],
            "right": [float(x) for x in car.right],
            "points": {name: [float(x) for x in place] for name, place in car.points.items()},
        },
        "inputs": {name: _input(law) for name, law in laws.items()},
        "time": {"start": start, "stop": stop, "samples": samples or (1 if stop == start else 3)},
    }


def car_of(scene: Scene) -> Car:
    """The car of a scene."""
    part = scene.mechanism
    return Car(part.points, part.side, part.up, part.right, part.closure, part.type)


def _input(law: Law) -> dict[str, Any]:
    if isinstance(law, Mapping):
        return dict(law)
    return {"polynomial": list(law)} if isinstance(law, Sequence) else {"constant": float(law)}
