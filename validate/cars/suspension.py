"""What the cars' side knows of a suspension: everything that makes it another one than the next, as data."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from validate.cars.car import Car, Closure, Drawing, Uniform
from validate.cars.closed_form import ClosedForm

REACH = 200.0  # mm, of a free point from the base car's
LEFT_OVER = 0.05  # mm, by which a drawn point may miss its line: half of what is warned of


class RandomDrawing(Protocol):
    """Draws a left-hand car in the axes of the paper (x rearward, y right, z up), mm."""

    def __call__(self, uniform: Uniform, closure: Closure, reach: float, left_over: float) -> Drawing:
        """A drawing.

        Args:
            uniform: gives a number between two; a generator of numbers or a search may be behind it.
            reach: how far free points lie from the base car's.
            left_over: by how much points of a car as drawn may miss the lines that they belong on.
        """
        ...


Reshape = Callable[[Uniform, Drawing], Drawing]
# A drawing moved to within a share of a singular one.
Nearly = Callable[[np.random.Generator, Drawing, float], Drawing]


@dataclass(frozen=True)
class Suspension:
    """A type of suspension.

    Attributes:
        name: its type in a scene.
        form: its closed form.
        base: by closure, a car to make others from.
        drawing: draws a random car.
        kingpin: the two points that the tie rod turns the knuckle about.
        links: pairs of points that keep the distance that they are drawn at.
        upper_lock: what can lock besides arm and tie rod: what holds the knuckle's upper end.
        with_arm_lock: a drawing whose arm may come to its dead points before anything else locks.
        with_upper_lock: a drawing whose upper end locks as the arm turns.
        sides: by closure and name, four points whose place tells one assembly from another: the fourth lies
            beside the plane of the first three on the side that it is drawn on.
        nearly_singular: by closure and by what is singular, drawings that nearly are.
    """

    name: str
    form: type[ClosedForm]
    base: Mapping[Closure, Car]
    drawing: RandomDrawing
    kingpin: tuple[str, str]
    links: tuple[tuple[str, str], ...]
    upper_lock: str
    with_arm_lock: Reshape
    with_upper_lock: Reshape
    sides: Mapping[Closure, Mapping[str, tuple[str, str, str, str]]]
    nearly_singular: Mapping[Closure, Mapping[str, Nearly]]

    @property
    def closures(self) -> tuple[Closure, ...]:
        """What may close its drawings."""
        return tuple(self.base)
