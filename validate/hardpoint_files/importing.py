"""From a file of another program to a scene of ours: points by name, in our axes and unit, of one wheel.

What is not known is refused or listed, never guessed: axes and units that the points speak against, points
without a name of ours, points of ours that the file lacks.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from decimal import Decimal
from functools import cached_property, partial
from math import radians, tan
from pathlib import Path
from typing import Any

from pointcoord import Scene, standing
from pointcoord.drawing_stands import Standing
from pointcoord.errors import UnknownName
from pointcoord.linkage.topology import Topology
from pointcoord.mechanism import mechanism_file, shipped
from pointcoord.mechanism.file import AS_DRAWN
from pointcoord.toml_text import read_file
from validate.hardpoint_files.axes import ALLOWED, DIRECTIONS, OUR_AXES, Axes
from validate.hardpoint_files.contents import Axle, Contents, FilePoint, Place, SpinAxis, plain, short
from validate.hardpoint_files.derived import derived
from validate.hardpoint_files.format import MJCF, TABLE, Format, format_of
from validate.hardpoint_files.mjcf import read_mjcf
from validate.hardpoint_files.mjcf_mechanism import mechanism_of
from validate.hardpoint_files.names_file import NO_NAMES, NamesFile, names_to_fill_in, read_names
from validate.hardpoint_files.static_angles import AngleCheck, check_angles
from validate.hardpoint_files.written_scene import ScenePoint, scene_of, scene_text, travel_of
from validate.plain_text import some_of
from validate.tables.cells import text_of
from validate.tables.errors import FileError
from validate.tables.units import LENGTHS

# mm: the points of one wheel's suspension, from model cars to lorries, span no less and no more.
SMALLEST, LARGEST = Decimal(150), Decimal(4000)
SIDES = ("left", "right")
PARTS = ("front", "rear")
# Of a metre: a tenth of what rounding leaves of a car's coordinates, so that 0.57 m is 570 mm.
DIGITS = 15
# Points or lines that are named one by one.
NAMED = 12


@dataclass(frozen=True)
class Choices:
    """What the user says of a file; what is left out is read from it or is the format's own.

    Attributes:
        format: its name. suspension: our type. side: of the wheel, left or right. part: the axle, front or
            rear, of a file that holds both.
        names: path of a file of names (see `names_file`).
        axes: where x, y and z point, such as "forward,left,up". unit: of its lengths.
        camber, toe: static angles of a wheel whose spin axis the file does not give, deg, + leaning out at
            the top and + toe in, projected.
        mirror: make the wheel of the other side of it.
    """

    format: str | None = None
    suspension: str | None = None
    side: str | None = None
    part: str | None = None
    names: str | None = None
    axes: str | None = None
    unit: str | None = None
    camber: float | None = None
    toe: float | None = None
    mirror: bool = False

    def __post_init__(self) -> None:
        allowed: dict[str, Iterable[str]] = {"suspension": shipped(), "side": SIDES, "unit": LENGTHS}
        if self.part is not None and not self.part.isdecimal():
            allowed["part"] = (*PARTS, "1", "2", "3")
        for kind, names in allowed.items():
            chosen = getattr(self, kind)
            if chosen is not None and chosen not in names:
                raise UnknownName(kind, chosen, names)


@dataclass(frozen=True)
class Imported:
    """A scene from another program's file, and what became of everything that the file holds.

    Attributes:
        scene: checked, with a way of the wheel. text: the same as a scene file, each point with a comment.
        points: of the scene, in its axes, with where each comes from.
        others: points of the file that are none of ours.
        angles: static angles that the file prints, held to the drawing's.
        stands: the drawing, closed. facts: what was taken for granted, in words.
    """

    format: Format
    scene: Scene
    text: str
    points: tuple[ScenePoint, ...]
    others: tuple[FilePoint, ...]
    angles: tuple[AngleCheck, ...]
    stands: Standing
    facts: tuple[str, ...]


def import_hardpoints(path: str | Path, **said: Any) -> Imported:
    """Make a scene from a file of hardpoints; the arguments are those of `Choices`.

    Raises:
        SceneError: the file cannot be read.
        FileError: it is not as it must be, or does not say all that is needed.
        UnknownName: no such format, suspension, side, part, unit or point.
        UsageError: `axes` are none.
        AssemblyError: its points cannot be put together.
    """
    choices, source = Choices(**said), str(path)
    own = NO_NAMES if choices.names is None else read_names(choices.names)
    found, text = _opened(source, choices)
    if found.form == MJCF:
        return _whole_mechanism(source, choices, found)
    return _Import(source, choices, found, found.read(text, source, own.table), own).result()


def names_of(path: str | Path, format: str | None = None, suspension: str | None = None) -> str:
    """A file of names (TOML) for a file of hardpoints, ready to be filled in, with the points that are known.

    Raises:
        SceneError, FileError, UnknownName: as `import_hardpoints`.
    """
    choices, source = Choices(format, suspension), str(path)
    found, text = _opened(source, choices)
    if found.form == MJCF:
        raise _takes_no(source, "names")
    try:
        contents = found.read(text, source, {})
    except FileError:
        # Such as a table whose columns are not known: they can be said in the same file.
        contents = Contents(())
    one = _Import(source, choices, found, contents, NO_NAMES)
    kind = suspension or one.closest()[0]
    known, others = one.named(kind)
    return names_to_fill_in(source, kind, one.missing(kind, ()), dict(known), others)


def _opened(source: str, choices: Choices) -> tuple[Format, str]:
    """A file's format and its text."""
    text = text_of(read_file(source, "the path of a file of hardpoints"))
    if text is None:
        raise FileError(source, 0, "is no text", "a text file; of a workbook, one sheet saved as CSV")
    return format_of(text, choices.format), text


def _takes_no(source: str, option: str) -> FileError:
    allowed = "--axes, where x, y and z point; names of sites are those of points"
    return FileError(source, 0, f"is a whole mechanism, for which --{option} means nothing", allowed)


def _whole_mechanism(source: str, choices: Choices, found: Format) -> Imported:
    """A scene of a file that has bodies and joints of its own."""
    for one in fields(choices):
        if one.name not in ("format", "axes") and getattr(choices, one.name) != one.default:
            raise _takes_no(source, one.name)
    axes = OUR_AXES if choices.axes is None else Axes.of(choices.axes)
    by = "ours unless --axes says others" if choices.axes is None else "by --axes"
    if not axes.right_handed:
        raise FileError(source, 0, f"has left-handed axes {axes.words}", "right-handed ones")
    made = mechanism_of(read_mjcf(source, axes.matrix), source)
    points = []
    for name, (at, words) in made.points.items():
        x, y, z = (Decimal(repr(round(float(number), DIGITS))) * LENGTHS[found.unit] for number in at)
        points.append(ScenePoint(name, (x, y, z), words))
    facts = [
        f"the file's axes are {axes.words}, {by}, in m; here x rearward, y right, z up, in mm",
        *made.facts,
    ]
    return _written(source, found, "mechanism", made.side, points, facts, tables=made.tables)


def _written(
    source: str,
    found: Format,
    kind: str,
    side: str,
    points: Sequence[ScenePoint],
    facts: Sequence[str],
    others: Sequence[FilePoint] = (),
    angles: Callable[[Mapping[str, float]], Iterable[AngleCheck]] = lambda drawn: (),
    tables: Mapping[str, Any] | None = None,
) -> Imported:
    """A scene of points, and its file.

    Args:
        angles: holds those that the file prints to the drawing's. tables: of a mechanism of its own.
    """
    drawn = scene_of(source, kind, side, points, tables)
    stands = standing(drawn)
    laws, scene = travel_of(drawn, stands)
    text = scene_text(source, found.words, drawn, points, laws, facts, others)
    checks = tuple(angles(stands.angles))
    return Imported(found, scene, text, tuple(points), tuple(others), checks, stands, tuple(facts))


@dataclass(frozen=True)
class _Wheel:
    """The points of one wheel.

    Attributes:
        ours: by our names. others: the file's others.
        part, side: its axle and side, by the file; empty where that does not say.
    """

    ours: Mapping[str, FilePoint]
    others: tuple[FilePoint, ...]
    part: str
    side: str

    @property
    def places(self) -> dict[str, Place]:
        """Where its points are, in the file's axes and unit."""
        return {name: point.place for name, point in self.ours.items()}


@dataclass(frozen=True)
class _Import:
    """One import, in its steps."""

    source: str
    choices: Choices
    format: Format
    contents: Contents
    own: NamesFile

    def refuse(self, problem: str, allowed: str, line: int = 0) -> FileError:
        return FileError(self.source, line, problem, allowed)

    def result(self) -> Imported:
        kind, topology, choices = self.kind, self.topology, self.choices
        if not (topology.wheel_axis and topology.inboard):
            raise self.refuse(
                f"is read as {kind}, whose file names no wheel: the roles wheel_axis and inboard",
                "a suspension of one wheel; else a scene written by hand (pointcoord new)",
            )
        wheel = self.chosen()
        axle = self.contents.axle(wheel.part)
        axis = self.spin_axis(axle)
        self.require_all(wheel, axis)
        axes, axes_by = self.axes(wheel)
        unit, unit_by = self.unit()
        # What the user says is taken, and the scene warns of what looks odd in it.
        if self.choices.axes is None:
            self.require_axes(axes, axes_by, wheel)
        if self.choices.unit is None:
            self.require_size(unit, wheel)
        turned = {name: axes.to_scene(place, unit) for name, place in wheel.places.items()}
        side = self.side(wheel, turned, axes)
        points = self.placed(wheel, turned, axis, side)
        facts = [
            f"the file's axes are {axes.words}, by {axes_by}, in {unit}, by {unit_by}; "
            "here x rearward, y right, z up, in mm",
            *([] if axes.right_handed else ["these axes are left-handed: is one of them turned round?"]),
            *axle.notes,
            *([self.format.notes[kind]] if kind in self.format.notes else []),
            *([f"lines without a point: {lines}"] if (lines := self.lines) else []),
        ]
        if choices.mirror:
            facts.append(f"the file's wheel is a {side} one; here it is mirrored in the middle of the car")
            side = SIDES[side == "left"]
            points = {name: point.mirrored for name, point in points.items()}
        facts += [
            f"{name} is not in the file: {other} stands in for it"
            for name, other in topology.stand_ins.items()
            if name not in points
        ]
        angles = partial(check_angles, self.format.angles, axle.angles, wheel.places, topology)
        return _written(self.source, self.format, kind, side, [*points.values()], facts, wheel.others, angles)

    @property
    def lines(self) -> str:
        """Lines that name something and are no points, in words."""
        return some_of(self.contents.lines, NAMED)

    # Which suspension, and which of the file's points are which of ours.

    @cached_property
    def kind(self) -> str:
        """Our type of the suspension: as the user or the file says, or the one whose points are there."""
        if self.choices.suspension:
            return self.choices.suspension
        if called := self.called:
            part = self.one_of("part", "axle", self.choices.part, {*called})
            said = called.get(part) or next(iter(called.values()))
            if kind := self.format.kind_called(said):
                return kind
            known = ", ".join(f"{theirs} ({ours})" for theirs, ours in self.format.called.items())
            at = f" at its axle {part}" if part else ""
            allowed = f"{known}; a like one by another name: say so with --suspension"
            raise self.refuse(f"holds a suspension called {short(said)}{at}", allowed)
        best = self.closest()
        if len(best) > 1:
            told = f"could be a {' or a '.join(best)}"
            raise self.refuse(told, f"--suspension {' or --suspension '.join(best)}")
        return best[0]

    @property
    def topology(self) -> Topology:
        """Of our type of the suspension."""
        return mechanism_file(self.kind).topology()

    @property
    def called(self) -> dict[str, str]:
        """What the file calls its suspensions, by part."""
        return {part: axle.called for part, axle in self.contents.axles.items() if axle.called}

    def closest(self) -> list[str]:
        """The suspensions that lack the fewest points in the file; of these, those with the most."""
        known = {kind: dict(self.named(kind)[0]) for kind in self.format.suspensions}
        fits = {kind: (-len(self.missing(kind, there)), len(there)) for kind, there in known.items()}
        return [kind for kind, fit in fits.items() if fit == max(fits.values())]

    def missing(self, kind: str, known: Iterable[str]) -> list[str]:
        """Points that a car of ours must have; its spin axis is not left to what may stand in for it."""
        topology, there = mechanism_file(kind).topology(), {*known, *self.own.points}
        needed = dict.fromkeys((*topology.required_points, *topology.wheel_axis))
        return [name for name in needed if name not in there]

    def named(self, kind: str) -> tuple[list[tuple[str, FilePoint]], list[FilePoint]]:
        """The file's points that are ours, by our names and with the wheels of theirs, and the others."""
        # What the user says goes before what the format says, of this point and of that name.
        taken = self.own.names.keys() | self.own.points.keys()
        every = {our: names for our, names in self.format.names_of(kind).items() if our not in taken}
        ours = {plain(their): our for our, names in every.items() for their in names}
        ours |= {plain(their): our for our, their in self.own.names.items()}
        known, others = [], []
        for point in self.contents.points:
            found = self.format.ours(point.name, ours)
            if point.section and (whole := self.format.ours(f"{point.section} {point.name}", ours)):
                found, point = whole, replace(point, name=f"{point.section} {point.name}")
            if found is None:
                others.append(point)
                continue
            our, (side, part) = found
            of_line = self.format.wheels.get(point.corner, ("", ""))
            side, part = side or of_line[0] or point.side, part or of_line[1] or point.part
            known.append((our, replace(point, side=side, part=part)))
        return known, others

    def chosen(self) -> _Wheel:
        """The points of the wheel that is asked for."""
        known, others = self.named(self.kind)
        theirs = {plain(point.name) for _, point in known}
        for their in self.own.names.values():
            if plain(their) not in theirs:
                raise UnknownName(f"point in {self.source}", their, {p.name for p in self.contents.points})
        parts = {point.part for _, point in known}
        part = self.one_of("part", "axle", self.choices.part, parts)
        # A file that does not say its axle is of the one that is said.
        part = part if part in parts else ""
        known = [(ours, point) for ours, point in known if point.of(part, "")]
        labels = {point.side for _, point in known} - {""}
        side = self.one_of("side", "side", self.choices.side if len(labels) > 1 else None, labels)
        found: dict[str, FilePoint] = {}
        for ours, point in known:
            other = found.setdefault(ours, point) if point.of(part, side) else point
            if other.place != point.place:
                told = f"has {ours} twice, {other.told} and {short(point.name)} elsewhere"
                allowed = "one of them; the points of one wheel of one axle, or a file of names (--names)"
                raise self.refuse(told, allowed, point.line)
        others = [point for point in others if point.of(part, side)]
        return _Wheel(found | dict(self.own.points), tuple(others), part, side)

    def one_of(self, option: str, what: str, chosen: str | None, there: set[str]) -> str:
        """The part or side of a file that may hold several."""
        labels = sorted(there - {""})
        every = " or ".join(f"--{option} {label}" for label in labels)
        if chosen and labels and chosen not in labels:
            raise self.refuse(f"has no points of {what} {chosen}", every)
        if not chosen and len(labels) > 1:
            called = self.called
            told = [f"{label} ({called[label]})" if label in called else label for label in labels]
            raise self.refuse(f"has points of more than one {what}: {', '.join(told)}", every)
        return chosen or (labels[0] if labels else "")

    # What is needed and is not there.

    def require_all(self, wheel: _Wheel, axis: SpinAxis | None) -> None:
        """Refuse a file without a point that is needed and does not follow from others."""
        structure, names = mechanism_file(self.kind).structures[AS_DRAWN], self.format.names_of(self.kind)
        lost = [
            name
            for name in self.missing(self.kind, wheel.ours)
            if derived(name, structure, wheel.places, 1, axis) is None
        ]
        if not lost:
            return
        looked = (f"{n} (looked for: {', '.join(map(short, names[n]))})" if n in names else n for n in lost)
        told = f"lacks {', '.join(looked)} of a {self.kind}"
        told += f"; not known in it: {some_of([p.told for p in wheel.others], NAMED)}" if wheel.others else ""
        told += f"; without three numbers: {self.lines}" if self.lines else ""
        advice = f'a file of names (--names; a new one is written) with {lost[0]} = "its name"'
        advice += f" or {lost[0]} = [x, y, z]"
        if self.topology.wheel_axis[0] in lost:
            advice += "; for the spin axis --camber and --toe will do, + leaning out at the top and + toe in"
        raise self.refuse(told, advice)

    def spin_axis(self, axle: Axle) -> SpinAxis | None:
        """Where the file or the user says that the wheel's spin axis points."""
        camber, toe = self.choices.camber, self.choices.toe
        if camber is None and toe is None:
            return axle.spin_axis
        if axle.spin_axis is not None:
            raise self.refuse("says where its spin axis points", "neither --camber nor --toe")
        if camber is None or toe is None or not max(abs(camber), abs(toe)) < 45.0:
            allowed = "both --camber and --toe, each of less than 45 deg, or neither"
            raise self.refuse(f"has --camber {camber} and --toe {toe} said of it", allowed)
        # Projected angles: tan(toe) = forward / outboard, tan(camber) = -up / outboard.
        direction = (tan(radians(toe)), 1.0, -tan(radians(camber)))
        return SpinAxis(direction, f"--camber {camber:g} and --toe {toe:g}, deg")

    # Axes, unit and side, and what speaks against them.

    def axes(self, wheel: _Wheel) -> tuple[Axes, str]:
        """The axes that somebody says, and who; points of a table under our own names have our own axes."""
        if self.choices.axes is not None:
            return Axes.of(self.choices.axes), "--axes"
        read = {name: point.name for name, point in wheel.ours.items() if name not in self.own.points}
        if self.format.form == TABLE and all(ours in theirs for ours, theirs in read.items()):
            return OUR_AXES, "its points' names, which are ours"
        for pattern, axes in self.format.axes.items():
            telling = [name for name in read.values() if re.fullmatch(pattern or ".*", plain(name))]
            if telling:
                return axes, f"names such as {short(telling[0])}" if pattern else "its format"
        lie = f", where {ways}" if (ways := self.lie(wheel)) else ""
        raise self.refuse("does not say where x, y and z point", f"--axes with {ALLOWED}{lie}")

    def lie(self, wheel: _Wheel) -> str:
        """Where points lie in the file that say where forward and up are."""
        return " and ".join(f"{one} lies along {way} from {other}" for one, other, way, _ in self.ways(wheel))

    def ways(self, wheel: _Wheel) -> list[tuple[str, str, str, int]]:
        """Points that lie ahead of and above others by what they are: where they do in the file, as `+y`,
        and the place of that coordinate in the scene.
        """
        topology, found, places = self.topology, [], wheel.places
        # The mechanism need not say which of its points these are.
        for ends, at in ((topology.front_and_rear, 0), (topology.steering_axis[::-1], 2)):
            if ends:
                one, other = ends
                apart = [a - b for a, b in zip(places[one], places[other], strict=True)]
                most = [*map(abs, apart)].index(max(map(abs, apart)))
                found.append((one, other, f"{'-+'[apart[most] > 0]}{'xyz'[most]}", at))
        return found

    def require_axes(self, axes: Axes, by: str, wheel: _Wheel) -> None:
        """Refuse axes that the car's points speak against.

        Which way is left no point shows: it decides which wheel this is.
        """
        for _, _, way, at in self.ways(wheel):
            along, sign = DIRECTIONS[axes.directions["xyz".index(way[1])]]
            # x points rearward.
            if along != at or (sign > 0) != ((way[0] == "+") == (at == 2)):
                told = f"has axes {axes.words} by {by}, but {self.lie(wheel)}"
                raise self.refuse(told, f"--axes of the file, or --axes {axes.option} if that is so")

    def unit(self) -> tuple[str, str]:
        """The unit of lengths, and who says it."""
        said, chosen = self.contents.unit, self.choices.unit
        if said and said not in LENGTHS:
            raise self.refuse(f"has lengths in {short(said)}", ", ".join(LENGTHS))
        if said and chosen and said != chosen:
            raise self.refuse(f"says that its lengths are in {said}", f"--unit {said}, or none")
        by = {"the file": said, "--unit": chosen, "its format": self.format.unit}
        return next((unit, who) for who, unit in by.items() if unit)

    def require_size(self, unit: str, wheel: _Wheel) -> None:
        """Refuse a unit in which the points make no car."""
        span = max(max(column) - min(column) for column in zip(*wheel.places.values(), strict=True))
        spans = {name: span * size for name, size in LENGTHS.items()}
        fitting = {name: size for name, size in spans.items() if SMALLEST <= size <= LARGEST}
        if unit not in fitting:
            told = f"spans {float(spans[unit]):.4g} mm if its lengths are in {unit}"
            others = (f"--unit {other} makes {float(size):.4g} mm" for other, size in fitting.items())
            raise self.refuse(told, "; ".join(others) or f"--unit {unit} if that is so")

    def side(self, file: _Wheel, turned: Mapping[str, Place], axes: Axes) -> str:
        """The wheel's side, from where it lies; it must be the one that the file or the user says."""
        wheel, inner = self.topology.wheel_centre, self.topology.inboard
        lies, out = turned[wheel][1], turned[wheel][1] - turned[inner][1]
        if not out:
            raise self.refuse(f"has {wheel} as far out as {inner}", "a wheel outboard of it; see --axes")
        seen = SIDES[out > 0]
        where = f"{wheel} lies {abs(out):.6g} mm to the {seen} of {inner}"
        by_whom = {"--side": self.choices.side, "the file": file.side, "its format": self.format.side}
        for by, said in by_whom.items():
            if said and said != seen:
                allowed = f"--axes with the other of left and right than {axes.option}, or the {seen} side"
                # Not where the file has the wheel that is asked for: a mirrored other one is another wheel.
                if by == "--side" and file.side != said:
                    allowed += f"; or --side {seen} --mirror makes the {said} wheel of it"
                raise self.refuse(f"has a {said} wheel by {by}, but {where}", allowed)
        if (lies > 0) != (out > 0) and not any(by_whom.values()):
            told = f"has {where}, but {abs(lies):.6g} mm to the {SIDES[lies > 0]} of the middle of the car"
            raise self.refuse(told, f"--side {seen} if y is not counted from the middle, or other --axes")
        return seen

    def placed(
        self, wheel: _Wheel, turned: Mapping[str, Place], axis: SpinAxis | None, side: str
    ) -> dict[str, ScenePoint]:
        """The scene's points in the order of its topology, with where each comes from."""
        structure, needed = mechanism_file(self.kind).structures[AS_DRAWN], self.missing(self.kind, turned)
        out, found = SIDES.index(side) * 2 - 1, {}
        for name in self.topology.points:
            if name in turned:
                found[name] = ScenePoint(name, turned[name], wheel.ours[name].source)
            elif name in needed and (one := derived(name, structure, turned, out, axis)):
                found[name] = ScenePoint(name, *one, derived=True)
        return found
