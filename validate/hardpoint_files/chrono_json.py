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
from validate.hardpoint_files.contents import Contents, Place, Point, number_of, place_of, short
from validate.tables.errors import FileError

CAMBER, TOE = "Camber Angle (deg)", "Toe Angle (deg)"
FORM = "a JSON object: a Project Chrono suspension or vehicle"
KINDS = "Type Suspension with a Template, or Type Vehicle with Axles"
CENTRE, INNER = "Spindle: COM", "Spindle: inner point"
# Distance of the two, m. Coordinates are rounded so that the direction of the axis changes by 1e-14 rad.
INWARD, DIGITS = 0.1, Decimal("1e-15")
AXLES, SUSPENSION, PLACE = "Axles", "Suspension Input File", "Suspension Location"
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
    axles = data.get(AXLES)
    if data.get("Type") == "Vehicle" and isinstance(axles, list) and {*map(type, axles)} == {dict}:
        return _vehicle(axles, source)
    called, points = _suspension(data, source)
    return Contents(points, called={"": called})


def _table(text: str, source: str) -> Mapping[str, Any]:
    """The JSON object of a text; numbers keep their digits."""
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


def _suspension(data: Mapping[str, Any], source: str) -> tuple[str, list[Point]]:
    """The type of a suspension, and its points."""
    kind, template = data.get("Type"), data.get("Template")
    if kind != "Suspension" or not template:
        problem = f"is a Chrono file of Type {short(str(kind))} and Template {short(str(template))}"
        raise FileError(source, 0, problem, KINDS)
    named = [
        (f"{part}: {key}", value)
        for part, keys in data.items()
        if isinstance(keys, dict)
        for key, value in keys.items()
        if key == "COM" or key.startswith("Location")
    ]
    points = [Point(name, place_of(value, source, 0, name), name, "left") for name, value in named]
    camber, toe = (radians(number_of(data.get(key, 0), source, 0, key)) for key in (CAMBER, TOE))
    # The y axis of the left spindle: R_z(-toe) R_x(-camber) e_y in Chrono's axes (ChDoubleWishbone.cpp).
    axis = (sin(toe) * cos(camber), cos(toe) * cos(camber), -sin(camber))
    taken = " and ".join(f"{key} {data.get(key, 'not given, which is 0')}" for key in (CAMBER, TOE))
    for centre in [point for point in points if point.name == CENTRE]:
        steps = (Decimal(INWARD * part).quantize(DIGITS) for part in axis)
        x, y, z = (at - step for at, step in zip(centre.place, steps, strict=True))
        how = f"from {CENTRE}: {INWARD} m inboard on the spin axis, from {taken}"
        points.append(Point(INNER, (x, y, z), how, "left"))
    return str(template), points


def _vehicle(axles: Sequence[Mapping[str, Any]], source: str) -> Contents:
    """The suspensions of a vehicle, each in the frame of its chassis, by axle."""
    places = [place_of(axle.get(PLACE), source, 0, f"{PLACE} of axle {i}") for i, axle in enumerate(axles, 1)]
    points: list[Point] = []
    called: dict[str, str] = {}
    for label, axle, place in zip(_labels(places), axles, places, strict=True):
        path = _path(axle.get(SUSPENSION), source)
        text = read_file(path, f"the path of a file that {source} names").decode("utf-8-sig", "replace")
        called[label], theirs = _suspension(_table(text, str(path)), str(path))
        for point in theirs:
            x, y, z = (a + b for a, b in zip(point.place, place, strict=True))
            words = f"{point.source}, of {path.name}"
            points.append(replace(point, part=label, place=(x, y, z), source=words))
    return Contents(points, called=called)


def _path(name: object, source: str) -> Path:
    """The file that a vehicle names, in the nearest folder above the vehicle that has it."""
    paths = (folder / str(name) for folder in Path(source).absolute().parents)
    path = next((path for path in paths if path.is_file()), None)
    if path is None:
        problem = f"names {short(str(name))}, which is in none of the folders above it"
        allowed = "a vehicle in Chrono's data folder with the files that it names"
        raise FileError(source, 0, problem, f"{allowed}, or the file of a suspension")
    return path


def _labels(places: Sequence[Place]) -> list[str]:
    """Labels of the axles: front and rear for two, by their positions; numbers for more; none for one."""
    if len(places) == 1:
        return [""]
    if len(places) == 2 and places[0][0] != places[1][0]:
        return ["front", "rear"] if places[0][0] > places[1][0] else ["rear", "front"]
    return [str(number) for number, _ in enumerate(places, 1)]
