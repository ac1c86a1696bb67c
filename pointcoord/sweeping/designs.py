"""Designs of one suspension: a scene, and the hardpoint coordinates that vary from design to design.

A coordinate has the name of its point and axis, such as lower_ball_joint.z, and a column of values. For a
grid only the values of each coordinate are stored, so a grid takes almost no memory, however many designs it
has.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from pointcoord.errors import UnknownName, WrongArgument
from pointcoord.linkage.topology import Topology
from pointcoord.numerics.arrays import Array, Indices
from pointcoord.results.read_only import ReadOnly
from pointcoord.scene.scene_file import Scene
from pointcoord.wording import shown

AXES = ("x", "y", "z")
# A larger grid is a mistake: with 100 instants and a microsecond each it would take more than a day.
MOST = 10**9


@dataclass(frozen=True)
class Column(ReadOnly):
    """Values of one coordinate: design number k has values[(k // repeat) % len(values)], mm."""

    values: Array
    repeat: int = 1

    def of(self, numbers: Indices) -> Array:
        return np.asarray(self.values[(numbers // self.repeat) % len(self.values)])


@dataclass(frozen=True)
class Designs(ReadOnly):
    """Designs of one suspension; make them with `designs_of` or `grid_of`.

    Attributes:
        scene: the scene that all designs share.
        count: number of designs; they are numbered from 0.
        columns: values of each coordinate that varies, by coordinate, mm.
    """

    scene: Scene
    count: int
    columns: Mapping[str, Column]

    @cached_property
    def following(self) -> Mapping[str, str]:
        """Points of the chassis that move with another hardpoint, by name: the point that each moves with.

        A rack centre that is drawn at the inner end of the tie rod moves with that end.
        """
        drawn, topology = self.scene.mechanism.points, self.scene.mechanism.topology
        varied = {coordinate.rpartition(".")[0] for coordinate in self.columns}
        return {
            name: other
            for name, other in topology.stand_ins.items()
            if name in topology.chassis and drawn[name] == drawn[other] and name not in varied
        }

    def varied(self, numbers: Indices) -> dict[str, Array]:
        """Values of each coordinate that varies in some designs, by coordinate, each (n,), mm."""
        return {coordinate: column.of(numbers) for coordinate, column in self.columns.items()}

    def points(self, numbers: Indices) -> dict[str, Array]:
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
            WrongArgument: the design does not exist.
            SceneError: the scene of the design cannot be solved.
        """
        if not 0 <= number < self.count:
            raise WrongArgument(f"design {number}", "does not exist", f"0 to {self.count - 1}")
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
    """Designs from a list of values for each point or coordinate that varies.

    Args:
        points: positions of each point in all designs, (D, 3), mm; or values of a coordinate, such as
            lower_ball_joint.z, (D,). One position, (3,), or one number holds for all designs.
        offsets: positions or values relative to the drawing of the scene.
    Raises:
        UnknownName: no point or axis has this name.
        WrongArgument: values of a wrong shape, columns of different lengths, or a coordinate given twice.
    """
    values = _coordinates(scene, points or {}, offsets or {})
    counts = {name: len(column) for name, column in values.items() if column.ndim}
    count = max(counts.values(), default=1)
    for name, own in counts.items():
        if own != count:
            longest = max(counts, key=lambda name: counts[name])
            raise WrongArgument(name, f"has {own} values, but {longest} has {count}", "as many of each")
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
        points: values of each coordinate, such as lower_ball_joint.z, (n,), mm.
        offsets: values relative to the drawing of the scene.
    Raises:
        UnknownName: no point or axis has this name.
        WrongArgument: values that are not a list of numbers, an empty list, a coordinate given twice, or too
            many designs.
    """
    for name in (*(points or {}), *(offsets or {})):
        if "." not in name:
            allowed = f"{name}.x, {name}.y or {name}.z with its values"
            raise WrongArgument(name, "is not a coordinate of a grid", allowed)
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
    """The values of every coordinate that varies, by coordinate, each (D,) or (), mm."""
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
    """The named coordinates, with all three coordinates of a named point; those of all points unless named.

    A rack centre that moves with the end of the tie rod is left out unless named.

    Raises:
        UnknownName: no point or axis has this name.
    """
    points = scene.mechanism.points
    going = () if named else Designs(scene, 1, {}).following
    some = (name for name in named or points if name not in going)
    return tuple(one for name in some for one in coordinates_named(name, points))


def coordinates_named(name: str, points: Collection[str]) -> tuple[str, ...]:
    """The coordinates that a name means: one coordinate, such as lower_ball_joint.z, or all three of a point.

    Raises:
        UnknownName: no point or axis has this name.
    """
    # The name of a point of a part contains a dot.
    if name in points:
        return tuple(f"{name}.{axis}" for axis in AXES)
    point, _, axis = name.rpartition(".")
    if point not in points:
        raise UnknownName("point", point if point and axis in AXES else name, points)
    if axis not in AXES:
        raise UnknownName(f"axis of {point}", axis, AXES)
    return (name,)


def _split(name: str, numbers: ArrayLike, topology: Topology) -> dict[str, Array]:
    """The given values of a point or a coordinate, by coordinate."""
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
