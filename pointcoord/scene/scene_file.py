"""The scene file: which mechanism, which inputs, which instants, which effects, how accurate.

A scene is checked when it is read. Every fault names the file, the key, the value and what is allowed.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from itertools import pairwise
from pathlib import Path
from typing import IO, Any, Literal

import numpy as np
from numpy.typing import NDArray

from pointcoord.effects.registry import EFFECTS
from pointcoord.errors import SceneError
from pointcoord.linkage.car_axes import CarAxes
from pointcoord.linkage.topology import Topology
from pointcoord.results.even_instants import even_instants
from pointcoord.scene.checks import (
    list_of,
    number,
    one_of,
    optional,
    part,
    positive,
    table_of,
    text,
    vector,
    whole_number,
)
from pointcoord.scene.drawing_doubts import drawing_doubts
from pointcoord.scene.messages import meant, shown
from pointcoord.scene.scene_part import Part, key
from pointcoord.scene.scene_text import parsed, read_file, read_stream
from pointcoord.suspensions import SUSPENSIONS
from pointcoord.time_functions import Polynomial, Sine, Table, TimeFunction

Vector = tuple[float, float, float]
Others = Mapping[str, Any]
"""The keys of a part that come before one, with their values."""

# The built-in ones. (importlib.resources takes as long to import as a fifth of numpy.)
SCENES = Path(__file__).parents[1] / "scenes"

# Seconds. The power of two above 2e15 s, 2^51, is the largest unit of time of a motion; to the 20th
# power, the order of its series, it stays below the largest number, 2^1024.
FARTHEST = 1e15
# Instants of one scene; a position, a velocity and an acceleration of ten points each take 7 GB at this.
MOST_SAMPLES = 10_000_000


def _known_type(type: str, others: Others) -> str:
    if type not in SUSPENSIONS:
        hint = meant(type, SUSPENSIONS)
        raise ValueError(f"no suspension is called {shown(type)}{hint}; allowed: {', '.join(SUSPENSIONS)}")
    return type


def _known_closure(closure: str, others: Others) -> str:
    if "type" in others:  # or else that is the fault
        closures = SUSPENSIONS[others["type"]].closures
        if closure not in closures:
            raise ValueError(
                f"a {others['type']} has no closure called {shown(closure)}; allowed: {', '.join(closures)}"
            )
    return closure


def _known_points(points: dict[str, Vector], others: Others) -> dict[str, Vector]:
    if not {"type", "closure"} <= others.keys():
        return points
    type = others["type"]
    topology = SUSPENSIONS[type].closures[others["closure"]]
    extra = [name for name in points if name not in topology.points]
    missing = [name for name in topology.required_points if name not in points]
    if extra:
        elsewhere = [one for one, kind in SUSPENSIONS.items() if extra[0] in kind.points]
        hint = f", which is a point of a {elsewhere[0]}" if elsewhere else meant(extra[0], topology.points)
        raise ValueError(
            f"no point of a {type} is called {shown(extra[0])}{hint}; allowed: {', '.join(topology.points)}"
        )
    if missing:
        raise ValueError(f"{missing[0]!r} is missing; needed: {', '.join(topology.required_points)}")
    return topology.with_defaults(points)


def _points_of_the_car(points: tuple[str, ...] | None, others: Others) -> tuple[str, ...] | None:
    if points is None or "mechanism" not in others:
        return points
    there = others["mechanism"].topology.points
    if not points:
        raise ValueError(
            f"none is named; allowed: one or more of {', '.join(there)}; without this key all of them"
        )
    for place, name in enumerate(points):
        if name not in there:
            raise ValueError(
                f"no point of this car is called {shown(name)}{meant(name, there)}; "
                f"allowed: {', '.join(there)}"
            )
        if name in points[:place]:
            raise ValueError(f"{name!r} is named twice; allowed: each point once")
    return points


def _known_effects(effects: tuple[str, ...], others: Others) -> tuple[str, ...]:
    for name in effects:
        if name not in EFFECTS:
            givers = [effect.name for effect in EFFECTS.values() if name in (effect.names or ())]
            hint = f" ({givers[0]!r} gives it)" if givers else meant(name, EFFECTS)
            raise ValueError(f"no effect is called {shown(name)}{hint}; allowed: {', '.join(EFFECTS)}")
    return effects


class MechanismPart(Part):
    """The type of suspension, its side of the car, its hardpoints in mm and the car's axes.

    `closure` says what becomes of a drawing that does not close: `drawn` takes it as it stands, others put
    points in place (see the type's file in `suspensions`). `points` has an entry also for those points of the
    chassis that the file leaves to others that stand in for them.
    """

    type: str = key(text, agrees=_known_type)
    closure: str = key(text, default="drawn", agrees=_known_closure)
    side: Literal["left", "right"] = key(one_of("left", "right"), default="left")
    up: Vector = key(vector, default=(0.0, 0.0, 1.0))
    right: Vector = key(vector, default=(0.0, 1.0, 0.0))
    points: dict[str, Vector] = key(table_of(vector), agrees=_known_points)

    def agree(self) -> None:
        """Its axes, its side and its spin axis have a meaning."""
        self._orthonormal()
        self._wheel_outboard()
        self._spin_axis()

    def _orthonormal(self) -> None:
        up, right = np.array(self.up), np.array(self.right)
        # Components printed with 15 digits leave 1e-15 in each product; anything above is a slip.
        with np.errstate(over="ignore", invalid="ignore"):
            worst = np.max(np.abs([up @ up - 1.0, right @ right - 1.0, up @ right]))
        if not worst <= 1e-12:
            raise ValueError(f"up {self.up} and right {self.right} are not unit vectors at right angles")

    def _wheel_outboard(self) -> None:
        inner, wheel = self.topology.inboard, self.topology.wheel_centre
        with np.errstate(over="ignore", invalid="ignore"):
            inboard = float((np.array(self.points[inner]) - np.array(self.points[wheel])) @ self.outboard)
        if inboard >= 0.0:
            other = "right" if self.side == "left" else "left"
            raise ValueError(
                f"{wheel} lies {inboard:.6g} mm inboard of {inner} for side = {self.side!r}; allowed: "
                f"{wheel} outboard of {inner}, here towards {'-' if self.side == 'left' else '+'}right "
                f"{self.right}; if y points to the left in your axes, say so with right = [0.0, -1.0, 0.0]; "
                f"if it is a wheel of the other side, try side = {other!r}"
            )

    def _spin_axis(self) -> None:
        inner, outer = self._whole.wheel_axis
        if self.points.get(inner) == self.points[outer]:
            raise ValueError(
                f"{inner} and {outer} are at the same place, so that the wheel's spin axis has "
                "no direction; allowed: two points of the axis apart from each other"
            )

    @property
    def topology(self) -> Topology:
        """The linkage that its points are put on."""
        return self._whole.given(self.points)

    @property
    def _whole(self) -> Topology:
        """The linkage with every point that a car may give."""
        return SUSPENSIONS[self.type].closures[self.closure]

    @property
    def axis_point(self) -> str:
        """The point by which a car can give its spin axis an inner end of its own."""
        return self._whole.wheel_axis[0]

    @property
    def defaults_taken(self) -> tuple[str, ...]:
        """What the scene leaves to us and what is seen in the results, in words."""
        taken = self.topology.wheel_axis[0]
        if taken == self.axis_point:
            return ()
        return (f"{self.axis_point} is not given: the wheel's spin axis starts at {taken}",)

    @property
    def doubts(self) -> tuple[str, ...]:
        """What looks wrong with the drawing although it can be solved, in words."""
        points = {name: np.array(place) for name, place in self.points.items()}
        axes = CarAxes(np.array(self.up), np.array(self.right), self.outboard)
        return drawing_doubts(self.topology, points, axes)

    @property
    def outboard(self) -> NDArray[np.float64]:
        """Unit vector away from the car's middle."""
        return np.array(self.right) * (-1.0 if self.side == "left" else 1.0)


class SinePart(Part):
    """offset + amplitude sin(angular_frequency t + phase)."""

    amplitude: float = key(number)
    angular_frequency: float = key(number)
    phase: float = key(number, default=0.0)
    offset: float = key(number, default=0.0)


class TablePart(Part):
    """A cubic spline through values at increasing times."""

    times: tuple[float, ...] = key(list_of(number, at_least=4))
    values: tuple[float, ...] = key(list_of(number, at_least=4))

    def agree(self) -> None:
        """Its times increase, and its spline is finite."""
        if len(self.times) != len(self.values):
            raise ValueError(f"{len(self.times)} times and {len(self.values)} values; allowed: as many")
        if not all(earlier < later for earlier, later in pairwise(self.times)):
            raise ValueError("times do not increase; allowed: strictly increasing times")
        if not Table(self.times, self.values).finite:
            raise ValueError(
                "the spline through the table is not finite; allowed: smaller values, or times further apart"
            )


class InputPart(Part):
    """One input over time: exactly one of constant, polynomial (from t^0 up), sine or table."""

    constant: float | None = key(optional(number), default=None)
    polynomial: tuple[float, ...] | None = key(optional(list_of(number, at_least=1)), default=None)
    sine: SinePart | None = key(optional(part(SinePart)), default=None)
    table: TablePart | None = key(optional(part(TablePart)), default=None)

    def agree(self) -> None:
        """It is of one kind."""
        given = [
            name for name in ("constant", "polynomial", "sine", "table") if getattr(self, name) is not None
        ]
        if len(given) != 1:
            raise ValueError(
                f"{' and '.join(given) or 'nothing'} given; "
                "allowed: exactly one of constant, polynomial, sine, table"
            )

    @property
    def function(self) -> TimeFunction:
        """The input as a function of time."""
        if self.constant is not None:
            return Polynomial((self.constant,))
        if self.polynomial is not None:
            return Polynomial(self.polynomial)
        if self.sine is not None:
            return Sine(self.sine.amplitude, self.sine.angular_frequency, self.sine.phase, self.sine.offset)
        assert self.table is not None  # the validator has seen that one is given
        return Table(self.table.times, self.table.values)


class TimePart(Part):
    """The instants: `samples` of them evenly from start to stop, both included; s."""

    start: float = key(number)
    stop: float = key(number)
    samples: int = key(whole_number(1, MOST_SAMPLES))

    def agree(self) -> None:
        """It goes forwards, within what a motion can count."""
        for name, instant in (("start", self.start), ("stop", self.stop)):
            if abs(instant) > FARTHEST:
                raise ValueError(f"{name} is {instant} s; allowed: {-FARTHEST:g} to {FARTHEST:g} s")
        if self.samples == 1 and self.start != self.stop:
            raise ValueError(
                f"one sample from {self.start} to {self.stop}; allowed: start = stop, or 2 samples"
            )
        if self.samples > 1 and not self.start < self.stop:
            raise ValueError(f"start {self.start} is not before stop {self.stop}; allowed: start < stop")


class Scene(Part):
    """A checked scene; read one with `Scene.load` or make one with `Scene.from_mapping`.

    `points` names the points that are reported, all of them if it is not given; what neither they nor the
    effects hang on is not solved for.
    """

    title: str = key(text, default="")
    effects: tuple[str, ...] = key(list_of(text), default=(), agrees=_known_effects)
    tolerance: float = key(positive, default=1e-9)
    mechanism: MechanismPart = key(part(MechanismPart))
    inputs: dict[str, InputPart] = key(table_of(part(InputPart)))
    time: TimePart = key(part(TimePart))
    points: tuple[str, ...] | None = key(optional(list_of(text)), default=None, agrees=_points_of_the_car)

    def agree(self) -> None:
        """Its effects and its inputs belong to its mechanism."""
        self._effects_have_a_meaning()
        self._inputs_fit()

    def _effects_have_a_meaning(self) -> None:
        topology, points = self.mechanism.topology, self.mechanism.points
        for name in self.effects:
            problem = EFFECTS[name].refusal(topology, points)
            if problem:
                raise ValueError(problem)

    def _inputs_fit(self) -> None:
        topology = self.mechanism.topology
        for name in self.inputs:
            if name not in topology.inputs:
                hint = meant(name, topology.inputs)
                raise ValueError(
                    f"no input is called {shown(name)}{hint}; allowed: {', '.join(topology.inputs)}"
                )
        for name in topology.required_inputs:
            if name not in self.inputs:
                raise ValueError(f"input {name!r} is missing; needed: {', '.join(topology.required_inputs)}")
        for name, law in self.inputs.items():
            table = law.table
            if table is not None and not (
                table.times[0] <= self.time.start and self.time.stop <= table.times[-1]
            ):
                raise ValueError(
                    f"the table of input {name!r} covers {table.times[0]} to {table.times[-1]} s; "
                    f"allowed: all of time, {self.time.start} to {self.time.stop} s"
                )

    @property
    def reported_points(self) -> tuple[str, ...]:
        """The points that are reported, in the order of the mechanism's."""
        every = self.mechanism.topology.points
        return tuple(name for name in every if self.points is None or name in self.points)

    @property
    def unreported_points(self) -> tuple[str, ...]:
        """The others."""
        return tuple(name for name in self.mechanism.topology.points if name not in self.reported_points)

    @property
    def instants(self) -> NDArray[np.float64]:
        """The instants of the scene, shape (samples,), s."""
        return even_instants(self.time.start, self.time.stop, self.time.samples)

    @property
    def functions(self) -> dict[str, TimeFunction]:
        """Every input as a function of time."""
        return {name: law.function for name, law in self.inputs.items()}

    @classmethod
    def from_mapping(cls, content: Mapping[str, Any], source: str = "scene") -> Scene:
        """Check a scene given as plain data, as `tomllib` reads it.

        Raises:
            SceneError: the first fault, with its key; further ones are counted.
        """
        return cls.checked(content, source)

    @classmethod
    def load(cls, name: str | Path) -> Scene:
        """Read a built-in scene by name, or a scene file by path.

        Raises:
            SceneError: there is no such scene, it is not written as it must be, or it is no regular file of
                at most 64 MB.
        """
        if not isinstance(name, str | os.PathLike):
            allowed = f"a path, or one of {', '.join(built_in_scenes())}"
            raise SceneError(shown(name), "", f"is a {type(name).__name__}, and names no scene", allowed)
        if str(name) in built_in_scenes():
            written = (SCENES / f"{name}.toml").read_bytes()
        else:
            written = read_file(name, f"a path, or one of {', '.join(built_in_scenes())}")
        return cls.from_mapping(parsed(written, str(name)), str(name))

    @classmethod
    def read(cls, stream: IO[bytes], source: str = "standard input") -> Scene:
        """Read a scene from an open binary stream, such as `sys.stdin.buffer`.

        Raises:
            SceneError: it is not written as it must be, or has no end within 64 MB.
        """
        return cls.from_mapping(parsed(read_stream(stream, source), source), source)


def built_in_scenes() -> tuple[str, ...]:
    """Names of the scenes that come with the package."""
    return tuple(sorted(path.stem for path in SCENES.glob("*.toml")))
