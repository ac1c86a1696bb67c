"""One wheel of a file of hardpoints: identifies its points, and converts them to the axes of the scene.

Static angles printed in the file are compared with those of the imported drawing: a misread name, a wrong
side or a reversed axis shows as a difference.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from decimal import Decimal
from functools import cached_property
from math import degrees, dist, radians, tan

import numpy as np

from pointcoord.errors import UnknownName
from pointcoord.mechanism import mechanism_file, shipped
from pointcoord.mechanism.file import AS_DRAWN
from pointcoord.mechanism.structure import Structure
from validate.arrays import Array
from validate.hardpoint_files.contents import (
    ALLOWED,
    DIRECTIONS,
    OUR_AXES,
    Axes,
    Axle,
    Contents,
    FilePoint,
    Place,
    SpinAxis,
    plain,
    short,
)
from validate.hardpoint_files.format import TABLE, Format
from validate.hardpoint_files.names_file import NamesFile
from validate.hardpoint_files.written_scene import Drawing, ScenePoint
from validate.plain_text import some_of
from validate.tables.errors import FileError
from validate.tables.units import LENGTHS

SIDES = ("left", "right")
PARTS = ("front", "rear")
# Limits of the extent of one wheel's suspension, from model cars to lorries, mm.
SMALLEST, LARGEST = Decimal(150), Decimal(4000)
# Distance from the wheel centre of the inner point of a spin axis that is given by its direction, mm.
INWARD = 100.0
# A coordinate of this point is rounded to 1e-12 mm, which changes the direction of the axis by 1e-14 rad.
DIGITS = Decimal("1e-12")
# Largest number of points or lines named in a message.
NAMED = 12


@dataclass(frozen=True)
class Choices:
    """Choices of the user about a file; choices left out are read from the file or are the format's defaults.

    Attributes:
        format: name of the format.
        suspension: our type of suspension.
        side: the wheel to import, left or right.
        part: the axle to import, front or rear or a number, if the file has several.
        names: path of a file of names (see `names_file`).
        axes: directions of x, y and z, such as "forward,left,up".
        unit: unit of lengths.
        camber, toe: static angles, if the file does not give the spin axis; deg, projected, + leaning out at
            the top and + toe in.
        mirror: whether to mirror the wheel to the other side.
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
class AngleCheck:
    """An angle that the file prints and the imported drawing has, deg.

    Attributes:
        name: our name of the angle.
        words, line: its name in the file, and the line.
        printed, drawn: the value in the file, and that of the drawing.
        tolerance: from the printed digits of the angle and of the points.
    """

    name: str
    words: str
    line: int
    printed: float
    drawn: float
    tolerance: float

    @property
    def verdict(self) -> str:
        """`agrees` or `disagrees`."""
        return "agrees" if abs(self.printed - self.drawn) <= self.tolerance else "disagrees"


@dataclass(frozen=True)
class _Wheel:
    """The points of one wheel.

    Attributes:
        ours: recognised points, by our names. others: the other points of the file.
        part, side: its axle and side according to the file; empty if the file does not say.
    """

    ours: Mapping[str, FilePoint]
    others: tuple[FilePoint, ...]
    part: str
    side: str

    @cached_property
    def places(self) -> dict[str, Place]:
        """The positions of its points, in the file's axes and unit."""
        return {name: point.place for name, point in self.ours.items()}


@dataclass(frozen=True)
class OneWheel:
    """The wheel of a file that the user asks for.

    Choices of the user are used even if they look wrong; the scene then gives warnings.
    """

    source: str
    choices: Choices
    format: Format
    contents: Contents
    own: NamesFile

    def refuse(self, problem: str, allowed: str, line: int = 0) -> FileError:
        return FileError(self.source, line, problem, allowed)

    def checked(self, drawn: Mapping[str, float]) -> Iterator[AngleCheck]:
        """Compare the static angles printed in the file with those of the drawing.

        The digits of the points limit the accuracy of an axis. Half a digit h in both coordinates of both
        ends moves them apart by 2 sqrt(2) h in the plane of an angle. An axis of length L within 45 deg of
        this plane has a projected length of at least L / sqrt(2). So the angle changes by at most 4 h / L.

        Args:
            drawn: angles of the drawing by our names, rad.
        """
        places, left_open = self.chosen.places, 0.0
        for ends in map(self.structure.role, ("wheel_axis", "steering_axis")):
            if ends and {*ends} <= places.keys():
                one, other = (places[name] for name in ends)
                half, length = max(map(_half_a_digit, (*one, *other))), dist(one, other)
                left_open = max(left_open, 4.0 * half / length if length else 0.0)
        for name, pattern in self.format.angles.items():
            for words, (value, line) in self.axle.angles.items():
                if name in drawn and re.match(pattern, words):
                    off = _half_a_digit(value) + degrees(left_open)
                    yield AngleCheck(name, words, line, float(value), degrees(drawn[name]), off)

    def drawing(self) -> Drawing:
        """The wheel's points in the order of its mechanism, and points that follow from them.

        Raises:
            FileError: the file lacks something that is needed, or its points contradict it.
            UnknownName: a name in the user's file of names is not in this file.
            UsageError: `axes` are not valid.
        """
        if not (self.structure.role("wheel_axis") and self.structure.role("inboard")):
            raise self.refuse(
                f"is read as {self.kind}, whose mechanism file lacks the roles wheel_axis and inboard",
                "a suspension of one wheel; for others write a scene (pointcoord new)",
            )
        self.require_all()
        (axes, axes_by), (unit, unit_by) = self.axes, self.unit
        turned = {name: axes.to_scene(place, unit) for name, place in self.chosen.places.items()}
        side = self.side(turned)
        found = {n: ScenePoint(n, at, self.chosen.ours[n].source) for n, at in turned.items()}
        found |= self.following(turned, 1 if side == "right" else -1)
        points = [found[name] for name in self.structure.points if name in found]
        lines = some_of(self.contents.lines, NAMED)
        facts = [
            f"the file's axes are {axes.words}, by {axes_by}, in {unit}, by {unit_by}; "
            "here x rearward, y right, z up, in mm",
            *([] if axes.right_handed else ["these axes are left-handed: is one of them reversed?"]),
            *self.axle.notes,
            *([self.format.notes[self.kind]] if self.kind in self.format.notes else []),
            *([f"lines without a point: {lines}"] if lines else []),
        ]
        if self.choices.mirror:
            facts.append(f"the file has the {side} wheel; here it is mirrored to the other side of the car")
            side = SIDES[side == "left"]
            points = [replace(one, place=(one.place[0], -one.place[1] + 0, one.place[2])) for one in points]
        facts += [
            f"{name} is not in the file: {other} is used instead"
            for name, other in self.structure.stand_ins.items()
            if name not in found
        ]
        return Drawing(self.source, self.kind, side, tuple(points), tuple(facts), self.chosen.others)

    # The suspension type, and the identification of points.

    @cached_property
    def kind(self) -> str:
        """Our type of suspension: from the user, from the file, or the type whose points the file has."""
        if self.choices.suspension:
            return self.choices.suspension
        if called := self.called:
            part = self.one_of("part", "axle", self.choices.part, {*called})
            name = called.get(part) or next(iter(called.values()))
            for pattern, kind in self.format.called.items():
                if re.fullmatch(pattern, name, re.IGNORECASE):
                    return kind
            known = ", ".join(f"{theirs} ({ours})" for theirs, ours in self.format.called.items())
            at = f" at its axle {part}" if part else ""
            allowed = f"{known}; if it is one of these under another name, give --suspension"
            raise self.refuse(f"has a suspension called {short(name)}{at}", allowed)
        best = self.closest()
        if len(best) > 1:
            problem = f"could be a {' or a '.join(best)}"
            raise self.refuse(problem, f"--suspension {' or --suspension '.join(best)}")
        return best[0]

    @cached_property
    def structure(self) -> Structure:
        """The structure of our type of suspension."""
        return mechanism_file(self.kind).structures[AS_DRAWN]

    @property
    def called(self) -> dict[str, str]:
        """The file's names of its suspensions, by part."""
        return {part: axle.called for part, axle in self.contents.axles.items() if axle.called}

    def closest(self) -> list[str]:
        """The suspension types with the fewest missing points; among these, those with the most points."""
        known = {kind: dict(self.named(kind)[0]) for kind in self.format.suspensions}
        fits = {kind: (-len(missing(kind, there)), len(there)) for kind, there in known.items()}
        return [kind for kind, fit in fits.items() if fit == max(fits.values())]

    def named(self, kind: str) -> tuple[list[tuple[str, FilePoint]], list[FilePoint]]:
        """The recognised points with our names and their wheels, and the other points of the file.

        Names from the user have precedence over names of the format.
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
        # If the file does not give axles, it is taken to be the requested one.
        part = part if part in parts else ""
        known = [(ours, point) for ours, point in known if point.of(part, "")]
        sides = {point.side for _, point in known} - {""}
        side = self.one_of("side", "side", self.choices.side if len(sides) > 1 else None, sides)
        found: dict[str, FilePoint] = {}
        for ours, point in known:
            other = found.setdefault(ours, point) if point.of(part, side) else point
            if other.place != point.place:
                problem = f"has {ours} twice, {other.told} and {short(point.name)} at another position"
                allowed = "one of them; the points of one wheel of one axle, or a file of names (--names)"
                raise self.refuse(problem, allowed, point.line)
        # All unrecognised points of a table are listed; of a file by axles only those of this wheel.
        if self.contents.axles:
            others = [point for point in others if point.of(part, side)]
        return _Wheel(found, tuple(others), part, side)

    def one_of(self, option: str, what: str, chosen: str | None, there: set[str]) -> str:
        """The part or side to import, of a file that may have several."""
        labels = sorted(there - {""})
        every = " or ".join(f"--{option} {label}" for label in labels)
        if chosen and labels and chosen not in labels:
            raise self.refuse(f"has no points of {what} {chosen}", every)
        if not chosen and len(labels) > 1:
            called = self.called
            names = [f"{label} ({called[label]})" if label in called else label for label in labels]
            raise self.refuse(f"has points of more than one {what}: {', '.join(names)}", every)
        return chosen or (labels[0] if labels else "")

    # Missing points.

    @property
    def axle(self) -> Axle:
        """The file's data of the wheel's axle, or else of the whole file."""
        axles = self.contents.axles
        return axles.get(self.chosen.part) or axles.get("", Axle())

    @cached_property
    def spin_axis(self) -> SpinAxis | None:
        """The direction of the wheel's spin axis from the file, or from --camber and --toe."""
        camber, toe, given = self.choices.camber, self.choices.toe, self.axle.spin_axis
        if camber is None and toe is None:
            return given
        inner = self.structure.role("wheel_axis")[0]
        if given is not None or inner in self.chosen.places:
            by = f" by {inner}" if given is None else ""
            raise self.refuse(f"gives the direction of its spin axis{by}", "neither --camber nor --toe")
        if camber is None or toe is None or not max(abs(camber), abs(toe)) < 45.0:
            allowed = "both --camber and --toe, each of less than 45 deg, or neither"
            raise self.refuse(f"is given --camber {camber} and --toe {toe}", allowed)
        # Projected angles: tan(toe) = forward / outboard, tan(camber) = -up / outboard.
        direction = (tan(radians(toe)), 1.0, -tan(radians(camber)))
        return SpinAxis(direction, f"--camber {camber:g} and --toe {toe:g}, deg")

    def following(self, places: Mapping[str, Place], out: int) -> dict[str, ScenePoint]:
        """Points that the file lacks and that follow from its points.

        Args:
            places: positions of the file's points, x rearward, y right, z up, mm.
            out: 1 if outboard is to the right, -1 if it is to the left.
        """
        lost, axis, found = missing(self.kind, places), self.spin_axis, dict[str, ScenePoint]()
        inner, centre = self.structure.role("wheel_axis")
        if inner in lost and axis is not None and centre in places:
            how = f"from {centre}: {INWARD:g} mm inboard on the spin axis, from {axis.words}"
            found[inner] = ScenePoint(inner, _inboard(places[centre], out, axis), how)
        for slide in mechanism_file(self.kind).structures[AS_DRAWN].slides.values():
            # A sliding point that only defines the line together with another point may be anywhere on it.
            ends = slide.along, slide.through
            if slide.along in slide.points and places.keys() >= {*ends}:
                x, y, z = ((a + b) / 2 for a, b in zip(*(places[end] for end in ends), strict=True))
                how = (
                    f"from {' and '.join(ends)}: halfway between them; the file does not give its position on"
                    " this axis, and nothing else depends on it"
                )
                found |= {one: ScenePoint(one, (x, y, z), how) for one in slide.points if one in lost}
        return found

    def require_all(self) -> None:
        """Refuse a file that lacks a point that is needed and does not follow from others."""
        # Whether a point follows does not depend on axes, unit and side, so these are not applied yet.
        there, names = self.chosen.places, self.format.names_of(self.kind)
        lost = missing(self.kind, {**there, **self.following(there, 1)})
        if not lost:
            return
        looked = (f"{n} (looked for: {', '.join(map(short, names[n]))})" if n in names else n for n in lost)
        problem = f"lacks {', '.join(looked)} of a {self.kind}"
        if others := [point.told for point in self.chosen.others]:
            problem += f"; not recognised: {some_of(others, NAMED)}"
        if lines := some_of(self.contents.lines, NAMED):
            problem += f"; without three numbers: {lines}"
        advice = f'a file of names (--names; a new one is written) with {lost[0]} = "its name"'
        advice += f" or {lost[0]} = [x, y, z]"
        if self.structure.role("wheel_axis")[0] in lost:
            advice += (
                "; for the spin axis you may give --camber and --toe, + leaning out at the top and + toe in"
            )
        raise self.refuse(problem, advice)

    # Axes, unit and side, and checks of them.

    @cached_property
    def axes(self) -> tuple[Axes, str]:
        """The axes and their source: the user, the names of points or the format.

        Refused if the points contradict them, unless the user gives them. No point shows the direction to the
        left, which determines the wheel's side.
        """
        if self.choices.axes is not None:
            return Axes.of(self.choices.axes), "--axes"
        read = {ours: point.name for ours, point in self.chosen.ours.items() if ours not in self.own.points}
        found: list[tuple[Axes, str]] = []
        if self.format.name == TABLE and all(ours in theirs for ours, theirs in read.items()):
            found.append((OUR_AXES, "its points' names, which are ours"))
        for pattern, axes in self.format.axes.items():
            telling = [name for name in read.values() if re.fullmatch(pattern or ".*", plain(name))]
            if telling:
                found.append((axes, f"names such as {short(telling[0])}" if pattern else "its format"))
        lie = " and ".join(words for words, *_ in self.ways())
        if not found:
            allowed = f"--axes with {ALLOWED}{f', where {lie}' if lie else ''}"
            raise self.refuse("does not give the directions of x, y and z", allowed)
        axes, by = found[0]
        if any((axes.matrix @ along != DIRECTIONS[way]).any() for _, along, way in self.ways()):
            allowed = f"--axes with the right directions, or --axes {axes.option} if they are right"
            raise self.refuse(f"has axes {axes.words} by {by}, but {lie}", allowed)
        return axes, by

    def ways(self) -> Iterator[tuple[str, Array, str]]:
        """The directions in the file of pairs of points whose direction in the car is known from their roles.

        Yields the direction in words, as a vector in the file's axes, (3,), and its direction in the car. If
        the mechanism does not have these roles, nothing is yielded.
        """
        structure, places = self.structure, self.chosen.places
        for way, ends in (
            ("forward", structure.role("front_and_rear")),
            ("up", structure.role("steering_axis")[::-1]),
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
        """The unit of lengths and its source; refused if the points do not have the size of a car in it."""
        given, chosen = self.contents.unit, self.choices.unit
        if given and given not in LENGTHS:
            raise self.refuse(f"has lengths in {short(given)}", ", ".join(LENGTHS))
        if given and chosen and given != chosen:
            raise self.refuse(f"states that its lengths are in {given}", f"--unit {given}, or no --unit")
        by = {"the file": given, "--unit": chosen, "its format": self.format.unit}
        unit, who = next((unit, who) for who, unit in by.items() if unit)
        columns = zip(*self.chosen.places.values(), strict=True)
        span = max(max(column) - min(column) for column in columns)
        fitting = {name: span * size for name, size in LENGTHS.items() if SMALLEST <= span * size <= LARGEST}
        if unit not in fitting and chosen is None:
            problem = f"spans {float(span * LENGTHS[unit]):.4g} mm if its lengths are in {unit}"
            others = (f"--unit {other} makes {float(size):.4g} mm" for other, size in fitting.items())
            raise self.refuse(problem, "; ".join(others) or f"--unit {unit} if this is right")
        return unit, who

    def side(self, turned: Mapping[str, Place]) -> str:
        """The wheel's side, from its position; it must be the side that the file or the user gives."""
        wheel, (inner,) = self.structure.role("wheel_axis")[1], self.structure.role("inboard")
        lies, out = turned[wheel][1], turned[wheel][1] - turned[inner][1]
        if not out:
            raise self.refuse(f"has {wheel} as far out as {inner}", "a wheel outboard of it; see --axes")
        seen = SIDES[out > 0]
        where = f"{wheel} lies {abs(out):.6g} mm to the {seen} of {inner}"
        by_whom = {"--side": self.choices.side, "the file": self.chosen.side}
        for by, said in by_whom.items():
            if said and said != seen:
                axes = self.axes[0].option
                allowed = f"--axes with left and right exchanged in {axes}, or the {seen} side"
                # Not offered if the file has the requested wheel: the other wheel, mirrored, may differ.
                if by == "--side" and self.chosen.side != said:
                    allowed += f"; or --side {seen} --mirror makes the {said} wheel of it"
                raise self.refuse(f"has a {said} wheel by {by}, but {where}", allowed)
        if (lies > 0) != (out > 0) and not any(by_whom.values()):
            problem = f"has {where}, but {abs(lies):.6g} mm to the {SIDES[lies > 0]} of the middle of the car"
            raise self.refuse(problem, f"--side {seen} if y is not counted from the middle, or other --axes")
        return seen


def missing(kind: str, known: Iterable[str]) -> list[str]:
    """The required points that are missing; points of the spin axis are required too, without defaults."""
    structure, there = mechanism_file(kind).structures[AS_DRAWN], {*known}
    needed = dict.fromkeys((*structure.required_points, *structure.role("wheel_axis")))
    return [name for name in needed if name not in there]


def _inboard(centre: Place, out: int, axis: SpinAxis) -> Place:
    """A point inboard on the spin axis; its distance from the centre does not affect any angle."""
    forward, outboard, up = axis.direction
    step = INWARD / sum(part * part for part in axis.direction) ** 0.5
    steps = (Decimal(step * part).quantize(DIGITS) for part in (forward, -out * outboard, -up))
    x, y, z = (at + step for at, step in zip(centre, steps, strict=True))
    return x, y, z


def _half_a_digit(number: Decimal) -> float:
    return 0.5 * 10.0 ** int(number.as_tuple().exponent)
