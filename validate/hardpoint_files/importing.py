"""From a file of another program to a scene of ours: points by name, in our axes and unit, of one wheel.

What is not known is refused or listed, never guessed: axes and units that the points speak against, points
without a name of ours, points of ours that the file lacks.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from functools import cached_property
from math import radians, tan
from pathlib import Path
from typing import Any

from pointcoord import Scene
from pointcoord.errors import UnknownName
from pointcoord.linkage.topology import Topology
from pointcoord.mechanism import mechanism_file, shipped
from pointcoord.mechanism.file import AS_DRAWN
from pointcoord.toml_text import read_file
from validate.hardpoint_files.axes import ALLOWED, OUR_AXES, Axes, axes_seen
from validate.hardpoint_files.columns import NO_WHEEL, WHEELS, Wheel, wheel_of
from validate.hardpoint_files.contents import (
    Axle,
    Contents,
    FilePoint,
    Place,
    SpinAxis,
    Spoilt,
    plain,
    short,
)
from validate.hardpoint_files.derived import derived
from validate.hardpoint_files.format import Format, format_of
from validate.hardpoint_files.names_file import NO_NAMES, NamesFile, names_to_fill_in, read_names
from validate.hardpoint_files.static_angles import AngleCheck, check_angles
from validate.hardpoint_files.written_scene import Bounce, ScenePoint, bounce_of, scene_of, scene_text
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
        allowed: tuple[tuple[str, str | None, Iterable[str]], ...] = (
            ("suspension", self.suspension, shipped()),
            ("side", self.side, SIDES),
            ("unit", self.unit, LENGTHS),
        )
        for kind, chosen, names in allowed:
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
        bounce: the motion that is written. facts: what was taken for granted, in words.
        doubts: what looks wrong and was taken as the user said it.
    """

    format: Format
    scene: Scene
    text: str
    points: tuple[ScenePoint, ...]
    not_needed: tuple[FilePoint, ...]
    unknown: tuple[FilePoint, ...]
    angles: tuple[AngleCheck, ...]
    bounce: Bounce
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
    own_names = NO_NAMES if choices.names is None else read_names(choices.names)
    found, text = _opened(source, choices)
    return _Import(source, choices, found, found.read(text, source, own_names.table), own_names).result()


def names_of(path: str | Path, format: str | None = None, suspension: str | None = None) -> str:
    """A file of names (TOML) for a file of hardpoints, ready to be filled in.

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
    return _Import(source, choices, found, contents, NO_NAMES).to_fill_in()


def _opened(source: str, choices: Choices) -> tuple[Format, str]:
    """A file's format and its text."""
    text = text_of(read_file(source, "the path of a file of hardpoints"))
    if text is None:
        allowed = "a text file; of a workbook, one sheet saved as CSV"
        raise FileError(source, 0, "is no text", allowed)
    return format_of(text, choices.format, source), text


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
        kind, topology = self.kind, self.topology
        if not (topology.wheel_axis and topology.inboard):
            raise self.refuse(
                f"is read as {kind}, whose file names no wheel: the roles wheel_axis and inboard",
                "a suspension of one wheel; else a scene written by hand (pointcoord new)",
            )
        ours, others, part, side_said = self.chosen()
        axle = self.contents.axle(part)
        axis = self.spin_axis(axle)
        values = self.values(part, side_said)
        self.require_all(ours, others, axis, values)
        doubts = list(axle.doubts)
        axes, axes_by, doubted = self.axes(ours, side_said)
        unit = self.unit()
        doubts += doubted
        doubts += self.against_unit(unit, ours)
        turned = {name: axes.to_scene(point.place, unit) for name, point in ours.items()}
        side = self.side(side_said, turned, axes)
        points = self.placed(ours, turned, axis, side)
        facts = [self.turning(axes, axes_by, unit), *axle.notes]
        facts += self.format.suspensions[kind].notes if kind in self.format.suspensions else ()
        if values:
            facts.append(f"lines without a point: {some_of(values, NAMED)}")
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
        bounce = bounce_of(drawn)
        text = scene_text(self.source, self.format.words, drawn, points.values(), bounce, facts, others)
        return Imported(
            format=self.format,
            scene=Scene.from_mapping(bounce.added_to(drawn), self.source),
            text=text,
            points=tuple(points.values()),
            not_needed=tuple(point for point in others if self.holds_nothing(point)),
            unknown=tuple(point for point in others if not self.holds_nothing(point)),
            angles=self.angles(axle, bounce.angles, ours, unit),
            bounce=bounce,
            facts=tuple(facts),
            doubts=tuple(doubts),
        )

    def to_fill_in(self) -> str:
        """A file of names, with the points that are known."""
        least = self.closest()
        kind = self.choices.suspension or least[0]
        known, others = self.named(kind)
        topology = mechanism_file(kind).topology()
        needed = dict.fromkeys((*topology.required_points, *topology.wheel_axis))
        return names_to_fill_in(self.source, kind, needed, dict(known), others)

    # Which suspension, and which of the file's points are which of ours.

    @cached_property
    def kind(self) -> str:
        """Our type of the suspension: as the user or the file says, or the one whose points are there."""
        if self.choices.suspension:
            return self.choices.suspension
        if called := self.called:
            part = self.one_of("part", "axle", self.choices.part, {*called})
            said = called.get(part) or next(iter(called.values()))
            kind = self.format.called(said)
            if kind is not None:
                return kind
            raise self.refuse(
                f"holds a suspension called {short(said)}" + (f" at its axle {part}" if part else ""),
                f"{self.format.known_suspensions}; a like one by another name: say so with --suspension",
            )
        best = self.closest()
        if len(best) > 1:
            raise self.refuse(
                f"could be a {' or a '.join(best)}", f"--suspension {' or --suspension '.join(best)}"
            )
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
        missing = {
            kind: len(self.missing(mechanism_file(kind).topology(), self.named(kind)[0]))
            for kind in self.format.suspensions
        }
        return [kind for kind, count in missing.items() if count == min(missing.values())]

    def lookup(self, kind: str) -> Callable[[FilePoint], tuple[str, FilePoint]]:
        """From a point of the file to our name, empty if it has none, with the side and axle of its name."""
        words = self.format.names_of(kind)
        ours = {plain(their): our for our, theirs in words.items() for their in theirs}
        if self.format.our_own_names:
            ours |= {plain(name): name for name in mechanism_file(kind).points}
        # What the user says goes before what the format says, of this point and of that name.
        said = {plain(their): our for our, their in self.own.names.items()}
        taken = self.own.names.keys() | self.own.points.keys()
        ours = {their: our for their, our in ours.items() if our not in taken} | said

        in_words = self.format.in_our_words
        worded = {in_words(their): our for their, our in ours.items()} if self.format.vocabulary else {}

        def known(name: str) -> str:
            return ours.get(plain(name)) or worded.get(in_words(name), "")

        def found(point: FilePoint) -> tuple[str, FilePoint]:
            for base, (side, part) in self.readings(point.name):
                if our := known(base):
                    if side and point.side and side != point.side:
                        told = f"has {short(point.name)} for the {point.side} wheel"
                        raise self.refuse(told, "one side", point.line)
                    return our, replace(point, side=side or point.side, part=part or point.part)
            return "", point

        return found

    def readings(self, name: str) -> Iterator[tuple[str, Wheel]]:
        """A name whole, and without words of a wheel that it begins or ends with, and the wheel."""
        yield name, NO_WHEEL
        words = re.findall(r"[^\W_]+", name) if self.format.our_own_names else []
        for ahead, behind in ((0, 1), (1, 0), (1, 1), (2, 0), (2, 1)):
            base = words[ahead : len(words) - behind]
            edge = [plain(word) for word in (*words[:ahead], *words[len(words) - behind :])]
            if base and all(word in WHEELS for word in edge):
                yield " ".join(base), wheel_of(edge)

    def holds_nothing(self, point: FilePoint) -> bool:
        """Whether a point is known and not needed, whatever tells its wheel."""
        return any(self.format.holds_nothing(base) for base, _ in self.readings(point.name))

    def named(self, kind: str) -> tuple[list[tuple[str, FilePoint]], list[FilePoint]]:
        """The file's points that are ours, by our names, and the others."""
        find = self.lookup(kind)
        found = [find(point) for point in self.contents.points]
        return [(ours, point) for ours, point in found if ours], [point for ours, point in found if not ours]

    def chosen(self) -> tuple[dict[str, FilePoint], list[FilePoint], str, str]:
        """The points of one wheel by our names, the file's others, and the axle and side by the file."""
        known, others = self.named(self.kind)
        unused = [
            their
            for their in self.own.names.values()
            if plain(their) not in {plain(p.name) for _, p in known}
        ]
        if unused:
            raise UnknownName(f"point in {self.source}", unused[0], {p.name for p in self.contents.points})
        parts = {point.part for _, point in known}
        part = self.one_of("part", "axle", self.choices.part, parts)
        # A file that does not say its axle is of the one that is said.
        part = part if part in parts else ""
        known = [(ours, point) for ours, point in known if point.part in ("", part)]
        others = [point for point in others if not part or point.part in ("", part)]
        labels = {point.side for _, point in known} - {""}
        side = self.one_of("side", "side", self.choices.side if len(labels) > 1 else None, labels)
        others = [point for point in others if not side or point.side in ("", side)]
        found: dict[str, FilePoint] = {}
        for ours, point in known:
            if point.side not in ("", side):
                continue
            other = found.setdefault(ours, point)
            if other.place != point.place:
                same = other.name == point.name
                raise self.refuse(
                    f"has {ours} twice, {short(other.name)} on line {other.line} and {short(point.name)} "
                    "elsewhere",
                    "one of them; the points of one wheel of one axle"
                    if same
                    else "one of them, or a file of names (--names) that says which",
                    point.line,
                )
        find = self.lookup(self.kind)
        for spoilt, point in self.spoilt(part, side):
            our, own = find(point)
            fits = own.part in ("", part) and own.side in ("", side)
            if fits and our and our not in found and our not in self.own.points:
                raise spoilt.error
        return found | dict(self.own.points), others, part, side

    def spoilt(self, part: str, side: str) -> list[tuple[Spoilt, FilePoint]]:
        """The lines without a point that may speak of this wheel."""
        return [
            (one, one.point)
            for one in self.contents.spoilt
            if (not part or one.point.part in ("", part)) and (not side or one.point.side in ("", side))
        ]

    def values(self, part: str, side: str) -> list[str]:
        """The lines without a point that give a number."""
        return list(dict.fromkeys(str(one) for one, _ in self.spoilt(part, side) if one.value))

    def one_of(self, option: str, what: str, chosen: str | None, there: set[str]) -> str:
        """The part or side of a file that may hold several."""
        labels = sorted(there - {""})
        if chosen and labels and chosen not in labels:
            raise self.refuse(
                f"has no points of {what} {chosen}",
                " or ".join(f"--{option} {label}" for label in labels),
            )
        if not chosen and len(labels) > 1:
            called = self.called
            told = [f"{label} ({called[label]})" if label in called else label for label in labels]
            raise self.refuse(
                f"has points of more than one {what}: {', '.join(told)}",
                " or ".join(f"--{option} {label}" for label in labels),
            )
        return chosen or (labels[0] if labels else "")

    # What is needed and is not there.

    def missing(self, topology: Topology, known: Iterable[tuple[str, FilePoint]]) -> list[str]:
        """Points that a car of ours must have; its spin axis is not left to what may stand in for it."""
        there = {name for name, _ in known} | self.own.points.keys()
        needed = dict.fromkeys((*topology.required_points, *topology.wheel_axis))
        return [name for name in needed if name not in there]

    def require_all(
        self,
        ours: Mapping[str, FilePoint],
        others: Sequence[FilePoint],
        axis: SpinAxis | None,
        values: Sequence[str],
    ) -> None:
        """Refuse a file without a point that is needed and does not follow from others."""
        lacking = self.missing(self.topology, ours.items())
        there = {name: point.place for name, point in ours.items()}
        structure = mechanism_file(self.kind).structures[AS_DRAWN]
        lost = [name for name in lacking if derived(name, structure, there, 1, axis) is None]
        if not lost:
            return
        names = self.format.names_of(self.kind)
        theirs = [
            f"{name} (looked for: {', '.join(map(short, names[name]))})" if name in names else name
            for name in lost
        ]
        unknown = [point for point in others if not self.holds_nothing(point)]
        listed = some_of([f"{short(point.name)} on line {point.line}" for point in unknown], NAMED)
        advice = f'a file of names (--names; a new one is written) with {lost[0]} = "its name"'
        advice += f" or {lost[0]} = [x, y, z]"
        if self.topology.wheel_axis[0] in lost:
            advice += "; for the spin axis --camber and --toe will do, + leaning out at the top and + toe in"
        raise self.refuse(
            f"lacks {', '.join(theirs)} of a {self.kind}"
            + (f"; not known in it: {listed}" if listed else "")
            + (f"; no points: {some_of(values, NAMED)}" if values else ""),
            advice,
        )

    def spin_axis(self, axle: Axle) -> SpinAxis | None:
        """Where the file or the user says that the wheel's spin axis points."""
        camber, toe = self.choices.camber, self.choices.toe
        if axle.spin_axis is not None:
            if camber is not None or toe is not None:
                raise self.refuse("says where its spin axis points", "neither --camber nor --toe")
            return axle.spin_axis
        if camber is None or toe is None:
            if camber is not None or toe is not None:
                raise self.refuse("has one static angle said of it", "both --camber and --toe, or neither")
            return None
        for option, angle in (("--camber", camber), ("--toe", toe)):
            if not abs(angle) < 45.0:
                raise self.refuse(f"has {option} {angle:g} said of it", "an angle of less than 45 deg")
        # Projected angles: tan(toe) = forward / outboard, tan(camber) = -up / outboard.
        direction = (tan(radians(toe)), 1.0, -tan(radians(camber)))
        return SpinAxis(direction, f"--camber {camber:g} and --toe {toe:g}, deg")

    # Axes, unit and side, and what speaks against them.

    def axes(self, ours: Mapping[str, FilePoint], side: str) -> tuple[Axes, str, list[str]]:
        """Where x, y and z point, who says so, and the doubts of it.

        Axes that nobody said and the car's points speak against are refused; those of the user are doubted.
        """
        said, by = self.axes_said(ours)
        seen, outboard, words = self.seen(ours)
        # Which way is left no point shows: it decides which wheel this is.
        both = [] if seen is None else [seen, seen.other_handed]
        ways = [(one.option, SIDES[one.to_scene(outboard, "mm")[1] > 0]) for one in both]
        if said is None:
            told = "does not say where x, y and z point"
            if seen is None:
                raise self.refuse(told, f"--axes with {ALLOWED}")
            # A wheel of a known side shows it.
            known = self.choices.side or side
            some = [f"--axes {one} of a {wheel} wheel" for one, wheel in ways if known in ("", wheel)]
            raise self.refuse(told, f"{' or '.join(some)}, as {words} lie; or others, if they are so")
        if seen is None or said in both:
            return said, by, []
        told = f"has axes {said.words} by {by}, but {words} lie as in {seen.words}"
        if self.choices.axes is not None:
            return said, by, [f"{told}: are these the right axes and names?"]
        every = " or ".join(f"--axes {one} of a {wheel} wheel" for one, wheel in ways)
        raise self.refuse(told, f"{every} if that is so, --axes {said.option} if not")

    def axes_said(self, ours: Mapping[str, FilePoint]) -> tuple[Axes | None, str]:
        """The axes that somebody says, and who; points under our own names have our own axes."""
        if self.choices.axes is not None:
            return Axes.of(self.choices.axes), "--axes"
        if self.contents.axes:
            return Axes.of(self.contents.axes), "its titles"
        read = {name: point for name, point in ours.items() if name not in self.own.points}
        if self.format.our_own_names and all(self.is_our_own(*one) for one in read.items()):
            return OUR_AXES, "its points' names, which are ours"
        told_by = self.format.axes_told_by
        if not told_by:
            return self.format.axes, "its format"
        telling = [point for point in read.values() if re.fullmatch(told_by, plain(point.name))]
        return (self.format.axes, f"names such as {short(telling[0].name)}") if telling else (None, "")

    def seen(self, ours: Mapping[str, FilePoint]) -> tuple[Axes | None, Place, str]:
        """The axes in which a car's points lie as these, where outboard is, and what shows it.

        There are none where the mechanism does not say which points lie so.
        """

        def difference(one: str, other: str) -> Place:
            (a, b, c), (d, e, f) = ours[one].place, ours[other].place
            return a - d, b - e, c - f

        topology = self.topology
        outboard = difference(topology.wheel_centre, topology.inboard)
        if not (topology.front_and_rear and topology.steering_axis):
            return None, outboard, ""
        (front, rear), (low, high) = topology.front_and_rear, topology.steering_axis
        words = f"{front} seen from {rear} and {high} from {low}"
        return axes_seen(difference(front, rear), difference(high, low)), outboard, words

    def is_our_own(self, ours: str, point: FilePoint) -> bool:
        """Whether a point of the file has our own name as we write it, with or without a side and an axle."""
        base, _, ending = point.name.rpartition("_")
        return ours in (point.name, base if plain(ending) in WHEELS else "")

    def unit(self) -> str:
        said, chosen = self.contents.unit, self.choices.unit
        if said and said not in LENGTHS:
            raise self.refuse(f"has lengths in {short(said)}", ", ".join(LENGTHS))
        if said and chosen and said != chosen:
            raise self.refuse(f"says that its lengths are in {said}", f"--unit {said}, or none")
        return chosen or said or self.format.unit

    def turning(self, axes: Axes, axes_by: str, unit: str) -> str:
        """What becomes of axes and unit, and who said what they are."""
        unit_by = "the file" if self.contents.unit else "--unit" if self.choices.unit else "its format"
        return (
            f"the file's axes are {axes.words}, by {axes_by}, in {unit}, by {unit_by}; "
            "here x rearward, y right, z up, in mm"
        )

    def against_unit(self, unit: str, ours: Mapping[str, FilePoint]) -> list[str]:
        """Refuse a unit that makes no car where nobody said it; doubt one that somebody did."""
        places = [point.place for point in ours.values()]
        span = max(max(column) - min(column) for column in zip(*places, strict=True))
        if SMALLEST <= span * LENGTHS[unit] <= LARGEST:
            return []
        fitting = {
            other: span * size for other, size in LENGTHS.items() if SMALLEST <= span * size <= LARGEST
        }
        told = f"spans {float(span * LENGTHS[unit]):.4g} mm if its lengths are in {unit}"
        others = "; ".join(f"--unit {other} makes {float(size):.4g} mm" for other, size in fitting.items())
        if self.choices.unit is not None:
            return [f"the file {told}" + (f"; {others}" if others else "")]
        raise self.refuse(told, others or f"--unit {unit} if that is so")

    def side(self, label: str, turned: Mapping[str, Place], axes: Axes) -> str:
        """The wheel's side, from where it lies; it must be the one that the file or the user says."""
        wheel, inner = self.topology.wheel_centre, self.topology.inboard
        lies, out = turned[wheel][1], turned[wheel][1] - turned[inner][1]
        if not out:
            raise self.refuse(f"has {wheel} as far out as {inner}", "a wheel outboard of it; see --axes")
        seen = SIDES[out > 0]
        where = f"{wheel} lies {abs(out):.6g} mm to the {seen} of {inner}"
        for said, by in (
            (self.choices.side, "--side"),
            (label, "the file"),
            (self.format.side, "its format"),
        ):
            if said and said != seen:
                allowed = f"--axes with the other of left and right than {axes.option}, or the {seen} side"
                # Not where the file has the wheel that is asked for: a mirrored other one is another wheel.
                if by == "--side" and label != said:
                    made = f"--side {seen} --mirror makes the {said} wheel of it"
                    both = (f"--side is of the file's wheel: {made}", allowed)
                    allowed = "; or ".join(both if self.choices.mirror else (allowed, made))
                raise self.refuse(f"has a {said} wheel by {by}, but {where}", allowed)
        if (lies > 0) != (out > 0) and not (self.choices.side or label or self.format.side):
            raise self.refuse(
                f"has {where}, but {abs(lies):.6g} mm to the {SIDES[lies > 0]} of the middle of the car",
                f"--side {seen} if y is not counted from the middle, or other --axes",
            )
        return seen

    # The scene's points.

    def placed(
        self,
        ours: Mapping[str, FilePoint],
        turned: Mapping[str, Place],
        axis: SpinAxis | None,
        side: str,
    ) -> dict[str, ScenePoint]:
        """The scene's points in the order of its topology, with where each comes from."""
        topology, structure = self.topology, mechanism_file(self.kind).structures[AS_DRAWN]
        out = 1 if side == "right" else -1
        needed = {*topology.required_points, *topology.wheel_axis}
        found = {}
        for name in topology.points:
            if name in turned:
                line = f", line {ours[name].line}" if ours[name].line else ""
                found[name] = ScenePoint(name, turned[name], f"{ours[name].name}{line}")
            elif name in needed and (one := derived(name, structure, turned, out, axis)) is not None:
                found[name] = ScenePoint(name, *one, derived=True)
        return found

    def angles(
        self, axle: Axle, drawn: Mapping[str, float], ours: Mapping[str, FilePoint], unit: str
    ) -> tuple[AngleCheck, ...]:
        """The static angles that the file prints of this axle beside those of the drawing."""
        places = {name: point.place for name, point in ours.items()}
        return check_angles(self.format.angles, axle.angles, drawn, places, LENGTHS[unit], self.topology)
