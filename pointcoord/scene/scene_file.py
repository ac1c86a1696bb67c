"""The scene file: mechanism, inputs, instants, effects and tolerance.

A scene is checked when it is read. Every error names the file, the key, the value and what is allowed.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Collection, Iterator, Mapping
from functools import cached_property, lru_cache
from pathlib import Path
from typing import IO, Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, PrivateAttr, ValidationInfo, field_validator

from pointcoord.effects.conventions import ConventionName
from pointcoord.effects.effect import Effect
from pointcoord.effects.point_states import FIRST_NUMBERED, NAMED, STATES
from pointcoord.effects.registry import EFFECTS
from pointcoord.errors import MechanismError, SceneError
from pointcoord.linkage.car_axes import CarAxes
from pointcoord.linkage.hardpoints import build_mechanism
from pointcoord.linkage.topology import Topology
from pointcoord.mechanism.faults import TableFault, no_such
from pointcoord.mechanism.file import (
    MechanismFile,
    is_path,
    mechanism_file,
    read_tables,
    shipped,
    whole_tables,
)
from pointcoord.mechanism.freedoms import askew_hinges, free_directions
from pointcoord.mechanism.inputs import CHASSIS, LENGTHS, Names
from pointcoord.mechanism.structure import TABLES, Structure
from pointcoord.numerics.rounding import EPS
from pointcoord.results.even_instants import even_instants
from pointcoord.scene.drawing_doubts import drawing_doubts
from pointcoord.scene.input_part import LAWS, SWEEP, InputPart, kinds_of, read_in, swept, with_drawn
from pointcoord.scene.own_units import MM, in_directions, in_mm
from pointcoord.scene.scene_part import (
    AS_LIST,
    NotZero,
    Number,
    Part,
    PlainTable,
    Positive,
    Share,
    Text,
    Vector,
    Whole,
)
from pointcoord.time_functions import TimeFunction
from pointcoord.toml_text import parsed, read_file, read_stream
from pointcoord.wording import meant, shown

# The built-in scenes. (Importing importlib.resources would take a fifth of numpy's import time.)
SCENES = Path(__file__).parents[1] / "scenes"

# Time of a scene that gives none, for a single pose and for a sweep; s.
ONE_POSE = {"start": 0.0, "stop": 0.0, "samples": 1}
PLAIN_TIME = {"start": 0.0, "stop": 1.0, "samples": 101}
# Seconds. The unit of time of a motion is at most 2^51, the power of two above 2e15 s. Its 20th power (the
# order of the series) stays below the largest double, 2^1024.
FARTHEST = 1e15
Instant = Annotated[Number, Field(ge=-FARTHEST, le=FARTHEST)]
# Largest error in products of directions: ROUNDED for directions that were rotated in doubles, SLIP for those
# printed with 12 digits. A larger error is a mistake.
ROUNDED, SLIP = 16.0 * EPS, 1e-12
NO_DIRECTION = (0.0, 0.0, 0.0)
# Position of an axle along the car, seen from the middle.
AXLES: Mapping[Any, float] = {"front": -1.0, "rear": 1.0}
# The axes of common chassis inputs that a mechanism file may define.
TURNS = {"roll": "forward", "pitch": "left"}
# Most instants of a scene: at this number, positions, velocities and accelerations of ten points take 7 GB.
MOST_SAMPLES = 10_000_000


def _of_every_part(
    points: dict[str, Vector], file: MechanismFile, structure: Structure, right: Vector
) -> dict[str, Vector]:
    """Points by their full names: a name without a prefix is expanded to every part that has the point."""
    found: dict[str, Vector] = {}
    for name, place in points.items():
        of_parts = {
            f"{prefix}{name}": _mirrored(place, right) if mirrored else place
            for prefix, mirrored in file.mirrored.items()
            if name not in structure.points and f"{prefix}{name}" in structure.points
        }
        for own, where in (of_parts or {name: place}).items():
            if own not in points or own == name:
                found[own] = where
    return found


def _mirrored(place: Vector, right: Vector) -> Vector:
    """The mirror image at the car's middle plane."""
    out = 2.0 * sum(p * r for p, r in zip(place, right, strict=True))
    x, y, z = (p - out * r for p, r in zip(place, right, strict=True))
    return x, y, z


def _file_of(keys: Mapping[str, Any]) -> MechanismFile | None:
    """The mechanism described by a part's keys; None if they do not describe one."""
    if "type" not in keys or any(name not in keys for name in TABLES):
        return None
    if keys["type"] is not None:
        return mechanism_file(keys["type"])
    tables = {name: keys[name] for name in TABLES if keys[name] is not None}
    return _inline(json.dumps({"title": keys.get("title", ""), **tables})) if tables else None


@lru_cache(maxsize=64)
def _inline(tables: str) -> MechanismFile:
    return MechanismFile.of(json.loads(tables), "mechanism")


def _by_dotted_name(table: object, whole: Callable[[Mapping[str, Any]], bool]) -> object:
    """A nested table with dotted names: TOML reads left.wheel_centre as a table within a table."""
    if not isinstance(table, Mapping):
        return table
    found: dict[Any, Any] = {}
    for name, value in table.items():
        inner = _by_dotted_name(value, whole) if isinstance(value, Mapping) and not whole(value) else None
        if isinstance(name, str) and isinstance(inner, Mapping) and inner:
            found |= {f"{name}.{own}": each for own, each in inner.items()}
        else:
            found[name] = value
    return found


class CarPart(Part):
    """Data of the whole car, for the effects that need them.

    `axle` is the axle of the wheel. Lengths are in mm; the height of the centre of gravity is above the drawn
    ground. The shares are this axle's parts of the car's whole braking and driving force. The spring acts
    between the damper's ends; its rate is in N/mm.
    """

    axle: Literal["front", "rear"] | None = None
    wheelbase: Positive | None = None
    centre_of_gravity_height: Positive | None = None
    brake_share: Share | None = None
    drive_share: Share | None = None
    spring_rate: Positive | None = None
    spring_free_length: Positive | None = None

    @property
    def numbers(self) -> dict[str, float]:
        """The given values by name; `axle` is -1 for the front and +1 for the rear."""
        given = self.model_dump(exclude_none=True)
        return {name: AXLES.get(value, value) for name, value in given.items()}


class LoadPart(Part):
    """The load on a wheel at its contact point, along the scene's axes: force, N, and moment, N mm."""

    force: Vector
    moment: Vector = (0.0, 0.0, 0.0)


class MechanismPart(Part):
    """The mechanism, its side of the car, its drawn points in mm and the car's axes.

    The mechanism is a shipped one, named by `type`, or is given by its tables. A `type` that is the path of a
    mechanism file is replaced by that file's tables, so that a scene does not depend on the file. `closure`
    says how a drawing that does not close is corrected: `drawn` keeps the points, other closures move some.
    `points` also contains the chassis points that the scene omits, at the places of their stand-ins.
    """

    type: Text | None = None
    title: Text = ""
    bodies: PlainTable | None = None
    rods: PlainTable | None = None
    slides: PlainTable | None = None
    inputs: PlainTable | None = None
    roles: PlainTable | None = None
    stand_ins: PlainTable | None = None
    closures: PlainTable | None = None
    parts: PlainTable | None = None
    closure: Text = "drawn"
    side: Literal["left", "right"] = "left"
    up: Vector = (0.0, 0.0, 1.0)
    right: Annotated[Vector, Field(validate_default=True)] = (0.0, 1.0, 0.0)
    wheel_radius: Positive | None = None
    rack_per_turn: NotZero | None = None
    car: CarPart | None = None
    loads: dict[str, LoadPart] = Field(default_factory=dict)
    points: dict[str, Vector]

    short_forms = ("axes",)

    _driven: tuple[str, ...] | None = PrivateAttr(None)

    @classmethod
    def completed(cls, content: dict[str, Any]) -> dict[str, Any]:
        """The content with mechanism files in place of their paths, and points by their dotted names.

        Raises:
            SceneError: a mechanism file cannot be read, or something in it is wrong.
            TableFault: the tables are wrong, or are given together with a type.
        """
        content = in_directions(content)
        given = [name for name in TABLES if content.get(name) is not None]
        if content.get("type") is not None and given:
            problem = f"{given[0]} is given together with type = {shown(content['type'])}"
            raise TableFault((given[0],), problem, "a type, or the mechanism's tables and then no type")
        if is_path(content.get("type")):
            content |= read_tables(Path(content.pop("type")))
        elif given:
            content |= whole_tables({name: content[name] for name in given}, Path())
            MechanismFile.of({name: content[name] for name in given}, "mechanism")
        loads = content.get("loads")
        if isinstance(loads, Mapping) and not loads.keys().isdisjoint(LoadPart.model_fields):
            content["loads"] = {"": loads}
        if "points" in content:
            content["points"] = _by_dotted_name(content["points"], lambda table: False)
        return content

    @field_validator("type")
    @classmethod
    def _known_type(cls, type: str | None) -> str | None:
        if type is not None:
            mechanism_file(type)
        return type

    @field_validator("up", "right")
    @classmethod
    def _to_rounding(cls, direction: Vector, others: ValidationInfo) -> Vector:
        """The direction, corrected to full digits: models would each complete a printed one differently.

        `agree` refuses larger errors.
        """
        given, up = np.array(direction), np.array(others.data.get("up", NO_DIRECTION))
        with np.errstate(over="ignore", invalid="ignore"):
            off = max(abs(float(given @ given) - 1.0), abs(float(given @ up)))
        if not ROUNDED < off <= SLIP:
            return direction
        x, y, z = across = given - float(given @ up) * up
        size = float(np.linalg.norm(across))
        return float(x) / size, float(y) / size, float(z) / size

    @field_validator("closure")
    @classmethod
    def _known_closure(cls, closure: str, others: ValidationInfo) -> str:
        file = _file_of(others.data)
        if file is not None and closure not in file.closures:
            raise no_such(f"closure of a {file.name}", closure, file.closures)
        return closure

    @field_validator("points")
    @classmethod
    def _known_points(cls, points: dict[str, Vector], others: ValidationInfo) -> dict[str, Vector]:
        file = _file_of(others.data)
        if file is None or not {"closure", "right"} <= others.data.keys():
            return points
        structure = file.structures[others.data["closure"]]
        points = _of_every_part(points, file, structure, others.data["right"])
        for name in points:
            if name not in structure.points:
                raise no_such(f"point of a {file.name}", name, structure.points)
        for name in structure.required_points:
            if name not in points:
                raise ValueError(f"{name!r} is missing; needed: {', '.join(structure.required_points)}")
        standing = {
            name: points[other]
            for name, other in structure.stand_ins.items()
            if name in structure.bodies[CHASSIS] and other in points
        }
        return standing | points

    def agree(self) -> None:
        if _file_of(self.__dict__) is None:
            raise TableFault(("type",), "this key is missing", f"{', '.join(shipped())}, a path, or tables")
        self._orthonormal()
        self._wheel_outboard()
        self._spin_axis()
        self._loads_of_wheels()

    def _orthonormal(self) -> None:
        up, right = np.array(self.up), np.array(self.right)
        with np.errstate(over="ignore", invalid="ignore"):
            worst = np.max(np.abs([up @ up - 1.0, right @ right - 1.0, up @ right]))
        if not worst <= SLIP:
            raise ValueError(f"up {self.up} and right {self.right} are not unit vectors at right angles")

    def _wheels(self) -> Iterator[tuple[str, str]]:
        """Prefix of the roles of the whole mechanism and of each part, and the side of the car."""
        yield "", self.side
        yield from ((f"{part}.", side) for part, side in self._whole.sides.items())

    def _wheel_outboard(self) -> None:
        roles = self.structure.roles
        for prefix, side in self._wheels():
            inner, axis = roles.get(f"{prefix}inboard"), roles.get(f"{prefix}wheel_axis")
            if not isinstance(inner, str) or axis is None:
                continue
            wheel, outboard = axis[1], self.axes.on(side).outboard
            with np.errstate(over="ignore", invalid="ignore"):
                inboard = float((np.array(self.points[inner]) - np.array(self.points[wheel])) @ outboard)
            if inboard >= 0.0:
                other = "right" if side == "left" else "left"
                advice = (
                    f"its part needs side = {other!r}, or to be mirrored"
                    if prefix
                    else f"try side = {other!r}"
                )
                raise ValueError(
                    f"{wheel} lies {inboard:.6g} mm inboard of {inner} for side = {side!r}; allowed: "
                    f"{wheel} outboard of {inner}, here towards {'-' if side == 'left' else '+'}right "
                    f"{self.right}; if y points to the left in your axes, say so with right = [0.0, -1.0, "
                    f"0.0]; if it is a wheel of the other side, {advice}"
                )

    def _loads_of_wheels(self) -> None:
        sides = self._whole.sides
        for part in self.loads:
            if part not in sides and (part or sides):
                known = f"a table for one of its parts, {', '.join(sides)}" if sides else "force and moment"
                raise TableFault(("loads", part) if part else ("loads",), "names no wheel", known)

    def _spin_axis(self) -> None:
        roles = self.structure.roles
        for prefix, *_ in self._wheels():
            axis = roles.get(f"{prefix}wheel_axis")
            if axis is not None and self.points[axis[0]] == self.points[axis[1]]:
                own = self._whole.roles[f"{prefix}wheel_axis"][0]
                raise ValueError(
                    f"{axis[0]} and {axis[1]} are at the same place, so that the wheel's spin axis has "
                    f"no direction; allowed: a place of {own} away from {axis[1]}"
                )

    @property
    def driven(self) -> tuple[str, ...] | None:
        """The inputs that the scene drives; None for a part outside a scene."""
        return self._driven

    @property
    def name(self) -> str:
        """The mechanism's name in messages: its type, or the title of its tables."""
        return self.file.name

    @cached_property
    def file(self) -> MechanismFile:
        found = _file_of(self.__dict__)
        assert found is not None  # such a part fails its checks
        return found

    @property
    def structure(self) -> Structure:
        """Bodies, rods, slides and inputs of a car with these points, stand-ins applied."""
        return self._whole.drawn_with(self.points)

    @property
    def _whole(self) -> Structure:
        """The structure with every point that a car may give, without stand-ins."""
        return self.file.structures[self.closure]

    def plain(self, driven: Collection[str]) -> dict[str, Any]:
        """The mechanism as plain data, for models that compile it themselves.

        Args:
            driven: names of the driven inputs, chassis inputs included; only these are returned.
        Returns:
            Bodies, rods, slides, inputs and roles by name, every point as drawn (mm), the car's axes, its
            side, the wheel's radius and the rack's travel per turn (mm, or None), the given data of the
            whole car, and the loads (N, N mm).
        """
        structure = self.structure
        return {
            **structure.plain(driven),
            "name": self.name,
            "points": {name: list(self.points[name]) for name in structure.points},
            "up": list(self.up),
            "right": list(self.right),
            "side": self.side,
            "wheel_radius": self.wheel_radius,
            "rack_per_turn": self.rack_per_turn,
            "car": {} if self.car is None else self.car.model_dump(exclude_none=True),
            "loads": {part: {n: list(v) for n, v in load} for part, load in self.loads.items()},
        }

    @cached_property
    def topology(self) -> Topology:
        return self.file.topology(self.closure, self.driven, self.points, self.directions, self._lengths)

    @property
    def directions(self) -> dict[str, Vector]:
        """The scene's directions up and right."""
        return {"up": self.up, "right": self.right}

    @property
    def _lengths(self) -> dict[str, float]:
        given = {name: getattr(self, name) for name in LENGTHS}
        return {name: length for name, length in given.items() if length is not None}

    def drawn_inputs(self, driven: Collection[str]) -> dict[str, float]:
        """The drawn values of inputs, if these inputs are driven; rad or mm.

        Empty if the hardpoints make no mechanism that these inputs drive; the scene's checks report that.
        """
        known = [name for name in self.structure.inputs if name in driven]
        try:
            topology = self.file.topology(self.closure, known, self.points, self.directions, self._lengths)
            if topology.layout.unknowns != len(topology.labels):
                return {}
            mechanism = build_mechanism(topology, dict(self.points), self.directions)
        except MechanismError:
            return {}
        return {name: float(value) + 0.0 for name, value in mechanism.drawn_inputs.items()}

    @cached_property
    def freedoms(self) -> int:
        """Number of freedoms, which is the number of inputs needed.

        Raises:
            MechanismError: the mechanism has more equations than coordinates, and the drawing does not close.
        """
        return self.file.freedoms(self.closure, self.points, self.directions)

    @property
    def axis_point(self) -> str:
        """The optional point for the inner end of the spin axis; empty without a wheel axis."""
        axis = self._whole.roles.get("wheel_axis")
        return axis[0] if axis else ""

    @property
    def defaults_taken(self) -> tuple[str, ...]:
        """Notes on defaults that affect the results."""
        axis = self.structure.roles.get("wheel_axis")
        if not axis or axis[0] == self.axis_point:
            return ()
        return (f"{self.axis_point} is not given: the wheel's spin axis starts at {axis[0]}",)

    @property
    def doubts(self) -> tuple[str, ...]:
        """Warnings about what looks wrong in the drawing although it can be solved."""
        points = {name: np.array(place) for name, place in self.points.items()}
        return drawing_doubts(self.topology, points, self.axes)

    @property
    def axes(self) -> CarAxes:
        """The car's directions, wheel radius, car data and loads."""
        car = {} if self.car is None else self.car.numbers
        loads = {part: (np.array(load.force), np.array(load.moment)) for part, load in self.loads.items()}
        return CarAxes(np.array(self.up), np.array(self.right), self.outboard, self.wheel_radius, car, loads)

    @property
    def effects(self) -> tuple[str, ...]:
        """Names of the effects that this car has. Derivatives of points that have no name but a number are
        left out, since every car has them."""
        return tuple(
            name
            for name, effect in EFFECTS.items()
            if not ((effect.reports_states and effect.base) or self.refusal(effect))
        )

    def refusal(self, effect: Effect) -> str:
        """Why this car does not have an effect, and what to do; empty if it has."""
        return effect.refusal(self.topology, self.points, self.axes)

    @property
    def outboard(self) -> NDArray[np.float64]:
        """Unit vector away from the car's middle, on the wheel's side."""
        return np.array(self.right) * (-1.0 if self.side == "left" else 1.0)


class TimePart(Part):
    """The instants: `samples` evenly spaced instants from start to stop, both included; s."""

    start: Instant
    stop: Instant
    samples: Annotated[Whole, Field(ge=1, le=MOST_SAMPLES)]

    def agree(self) -> None:
        if self.samples == 1 and self.start != self.stop:
            raise ValueError(
                f"one sample from {self.start} to {self.stop}; allowed: start = stop, or 2 samples"
            )
        if self.samples > 1 and not self.start < self.stop:
            raise ValueError(f"start {self.start} is not before stop {self.stop}; allowed: start < stop")


class Scene(Part):
    """A checked scene; read one with `Scene.load` or make one with `Scene.from_mapping`.

    `points` names the points that are reported; all points by default. What neither these points nor the
    effects depend on is not solved for. `convention` chooses the convention in which tables, plots and result
    files give an angle asked for by its name; solving and comparing always use one definition.
    """

    title: Text = ""
    effects: Annotated[tuple[Text, ...], AS_LIST] = ()
    tolerance: Positive = 1e-9
    convention: ConventionName = "iso"
    mechanism: MechanismPart
    inputs: dict[str, InputPart]
    time: TimePart
    points: Annotated[Names, AS_LIST] | None = None

    short_forms = ("units",)

    @classmethod
    def completed(cls, content: dict[str, Any]) -> dict[str, Any]:
        """The content in mm, with inputs by dotted names (they may be in a table for each part), and sweeps
        as polynomials.

        Raises:
            SceneError: a table's file cannot be read.
            TableFault: a sweep is not a pair of numbers or has no time span; a unit is unknown.
        """
        if "inputs" not in content:
            return in_mm(content, ())
        content["inputs"] = read_in(_by_dotted_name(content["inputs"], _is_no_part), content.get("units", MM))
        if "units" in content:
            part = _part_of(content.get("mechanism"))
            known = {} if part is None else part.structure.inputs
            content = in_mm(content, [name for name, one in known.items() if one.unit == "mm"])
        inputs = content["inputs"]
        if isinstance(inputs, Mapping):
            if any(with_drawn(law, 0.0) != law for law in inputs.values()):
                part = _part_of(content.get("mechanism"))
                values = {} if part is None else part.drawn_inputs(inputs)
                inputs = {name: with_drawn(law, values.get(name, 0.0)) for name, law in inputs.items()}
            kinds = set().union(*map(kinds_of, inputs.values()))
            if SWEEP in kinds:
                content.setdefault("time", PLAIN_TIME)
            elif kinds == {"constant"}:
                content.setdefault("time", ONE_POSE)
            inputs = {n: swept(law, content.get("time"), ("inputs", n)) for n, law in inputs.items()}
        content["inputs"] = inputs
        return content

    @field_validator("effects")
    @classmethod
    def _known_effects(cls, effects: tuple[str, ...]) -> tuple[str, ...]:
        for name in effects:
            if name not in EFFECTS:
                givers = [
                    effect.name for effect in EFFECTS.values() if name.rpartition(".")[2] in effect.own_names
                ]
                if (order := name.removeprefix("derivative_")) in map(str, range(1, len(NAMED))):
                    hint = f" ({STATES[int(order)]!r} is its name)"
                else:
                    hint = f" ({givers[0]!r} gives it)" if givers else meant(name, EFFECTS)
                allowed = [name for name, effect in EFFECTS.items() if not effect.base]
                more = f"{FIRST_NUMBERED} to {STATES[-1]}, and gradients"
                raise TableFault(
                    (),
                    f"no effect is called {shown(name)}{hint}",
                    ", ".join((*allowed, more)),
                )
        return effects

    @field_validator("points")
    @classmethod
    def _points_of_the_car(
        cls, points: tuple[str, ...] | None, others: ValidationInfo
    ) -> tuple[str, ...] | None:
        if points is None or "mechanism" not in others.data:
            return points
        there = others.data["mechanism"].structure.points
        for name in points:
            if name not in there:
                raise no_such("point of this car", name, there)
        return points

    def agree(self) -> None:
        self._inputs_fit()
        self._effects_have_a_meaning()

    def _effects_have_a_meaning(self) -> None:
        for name in self.effects:
            problem = self.mechanism.refusal(EFFECTS[name])
            if problem:
                raise TableFault(("effects",), problem)

    def _inputs_fit(self) -> None:
        known = self.mechanism.structure.inputs
        for name in self.inputs:
            if name not in known:
                fault = no_such("input", name, known, ("inputs",))
                if name in TURNS:
                    turn = f'{name} = {{ turns = "chassis", about = "POINT", along = "{TURNS[name]}" }}'
                    fault.allowed += f"; to define it, write {turn} under [inputs] of your own mechanism file"
                raise fault
        self.mechanism._driven = tuple(name for name in known if name in self.inputs)
        self._inputs_hold_the_mechanism()
        for name, law in self.inputs.items():
            for table in law.tables:
                if table.times[0] <= self.time.start and self.time.stop <= table.times[-1]:
                    continue
                raise TableFault(
                    ("inputs", name),
                    f"the table of input {name!r} covers {table.times[0]} to {table.times[-1]} s",
                    f"all of time, {self.time.start} to {self.time.stop} s",
                )

    def _inputs_hold_the_mechanism(self) -> None:
        """Check that as many inputs are driven as there are freedoms; building checks that they hold them.

        Raises:
            TableFault: too few or too many inputs, or points that make no mechanism.
        """
        part = self.mechanism
        try:
            topology = part.topology
        except MechanismError as error:
            of_points = ("points",) if set(error.names) <= set(part.points) else ()
            raise TableFault(("mechanism", *of_points), error.problem) from None
        missing, fighting = topology.layout.unknowns - len(topology.labels), topology.fighting
        if not missing and not fighting and topology.required_inputs:
            return
        names = [name for name, one in part.structure.inputs.items() if not one.moves_the_chassis]
        given = [name for name in names if name in self.inputs]
        if not part.freedoms:
            askew = askew_hinges(part.structure, part.points)
            exact = f"; if the hinges {', '.join(askew)} are meant to be parallel, draw them exactly so"
            driven = f"{', '.join(given)} {'is' if len(given) == 1 else 'are'} driven"
            raise TableFault(
                ("mechanism",),
                f"the {part.name} is locked: it has no freedom as drawn, "
                f"{f'and {driven}' if given else 'a structure that nothing moves'}",
                f"at least one freedom: leave out a rod or a slide{exact if askew else ''}",
            )
        others = ", ".join(name for name in names if name not in given) or "new ones in [mechanism.inputs]"
        words = f"the {part.name} has {part.freedoms} freedom{'' if part.freedoms == 1 else 's'}, and "
        listed = f": {', '.join(given)}" if given else ""
        words += f"{len(given)} {'is' if len(given) == 1 else 'are'} driven{listed}"
        more = part.freedoms - len(given)
        if more < 0:
            raise TableFault(("inputs",), words, f"as many inputs as freedoms: leave out {-more}")
        free = ", ".join(free_directions(topology, part.points, part.directions))
        if not missing:
            words = f"the inputs {', '.join(fighting)} drive the same freedoms of the {part.name}"
            allowed = f"one of them less, and one of {others} instead"
            raise TableFault(("inputs",), f"{words}, so that others stay free: {free}", allowed)
        allowed = f"as many inputs as freedoms: drive {more} more of {others}"
        raise TableFault(("inputs",), f"{words}; free: {free}", allowed)

    @property
    def reported_points(self) -> tuple[str, ...]:
        """The points that are reported, in the mechanism's order."""
        every = self.mechanism.topology.points
        return tuple(name for name in every if self.points is None or name in self.points)

    @property
    def unreported_points(self) -> tuple[str, ...]:
        reported = self.reported_points
        return tuple(name for name in self.mechanism.topology.points if name not in reported)

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
            SceneError: there is no such scene, its content is wrong, or the path is not a regular file of at
                most 64 MB.
        """
        if not isinstance(name, str | os.PathLike):
            allowed = f"a path, or one of {', '.join(built_in_scenes())}"
            raise SceneError(shown(name), "", f"is a {type(name).__name__}, not the name of a scene", allowed)
        if str(name) in built_in_scenes():
            written = (SCENES / f"{name}.toml").read_bytes()
        else:
            hint = meant(str(name), built_in_scenes())
            written = read_file(name, f"a path, or one of {', '.join(built_in_scenes())}{hint}")
        return cls.from_mapping(_found_beside(parsed(written, str(name)), Path(name).parent), str(name))

    @classmethod
    def read(cls, stream: IO[bytes], source: str = "standard input") -> Scene:
        """Read a scene from an open binary stream, such as `sys.stdin.buffer`.

        Raises:
            SceneError: the content is wrong, or has no end within 64 MB.
        """
        return cls.from_mapping(parsed(read_stream(stream, source), source), source)


def _part_of(mechanism: object) -> MechanismPart | None:
    """A scene's mechanism; None if it is invalid, which the scene's checks report."""
    try:
        return MechanismPart.checked(mechanism, "scene")
    except SceneError:
        return None


def _is_no_part(table: Mapping[str, Any]) -> bool:
    """Whether a table of inputs is not a part's table: one of its entries is not an input."""
    return not all(
        isinstance(law, Mapping) and not law.keys().isdisjoint((*LAWS, SWEEP)) for law in table.values()
    )


def _found_beside(content: dict[str, Any], folder: Path) -> dict[str, Any]:
    """A scene's content with paths of mechanism files counted from a folder, and its tables read."""
    if "inputs" in content:
        content = {**content, "inputs": read_in(content["inputs"], content.get("units", MM), folder)}
    mechanism = content.get("mechanism")
    if not isinstance(mechanism, dict):
        return content
    if is_path(mechanism.get("type")):
        return {**content, "mechanism": {**mechanism, "type": str(folder / mechanism["type"])}}
    return {**content, "mechanism": whole_tables(mechanism, folder)}


def built_in_scenes() -> tuple[str, ...]:
    """Names of the scenes that come with the package."""
    return tuple(sorted(path.stem for path in SCENES.glob("*.toml")))
