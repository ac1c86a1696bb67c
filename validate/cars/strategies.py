"""Random cars and motions for the project's own property-based tests: as different as they can be.

Most of them can be assembled. Others' tests are drawn from `accepted`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from pointcoord import Scene
from validate.cars.car import Car, as_tuples, other_side
from validate.cars.input_limits import Linkage
from validate.cars.registry import SUSPENSIONS, VARIANTS, Variant
from validate.cars.scene_content import scene_content
from validate.cars.suspension import LEFT_OVER, REACH
from validate.extras import MissingPackage

try:
    from hypothesis import strategies as st
except ModuleNotFoundError as error:
    raise MissingPackage("validate.strategies", error, "strategies") from None


def _between(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(low, high, allow_nan=False, allow_subnormal=False)


def _floats(reach: float) -> st.SearchStrategy[float]:
    return _between(-reach, reach)


@st.composite
def cars(
    draw: st.DrawFn,
    variants: Sequence[Variant] = VARIANTS,
    reach: float = REACH,
    left_over: float = LEFT_OVER,
) -> Car:
    """A random car on either side, of one of these suspensions; see `suspension.RandomDrawing`."""
    variant = draw(st.sampled_from(variants))
    drawing = SUSPENSIONS[variant.suspension].drawing
    drawn = drawing(lambda low, high: draw(_between(low, high)), variant.closure, reach, left_over)
    left = Car(as_tuples(drawn), "left", closure=variant.closure, suspension=variant.suspension)
    return other_side(left) if draw(st.booleans()) else left


@st.composite
def scenes(
    draw: st.DrawFn, variants: Sequence[Variant] = VARIANTS, reach: float = REACH, samples: int = 5
) -> Scene:
    """A random car with random inputs and rates about its own drawing; whether it can follow is not known.

    Args:
        samples: instants.
    """
    car = draw(cars(variants, reach))
    laws: dict[str, Any] = {
        "arm_angle": draw(_law(Linkage.of(car).drawn_angle, 0.25, 0.6)),
        "rack": draw(_law(0.0, 20.0, 60.0)),
    }
    if draw(st.booleans()):
        laws["heave"] = draw(_law(0.0, 30.0, 200.0))
    stop = draw(st.sampled_from([0.05, 0.2, 0.5]))
    return Scene.from_mapping(scene_content(car, **laws, stop=stop, samples=samples))


@st.composite
def _law(draw: st.DrawFn, middle: float, reach: float, rate: float) -> dict[str, Any]:
    offset = middle + draw(_floats(reach))
    if draw(st.booleans()):
        return {"polynomial": [offset, draw(_floats(rate)), draw(_floats(rate))]}
    speed = draw(st.floats(0.5, 8.0))
    wave = {"amplitude": draw(_floats(rate)) / speed, "angular_frequency": speed}
    return {"sine": {**wave, "phase": draw(_floats(3.0)), "offset": offset}}
