"""A car to try: its hardpoints and axes, and what closes its drawing; turned, moved, scaled, mirrored."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene
from pointcoord.mechanism.structure import TABLES, Structure
from pointcoord.scene.scene_file import MechanismPart
from validate.spanning_tree.cut import car_directions

Array = NDArray[np.float64]
Points = dict[str, tuple[float, float, float]]
Closure = str  # what closes a drawing, as a scene names it

UP, RIGHT = (0.0, 0.0, 1.0), (0.0, 1.0, 0.0)


@dataclass(frozen=True)
class Car:
    """A mechanism with a drawing.

    Attributes:
        points: hardpoints, mm.
        side: of the car, `left` or `right`.
        up, right: the car's axes in the frame of its points, unit vectors.
        closure: what makes a drawing close, as a scene names it.
        suspension: its type, as a scene names it; the title of its tables if it has these.
        tables: of a mechanism that is not a shipped one.
        wheel_radius: mm; needed by inputs at the wheel's contact point alone.
    """

    points: Mapping[str, tuple[float, float, float]]
    side: str = "left"
    up: tuple[float, float, float] = UP
    right: tuple[float, float, float] = RIGHT
    closure: Closure = "drawn"
    suspension: str = "macpherson"
    tables: Mapping[str, Any] | None = None
    wheel_radius: float | None = None

    @classmethod
    def of(cls, scene: Scene) -> Car:
        """The car of a scene."""
        return cls._of(scene.mechanism)

    @classmethod
    def of_mechanism(cls, content: Mapping[str, Any]) -> Car:
        """The car of the `mechanism` of a scene's content.

        Raises:
            SceneError: it is no car.
        """
        return cls._of(MechanismPart.checked(content, "a car"))

    @classmethod
    def _of(cls, part: MechanismPart) -> Car:
        given = {name: getattr(part, name) for name in ("title", *TABLES)}
        # A shipped mechanism has none of its own.
        shipped = not (given["bodies"] or given["parts"])
        tables = None if shipped else {name: table for name, table in given.items() if table}
        own = part.points, part.side, part.up, part.right, part.closure
        return cls(*own, part.name, tables, part.wheel_radius)

    @property
    def mechanism(self) -> dict[str, Any]:
        """The `mechanism` of a scene's content."""
        return {
            **({"type": self.suspension} if self.tables is None else self.tables),
            "closure": self.closure,
            "side": self.side,
            "up": [float(x) for x in self.up],
            "right": [float(x) for x in self.right],
            **({} if self.wheel_radius is None else {"wheel_radius": self.wheel_radius}),
            "points": {name: [float(x) for x in place] for name, place in self.points.items()},
        }

    @property
    def structure(self) -> Structure:
        """What its bodies, rods, slides and inputs are, with every point that a car may have.

        Raises:
            SceneError: it is no car.
        """
        return self._part.file.structures[self.closure]

    @property
    def _part(self) -> MechanismPart:
        return MechanismPart.checked(self.mechanism, "a car")

    @property
    def array(self) -> dict[str, Array]:
        """The hardpoints as arrays, (3,) each."""
        return {name: np.array(place) for name, place in self.points.items()}

    @property
    def size(self) -> float:
        """Its largest extent along an axis, mm."""
        return float(np.ptp(np.array(list(self.points.values())), axis=0).max())

    def direction(self, name: str) -> Array:
        """A direction of the car, unit vector: up, right, down, left, forward (up x right) or rearward."""
        return direction(self.up, self.right, name)

    def drawn_as(self, points: Mapping[str, Array]) -> Car:
        """The car with other hardpoints."""
        return replace(self, points=as_tuples(points))


def direction(up: Sequence[float], right: Sequence[float], name: str) -> Array:
    """A direction by its name from a car's axes, see `Car.direction`."""
    return car_directions({"up": up, "right": right})[name]


def other_side(car: Car) -> Car:
    """The same suspension on the other side of the car, mirrored in the plane through the origin."""
    right = np.array(car.right)
    there = car.drawn_as({name: place - 2.0 * (place @ right) * right for name, place in car.array.items()})
    return replace(there, side="left" if car.side == "right" else "right")


def turned(car: Car, turn: Array) -> Car:
    """The whole car turned by an orthogonal matrix of determinant 1, its axes with it."""
    there = car.drawn_as({name: turn @ place for name, place in car.array.items()})
    return replace(there, up=as_tuple(turn @ np.array(car.up)), right=as_tuple(turn @ np.array(car.right)))


def moved(car: Car, away: Array) -> Car:
    """The whole car displaced, mm."""
    return car.drawn_as({name: place + away for name, place in car.array.items()})


def scaled(car: Car, scale: float) -> Car:
    """All lengths of the car multiplied, as seen from the origin."""
    there = car.drawn_as({name: scale * place for name, place in car.array.items()})
    return there if car.wheel_radius is None else replace(there, wheel_radius=scale * car.wheel_radius)


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


def as_tuples(points: Mapping[str, Array]) -> Points:
    """Plain numbers, as a scene has them."""
    return {name: as_tuple(place) for name, place in points.items()}


def as_tuple(vector: Array) -> tuple[float, float, float]:
    """The three numbers of a vector."""
    x, y, z = (float(component) for component in vector)
    return x, y, z


def unit(vector: Array) -> Array:
    """A vector of length 1."""
    return np.asarray(vector / np.linalg.norm(vector))
