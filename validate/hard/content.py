"""Scenes of hard cases as plain data, written briefly: the paper's car unless said otherwise."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from validate.cars.closed_form import Closure
from validate.cars.paper_car import EFFECTS, PAPER

Triple = tuple[float, float, float]
# A number is held constant, a sequence is a polynomial from t^0 up, a mapping is a law as a scene has it.
Law = float | Sequence[float] | Mapping[str, Any]

SQUARE = 1.5707963267948966  # rad: the arm angle at which rise and angle are most nearly proportional


def decades(low: int = -12, high: int = 0) -> tuple[float, ...]:
    """One value per decade, going in: from 10^high down to 10^low."""
    return tuple(float(f"1e{k}") for k in range(high, low - 1, -1))


def paper_car(
    arm_angle: Law = SQUARE,
    rack: Law = 0.0,
    heave: Law | None = None,
    *,
    points: Mapping[str, Sequence[float]] = PAPER,
    closure: Closure = "collinear",
    side: str = "left",
    up: Sequence[float] = (0.0, 0.0, 1.0),
    right: Sequence[float] = (0.0, 1.0, 0.0),
    start: float = 0.0,
    stop: float | None = None,
    samples: int | None = None,
    tolerance: float = 1e-9,
    effects: Sequence[str] = EFFECTS,
) -> dict[str, Any]:
    """The content of a scene.

    Args:
        arm_angle, rack, heave: laws of the inputs, rad and mm over s.
        points: hardpoints, mm; the paper's if not given.
        closure: what the strut is; the paper's is collinear.
        stop: s; the start if not given, which is a single instant.
        samples: instants; three of a motion if not given.
    """
    laws = {"arm_angle": arm_angle, "rack": rack} | ({} if heave is None else {"heave": heave})
    stop = start if stop is None else stop
    return {
        "effects": list(effects),
        "tolerance": tolerance,
        "mechanism": {
            "type": "macpherson",
            "closure": closure,
            "side": side,
            "up": [float(x) for x in up],
            "right": [float(x) for x in right],
            "points": {name: [float(x) for x in place] for name, place in points.items()},
        },
        "inputs": {name: _input(law) for name, law in laws.items()},
        "time": {"start": start, "stop": stop, "samples": samples or (1 if stop == start else 3)},
    }


def _input(law: Law) -> dict[str, Any]:
    if isinstance(law, Mapping):
        return dict(law)
    return {"polynomial": list(law)} if isinstance(law, Sequence) else {"constant": float(law)}
