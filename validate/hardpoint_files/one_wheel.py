"""One wheel of a file of hardpoints: which points are which of ours, and where they lie in the car."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from decimal import Decimal
from functools import cached_property
from math import radians, tan

import numpy as np
from numpy.typing import NDArray

from pointcoord.errors import UnknownName
from pointcoord.linkage.topology import Topology
from pointcoord.mechanism import mechanism_file, shipped
from pointcoord.mechanism.file import AS_DRAWN
from validate.hardpoint_files.axes import ALLOWED, DIRECTIONS, OUR_AXES, Axes
from validate.hardpoint_files.contents import Axle, Contents, FilePoint, Place, SpinAxis, plain, short
from validate.hardpoint_files.format import TABLE, Format
from validate.hardpoint_files.names_file import NamesFile
from validate.hardpoint_files.static_angles import AngleCheck, check_angles
from validate.hardpoint_files.written_scene import Drawing, ScenePoint
from validate.plain_text import some_of
from validate.tables.errors import FileError
from validate.tables.units import LENGTHS

Array = NDArray[np.float64]

SIDES = ("left", "right")
PARTS = ("front", "rear")
# mm: the points of one wheel's suspension, from model cars to lorries, span no less and no more.
SMALLEST, LARGEST = Decimal(150), Decimal(4000)
# mm from the wheel centre to the inner point of an axis that is known by its direction only.
INWARD = 100.0
# A coordinate of that point is rounded to 1e-12 mm, which is 1e-14 rad of the axis's direction.
DIGITS = Decimal("1e-12")
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

    @cached_property
    def places(self) -> dict[str, Place]:
        """Where its points are, in the file's axes and unit."""
        return {name: point.place for name, point in self.ours.items()}


@dataclass(frozen=True)
class OneWheel:
    """The wheel of a file that the user asks for.

    What the user says is taken, and the scene warns of what looks odd in it.
    """

    source: str
    choices: Choices
    format: Format
    contents: Contents
    own: NamesFile

    def refuse(self, problem: str, allowed: str, line: int = 0) -> FileError:
        return FileError(self.source, line, problem, allowed)

    def checked(self, drawn: Mapping[str, float]) -> Iterator[AngleCheck]:
        """The static angles that the file prints, held to those of the drawing, by our names, rad."""
        return check_angles(self.format.angles, self.axle.angles, self.chosen.places, self.topology, drawn)

    def drawing(self) -> Drawing:
        """The wheel's points in the order of its topology, and those that follow from them.

        Raises:
            FileError: the file does not say all that is needed, or its points speak against what it says.
            UnknownName: a name in the user's file is none of this file's. UsageError: `axes` are none.
        """
        if not (self.topology.wheel_axis and self.topology.role("inboard")):
            raise self.refuse(
                f"is read as {self.kind}, whose file names no wheel: the roles wheel_axis and inboard",
                "a suspension of one wheel; else a scene written by hand (pointcoord new)",
            )
        self.require_all()
        (axes, axes_by), (unit, unit_by) = self.axes, self.unit
        turned = {name: axes.to_scene(place, unit) for name, place in self.chosen.places.items()}
        side = self.side(turned)
        found = {n: ScenePoint(n, at, self.chosen.ours[n].source) for n, at in turned.items()}
        found |= self.following(turned, 1 if side == "right" else -1)
        points = [found[name] for name in self.topology.points if name in found]
        facts = [
            f"the file's axes are {axes.words}, by {axes_by}, in {unit}, by {unit_by}; "
            "here x rearward, y right, z up, in mm",
            *([] if axes.right_handed else ["these axes are left-handed: is one of them turned round?"]),
            *self.axle.notes,
            *([self.format.notes[self.kind]] if self.kind in self.format.notes else []),
            *([f"lines without a point: {self.lines}"] if self.lines else []),
        ]
        if self.choices.mirror:
            facts.append(f"the file's wheel is a {side} one; here it is mirrored in the middle of the car")
            side = SIDES[side == "left"]
            points = [point.mirrored for point in points]
        facts += [
            f"{name} is not in the file: {other} stands in for it"
            for name, other in self.topology.stand_ins.items()
            if name not in found
        ]
        return Drawing(self.source, self.kind, side, tuple(points), tuple(facts), self.chosen.others)

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

    @cached_property
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
        fits = {kind: (-len(missing(kind, there)), len(there)) for kind, there in known.items()}
        return [kind for kind, fit in fits.items() if fit == max(fits.values())]

    def named(self, kind: str) -> tuple[list[tuple[str, FilePoint]], list[FilePoint]]:
        """The points that are ours, by our names and with the wheels of theirs, and the file's others.

        What the user says goes before what the format says, of a point of ours and of a name of the file.
        """
        known, others = [*self.own.points.items()], []
        taken = self.own.names.keys() | self.own.points.keys()
        every = {our: names for our, names in self.format.names_of(kind).items() if our not in taken}
        ours = {plain(their): our for our, names in every.items() for their in names}
        ours |= {plain(their): our for our, their in self.own.names.items()}
        for point in self.contents.points:
            found = self.format.ours(point.name, ours)
            if point.section and (whole := self.format.ours(f"{point.section} {point.name}", ours)):
                found, point = whole, replace(point, name=f"{point.section} {point.name}")
            if found is None:
                others.append(point)
            else:
                our, (side, part) = found
                known.append((our, replace(point, side=side or point.side, part=part or point.part)))
        return known, others

    @cached_property
    def chosen(self) -> _Wheel:
        """The wheel that is asked for."""
        known, others = self.named(self.kind)
        theirs = {plain(point.name) for _, point in known}
        for their in self.own.names.values():
            if plain(their) not in theirs:
                every = dict.fromkeys(point.name for point in self.contents.points)
                raise UnknownName(f"point in {self.source}", their, every)
        parts = {point.part for _, point in known}
        part = self.one_of("part", "axle", self.choices.part, parts)
        # A file that does not say its axle is of the one that is said.
        part = part if part in parts else ""
        known = [(ours, point) for ours, point in known if point.of(part, "")]
        sides = {point.side for _, point in known} - {""}
        side = self.one_of("side", "side", self.choices.side if len(sides) > 1 else None, sides)
        found: dict[str, FilePoint] = {}
        for ours, point in known:
            other = found.setdefault(ours, point) if point.of(part, side) else point
            if other.place != point.place:
                told = f"has {ours} twice, {other.told} and {short(point.name)} elsewhere"
                allowed = "one of them; the points of one wheel of one axle, or a file of names (--names)"
                raise self.refuse(told, allowed, point.line)
        # Of a table all is told that is none of ours; a file by axles has much of the other ones.
        if self.contents.axles:
            others = [point for point in others if point.of(part, side)]
        return _Wheel(found, tuple(others), part, side)

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

    @property
    def axle(self) -> Axle:
        """What the file says of the wheel's axle."""
        return self.contents.axle(self.chosen.part)

    @cached_property
    def spin_axis(self) -> SpinAxis | None:
        """Where the file or the user says that the wheel's spin axis points."""
        camber, toe, said = self.choices.camber, self.choices.toe, self.axle.spin_axis
        if camber is None and toe is None:
            return said
        inner = self.topology.wheel_axis[0]
        if said is not None or inner in self.chosen.places:
            by = f" by {inner}" if said is None else ""
            raise self.refuse(f"says where its spin axis points{by}", "neither --camber nor --toe")
        if camber is None or toe is None or not max(abs(camber), abs(toe)) < 45.0:
            allowed = "both --camber and --toe, each of less than 45 deg, or neither"
            raise self.refuse(f"has --camber {camber} and --toe {toe} said of it", allowed)
        # Projected angles: tan(toe) = forward / outboard, tan(camber) = -up / outboard.
        direction = (tan(radians(toe)), 1.0, -tan(radians(camber)))
        return SpinAxis(direction, f"--camber {camber:g} and --toe {toe:g}, deg")

    def following(self, places: Mapping[str, Place], out: int) -> dict[str, ScenePoint]:
        """Points that the file lacks and that follow from what it has.

        Args:
            places: of the points that there are, x rearward, y right, z up, mm.
            out: 1 if outboard is to the right, -1 if it is to the left.
        """
        lost, axis, found = missing(self.kind, places), self.spin_axis, dict[str, ScenePoint]()
        inner, centre = self.topology.wheel_axis
        if inner in lost and axis is not None and centre in places:
            how = f"from {centre}: {INWARD:g} mm inboard on the spin axis, from {axis.words}"
            found[inner] = ScenePoint(inner, _inboard(places[centre], out, axis), how)
        for slide in mechanism_file(self.kind).structures[AS_DRAWN].slides.values():
            # One of two points of a body that slide on a line through the other may be anywhere on that line.
            ends = slide.along, slide.through
            if slide.along in slide.points and places.keys() >= {*ends}:
                x, y, z = ((a + b) / 2 for a, b in zip(*(places[end] for end in ends), strict=True))
                how = f"from {' and '.join(ends)}: halfway, for the file does not say where on this axis"
                how += ": nothing else hangs on it"
                found |= {one: ScenePoint(one, (x, y, z), how) for one in slide.points if one in lost}
        return found

    def require_all(self) -> None:
        """Refuse a file without a point that is needed and does not follow from others."""
        # That a point follows does not hang on axes, unit and side.
        there, names = self.chosen.places, self.format.names_of(self.kind)
        lost = missing(self.kind, {**there, **self.following(there, 1)})
        if not lost:
            return
        looked = (f"{n} (looked for: {', '.join(map(short, names[n]))})" if n in names else n for n in lost)
        told = f"lacks {', '.join(looked)} of a {self.kind}"
        if others := [point.told for point in self.chosen.others]:
            told += f"; not known in it: {some_of(others, NAMED)}"
        told += f"; without three numbers: {self.lines}" if self.lines else ""
        advice = f'a file of names (--names; a new one is written) with {lost[0]} = "its name"'
        advice += f" or {lost[0]} = [x, y, z]"
        if self.topology.wheel_axis[0] in lost:
            advice += "; for the spin axis --camber and --toe will do, + leaning out at the top and + toe in"
        raise self.refuse(told, advice)

    # Axes, unit and side, and what speaks against them.

    @cached_property
    def axes(self) -> tuple[Axes, str]:
        """The axes, and who says them; refused where the car's points speak against them.

        Which way is left no point shows: it decides which wheel this is.
        """
        if self.choices.axes is not None:
            return Axes.of(self.choices.axes), "--axes"
        lie = " and ".join(words for words, *_ in self.ways())
        if (said := self.said_axes()) is None:
            allowed = f"--axes with {ALLOWED}{f', where {lie}' if lie else ''}"
            raise self.refuse("does not say where x, y and z point", allowed)
        axes, by = said
        if any((axes.matrix @ along != DIRECTIONS[way]).any() for _, along, way in self.ways()):
            told = f"has axes {axes.words} by {by}, but {lie}"
            raise self.refuse(told, f"--axes of the file, or --axes {axes.option} if that is so")
        return axes, by

    def said_axes(self) -> tuple[Axes, str] | None:
        """The axes that names or the format say; points of a table under our own names have our own axes."""
        read = {ours: point.name for ours, point in self.chosen.ours.items() if ours not in self.own.points}
        if self.format.form == TABLE and all(ours in theirs for ours, theirs in read.items()):
            return OUR_AXES, "its points' names, which are ours"
        for pattern, axes in self.format.axes.items():
            telling = [name for name in read.values() if re.fullmatch(pattern or ".*", plain(name))]
            if telling:
                return axes, f"names such as {short(telling[0])}" if pattern else "its format"
        return None

    def ways(self) -> Iterator[tuple[str, Array, str]]:
        """How a point lies in the file that lies ahead of or above another one by what they are.

        In words, along which axis of the file, (3,), and which way that is in the car. The mechanism need not
        say which of its points these are.
        """
        topology, places = self.topology, self.chosen.places
        for way, ends in (
            ("forward", topology.role("front_and_rear")),
            ("up", topology.role("steering_axis")[::-1]),
        ):
            if ends:
                one, other = ends
                apart = [a - b for a, b in zip(places[one], places[other], strict=True)]
                most = max(range(3), key=lambda axis: abs(apart[axis]))
                sign = "-+"[apart[most] > 0]
                along = float(f"{sign}1") * np.eye(3)[most]
                yield f"{one} lies along {sign}{'xyz'[most]} from {other}", along, way

    @cached_property
    def unit(self) -> tuple[str, str]:
        """The unit of lengths, and who says it; refused where the points make no car in it."""
        said, chosen = self.contents.unit, self.choices.unit
        if said and said not in LENGTHS:
            raise self.refuse(f"has lengths in {short(said)}", ", ".join(LENGTHS))
        if said and chosen and said != chosen:
            raise self.refuse(f"says that its lengths are in {said}", f"--unit {said}, or none")
        by = {"the file": said, "--unit": chosen, "its format": self.format.unit}
        unit, who = next((unit, who) for who, unit in by.items() if unit)
        columns = zip(*self.chosen.places.values(), strict=True)
        span = max(max(column) - min(column) for column in columns)
        fitting = {name: span * size for name, size in LENGTHS.items() if SMALLEST <= span * size <= LARGEST}
        if unit not in fitting and chosen is None:
            told = f"spans {float(span * LENGTHS[unit]):.4g} mm if its lengths are in {unit}"
            others = (f"--unit {other} makes {float(size):.4g} mm" for other, size in fitting.items())
            raise self.refuse(told, "; ".join(others) or f"--unit {unit} if that is so")
        return unit, who

    def side(self, turned: Mapping[str, Place]) -> str:
        """The wheel's side, from where it lies; it must be the one that the file or the user says."""
        wheel, (inner,) = self.topology.wheel_centre, self.topology.role("inboard")
        lies, out = turned[wheel][1], turned[wheel][1] - turned[inner][1]
        if not out:
            raise self.refuse(f"has {wheel} as far out as {inner}", "a wheel outboard of it; see --axes")
        seen = SIDES[out > 0]
        where = f"{wheel} lies {abs(out):.6g} mm to the {seen} of {inner}"
        by_whom = {"--side": self.choices.side, "the file": self.chosen.side}
        for by, said in by_whom.items():
            if said and said != seen:
                axes = self.axes[0].option
                allowed = f"--axes with the other of left and right than {axes}, or the {seen} side"
                # Not where the file has the wheel that is asked for: a mirrored other one is another wheel.
                if by == "--side" and self.chosen.side != said:
                    allowed += f"; or --side {seen} --mirror makes the {said} wheel of it"
                raise self.refuse(f"has a {said} wheel by {by}, but {where}", allowed)
        if (lies > 0) != (out > 0) and not any(by_whom.values()):
            told = f"has {where}, but {abs(lies):.6g} mm to the {SIDES[lies > 0]} of the middle of the car"
            raise self.refuse(told, f"--side {seen} if y is not counted from the middle, or other --axes")
        return seen


def missing(kind: str, known: Iterable[str]) -> list[str]:
    """Points that a car of ours must have; its spin axis is not left to what may stand in for it."""
    topology, there = mechanism_file(kind).topology(), {*known}
    needed = dict.fromkeys((*topology.required_points, *topology.wheel_axis))
    return [name for name in needed if name not in there]


def _inboard(centre: Place, out: int, axis: SpinAxis) -> Place:
    """The point on the spin axis; only its direction counts, its place on the axis changes no angle."""
    forward, outboard, up = axis.direction
    step = INWARD / sum(part * part for part in axis.direction) ** 0.5
    steps = (Decimal(step * part).quantize(DIGITS) for part in (forward, -out * outboard, -up))
    x, y, z = (at + step for at, step in zip(centre, steps, strict=True))
    return x, y, z
