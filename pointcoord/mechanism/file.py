"""Mechanism files: found, read and checked, with parts put in and closures applied."""

from __future__ import annotations

from collections.abc import Collection, Hashable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, BeforeValidator, StrictBool

from pointcoord.linkage.topology import Topology
from pointcoord.mechanism.checks import check
from pointcoord.mechanism.compiled import Compiler, Place
from pointcoord.mechanism.faults import TableFault, known_keys, no_such
from pointcoord.mechanism.freedoms import Freedoms, settled
from pointcoord.mechanism.inputs import CHASSIS, Name
from pointcoord.mechanism.structure import CLOSING, TABLES, Structure, read, structure_of
from pointcoord.toml_text import parsed, read_file
from pointcoord.wording import shown

# The shipped ones. (importlib.resources takes as long to import as a fifth of numpy.)
MECHANISMS = Path(__file__).parents[1] / "mechanisms"
AS_DRAWN = "drawn"
ENDING = ".toml"
BY_ORDER: Place = (0.0, 0.0, 0.0)
"""Where all points are if only their order counts."""
AXES: Mapping[str, Place] = {"up": (0.0, 0.0, 1.0), "right": (0.0, 1.0, 0.0)}
"""Of a car that says nothing of them."""


@lru_cache(maxsize=1)
def shipped() -> tuple[str, ...]:
    """Names of the mechanisms that come with the package."""
    return tuple(sorted(path.stem for path in MECHANISMS.glob(f"*{ENDING}")))


def _name_or_tables(mechanism: object) -> object:
    if not isinstance(mechanism, str | Mapping):
        raise TableFault((), f"is {shown(mechanism)}", "the name of a mechanism, or its tables")
    return mechanism


class _Part(BaseModel, defer_build=True):
    mechanism: Annotated[Any, AfterValidator(_name_or_tables)]
    side: Literal["left", "right"] = "left"
    mirrored: StrictBool = False


CHANGES = Annotated[dict[Name, dict[Name, Any]], AfterValidator(lambda changes: known_keys(changes, CLOSING))]
PART = Annotated[_Part, BeforeValidator(lambda v: known_keys(v, _Part.model_fields))]


@dataclass(frozen=True)
class MechanismFile:
    """A mechanism by its tables, checked.

    Attributes:
        name: in messages and results.
        structures: by closure, what it is then; "drawn" is the tables as they stand.
        mirrored: by prefix of its points, whether a part of it is mirrored.
    """

    name: str
    structures: Mapping[str, Structure]
    mirrored: Mapping[str, bool]

    @property
    def closures(self) -> tuple[str, ...]:
        return tuple(self.structures)

    @cached_property
    def points(self) -> tuple[str, ...]:
        """Every point that a car of it may have, whatever its closure."""
        return tuple(dict.fromkeys(name for one in self.structures.values() for name in one.points))

    @property
    def inputs(self) -> tuple[str, ...]:
        return tuple(self.structures[AS_DRAWN].inputs)

    def topology(
        self,
        closure: str = AS_DRAWN,
        driven: Collection[str] | None = None,
        points: Mapping[str, Place] | None = None,
        axes: Mapping[str, Place] | None = None,
        lengths: Mapping[str, float] | None = None,
    ) -> Topology:
        """The linkage of a car, made once for all that are alike.

        Args:
            driven: names of the inputs that are driven; the first of the file that are enough unless given.
            points: as drawn, mm. They say which points are there, and which stand for a body; by order of
                the file unless given.
            axes: `up` and `right` of the car.
            lengths: what inputs may need beside the points, by name, mm.
        """
        known, along, given = self.structures[closure].inputs, axes or AXES, lengths or {}
        if driven is None:
            driven = self._first_driven(closure, points, along, given)
        own = tuple(name for name in known if name in driven)
        topology = self._linkage(closure, own, points, along, given)
        if points is None or len(topology.labels) <= topology.layout.unknowns:
            return topology
        holding = sum(not known[name].moves_the_chassis for name in own)
        too_many = holding > self.freedoms(closure, points, along)
        return topology if too_many else settled(topology, points, along)

    def _linkage(
        self,
        closure: str,
        driven: tuple[str, ...],
        points: Mapping[str, Place] | None,
        axes: Mapping[str, Place],
        lengths: Mapping[str, float],
    ) -> Topology:
        """The linkage with all its rows."""
        whole = self.structures[closure]
        structure = whole if points is None else whole.drawn_with(points)
        there = dict.fromkeys(structure.points, BY_ORDER) if points is None else points
        compiler = Compiler(structure, driven, there, axes, lengths)
        key = closure, compiler.key
        if key not in self._compiled:
            named = f"{self.name}, {closure}" if closure != AS_DRAWN else self.name
            # What a drawing may leave out stays known by name: messages say what stands in for what.
            self._compiled[key] = compiler.topology(named, whole.stand_ins, closure != AS_DRAWN)
        return self._compiled[key]

    def _first_driven(
        self,
        closure: str,
        points: Mapping[str, Place] | None,
        axes: Mapping[str, Place],
        lengths: Mapping[str, float],
    ) -> tuple[str, ...]:
        """The first inputs of the file that hold every freedom, of those whose lengths are given.

        One is passed over that drives, however the car is drawn, what those before it hold.
        """
        holding = [
            name
            for name, one in self.structures[closure].inputs.items()
            if not one.moves_the_chassis and (not one.length or one.length in lengths)
        ]
        if self.freedoms(closure) <= 0:
            return tuple(holding[: max(self.freedoms(closure, points, axes), 0)]) if points else ()
        taken: tuple[str, ...] = ()
        for name in holding:
            topology = self._linkage(closure, (*taken, name), points, axes, lengths)
            free = topology.layout.unknowns - len(topology.labels)
            if free >= 0 and not topology.fighting:
                taken = (*taken, name)
                if free == 0:
                    break
        return taken

    def freedoms(
        self,
        closure: str = AS_DRAWN,
        points: Mapping[str, Place] | None = None,
        axes: Mapping[str, Place] | None = None,
    ) -> int:
        """How many inputs hold the mechanism: coordinates less equations, of which some may be redundant.

        Args:
            points: as drawn, mm. Without them no equation is taken for redundant.
        """
        along = axes or AXES
        topology = self._linkage(closure, (), points, along, {})
        if points is None:
            return topology.layout.unknowns - len(topology.labels)
        return Freedoms.of(topology, points, along).count

    @cached_property
    def _compiled(self) -> dict[Hashable, Topology]:
        return {}

    @classmethod
    def of(cls, tables: Mapping[str, Any], name: str) -> MechanismFile:
        """Check the tables of a mechanism; a part's file is in place of its name (`whole_tables`).

        Raises:
            TableFault: the first fault.
        """
        known_keys(tables, (*TABLES, "title"))
        given = {key: value for key, value in tables.items() if value is not None}
        # A table that is not there is not read: most files have neither, and to build a reader takes time.
        changed = read(dict[Name, CHANGES], given["closures"], "closures") if "closures" in given else {}
        tables_of_parts = read(dict[Name, PART], given["parts"], "parts") if "parts" in given else {}
        title = str(given.get("title") or name)
        parts = {f"{part}.": _part(part, table) for part, table in tables_of_parts.items()}
        sides = {part: str(table.side) for part, table in tables_of_parts.items()}
        closures = {AS_DRAWN: {}, **changed}
        for own in parts.values():
            closures |= {closure: {} for closure in own.closures if closure not in closures}
        structures = {}
        for closure, changes in closures.items():
            put_in = {table: {**given.get(table, {}), **entries} for table, entries in changes.items()}
            try:
                structures[closure] = _closed({**given, **put_in}, parts, sides, title, closure)
            except TableFault as fault:
                if closure == AS_DRAWN or not fault.place:
                    raise
                raise fault.under("closures", closure) from None
        return cls(title, structures, {f"{part}.": table.mirrored for part, table in tables_of_parts.items()})


def _part(part: str, table: _Part) -> MechanismFile:
    own = table.mechanism
    try:
        return mechanism_file(own) if isinstance(own, str) else MechanismFile.of(own, part)
    except TableFault as fault:
        raise fault.under("parts", part, "mechanism") from None


def _closed(
    tables: Mapping[str, Any],
    parts: Mapping[str, MechanismFile],
    sides: dict[str, str],
    name: str,
    closure: str,
) -> Structure:
    """The tables joined with those of the parts, closed alike where they can be, and checked."""
    if "bodies" not in tables and not parts:
        raise TableFault(("bodies",), "this table is missing", "bodies with their points")
    whole = Structure(name, {CHASSIS: ()}, sides=sides) if parts else Structure(name)
    for prefix, part in parts.items():
        own = part.structures[closure if closure in part.structures else AS_DRAWN]
        whole = whole.joined(own.prefixed(prefix))
    whole = whole.joined(structure_of(tables, name))
    check(whole)
    return whole


def mechanism_file(name: str) -> MechanismFile:
    """A shipped mechanism by name.

    Raises:
        TableFault: there is none.
    """
    if name not in shipped():
        raise no_such("mechanism", name, (*shipped(), "or a path that ends in .toml"), ())
    return _shipped(name)


@lru_cache(maxsize=64)
def _shipped(name: str) -> MechanismFile:
    tables = parsed((MECHANISMS / f"{name}{ENDING}").read_bytes(), name)
    return replace(MechanismFile.of(tables, name), name=name)


def read_tables(path: Path) -> dict[str, Any]:
    """The checked tables of a mechanism file, with those of its parts' files in place of their names.

    Raises:
        SceneError: it cannot be read, or something in it is wrong.
    """
    allowed = f"a path to a mechanism file, or one of {', '.join(shipped())}"
    tables = whole_tables(parsed(read_file(path, allowed), str(path)), path.parent)
    tables.setdefault("title", path.stem)
    try:
        MechanismFile.of(tables, path.stem)
    except TableFault as fault:
        raise fault.of_file(str(path)) from None
    return tables


def whole_tables(tables: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """Tables with those of its parts' files in place of their paths."""
    parts = tables.get("parts")
    if not isinstance(parts, Mapping):
        return dict(tables)
    put_in = {}
    for part, table in parts.items():
        put_in[part] = table
        if isinstance(table, Mapping) and is_path(table.get("mechanism")):
            put_in[part] = {**table, "mechanism": read_tables(folder / table["mechanism"])}
    return {**tables, "parts": put_in}


def is_path(name: object) -> bool:
    """Whether a mechanism's name is that of a file of the user's."""
    return isinstance(name, str) and name.endswith(ENDING)
