"""The mechanism of a scene: a shipped one or a user's, with its drawn points, the car's axes and data."""

from __future__ import annotations

import json
from collections.abc import Callable, Collection, Iterable, Mapping
from functools import cached_property, lru_cache
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import Field, PrivateAttr, ValidationInfo, field_validator

from pointcoord.effects.effect import Effect
from pointcoord.effects.registry import EFFECTS
from pointcoord.errors import MechanismError
from pointcoord.linkage.directions import CarAxes
from pointcoord.linkage.hardpoints import build_mechanism
from pointcoord.linkage.topology import Topology
from pointcoord.mechanism.faults import TableFault, known_name, under
from pointcoord.mechanism.file import (
    MechanismFile,
    is_path,
    mechanism_file,
    read_tables,
    shipped,
    whole_tables,
)
from pointcoord.mechanism.inputs import LENGTHS
from pointcoord.mechanism.structure import TABLES, Structure
from pointcoord.numerics.arrays import Array
from pointcoord.numerics.rounding import EPS
from pointcoord.scene.drawing_doubts import doubts_of_drawings
from pointcoord.scene.reading import now
from pointcoord.scene.scene_part import Part, PerTurn, Place, Share, Size, SpringRate, Text, Vector
from pointcoord.wording import shown

# Largest error in products of directions: ROUNDED for directions that were rotated in doubles, SLIP for those
# printed with 12 digits. A larger error is a mistake.
ROUNDED, SLIP = 16.0 * EPS, 1e-12
# Position of an axle along the car, seen from the middle.
AXLES: Mapping[Any, float] = {"front": -1.0, "rear": 1.0}
AXES = {
    "rearward-right-up": {"up": (0.0, 0.0, 1.0), "right": (0.0, 1.0, 0.0)},
    "iso": {"up": (0.0, 0.0, 1.0), "right": (0.0, -1.0, 0.0)},
    "sae": {"up": (0.0, 0.0, -1.0), "right": (0.0, 1.0, 0.0)},
}
"""Named axes: the default; x forward, y left, z up (ISO 8855); x forward, y right, z down (SAE J670)."""
Table = dict[str, Any]


class CarPart(Part):
    """Data of the whole car, for the effects that need them.

    `axle` is the axle of the wheel. Lengths are in mm; the height of the centre of gravity is above the drawn
    ground. The shares are this axle's parts of the car's whole braking and driving force. The spring acts
    between the damper's ends; its rate is in N/mm.
    """

    axle: Literal["front", "rear"] | None = None
    wheelbase: Size | None = None
    centre_of_gravity_height: Size | None = None
    brake_share: Share | None = None
    drive_share: Share | None = None
    spring_rate: SpringRate | None = None
    spring_free_length: Size | None = None

    @property
    def numbers(self) -> dict[str, float]:
        """The given values by name; `axle` is -1 for the front and +1 for the rear."""
        given = self.model_dump(exclude_none=True)
        return {name: AXLES.get(value, value) for name, value in given.items()}


class LoadPart(Part):
    """The load on a wheel at its contact point, along the scene's axes: force, N, and moment, N mm."""

    force: Vector
    moment: Place = (0.0, 0.0, 0.0)


class MechanismPart(Part):
    """The mechanism, its side of the car, its drawn points in mm and the car's axes.

    The mechanism is a shipped one, named by `type`, or is given by its tables. A `type` that is the path of a
    mechanism file is replaced by that file's tables, so that a scene does not depend on the file. `closure`
    says how a drawing that does not close is corrected: `drawn` keeps the points, other closures move some.
    `points` also contains the chassis points that the scene omits, at the places of their stand-ins.
    """

    type: Text | None = None
    title: Text = ""
    bodies: Table | None = None
    rods: Table | None = None
    slides: Table | None = None
    inputs: Table | None = None
    roles: Table | None = None
    stand_ins: Table | None = None
    closures: Table | None = None
    parts: Table | None = None
    closure: Text = "drawn"
    side: Literal["left", "right"] = "left"
    up: Vector = (0.0, 0.0, 1.0)
    right: Annotated[Vector, Field(validate_default=True)] = (0.0, 1.0, 0.0)
    wheel_radius: Size | None = None
    rack_per_turn: PerTurn | None = None
    car: CarPart | None = None
    loads: dict[str, LoadPart] = Field(default_factory=dict)
    points: dict[str, Place]

    short_forms = ("axes",)

    _driven: tuple[str, ...] | None = PrivateAttr(None)

    @classmethod
    def completed(cls, content: dict[str, Any]) -> dict[str, Any]:
        """The content with mechanism files in place of their paths, `up` and `right` in place of named axes,
        and points by their dotted names.

        Raises:
            SceneError: a mechanism file cannot be read, or something in it is wrong.
            TableFault: axes or tables are given twice, or unknown.
        """
        if "axes" in content:
            axes = content.pop("axes")
            known_name("kind of axes", axes, [*AXES], ("axes",))
            if twice := [name for name in AXES[axes] if name in content]:
                problem = f"is given together with {twice[0]}"
                raise TableFault(("axes",), problem, "axes by their name, or up and right")
            content |= AXES[axes]
        given = {name: content[name] for name in TABLES if content.get(name) is not None}
        if content.get("type") is not None and given:
            problem = f"is given together with type = {shown(content['type'])}"
            raise TableFault((next(iter(given)),), problem, "a type, or the mechanism's tables")
        if is_path(content.get("type")):
            content |= read_tables(now().folder / content.pop("type"))
        elif given:
            content |= whole_tables(given, now().folder)
        loads = content.get("loads")
        if isinstance(loads, Mapping) and not all(
            isinstance(one, Mapping | LoadPart) for one in loads.values()
        ):
            content["loads"] = {"": loads}  # of the one wheel
        if "points" in content:
            content["points"] = by_dotted_name(content["points"], lambda table: False)
        return content

    @field_validator("up", "right")
    @classmethod
    def _to_rounding(cls, direction: Vector, others: ValidationInfo) -> Vector:
        """The direction, corrected to full digits: models would each complete a printed one differently.

        `agreed` refuses larger errors.
        """
        given, up = np.array(direction), np.array(others.data.get("up", (0.0, 0.0, 0.0)))
        with np.errstate(over="ignore", invalid="ignore"):
            off = max(abs(float(given @ given) - 1.0), abs(float(given @ up)))
        if not ROUNDED < off <= SLIP:
            return direction
        x, y, z = across = given - float(given @ up) * up
        size = float(np.linalg.norm(across))
        return float(x) / size, float(y) / size, float(z) / size

    def agreed(self) -> Self:
        """The part with the points that its drawing omits, checked.

        Raises:
            ValueError: axes, points, sides or loads do not fit the mechanism.
        """
        known_name(f"closure of a {self.name}", self.closure, self.file.closures, ("closure",))
        self._complete_points()
        axes = np.array([self.up, self.right])
        with np.errstate(over="ignore", invalid="ignore"):
            worst = np.abs(axes @ axes.T - np.eye(2)).max()
        if not worst <= SLIP:
            usual = "up = [0.0, 0.0, 1.0] and right = [0.0, 1.0, 0.0]"
            raise ValueError(
                f"up {self.up} and right {self.right} are not unit vectors at right angles: a product is "
                f"{worst:.3g} off; allowed: at most {SLIP:g}, as with {usual}"
            )
        sides = self._whole.sides
        if sides and self.side != "left":  # the default, which a written scene has too
            parts = ", ".join(f"{part} is {side}" for part, side in sides.items())
            problem = f"is {self.side!r}, but each part has its own side: {parts}"
            raise TableFault(("side",), problem, "no side")
        self._check_wheel("", self.side)
        for part, side in sides.items():
            self._check_wheel(f"{part}.", side)
        for part in self.loads:
            if part not in sides and (part or sides):
                known = f"a table for one of its parts, {', '.join(sides)}" if sides else "force and moment"
                raise TableFault(("loads", part), "names no wheel", known)
        return self

    def _complete_points(self) -> None:
        """Add the points that the drawing leaves to other parts of the car, and to stand-ins.

        Raises:
            TableFault: a point is unknown or missing.
        """
        whole = self._whole
        points = _of_every_part(self.points, self.file, whole, self.right)
        for name in points:
            known_name(f"point of a {self.name}", name, whole.points, ("points",))
        for name in whole.required_points:
            if name not in points:
                needed = ", ".join(whole.required_points)
                raise TableFault(("points",), f"{name!r} is missing; needed: {needed}")
        self.points.clear()
        self.points.update(whole.placed(points))

    def _check_wheel(self, prefix: str, side: str) -> None:
        """Check that a wheel lies outboard, and that its spin axis has a direction.

        Args:
            prefix: of the roles of the wheel's part. side: the part's side of the car.
        """
        roles = self.structure.roles
        inner, axis = roles.get(f"{prefix}inboard"), roles.get(f"{prefix}wheel_axis")
        if axis is None:
            return
        wheel = axis[1]
        if isinstance(inner, str):
            across = np.array(self.points[inner]) - np.array(self.points[wheel])
            with np.errstate(over="ignore", invalid="ignore"):
                inboard = float(self.axes.on(side).component(across, "outboard"))
            if inboard >= 0.0:
                outwards, other = ("-right", "right") if side == "left" else ("+right", "left")
                of_part, opposite = " for its part" if prefix else "", [0.0 - x for x in self.right]
                raise ValueError(
                    f"{wheel} lies {inboard:.6g} mm inboard of {inner} for side = {side!r}; allowed: "
                    f"{wheel} outboard of {inner}, here towards {outwards} {self.right}; if this points to "
                    f"the left in your axes, say so with right = {opposite}; if it is a wheel of the other "
                    f"side, try side = {other!r}{of_part}"
                )
        if self.points[axis[0]] == self.points[wheel]:
            own = self._whole.roles[f"{prefix}wheel_axis"][0]
            raise ValueError(
                f"{axis[0]} and {wheel} are at the same place, so that the wheel's spin axis has "
                f"no direction; allowed: a place of {own} away from {wheel}"
            )

    @property
    def driven(self) -> tuple[str, ...] | None:
        """The inputs that the scene drives; None for a part outside a scene."""
        return self._driven

    def driven_by(self, inputs: Collection[str]) -> MechanismPart:
        """This part in a scene that drives some of its inputs; a new part if another scene drives others."""
        driven = tuple(name for name in self.structure.inputs if name in inputs)
        part = self if self.driven in (None, driven) else type(self).model_validate(self.as_given())
        part._driven = driven
        return part

    @property
    def name(self) -> str:
        """The mechanism's name in messages: its type, or the title of its tables."""
        return self.file.name

    @cached_property
    def file(self) -> MechanismFile:
        """The mechanism's checked tables.

        Raises:
            TableFault: they are wrong, or there are none.
        """
        if self.type is not None:
            with under("type"):
                return mechanism_file(self.type)
        tables = {name: getattr(self, name) for name in TABLES if getattr(self, name) is not None}
        if not tables:
            raise TableFault(("type",), "this key is missing", f"{', '.join(shipped())}, a path, or tables")
        return _inline(json.dumps({"title": self.title, **tables}, default=str))

    @cached_property
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
        given = {"up", "right", "side", "wheel_radius", "rack_per_turn", "loads"}
        return {
            **self.structure.plain(driven),
            **self.model_dump(mode="json", include=given),
            "name": self.name,
            "points": {name: list(self.points[name]) for name in self.structure.points},
            "car": {} if self.car is None else self.car.model_dump(exclude_none=True),
        }

    @cached_property
    def topology(self) -> Topology:
        given = {name: getattr(self, name) for name in LENGTHS}
        lengths = {name: length for name, length in given.items() if length is not None}
        return self.file.topology(self.points, self.closure, self.driven, self.directions, lengths)

    @property
    def directions(self) -> dict[str, Vector]:
        """The scene's directions up and right."""
        return {"up": self.up, "right": self.right}

    def drawn_value(self, input: str) -> float:
        """The drawn value of a driven input; rad or mm.

        Zero if the hardpoints make no mechanism that the inputs drive; the scene's checks report that.
        """
        try:
            if self.topology.layout.unknowns == len(self.topology.labels):
                mechanism = build_mechanism(self.topology, dict(self.points), self.directions)
                return float(mechanism.drawn_inputs.get(input, 0.0)) + 0.0
        except MechanismError:
            pass
        return 0.0

    @cached_property
    def freedoms(self) -> int:
        """Number of freedoms, which is the number of inputs needed.

        Raises:
            MechanismError: the mechanism has more equations than coordinates, and the drawing does not close.
        """
        return self.file.freedoms(self.points, self.closure, self.directions)

    def inputs_in_words(self, names: Iterable[str]) -> str:
        """Inputs, each with the number of slides that it drives if there are several."""
        held = ((name, self.structure.inputs[name].holds) for name in names)
        return ", ".join(f"{name} ({count} slides)" if count > 1 else name for name, count in held)

    @property
    def defaults_taken(self) -> tuple[str, ...]:
        """Notes on defaults that affect the results."""
        given, taken = (one.role("wheel_axis") for one in (self._whole, self.structure))
        if given == taken:
            return ()
        return (f"{given[0]} is not given: the wheel's spin axis starts at {taken[0]}",)

    @property
    def doubts(self) -> tuple[str, ...]:
        """Warnings about what looks wrong in the drawing although it can be solved."""
        points = {name: np.array(place) for name, place in self.points.items()}
        found = doubts_of_drawings(self.topology, points, self.axes)
        return tuple(doubt.words(()) for doubt in found if doubt.where)

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
        return effect.refusal(self.topology, self.axes)

    @property
    def outboard(self) -> Array:
        """Unit vector away from the car's middle, on the wheel's side."""
        return np.array(self.right) * (-1.0 if self.side == "left" else 1.0)


def _of_every_part(
    points: dict[str, Vector], file: MechanismFile, structure: Structure, right: Vector
) -> dict[str, Vector]:
    """Points by their full names: a name is expanded to every part, or part of its part, that has the point.

    The place given with the longest prefix holds.
    """
    found: dict[str, Vector] = {}
    for name, place in sorted(points.items(), key=lambda item: item[0].count(".")):
        head, dot, own = name.rpartition(".")
        as_given = file.mirrored.get(head + dot, False)
        of_parts = {
            prefix + own: place if mirrored == as_given else _mirrored(place, right)
            for prefix, mirrored in file.mirrored.items()
            if prefix.startswith(head + dot) and prefix + own in structure.points
        }
        found |= {name: place} if name in structure.points else of_parts or {name: place}
    return found


def _mirrored(place: Vector, right: Vector) -> Vector:
    """The mirror image at the car's middle plane."""
    out = 2.0 * sum(p * r for p, r in zip(place, right, strict=True))
    x, y, z = (p - out * r for p, r in zip(place, right, strict=True))
    return x, y, z


@lru_cache(maxsize=64)
def _inline(tables: str) -> MechanismFile:
    return MechanismFile.of(json.loads(tables), "mechanism")


def by_dotted_name(table: Any, whole: Callable[[Mapping[str, Any]], bool]) -> Any:
    """A nested table with dotted names: TOML reads left.wheel_centre as a table within a table."""
    if not isinstance(table, Mapping):
        return table
    found: dict[Any, Any] = {}
    for name, value in table.items():
        inner = by_dotted_name(value, whole) if isinstance(value, Mapping) and not whole(value) else {}
        found |= {f"{name}.{own}": each for own, each in inner.items()} or {name: value}
    return found
