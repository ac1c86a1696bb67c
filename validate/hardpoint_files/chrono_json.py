"""Reads a suspension of Project Chrono, or a vehicle that names suspensions: JSON with comments.

A point is a key `Location ...` or `COM` of a part, with three numbers; its name here is `Part: Key`. Points
belong to the left wheel, whatever the sign of y. A vehicle names the files of its suspensions relative to
Chrono's data folder, and the position of each suspension on the chassis (WheeledVehicle.cpp). Its steering is
not read: the scene has a straight rack.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
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
STEERED = "the steering is not read: the tie rod's inner end moves along a straight rack across the car"
# A string, which is kept, or a comment.
_COMMENT = re.compile(r'"(?:\\.|[^"\\\n])*"|//[^\n]*|/\*[\s\S]*?\*/')


def read(text: str, source: str) -> Contents:
    """The points and spin axes of a suspension, or of the suspensions that a vehicle names.

    Raises:
        FileError: the file is not JSON, is neither a suspension nor a vehicle, has an invalid point, or names
            a file that does not exist.
        SceneError: a file that it names cannot be read.
    """
    data = _table(text, source)
    if _is_suspension(data):
        framed = "points are in the frame of the suspension; the vehicle's file, which is not read, places it"
        points, axle = _suspension(data, source, framed)
        return Contents(tuple(points), {"": axle})
    if data.get("Type") == "Vehicle" and isinstance(data.get(AXLES), list):
        return _vehicle(data[AXLES], source)
    raise FileError(source, 0, _kind(data), KINDS)


def _table(text: str, source: str) -> Mapping[str, Any]:
    """The JSON object of a text; numbers keep their digits.

    Raises:
        FileError: the text is not a JSON object.
    """
    # The line breaks of comments are kept, so that line numbers stay right.
    clean = _COMMENT.sub(lambda f: f[0] if f[0][0] == '"' else "\n" * f[0].count("\n") + " ", text)
    try:
        data = json.loads(clean, parse_float=Decimal, parse_int=Decimal, parse_constant=Decimal)
    except (ValueError, RecursionError, DecimalException) as error:
        line = getattr(error, "lineno", 0)
        raise FileError(source, line, f"is not JSON: {getattr(error, 'msg', error)}", FORM) from None
    if not isinstance(data, dict):
        raise FileError(source, 1, f"is of type {type(data).__name__}", FORM)
    return data


def _kind(data: Mapping[str, Any]) -> str:
    """The type and template of a file, in words."""
    kind, template = (short(str(data.get(key))) for key in ("Type", "Template"))
    return f"is a Chrono file of Type {kind} and Template {template}"


def _is_suspension(data: Mapping[str, Any]) -> bool:
    return data.get("Type") == "Suspension" and bool(data.get("Template"))


def _suspension(data: Mapping[str, Any], source: str, note: str) -> tuple[list[FilePoint], Axle]:
    """The points of a suspension, and its spin axis."""
    points = [
        FilePoint(f"{part}: {key}", _place(value, source, f"{part}: {key}"), side="left")
        for part, keys in data.items()
        if isinstance(keys, dict)
        for key, value in keys.items()
        if key == "COM" or key.startswith("Location")
    ]
    angles = {key: number_of(data.get(key, 0), source, 0, key) for key in (CAMBER, TOE)}
    for key, value in angles.items():
        if not abs(value) < 90:
            raise FileError(source, 0, f"{key} is {value}", "an angle below 90 deg")
    camber, toe = (radians(float(value)) for value in angles.values())
    # The y axis of the left spindle: R_z(-toe) R_x(-camber) e_y in Chrono's axes (ChDoubleWishbone.cpp).
    axis = (sin(toe) * cos(camber), cos(toe) * cos(camber), -sin(camber))
    taken = " and ".join(f"{key} {data.get(key, 'not given, which is 0')}" for key in angles)
    return points, Axle(str(data["Template"]), {}, SpinAxis(axis, taken), (note, STEERED))


def _vehicle(axles: Sequence[Any], source: str) -> Contents:
    """The suspensions of a vehicle, each in the frame of its chassis, by axle."""
    if not axles or not all(isinstance(axle, dict) for axle in axles):
        raise FileError(source, 0, f"has no {AXLES}", f"one with {SUSPENSION} each")
    places = [_place(axle.get(PLACE), source, f"{PLACE} of axle {i}") for i, axle in enumerate(axles, 1)]
    points: list[FilePoint] = []
    read: dict[str, Axle] = {}
    for label, axle, place in zip(_labels(places), axles, places, strict=True):
        if place[1]:
            problem = f"{PLACE} of its {label} axle has y {place[1]}, which is not the middle of the car"
            raise FileError(source, 0, problem, "y 0")
        data, path = _named(axle.get(SUSPENSION), source)
        into = f"moved by its {PLACE} {[float(n) for n in place]} m into the frame of the chassis"
        theirs, read[label] = _suspension(data, path, f"points are those of {path}, {into}")
        for point in theirs:
            x, y, z = (a + b for a, b in zip(point.place, place, strict=True))
            points.append(replace(point, part=label, place=(x, y, z)))
    return Contents(tuple(points), read)


def _named(name: object, source: str) -> tuple[Mapping[str, Any], str]:
    """The suspension file that a vehicle names, from the nearest folder above the vehicle that has it."""
    if not isinstance(name, str):
        raise FileError(source, 0, f"has no {SUSPENSION} of an axle", "the name of a file")
    paths = (folder / name for folder in Path(source).absolute().parents)
    path = next((path for path in paths if path.is_file()), None)
    if path is None:
        problem = f"names {short(name)}, which is in none of the folders above it"
        allowed = "a vehicle in Chrono's data folder with the files that it names"
        raise FileError(source, 0, problem, f"{allowed}, or the file of a suspension")
    text = read_file(path, f"the path of a file that {source} names").decode("utf-8-sig", "replace")
    data = _table(text, str(path))
    if not _is_suspension(data):
        raise FileError(str(path), 0, f"{_kind(data)}, but {source} names it as a suspension", KINDS)
    return data, str(path)


def _place(value: object, source: str, name: str) -> Place:
    """Three coordinates."""
    if not isinstance(value, list):
        raise FileError(source, 0, f"{short(name)} has {short(str(value))}", "a list of three numbers")
    return place_of(value, source, 0, name)


def _labels(places: Sequence[Place]) -> list[str]:
    """Labels of the axles: front and rear for two, by their positions; numbers for more; none for one."""
    if len(places) == 1:
        return [""]
    if len(places) == 2 and places[0][0] != places[1][0]:
        return ["front", "rear"] if places[0][0] > places[1][0] else ["rear", "front"]
    return [str(number) for number, _ in enumerate(places, 1)]
