"""A car: hardpoints, axes and closure. It can be turned, moved, scaled and mirrored, and makes scenes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from pointcoord import Scene
from pointcoord.effects.registry import EFFECTS
from pointcoord.mechanism.structure import TABLES, Structure
from pointcoord.scene.mechanism_part import MechanismPart
from validate.arrays import Array
from validate.spanning_tree.tree import car_directions

Point = tuple[float, float, float]
Points = dict[str, Point]
Law = float | Sequence[float] | Mapping[str, Any]
"""The law of an input: a constant, a polynomial from t^0 up, or a law as in a scene."""

UP, RIGHT = (0.0, 0.0, 1.0), (0.0, 1.0, 0.0)


@dataclass(frozen=True)
class Car:
    """A mechanism with a drawing.

    Attributes:
        points: hardpoints, mm.
        side: side of the car, `left` or `right`.
        up, right: the car's axes in the frame of its points, unit vectors.
        closure: how the drawing is closed, as in a scene.
        suspension: the type, as in a scene; for a mechanism with `tables`, their title.
        tables: the tables of a mechanism that is not shipped.
        wheel_radius: mm; needed only by inputs at the wheel's contact point.
    """

    points: Mapping[str, Point]
    side: str = "left"
    up: Point = UP
    right: Point = RIGHT
    closure: str = "drawn"
    suspension: str = "macpherson"
    tables: Mapping[str, Any] | None = None
    wheel_radius: float | None = None

    @classmethod
    def of(cls, part: Scene | MechanismPart | Mapping[str, Any]) -> Car:
        """The car of a scene, or of the `mechanism` of a scene's content.

        Raises:
            SceneError: the content describes no car.
        """
        part = part.mechanism if isinstance(part, Scene) else part
        part = part if isinstance(part, MechanismPart) else MechanismPart.checked(part, "a car")
        given = {name: getattr(part, name) for name in ("title", *TABLES)}
        # A shipped mechanism has no tables in the scene.
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
        """The bodies, rods, slides and inputs of its mechanism, with every point that a car may have.

        Raises:
            SceneError: the content describes no car.
        """
        return MechanismPart.checked(self.mechanism, "a car").file.structures[self.closure]

    @property
    def array(self) -> dict[str, Array]:
        """The hardpoints as arrays, (3,) each."""
        return {name: np.array(place) for name, place in self.points.items()}

    @property
    def size(self) -> float:
        """Its largest extent along an axis, mm."""
        return float(np.ptp(np.array(list(self.points.values())), axis=0).max())

    def room(self, name: str, share: tuple[float, float]) -> float:
        """The range of an input, rad or mm; `share` gives it in rad, and as a share of the car's size."""
        return share[0] if self.structure.inputs[name].unit == "rad" else share[1] * self.size

    def direction(self, name: str) -> Array:
        """A direction of the car, unit vector: up, right, down, left, forward (up x right) or rearward."""
        return car_directions({"up": self.up, "right": self.right})[name]

    def drawn_as(self, points: Mapping[str, Array]) -> Car:
        """This car with other hardpoints."""
        return replace(self, points={name: as_tuple(place) for name, place in points.items()})

    def _each(self, put: Callable[[Array], Array]) -> Car:
        return self.drawn_as({name: put(place) for name, place in self.array.items()})

    def mirrored(self) -> Car:
        """The suspension of the other side, mirrored in the car's plane through the origin."""
        right, side = np.array(self.right), "left" if self.side == "right" else "right"
        return replace(self._each(lambda place: place - 2.0 * (place @ right) * right), side=side)

    def turned(self, turn: Array) -> Car:
        """The whole car, with its axes, turned by an orthogonal matrix of determinant 1."""
        up, right = (as_tuple(turn @ np.array(axis)) for axis in (self.up, self.right))
        return replace(self._each(lambda place: turn @ place), up=up, right=right)

    def moved(self, away: Array) -> Car:
        """The whole car moved by a vector, mm."""
        return self._each(lambda place: place + away)

    def scaled(self, scale: float) -> Car:
        """The car scaled about the origin."""
        radius = None if self.wheel_radius is None else scale * self.wheel_radius
        return replace(self._each(lambda place: scale * place), wheel_radius=radius)


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
    """The content of a scene of a car.

    Args:
        laws: laws of the inputs, rad and mm over s.
        start, stop: s; without a stop there is a single instant.
        samples: number of instants; if not given, three for a motion.
        tolerance: mm.
        effects: by default all that the car has and every model computes.
    Raises:
        SceneError: effects are not given, and the content is no valid scene.
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
    # Gradients follow from the other effects and take as long; models in trees give no jerks.
    had = (EFFECTS[name] for name in Scene.from_mapping(content).mechanism.effects)
    plain = [one.name for one in had if not (one.way or one.base) and one.derivative <= 2]
    return content | {"effects": plain}


def _input(law: Law) -> dict[str, Any]:
    if isinstance(law, Mapping):
        return dict(law)
    return {"polynomial": list(law)} if isinstance(law, Sequence) else {"constant": float(law)}


def rotation(axis: int, cosine: float, sine: float) -> Array:
    """The rotation matrix about a coordinate axis (0 to 2) by the angle with this cosine and sine."""
    turn = np.eye(3)
    first, second = (axis + 1) % 3, (axis + 2) % 3
    turn[[first, second], [first, second]] = cosine
    turn[first, second], turn[second, first] = -sine, sine
    return turn


def any_rotation(seed: int | np.random.Generator) -> Array:
    """A random rotation matrix; equal seeds give equal matrices."""
    turn, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    return np.asarray(turn * np.sign(np.linalg.det(turn)))


def as_tuple(vector: Array) -> Point:
    """A vector as a tuple of three floats."""
    x, y, z = (float(component) for component in vector)
    return x, y, z


def unit(vector: Array) -> Array:
    """The unit vector in the direction of a vector."""
    return np.asarray(vector / np.linalg.norm(vector))
