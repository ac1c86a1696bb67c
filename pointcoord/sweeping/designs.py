"""Designs of one suspension: a scene, and what varies from design to design.

A coordinate is called by its point and its axis, such as lower_ball_joint.z, and varies by a column of
values. A column of a grid is kept as the values of its axis, so that a grid takes no memory however many
designs it has.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pointcoord.errors import UnknownName, WrongArgument
from pointcoord.linkage.topology import Topology
from pointcoord.results.read_only import ReadOnly
from pointcoord.scene.scene_file import Scene
from pointcoord.wording import shown

Array = NDArray[np.float64]
Numbers = NDArray[np.intp]

AXES = ("x", "y", "z")
# Grids of more designs are a slip: at a microsecond each of 100 instants they would take a day.
MOST = 10**9


@dataclass(frozen=True)
class Column(ReadOnly):
    """Values of one coordinate: design number k has values[(k // repeat) % len(values)], mm."""

    values: Array
    repeat: int = 1

    def of(self, numbers: Numbers) -> Array:
        return np.asarray(self.values[(numbers // self.repeat) % len(self.values)])


@dataclass(frozen=True)
class Designs(ReadOnly):
    """Designs of one suspension; make them with `designs_of` or `grid_of`.

    Attributes:
        scene: what is not varied.
        count: how many designs there are; they are numbered from 0.
        columns: by coordinate, what varies: where it is drawn, mm.
    """

    scene: Scene
    count: int
    columns: Mapping[str, Column]

    @cached_property
    def following(self) -> Mapping[str, str]:
        """Points of the chassis that go where others go: by name, the point that each goes along with.

        A rack that is drawn where the end of the tie rod is drawn belongs to it.
        """
        drawn, topology = self.scene.mechanism.points, self.scene.mechanism.topology
        varied = {coordinate.rpartition(".")[0] for coordinate in self.columns}
        return {
            name: other
            for name, other in topology.stand_ins.items()
            if name in topology.chassis and drawn[name] == drawn[other] and name not in varied
        }

    def varied(self, numbers: Numbers) -> dict[str, Array]:
        """By coordinate its values in some designs, each (n,), mm."""
        return {coordinate: column.of(numbers) for coordinate, column in self.columns.items()}

    def points(self, numbers: Numbers) -> dict[str, Array]:
        """The hardpoints of some designs, each (n, 3), mm."""
        found = {
            name: np.tile(np.array(place, dtype=float), (len(numbers), 1))
            for name, place in self.scene.mechanism.points.items()
        }
        for coordinate, values in self.varied(numbers).items():
            point, _, axis = coordinate.rpartition(".")
            found[point][:, AXES.index(axis)] = values
        return found | {name: found[other].copy() for name, other in self.following.items()}

    def design(self, number: int) -> Scene:
        """The scene of one design, checked.

        Raises:
            WrongArgument: there is no such design.
            SceneError: it is no scene that could be solved.
        """
        if not 0 <= number < self.count:
            raise WrongArgument(f"design {number}", "is none of these", f"0 to {self.count - 1}")
        points = {name: tuple(place[0].tolist()) for name, place in self.points(np.array([number])).items()}
        part = self.scene.mechanism
        content = {name: getattr(self.scene, name) for name in self.scene.model_fields_set}
        content["mechanism"] = {name: getattr(part, name) for name in part.model_fields_set} | {
            "points": points
        }
        return Scene.checked(content, f"design {number}")


def designs_of(
    scene: Scene,
    points: Mapping[str, ArrayLike] | None = None,
    offsets: Mapping[str, ArrayLike] | None = None,
) -> Designs:
    """Designs from a list of values for whatever varies.

    Args:
        points: by point, where each design draws it, (D, 3), mm; or by coordinate, such as
            lower_ball_joint.z, (D,). What is given once, (3,) or a number, holds for all designs.
        offsets: the same, measured from where the scene draws it.
    Raises:
        UnknownName: no point or axis is called so.
        WrongArgument: numbers of another shape, of another count than the others, or of a coordinate twice.
    """
    values = _coordinates(scene, points or {}, offsets or {})
    counts = {name: len(column) for name, column in values.items() if column.ndim}
    count = max(counts.values(), default=1)
    for name, own in counts.items():
        if own != count:
            longest = max(counts, key=lambda name: counts[name])
            raise WrongArgument(name, f"has {own} values where {longest} has {count}", "as many of each")
    if not count:
        raise WrongArgument(next(iter(counts)), "has no values", "one or more designs")
    return Designs(scene, count, {name: Column(np.atleast_1d(column)) for name, column in values.items()})


def grid_of(
    scene: Scene,
    points: Mapping[str, ArrayLike] | None = None,
    offsets: Mapping[str, ArrayLike] | None = None,
) -> Designs:
    """Every combination of values of some coordinates; the last coordinate changes from design to design.

    Args:
        points: by coordinate, such as lower_ball_joint.z, the values that it takes, (n,), mm.
        offsets: the same, measured from where the scene draws it.
    Raises:
        UnknownName: no point or axis is called so.
        WrongArgument: something else than a list of numbers, an empty one, a coordinate twice, or too many
            designs.
    """
    for name in (*(points or {}), *(offsets or {})):
        if "." not in name:
            allowed = f"{name}.x, {name}.y or {name}.z with its values"
            raise WrongArgument(name, "is no axis of a grid", allowed)
    values = _coordinates(scene, points or {}, offsets or {})
    lengths = {name: int(column.size) for name, column in values.items()}
    for name, length in lengths.items():
        if not length:
            raise WrongArgument(name, "has no values", "one or more")
    columns, repeat = {}, 1
    for name in reversed(values):
        columns[name] = Column(np.atleast_1d(values[name]), repeat)
        repeat *= lengths[name]
    if repeat > MOST:
        sizes = " x ".join(str(length) for length in lengths.values())
        raise WrongArgument("the grid", f"has {sizes} = {repeat:.3g} designs", f"at most {MOST:.0e}")
    return Designs(scene, repeat, {name: columns[name] for name in values})


def _coordinates(
    scene: Scene, points: Mapping[str, ArrayLike], offsets: Mapping[str, ArrayLike]
) -> dict[str, Array]:
    """What varies by coordinate, each (D,) or (), mm."""
    found: dict[str, Array] = {}
    drawn, topology = scene.mechanism.points, scene.mechanism.topology
    for given, relative in ((points, False), (offsets, True)):
        for name, numbers in given.items():
            for coordinate, values in _split(name, numbers, topology).items():
                if coordinate in found:
                    raise WrongArgument(coordinate, "is varied twice", "once")
                point, _, axis = coordinate.rpartition(".")
                found[coordinate] = values + drawn[point][AXES.index(axis)] if relative else values
    return found


def coordinates_of(scene: Scene, named: Sequence[str] = ()) -> tuple[str, ...]:
    """Coordinates by their names, and all three of a point that is named whole; of every point unless named.

    A rack that goes along with the end of the tie rod has no coordinates of its own unless it is named.

    Raises:
        UnknownName: no point or axis is called so.
    """
    points = scene.mechanism.points
    going = () if named else Designs(scene, 1, {}).following
    some = (name for name in named or points if name not in going)
    return tuple(one for name in some for one in coordinates_named(name, points))


def coordinates_named(name: str, points: Collection[str]) -> tuple[str, ...]:
    """The coordinates that a name means: one such as lower_ball_joint.z, or all three of a point.

    Raises:
        UnknownName: no point or axis is called so.
    """
    # A point of a part has a dot in its own name.
    if name in points:
        return tuple(f"{name}.{axis}" for axis in AXES)
    point, _, axis = name.rpartition(".")
    if point not in points:
        raise UnknownName("point", point if point and axis in AXES else name, points)
    if axis not in AXES:
        raise UnknownName(f"axis of {point}", axis, AXES)
    return (name,)


def _split(name: str, numbers: ArrayLike, topology: Topology) -> dict[str, Array]:
    """Values of a point or of a coordinate by coordinate."""
    named = coordinates_named(name, topology.points)
    try:
        values = np.array(numbers, dtype=float)
    except (TypeError, ValueError):
        raise WrongArgument(name, f"is {shown(numbers)}", "numbers") from None
    if len(named) == 1:
        if values.ndim > 1:
            raise WrongArgument(name, f"has the shape {values.shape}", "a number for each design, (D,)")
        return {name: values}
    if values.shape[-1:] != (3,) or values.ndim > 2:
        raise WrongArgument(name, f"has the shape {values.shape}", "three numbers for each design, (D, 3)")
    return {coordinate: values[..., i] for i, coordinate in enumerate(named)}
