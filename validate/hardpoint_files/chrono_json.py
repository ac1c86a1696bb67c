"""A suspension of Project Chrono, or a vehicle that names some: JSON, with comments as Chrono allows them.

A point is a key `Location ...` or `COM` of a part, with three numbers; here it is called `Part: Key`.
A vehicle names the files of its suspensions from Chrono's folder of data, and puts each suspension at a
place of its chassis (WheeledVehicle.cpp). What steers an axle is not read: here it is a straight rack.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal, DecimalException
from math import cos, radians, sin
from pathlib import Path
from typing import Any

from pointcoord.toml_text import read_file
from validate.hardpoint_files.contents import (
    Axle,
    Contents,
    FilePoint,
    Place,
    SpinAxis,
    number_of,
    place_of,
    short,
)
from validate.tables.errors import FileError

CAMBER, TOE = "Camber Angle (deg)", "Toe Angle (deg)"
FORM = "JSON of a Project Chrono suspension"
KINDS = "Type Suspension with a Template, or Type Vehicle with Template WheeledVehicle"
AXLES, SUSPENSION, PLACE = "Axles", "Suspension Input File", "Suspension Location"
STEERED = "the tie rod's inner end runs along a straight rack across the car, whatever steering the car has"
# A text in quotes, which is kept, or a comment.
_COMMENT = re.compile(r'"(?:\\.|[^"\\\n])*"|//[^\n]*|/\*[\s\S]*?\*/')


@dataclass(frozen=True)
class _Json:
    """A file, and what it holds."""

    source: str
    data: Mapping[str, Any]

    @classmethod
    def of(cls, text: str, source: str) -> _Json:
        """A file of such a text.

        Raises:
            FileError: it is no JSON, or no table.
        """
        # Comments leave the line breaks in them.
        clean = _COMMENT.sub(lambda f: f[0] if f[0][0] == '"' else "\n" * f[0].count("\n") + " ", text)
        try:
            data = json.loads(clean, parse_float=Decimal, parse_int=Decimal, parse_constant=Decimal)
        except (ValueError, RecursionError, DecimalException) as error:
            line = getattr(error, "lineno", 0)
            raise FileError(source, line, f"is no JSON: {getattr(error, 'msg', error)}", FORM) from None
        if not isinstance(data, dict):
            raise FileError(source, 1, f"is a {type(data).__name__}", FORM)
        return cls(source, data)

    @property
    def kind(self) -> str:
        """Its type and template, in words."""
        kind, template = (short(str(self.data.get(key))) for key in ("Type", "Template"))
        return f"is a file of Chrono's of Type {kind} and Template {template}"

    @property
    def is_suspension(self) -> bool:
        """Whether it is a suspension of some kind."""
        return self.data.get("Type") == "Suspension" and bool(self.data.get("Template"))

    def refuse(self, told: str, allowed: str) -> FileError:
        return FileError(self.source, 0, told, allowed)

    def named(self, name: object) -> _Json:
        """The suspension that it names, from the nearest folder above it that has a file of that name."""
        if not isinstance(name, str):
            raise self.refuse(f"has no {SUSPENSION} of an axle", "the name of a file")
        paths = (folder / name for folder in Path(self.source).absolute().parents)
        path = next((path for path in paths if path.is_file()), None)
        if path is None:
            told = f"names {short(name)}, which is in none of the folders above it"
            allowed = "a vehicle in Chrono's folder of data with the files that it names"
            raise self.refuse(told, f"{allowed}, or a suspension's own file")
        data = read_file(path, f"the path of a file that {self.source} names")
        found = _Json.of(data.decode("utf-8-sig", "replace"), str(path))
        if not found.is_suspension:
            raise found.refuse(f"{found.kind}, and {self.source} has it as a suspension", KINDS)
        return found

    def place(self, value: object, name: str) -> Place:
        """Three coordinates."""
        if not isinstance(value, list):
            raise self.refuse(f"{short(name)} has {short(str(value))}", "a list of three numbers")
        return place_of(value, self.source, 0, name)

    def angle(self, key: str) -> float:
        """An angle at a key, rad; 0 if it is not there."""
        value = number_of(self.data.get(key, 0), self.source, 0, key)
        if not abs(value) < 90:
            raise self.refuse(f"{key} is {value}", "an angle below 90 deg")
        return radians(float(value))


def read(text: str, source: str) -> Contents:
    """The points of a suspension, or of those that a vehicle names, and where their spin axes point.

    Raises:
        FileError: it is no JSON, no suspension and no vehicle, has a point that is none, or names a
            file that is not there.
        SceneError: a file that it names cannot be read.
    """
    file = _Json.of(text, source)
    if not file.is_suspension:
        return _vehicle(file)
    framed = "points are in the frame of the suspension, which the car's own file puts somewhere"
    points, axle = _suspension(file, framed)
    return Contents(tuple(points), {"": axle})


def _suspension(file: _Json, note: str) -> tuple[list[FilePoint], Axle]:
    """The points of a suspension, and its spin axis."""
    points = [
        FilePoint(f"{part}: {key}", file.place(value, f"{part}: {key}"))
        for part, keys in file.data.items()
        if isinstance(keys, dict)
        for key, value in keys.items()
        if key == "COM" or key.startswith("Location")
    ]
    camber, toe = (file.angle(key) for key in (CAMBER, TOE))
    # The left spindle's own y axis: R_z(-toe) R_x(-camber) e_y in Chrono's axes (ChDoubleWishbone.cpp).
    axis = (sin(toe) * cos(camber), cos(toe) * cos(camber), -sin(camber))
    taken = " and ".join(f"{key} {file.data.get(key, 'not given, which is 0')}" for key in (CAMBER, TOE))
    return points, Axle(str(file.data["Template"]), {}, SpinAxis(axis, taken), (note, STEERED))


def _vehicle(file: _Json) -> Contents:
    """The suspensions of a vehicle, each in the frame of its chassis, by axle."""
    axles = file.data.get(AXLES)
    if file.data.get("Type") != "Vehicle" or not isinstance(axles, list):
        raise file.refuse(file.kind, KINDS)
    if not axles or not all(isinstance(axle, dict) for axle in axles):
        raise file.refuse(f"has no {AXLES}", f"one with {SUSPENSION} each")
    places = [file.place(axle.get(PLACE), f"{PLACE} of axle {i}") for i, axle in enumerate(axles, 1)]
    points: list[FilePoint] = []
    read: dict[str, Axle] = {}
    for label, axle, place in zip(_labels(places), axles, places, strict=True):
        if place[1]:
            told = f"{PLACE} of its {label} axle has y {place[1]}, beside the middle of the car"
            raise file.refuse(told, "y 0")
        own = file.named(axle.get(SUSPENSION))
        into = f"moved by its {PLACE} {[float(n) for n in place]} m into the frame of the chassis"
        theirs, read[label] = _suspension(own, f"points are those of {own.source}, {into}")
        for point in theirs:
            x, y, z = (a + b for a, b in zip(point.place, place, strict=True))
            points.append(replace(point, part=label, place=(x, y, z)))
    return Contents(tuple(points), read)


def _labels(places: Sequence[Place]) -> list[str]:
    """Front and rear of two axles, by where they are; the numbers in the file of more; none of one."""
    if len(places) == 1:
        return [""]
    if len(places) == 2 and places[0][0] != places[1][0]:
        ahead = places[0][0] > places[1][0]
        return ["front", "rear"] if ahead else ["rear", "front"]
    return [str(number) for number, _ in enumerate(places, 1)]
