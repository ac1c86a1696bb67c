"""Identifies the points of one wheel in a file: its type of suspension, our names, its axle and its side."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

from pointcoord.errors import UnknownName
from pointcoord.mechanism import mechanism_file, shipped
from pointcoord.mechanism.file import AS_DRAWN
from pointcoord.mechanism.structure import Structure
from validate.hardpoint_files.contents import Contents, Point, plain, short
from validate.hardpoint_files.format import Format
from validate.hardpoint_files.names_file import NamesFile
from validate.tables.errors import FileError
from validate.tables.units import LENGTHS

SIDES = ("left", "right")
PARTS = ("front", "rear")


@dataclass(frozen=True)
class Choices:
    """The options of `pointcoord import`; those left out are read from the file, or the format's defaults.

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
class HardpointFile:
    """A file of hardpoints of one or several wheels, and what the user says about it."""

    source: str
    choices: Choices
    format: Format
    contents: Contents
    own: NamesFile

    def refuse(self, problem: str, allowed: str) -> FileError:
        return FileError(self.source, 0, problem, allowed)

    def named(self, kind: str) -> tuple[list[tuple[str, Point]], list[Point]]:
        """The points of a suspension with our names, and the other points of the file.

        A name may follow the heading above it. Names from the user have precedence over names of the format.
        """
        known, others = [*self.own.points.items()], list[Point]()
        known_as = self._names(kind)
        for point in self.contents.points:
            for name in (f"{point.section} {point.name}".strip(), point.name):
                if found := known_as.get(plain(name)):
                    our, (side, part) = found
                    point = replace(point, name=name, side=side or point.side, part=part or point.part)
                    known.append((our, point))
                    break
            else:
                others.append(point)
        return known, others

    def _names(self, kind: str) -> dict[str, tuple[str, tuple[str, str]]]:
        """Our name and the wheel, (side, axle), of each name that a point may have in the file, made plain.

        A name may have the wheel at its beginning or end.
        """
        given, every = self.own.names.keys() | self.own.points.keys(), self.format.names_of(kind)
        names = {plain(their): our for our, some in every.items() if our not in given for their in some}
        names |= {plain(their): our for our, their in self.own.names.items()}
        found: dict[str, tuple[str, tuple[str, str]]] = {}
        for words, wheel in {"": ("", ""), **self.format.wheels}.items():
            for their, our in names.items():
                found.setdefault(f"{words} {their}".strip(), (our, wheel))
                found.setdefault(f"{their} {words}".strip(), (our, wheel))
        return found

    def closest(self) -> list[str]:
        """The suspension types with the fewest missing points; among these, those with the most points."""
        fits: dict[str, tuple[int, int]] = {}
        for kind in (*self.format.suspensions, *self.format.called.values()):
            known = dict(self.named(kind)[0])
            fits[kind] = -len(missing(kind, known)), len(known)
        return [kind for kind, fit in fits.items() if fit == max(fits.values())]

    def kind(self) -> str:
        """Our type of suspension: from the user, from the file, or the type whose points the file has."""
        if self.choices.suspension:
            return self.choices.suspension
        called = self.contents.called
        part = self.one_of("part", "axle", self.choices.part, called)
        if name := called.get(part) or next(iter(called.values()), ""):
            for pattern, kind in self.format.called.items():
                if re.fullmatch(pattern, name, re.IGNORECASE):
                    return kind
            known = ", ".join(f"{theirs} ({ours})" for theirs, ours in self.format.called.items())
            allowed = f"{known}; if it is one of these under another name, give --suspension"
            raise self.refuse(f"has a suspension called {short(name)}", allowed)
        best = self.closest()
        if len(best) > 1:
            problem = f"could be a {' or a '.join(best)}"
            raise self.refuse(problem, f"--suspension {' or --suspension '.join(best)}")
        return best[0]

    def one_of(self, option: str, what: str, chosen: str | None, there: Iterable[str]) -> str:
        """The axle or side to import, of a file that may have several; `there` are those that it has."""
        labels, called = sorted({*there} - {""}), self.contents.called
        every = " or ".join(f"--{option} {label}" for label in labels)
        if chosen and labels and chosen not in labels:
            raise self.refuse(f"has no points of {what} {chosen}", every)
        if not chosen and len(labels) > 1:
            names = [f"{label} ({called[label]})" if label in called else label for label in labels]
            raise self.refuse(f"has points of more than one {what}: {', '.join(names)}", every)
        return chosen or "".join(labels)


@dataclass(frozen=True)
class Wheel:
    """The points of one wheel of a file.

    Attributes:
        kind: our type of its suspension.
        ours: recognised points, by our names. others: points and lines that are not recognised, in words.
        part, side: its axle and side according to the file; empty if the file does not say.
    """

    file: HardpointFile
    kind: str
    ours: Mapping[str, Point]
    others: tuple[str, ...]
    part: str
    side: str

    @property
    def structure(self) -> Structure:
        """The structure of its suspension."""
        return mechanism_file(self.kind).structures[AS_DRAWN]

    @classmethod
    def of(cls, file: HardpointFile) -> Wheel:
        """The wheel that the user asks for.

        Raises:
            FileError: the suspension is not known, the file has several wheels and the user names none, or a
                point is there twice.
            UnknownName: a name in the user's file of names is not in this file.
        """
        kind = file.kind()
        known, others = file.named(kind)
        for our, their in file.own.names.items():
            if our not in dict(known):
                every = dict.fromkeys(point.name for point in file.contents.points)
                raise UnknownName(f"point in {file.source}", their, every)
        part = file.one_of("part", "axle", file.choices.part, (point.part for _, point in known))
        known = [(our, point) for our, point in known if _fits(point.part, part)]
        sides = {point.side for _, point in known} - {""}
        side = file.one_of("side", "side", file.choices.side if len(sides) > 1 else None, sides)
        ours: dict[str, Point] = {}
        for our, point in ((our, point) for our, point in known if _fits(point.side, side)):
            if (other := ours.setdefault(our, point)).place != point.place:
                problem = f"has {our} twice: {other.source}, and {point.source}, at another position"
                allowed = "one of them; the points of one wheel of one axle, or a file of names (--names)"
                raise file.refuse(problem, allowed)
        left = (one.source for one in others if _fits(one.part, part) and _fits(one.side, side))
        return cls(file, kind, ours, (*left, *file.contents.others), part, side)


def missing(kind: str, known: Iterable[str]) -> list[str]:
    """The required points that are missing; points of the spin axis are required too, without defaults."""
    structure, there = mechanism_file(kind).structures[AS_DRAWN], {*known}
    needed = dict.fromkeys((*structure.required_points, *structure.role("wheel_axis")))
    return [name for name in needed if name not in there]


def _fits(stated: str, asked: str) -> bool:
    """Whether a point may belong to an axle or side; an empty label matches any."""
    return not stated or not asked or stated == asked
