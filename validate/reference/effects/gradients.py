"""Any number's gradients: by the travel of the wheel, and by the steering input."""

from __future__ import annotations

from collections.abc import Callable

from validate.reference.dual import slope_of
from validate.reference.effects.car import WHEEL, Car
from validate.reference.effects.effect import RACK, TRAVEL, Effect
from validate.reference.effects.wheel_travel import TRAVELLED
from validate.reference.vectors import Scalar


def by_travel(effect: Effect) -> Effect:
    """(dN/dq) / (d travel/dq), q the one driven input that is not the travel of a slide."""

    def quotient(car: Car) -> Scalar:
        return slope_of(effect.evaluate(car)) / slope_of(TRAVELLED.evaluate(car))

    return _gradient(effect, TRAVEL, (WHEEL,), quotient)


def by_rack(effect: Effect) -> Effect:
    """dN/dq, q the one driven input that is the travel of a slide."""
    return _gradient(effect, RACK, (), lambda car: slope_of(effect.evaluate(car)))


def _gradient(effect: Effect, along: str, more: tuple[str, ...], evaluate: Callable[[Car], Scalar]) -> Effect:
    words = {TRAVEL: "the wheel goes up", RACK: "the slide travels"}[along]
    return Effect(
        f"{effect.name}_{along}",
        f"{effect.unit}/mm",
        f"{effect.name} grows as {words}",
        tuple(dict.fromkeys((*effect.needs, *more, along))),
        evaluate,
        along,
    )
