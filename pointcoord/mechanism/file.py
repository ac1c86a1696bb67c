"""Mechanism files: finds, reads and checks them, includes their parts and applies closures."""

from __future__ import annotations

from collections.abc import Collection, Hashable, Mapping
from dataclasses import dataclass, replace
from functools import cache, cached_property
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Field, StrictBool

from pointcoord.errors import SceneError
from pointcoord.linkage.topology import Topology
from pointcoord.mechanism.checks import check
from pointcoord.mechanism.compiled import Compiler, Place
from pointcoord.mechanism.faults import TableFault, known_keys, no_such, under
from pointcoord.mechanism.freedoms import Freedoms, settled
from pointcoord.mechanism.inputs import CHASSIS, Entry, Name
from pointcoord.mechanism.structure import CLOSING, Structure, read
from pointcoord.toml_text import parsed, read_file
from pointcoord.wording import shown

# The shipped mechanisms. (Importing importlib.resources would take a fifth of numpy's import time.)
MECHANISMS = Path(__file__).parents[1] / "mechanisms"
AS_DRAWN = "drawn"
ENDING = ".toml"
AXES: Mapping[str, Place] = {"up": (0.0, 0.0, 1.0), "right": (0.0, 1.0, 0.0)}
"""Axes of a car that gives none."""
NO_LENGTHS: Mapping[str, float] = {}


@cache
def shipped() -> tuple[str, ...]:
    """Names of the mechanisms that come with the package."""
    return tuple(sorted(path.stem for path in MECHANISMS.glob(f"*{ENDING}")))


@dataclass(frozen=True)
class MechanismFile:
    """A mechanism's checked tables.

    Attributes:
        name: the mechanism's name in messages and results.
        structures: closure -> structure; "drawn" is the structure of the unchanged tables.
        mirrored: prefix of a part, or of a part of it -> whether its points are mirrored.
    """

    name: str
    structures: Mapping[str, Structure]
    mirrored: Mapping[str, bool]

    @property
    def closures(self) -> tuple[str, ...]:
        return tuple(self.structures)

    @cached_property
    def points(self) -> tuple[str, ...]:
        """Every point that a car with this mechanism may have, over all closures."""
        return tuple(dict.fromkeys(name for one in self.structures.values() for name in one.points))

    def topology(
        self,
        points: Mapping[str, Place],
        closure: str = AS_DRAWN,
        driven: Collection[str] | None = None,
        axes: Mapping[str, Place] = AXES,
        lengths: Mapping[str, float] = NO_LENGTHS,
    ) -> Topology:
        """The linkage of a car; cars of equal `Compiler.key` share one.

        Args:
            points: drawn places, mm. They decide which optional points exist, and which points represent a
                body.
            driven: names of the driven inputs; by default the first in the file that hold all freedoms.
            axes: `up` and `right` of the car.
            lengths: further lengths that inputs need, by name, mm.
        """
        inputs = self.structures[closure].inputs
        car = Compiler(self.structures[closure].drawn_with(points), (), points, axes, lengths)
        if driven is None:
            driven, free = (), self.freedoms(points, closure, axes)
            for name, one in inputs.items():
                if free and not one.moves_the_chassis and one.length in ("", *lengths):
                    tried = self._linkage(closure, replace(car, driven=(*driven, name)))
                    left = Freedoms.of(tried, points, axes).count
                    if left == free - one.holds:
                        driven, free = (*driven, name), left
        topology = self._linkage(closure, replace(car, driven=tuple(n for n in inputs if n in driven)))
        spare = len(topology.labels) > topology.layout.unknowns
        return settled(topology, points, axes) if spare else topology

    def freedoms(
        self, points: Mapping[str, Place], closure: str = AS_DRAWN, axes: Mapping[str, Place] = AXES
    ) -> int:
        """Number of freedoms of a drawing without driven inputs: coordinates less independent equations."""
        car = Compiler(self.structures[closure].drawn_with(points), (), points, axes, NO_LENGTHS)
        return Freedoms.of(self._linkage(closure, car), points, axes).count

    def _linkage(self, closure: str, car: Compiler) -> Topology:
        """The linkage of a car with all its rows, redundant ones included."""
        key = closure, car.key
        if key not in self._compiled:
            named = f"{self.name}, {closure}" if closure != AS_DRAWN else self.name
            self._compiled[key] = car.topology(named, closure != AS_DRAWN)
        return self._compiled[key]

    @cached_property
    def _compiled(self) -> dict[Hashable, Topology]:
        return {}

    @classmethod
    def of(cls, tables: Mapping[str, Any], name: str) -> MechanismFile:
        """Check a mechanism's tables, with the tables of parts in place of their files (`whole_tables`).

        Raises:
            TableFault: the first fault.
        """
        given = {key: value for key, value in tables.items() if value is not None}
        head = read(_Head, {key: value for key, value in given.items() if key not in CLOSING})
        closures = dict.fromkeys((AS_DRAWN, *head.closures))
        closures |= dict.fromkeys(c for part in head.parts.values() for c in part.mechanism.closures)
        structures = {}
        for closure in closures:
            changes = head.closures.get(closure, {})
            put_in = {table: {**given.get(table, {}), **entries} for table, entries in changes.items()}
            with under(*(("closures", closure) if changes else ())):
                structures[closure] = head.joined({**given, **put_in}, closure)
        mirrored = {
            f"{part}.{prefix}": one.mirrored != own
            for part, one in head.parts.items()
            for prefix, own in {"": False, **one.mechanism.mirrored}.items()
        }
        return cls(head.title or name, structures, mirrored)


def _of_part(mechanism: object) -> MechanismFile:
    if isinstance(mechanism, Mapping):
        return MechanismFile.of(mechanism, "part")
    if not isinstance(mechanism, str):
        raise TableFault((), f"is {shown(mechanism)}", "the name of a mechanism, or its tables")
    return mechanism_file(mechanism)


CHANGES = Annotated[dict[Name, dict[Name, Any]], AfterValidator(lambda changes: known_keys(changes, CLOSING))]


class _Part(Entry):
    """A part: another mechanism, or without one a wheel that this mechanism's own bodies carry."""

    mechanism: Annotated[Any, AfterValidator(_of_part)] = MechanismFile("", {AS_DRAWN: Structure()}, {})
    side: Literal["left", "right"] = "left"
    mirrored: StrictBool = False


class _Head(Entry):
    """What a mechanism's tables contain besides the tables of its own structure."""

    more_keys = CLOSING

    title: Annotated[str, Field(strict=True)] = ""
    closures: dict[Name, CHANGES] = Field(default_factory=dict)
    parts: dict[Name, _Part] = Field(default_factory=dict)

    def joined(self, tables: Mapping[str, Any], closure: str) -> Structure:
        """The tables joined with those of the parts (each in this closure if it has it), and checked."""
        if "bodies" not in tables and not self.parts:
            raise TableFault(("bodies",), "this table is missing", "bodies with their points")
        whole = Structure({CHASSIS: ()})
        for part, one in self.parts.items():
            of_part = one.mechanism.structures
            own = of_part.get(closure, of_part[AS_DRAWN]).prefixed(f"{part}.")
            whole = whole.joined(own if own.sides else replace(own, sides={part: one.side}))
        whole = whole.joined(read(Structure, {table: tables[table] for table in CLOSING if table in tables}))
        check(whole)
        return whole


@cache
def mechanism_file(name: str) -> MechanismFile:
    """A shipped mechanism by name.

    Raises:
        TableFault: there is no such mechanism.
    """
    if name not in shipped():
        raise no_such("mechanism", name, (*shipped(), "or a path that ends in .toml"))
    tables = parsed((MECHANISMS / f"{name}{ENDING}").read_bytes(), name)
    return replace(MechanismFile.of(tables, name), name=name)


def read_tables(path: Path, whole: tuple[Path, ...] = ()) -> dict[str, Any]:
    """The checked tables of a mechanism file, with the tables of parts in place of their files.

    Args:
        whole: the files of which this one is a part.
    Raises:
        SceneError: the file cannot be read, or something in it is wrong.
    """
    if path.resolve() in whole:
        raise SceneError(str(path), "parts", "is a part of itself", "a part that is another mechanism")
    allowed = f"as type in [mechanism], or as mechanism of a part: a path, or one of {', '.join(shipped())}"
    own = parsed(read_file(path, allowed), str(path))
    tables = whole_tables(own, path.parent, (*whole, path.resolve()))
    tables.setdefault("title", path.stem)
    try:
        MechanismFile.of(tables, path.stem)
    except TableFault as fault:
        raise fault.of_file(str(path)) from None
    return tables


def whole_tables(tables: Mapping[str, Any], folder: Path, whole: tuple[Path, ...] = ()) -> dict[str, Any]:
    """The tables with tables of parts in place of the paths of their files; whole: as in `read_tables`."""
    parts = tables.get("parts")
    if not isinstance(parts, Mapping):
        return dict(tables)
    put_in = {}
    for part, table in parts.items():
        put_in[part] = table
        if isinstance(table, Mapping) and is_path(table.get("mechanism")):
            put_in[part] = {**table, "mechanism": read_tables(folder / table["mechanism"], whole)}
    return {**tables, "parts": put_in}


def is_path(name: object) -> bool:
    """Whether a mechanism is named by the path of a user's file."""
    return isinstance(name, str) and name.endswith(ENDING)
