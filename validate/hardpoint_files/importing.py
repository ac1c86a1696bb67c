"""From a file of another program to a scene of ours: points by name, in our axes and unit, of one wheel.

What is not known is refused or listed, never guessed: axes and units that the points speak against, points
without a name of ours, points of ours that the file lacks.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from decimal import Decimal
from functools import cached_property
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
from validate.hardpoint_files.axes import ALLOWED, OUR_AXES, Axes, axes_seen
from validate.hardpoint_files.contents import Contents, FilePoint, Place, SpinAxis, plain, short
from validate.hardpoint_files.derived import derived
from validate.hardpoint_files.format import Format, format_of
from validate.hardpoint_files.names_file import NamesFile, names_to_fill_in, read_names
from validate.hardpoint_files.static_angles import AngleCheck, check_angles
from validate.hardpoint_files.table import NO_WHEEL, WHEELS, Wheel, wheel_of
from validate.hardpoint_files.written_scene import ScenePoint, bounce_of, scene_of, scene_text
from validate.plain_text import some_of
from validate.tables.cells import text_of
from validate.tables.errors import FileError
from validate.tables.units import LENGTHS

# mm: the points of one wheel's suspension, from model cars to lorries, span no less and no more.
SMALLEST, LARGEST = Decimal(150), Decimal(4000)
SIDES = ("left", "right")
PARTS = ("front", "rear")
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
        for kind, names in allowed.items():
            chosen = getattr(self, kind)
            if chosen is not None and chosen not in names:
                raise UnknownName(kind, chosen, names)
        if self.part is not None and not self.part.isdecimal() and self.part not in PARTS:
            raise UnknownName("part", self.part, (*PARTS, "1", "2", "3"))


@dataclass(frozen=True)
class Imported:
    """A scene from another program's file, and what became of everything that the file holds.

    Attributes:
        scene: checked, with a bounce. text: the same as a scene file, with a comment for each point.
        points: of the scene, in its axes, with where each comes from.
        not_needed: points of the file that are known and hold nothing. unknown: points that are not known.
        angles: static angles that the file prints, held to the drawing's.
        stands: the drawing, closed. facts: what was taken for granted, in words.
        doubts: what looks wrong and was taken as the user said it.
    """

    format: Format
    scene: Scene
    text: str
    points: tuple[ScenePoint, ...]
    not_needed: tuple[FilePoint, ...]
    unknown: tuple[FilePoint, ...]
    angles: tuple[AngleCheck, ...]
    stands: Standing
    facts: tuple[str, ...]
    doubts: tuple[str, ...]


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
    own = NamesFile() if choices.names is None else read_names(choices.names)
    found, text = _opened(source, choices)
    return _Import(source, choices, found, found.read(text, source, own.columns), own).result()


def names_of(path: str | Path, format: str | None = None, suspension: str | None = None) -> str:
    """A file of names (TOML) for a file of hardpoints, ready to be filled in, with the points that are known.

    Raises:
        SceneError, FileError, UnknownName: as `import_hardpoints`.
    """
    choices, source = Choices(format, suspension), str(path)
    found, text = _opened(source, choices)
    try:
        contents = found.read(text, source, {})
    except FileError:
        # Such as a table whose columns are not known: they can be said in the same file.
        contents = Contents(())
    one = _Import(source, choices, found, contents, NamesFile())
    kind = suspension or one.closest()[0]
    known, others = one.named(kind)
    return names_to_fill_in(source, kind, one.missing(kind, ()), dict(known), others)


def _opened(source: str, choices: Choices) -> tuple[Format, str]:
    """A file's format and its text."""
    text = text_of(read_file(source, "the path of a file of hardpoints"))
    if text is None:
        raise FileError(source, 0, "is no text", "a text file; of a workbook, one sheet saved as CSV")
    return format_of(text, choices.format, source), text


@dataclass(frozen=True)
class _Wheel:
    """The points of one wheel.

    Attributes:
        ours: by our names. others, spoilt: the file's others, and its lines that are no points.
        part, side: its axle and side, by the file; empty where that does not say.
    """

    ours: Mapping[str, FilePoint]
    others: tuple[FilePoint, ...]
    spoilt: tuple[FilePoint, ...]
    part: str
    side: str

    @property
    def places(self) -> dict[str, Place]:
        """Where its points are, in the file's axes and unit."""
        return {name: point.place for name, point in self.ours.items()}

    def difference(self, one: str, other: str) -> Place:
        """From a point to another."""
        x, y, z = (b - a for a, b in zip(self.ours[one].place, self.ours[other].place, strict=True))
        return x, y, z


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

    @cached_property
    def given(self) -> dict[str, FilePoint]:
        """The points that the file of names has."""
        return self.own.points(self.choices.names or "")

    def result(self) -> Imported:
        kind, topology = self.kind, self.topology
        if not (topology.wheel_axis and topology.inboard):
            raise self.refuse(
                f"is read as {kind}, whose file names no wheel: the roles wheel_axis and inboard",
                "a suspension of one wheel; else a scene written by hand (pointcoord new)",
            )
        wheel = self.chosen()
        axle = self.contents.axle(wheel.part)
        axis = self.spin_axis(axle.spin_axis)
        self.require_all(wheel, axis)
        axes, axes_by, doubted = self.axes(wheel)
        unit, unit_by = self.unit()
        doubts = [*axle.doubts, *doubted, *self.against_unit(unit, wheel)]
        turned = {name: axes.to_scene(place, unit) for name, place in wheel.places.items()}
        side = self.side(wheel, turned, axes)
        points = self.placed(wheel, turned, axis, side)
        facts = [
            f"the file's axes are {axes.words}, by {axes_by}, in {unit}, by {unit_by}; "
            "here x rearward, y right, z up, in mm",
            *axle.notes,
            *(self.format.suspensions[kind].notes if kind in self.format.suspensions else ()),
        ]
        if wheel.spoilt:
            facts.append(f"lines without a point: {_listed(wheel.spoilt)}")
        if not axes.right_handed:
            doubts.append(f"axes {axes.words} are left-handed: is one of them turned round?")
        if self.choices.mirror:
            facts.append(f"the file's wheel is a {side} one; here it is mirrored in the middle of the car")
            side = SIDES[side == "left"]
            points = {name: point.mirrored for name, point in points.items()}
        facts += [
            f"{name} is not in the file: {other} stands in for it"
            for name, other in topology.stand_ins.items()
            if name not in points
        ]
        drawn = scene_of(self.source, kind, side, points.values())
        stands = standing(drawn)
        laws, scene = bounce_of(drawn, stands)
        words = self.format.words, drawn, points.values(), laws, facts, wheel.others
        angles = check_angles(self.format.angles, axle.angles, stands.angles, wheel.places, topology)
        return Imported(
            format=self.format,
            scene=scene,
            text=scene_text(self.source, *words),
            points=tuple(points.values()),
            not_needed=tuple(point for point in wheel.others if self.holds_nothing(point)),
            unknown=tuple(point for point in wheel.others if not self.holds_nothing(point)),
            angles=tuple(angles),
            stands=stands,
            facts=tuple(facts),
            doubts=tuple(doubts),
        )

    # Which suspension, and which of the file's points are which of ours.

    @cached_property
    def kind(self) -> str:
        """Our type of the suspension: as the user or the file says, or the one whose points are there."""
        if self.choices.suspension:
            return self.choices.suspension
        if called := self.called:
            part = self.one_of("part", self.choices.part, {*called})
            said = called.get(part) or next(iter(called.values()))
            if kind := self.format.called(said):
                return kind
            raise self.refuse(
                f"holds a suspension called {short(said)}" + (f" at its axle {part}" if part else ""),
                f"{self.format.known_suspensions}; a like one by another name: say so with --suspension",
            )
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
        """The suspensions of which the file lacks the fewest points."""
        lacking = {k: len(self.missing(k, dict(self.named(k)[0]))) for k in self.format.suspensions}
        return [kind for kind, count in lacking.items() if count == min(lacking.values())]

    def missing(self, kind: str, known: Iterable[str]) -> list[str]:
        """Points that a car of ours must have; its spin axis is not left to what may stand in for it."""
        topology, there = mechanism_file(kind).topology(), {*known, *self.given}
        needed = dict.fromkeys((*topology.required_points, *topology.wheel_axis))
        return [name for name in needed if name not in there]

    def readings(self, name: str) -> Iterator[tuple[str, Wheel]]:
        """A name whole, and without words of a wheel that it begins or ends with, and the wheel."""
        yield plain(name), NO_WHEEL
        words = plain(name).split() if self.format.our_own_names else []
        for ahead, behind in ((0, 1), (1, 0), (1, 1), (2, 0), (2, 1)):
            base = words[ahead : len(words) - behind]
            edge = [*words[:ahead], *words[len(words) - behind :]]
            if base and all(word in WHEELS for word in edge):
                yield " ".join(base), wheel_of(edge)

    def holds_nothing(self, point: FilePoint) -> bool:
        """Whether a point is known and not needed, whatever tells its wheel."""
        return any(self.format.holds_nothing(base) for base, _ in self.readings(point.name))

    def named(self, kind: str, spoilt: bool = False) -> tuple[list[tuple[str, FilePoint]], list[FilePoint]]:
        """The file's points that are ours, by our names, with the wheel of theirs, and the others."""
        ours = {plain(their): our for our, names in self.format.names_of(kind).items() for their in names}
        if self.format.our_own_names:
            ours |= {plain(name): name for name in mechanism_file(kind).points}
        # What the user says goes before what the format says, of this point and of that name.
        ours = {their: our for their, our in ours.items() if our not in self.own.names}
        ours |= {plain(their): our for our, their in self.own.theirs.items()}
        known, others = [], []
        for point in self.contents.spoilt if spoilt else self.contents.points:
            readings = (one for one in self.readings(point.name) if one[0] in ours)
            base, (side, part) = next(readings, ("", NO_WHEEL))
            if not base:
                others.append(point)
                continue
            if side and point.side and side != point.side:
                told = f"has {short(point.name)} for the {point.side} wheel"
                raise self.refuse(told, "one side", point.line)
            known.append((ours[base], replace(point, side=side or point.side, part=part or point.part)))
        return known, others

    def chosen(self) -> _Wheel:
        """The points of the wheel that is asked for."""
        known, others = self.named(self.kind)
        theirs = {plain(point.name) for _, point in known}
        for their in self.own.theirs.values():
            if plain(their) not in theirs:
                raise UnknownName(f"point in {self.source}", their, {p.name for p in self.contents.points})
        parts = {point.part for _, point in known}
        part = self.one_of("part", self.choices.part, parts)
        # A file that does not say its axle is of the one that is said.
        part = part if part in parts else ""
        known = [(ours, point) for ours, point in known if point.of(part, "")]
        labels = {point.side for _, point in known} - {""}
        side = self.one_of("side", self.choices.side if len(labels) > 1 else None, labels)
        found: dict[str, FilePoint] = {}
        for ours, point in known:
            other = found.setdefault(ours, point) if point.of(part, side) else point
            if other.place != point.place:
                told = f"has {ours} twice, {short(other.name)} on line {other.line} and {short(point.name)} "
                more = "the points of one wheel of one axle, or a file of names (--names) that says which"
                raise self.refuse(f"{told}elsewhere", more, point.line)
        for our, point in self.named(self.kind, spoilt=True)[0]:
            if point.error and point.of(part, side) and our not in {*found, *self.given}:
                raise point.error
        theirs_too, spoilt = (
            tuple(one for one in some if one.of(part, side)) for some in (others, self.contents.spoilt)
        )
        return _Wheel(found | self.given, theirs_too, spoilt, part, side)

    def one_of(self, option: str, chosen: str | None, there: set[str]) -> str:
        """The part or side of a file that may hold several."""
        labels = sorted(there - {""})
        every = " or ".join(f"--{option} {label}" for label in labels)
        if chosen and labels and chosen not in labels:
            raise self.refuse(f"has no points of {option} {chosen}", every)
        if not chosen and len(labels) > 1:
            called = self.called
            told = [f"{label} ({called[label]})" if label in called else label for label in labels]
            raise self.refuse(f"has points of more than one {option}: {', '.join(told)}", every)
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
        theirs = [
            f"{name} (looked for: {', '.join(map(short, names[name]))})" if name in names else name
            for name in lost
        ]
        told = f"lacks {', '.join(theirs)} of a {self.kind}"
        if unknown := [*wheel.spoilt, *(p for p in wheel.others if not self.holds_nothing(p))]:
            told += f"; not known in it: {_listed(unknown)}"
        advice = f'a file of names (--names; a new one is written) with {lost[0]} = "its name"'
        advice += f" or {lost[0]} = [x, y, z]"
        if self.topology.wheel_axis[0] in lost:
            advice += "; for the spin axis --camber and --toe will do, + leaning out at the top and + toe in"
        raise self.refuse(told, advice)

    def spin_axis(self, by_file: SpinAxis | None) -> SpinAxis | None:
        """Where the file or the user says that the wheel's spin axis points."""
        camber, toe = self.choices.camber, self.choices.toe
        if camber is None and toe is None:
            return by_file
        if by_file is not None:
            raise self.refuse("says where its spin axis points", "neither --camber nor --toe")
        if camber is None or toe is None:
            raise self.refuse("has one static angle said of it", "both --camber and --toe, or neither")
        for option, angle in (("--camber", camber), ("--toe", toe)):
            if not abs(angle) < 45.0:
                raise self.refuse(f"has {option} {angle:g} said of it", "an angle of less than 45 deg")
        # Projected angles: tan(toe) = forward / outboard, tan(camber) = -up / outboard.
        direction = (tan(radians(toe)), 1.0, -tan(radians(camber)))
        return SpinAxis(direction, f"--camber {camber:g} and --toe {toe:g}, deg")

    # Axes, unit and side, and what speaks against them.

    def axes(self, wheel: _Wheel) -> tuple[Axes, str, list[str]]:
        """Where x, y and z point, who says so, and the doubts of it.

        Axes that nobody said and the car's points speak against are refused; those of the user are doubted.
        Which way is left no point shows: it decides which wheel this is.
        """
        topology, seen, words = self.topology, None, ""
        # The mechanism need not say which of its points lie ahead of and above others.
        if topology.front_and_rear and topology.steering_axis:
            (front, rear), (low, high) = topology.front_and_rear, topology.steering_axis
            words = f"{front} seen from {rear} and {high} from {low}"
            seen = axes_seen(wheel.difference(rear, front), wheel.difference(low, high))
        outboard = wheel.difference(topology.inboard, topology.wheel_centre)
        both = [] if seen is None else [seen, seen.other_handed]
        # A wheel of a known side shows which way is left.
        known = self.choices.side or wheel.side
        ways = [(one.option, SIDES[one.to_scene(outboard, "mm")[1] > 0]) for one in both]
        some = [f"--axes {one} of a {side} wheel" for one, side in ways if known in ("", side)]
        fitting = " or ".join(some) or f"--axes with {ALLOWED}"
        said, by = self.axes_said(wheel)
        if said is None:
            raise self.refuse("does not say where x, y and z point", f"{fitting}, by where points lie")
        if seen is None or said in both:
            return said, by, []
        told = f"has axes {said.words} by {by}, but {words} lie as in {seen.words}"
        if self.choices.axes is None:
            raise self.refuse(told, f"{fitting} if that is so, --axes {said.option} if not")
        return said, by, [f"{told}: are these the right axes and names?"]

    def axes_said(self, wheel: _Wheel) -> tuple[Axes | None, str]:
        """The axes that somebody says, and who; points under our own names have our own axes."""
        if self.choices.axes is not None:
            return Axes.of(self.choices.axes), "--axes"
        read = {name: point.name for name, point in wheel.ours.items() if name not in self.given}
        if self.format.our_own_names and all(_is_our_own(*one) for one in read.items()):
            return OUR_AXES, "its points' names, which are ours"
        told_by = self.format.axes_told_by
        if not told_by:
            return self.format.axes, "its format"
        telling = [name for name in read.values() if re.fullmatch(told_by, plain(name))]
        return (self.format.axes, f"names such as {short(telling[0])}") if telling else (None, "")

    def unit(self) -> tuple[str, str]:
        """The unit of the file's lengths, and who says so."""
        said, chosen = self.contents.unit, self.choices.unit
        if said and said not in LENGTHS:
            raise self.refuse(f"has lengths in {short(said)}", ", ".join(LENGTHS))
        if said and chosen and said != chosen:
            raise self.refuse(f"says that its lengths are in {said}", f"--unit {said}, or none")
        if said:
            return said, "the file"
        return (chosen, "--unit") if chosen else (self.format.unit, "its format")

    def against_unit(self, unit: str, wheel: _Wheel) -> list[str]:
        """Refuse a unit that makes no car where nobody said it; doubt one that somebody did."""
        span = max(max(column) - min(column) for column in zip(*wheel.places.values(), strict=True))
        spans = {name: span * size for name, size in LENGTHS.items()}
        fitting = {name: size for name, size in spans.items() if SMALLEST <= size <= LARGEST}
        if unit in fitting:
            return []
        told = f"spans {float(spans[unit]):.4g} mm if its lengths are in {unit}"
        others = "; ".join(f"--unit {other} makes {float(size):.4g} mm" for other, size in fitting.items())
        if self.choices.unit is not None:
            return ["; ".join(filter(None, (f"the file {told}", others)))]
        raise self.refuse(told, others or f"--unit {unit} if that is so")

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
            raise self.refuse(
                f"has {where}, but {abs(lies):.6g} mm to the {SIDES[lies > 0]} of the middle of the car",
                f"--side {seen} if y is not counted from the middle, or other --axes",
            )
        return seen

    def placed(
        self, wheel: _Wheel, turned: Mapping[str, Place], axis: SpinAxis | None, side: str
    ) -> dict[str, ScenePoint]:
        """The scene's points in the order of its topology, with where each comes from."""
        structure, needed = mechanism_file(self.kind).structures[AS_DRAWN], self.missing(self.kind, turned)
        found = {}
        for name in self.topology.points:
            if name in turned:
                own = wheel.ours[name]
                line = f", line {own.line}" if own.line else ""
                found[name] = ScenePoint(name, turned[name], f"{own.name}{line}")
            elif name in needed and (
                one := derived(name, structure, turned, SIDES.index(side) * 2 - 1, axis)
            ):
                found[name] = ScenePoint(name, *one, derived=True)
        return found


def _listed(points: Iterable[FilePoint]) -> str:
    """Points with their lines."""
    return some_of([f"{short(point.name)} on line {point.line}" for point in points], NAMED)


def _is_our_own(ours: str, theirs: str) -> bool:
    """Whether a file's name of a point is ours as we write it, with or without a side and an axle."""
    base, _, ending = theirs.rpartition("_")
    return ours in (theirs, base if plain(ending) in WHEELS else "")
