"""Scenes of cars as plain data, written briefly: every scene that is made here is made by this function."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from pointcoord import Scene
from pointcoord.effects.registry import EFFECTS
from validate.cars.car import Car

# A number is held constant, a sequence is a polynomial from t^0 up, a mapping is a law as a scene has it.
Law = float | Sequence[float] | Mapping[str, Any]


def content_of(
    car: Car,
    laws: Mapping[str, Law],
    *,
    start: float = 0.0,
    stop: float | None = None,
    samples: int | None = None,
    tolerance: float = 1e-9,
    effects: Sequence[str] | None = None,
    title: str = "",
) -> dict[str, Any]:
    """The content of a scene.

    Args:
        laws: of the inputs, rad and mm over s.
        start, stop: s; without a stop there is a single instant.
        samples: instants; three of a motion if not given.
        tolerance: mm.
        effects: if not given all that the car has and every model gives.
    Raises:
        SceneError: it is no scene, and no effects are given.
    """
    stop = start if stop is None else stop
    content = {
        **({"title": title} if title else {}),
        "effects": list(effects or ()),
        "tolerance": tolerance,
        "mechanism": car.mechanism,
        "inputs": {name: _input(law) for name, law in laws.items()},
        "time": {"start": start, "stop": stop, "samples": samples or (1 if stop == start else 3)},
    }
    if effects is not None:
        return content
    # Gradients follow from the rest, and take as long; trees of joints have no jerks.
    had = (EFFECTS[name] for name in Scene.from_mapping(content).mechanism.effects)
    plain = [one.name for one in had if not (one.way or one.base) and one.derivative <= 2]
    return content | {"effects": plain}


def _input(law: Law) -> dict[str, Any]:
    if isinstance(law, Mapping):
        return dict(law)
    return {"polynomial": list(law)} if isinstance(law, Sequence) else {"constant": float(law)}
