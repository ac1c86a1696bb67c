"""A car to try: its hardpoints and axes, and what closes its drawing; turned, moved, scaled, mirrored."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Points = dict[str, tuple[float, float, float]]
Drawing = dict[str, Array]
Closure = str  # what closes a drawing, as a scene names it
Uniform = Callable[[float, float], float]  # a number between two, drawn at random or looked for

UP, RIGHT = (0.0, 0.0, 1.0), (0.0, 1.0, 0.0)


@dataclass(frozen=True)
class Car:
    """One wheel's suspension.

    Attributes:
        points: hardpoints, mm.
        side: of the car, `left` or `right`.
        up, right: the car's axes in the frame of its points, unit vectors.
        closure: what makes a drawing close, as a scene names it.
        suspension: its type, as a scene names it.
    """

    points: Mapping[str, tuple[float, float, float]]
    side: str = "left"
    up: tuple[float, float, float] = UP
    right: tuple[float, float, float] = RIGHT
    closure: Closure = "drawn"
    suspension: str = "macpherson"

    @property
    def array(self) -> Drawing:
        """The hardpoints as arrays, (3,) each."""
        return {name: np.array(place) for name, place in self.points.items()}

    def drawn_as(self, points: Mapping[str, Array]) -> Car:
        """The car with other hardpoints."""
        return replace(self, points=as_tuples(points))


def other_side(car: Car) -> Car:
    """The same suspension on the other side of a car whose right is y."""
    side = "left" if car.side == "right" else "right"
    return replace(car, points=mirrored(car.points), side=side)


def mirrored(points: Mapping[str, tuple[float, float, float]]) -> Points:
    """The same hardpoints on the other side of a car whose right is y."""
    return {name: (x, -y, z) for name, (x, y, z) in points.items()}


def turned(car: Car, turn: Array) -> Car:
    """The whole car turned by an orthogonal matrix of determinant 1, its axes with it."""
    there = car.drawn_as({name: turn @ place for name, place in car.array.items()})
    return replace(there, up=as_tuple(turn @ np.array(car.up)), right=as_tuple(turn @ np.array(car.right)))


def moved(car: Car, away: Array) -> Car:
    """The whole car displaced, mm."""
    return car.drawn_as({name: place + away for name, place in car.array.items()})


def scaled(car: Car, scale: float) -> Car:
    """All lengths of the car multiplied, as seen from the origin."""
    return car.drawn_as({name: scale * place for name, place in car.array.items()})


def rotation(axis: int, cosine: float, sine: float) -> Array:
    """The turn about a coordinate axis (0 to 2) by the angle of this cosine and sine."""
    turn = np.eye(3)
    first, second = (axis + 1) % 3, (axis + 2) % 3
    turn[[first, second], [first, second]] = cosine
    turn[first, second], turn[second, first] = -sine, sine
    return turn


def any_rotation(seed: int) -> Array:
    """A turn drawn at random, the same for the same seed."""
    return random_rotation(np.random.default_rng(seed))


def random_rotation(rng: np.random.Generator) -> Array:
    """A turn drawn at random."""
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return np.asarray(turn * np.sign(np.linalg.det(turn)))


def placed(rng: np.random.Generator, car: Car) -> tuple[Car, float]:
    """The car scaled by up to a thousand, turned and moved, each in one of two; and the scale."""
    scale = 10.0 ** rng.uniform(-3.0, 3.0) if rng.random() < 0.5 else 1.0
    turn = random_rotation(rng) if rng.random() < 0.5 else np.eye(3)
    away = np.zeros(3)
    if rng.random() < 0.5:
        away = rng.normal(size=3)
        away *= scale * 10.0 ** rng.uniform(0.0, 7.0) / np.linalg.norm(away)
    return moved(scaled(turned(car, turn), scale), away), scale


def as_tuples(points: Mapping[str, Array]) -> Points:
    """Plain numbers, as a scene has them."""
    return {name: as_tuple(place) for name, place in points.items()}


def as_tuple(vector: Array) -> tuple[float, float, float]:
    """The three numbers of a vector."""
    x, y, z = (float(component) for component in vector)
    return x, y, z


def random_vector(uniform: Uniform, reach: float) -> Array:
    """A vector with components up to `reach`."""
    return np.array([uniform(-reach, reach) for _ in range(3)])


def unit(vector: Array) -> Array:
    """A vector of length 1."""
    return np.asarray(vector / np.linalg.norm(vector))
