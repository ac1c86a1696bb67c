"""A suspension of Project Chrono, or a vehicle that names some: JSON, with comments as Chrono allows them.

A point is a key `Location ...` or `COM` of a part, with three numbers; here it is called `Part: Key`.
A vehicle names the files of its suspensions and steering from Chrono's folder of data, and puts each
suspension at a place of its chassis (WheeledVehicle.cpp).
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from decimal import Decimal, DecimalException
from math import cos, radians, sin
from pathlib import Path
from typing import Any, NoReturn

from pointcoord.toml_text import read_file
from validate.hardpoint_files.contents import (
    Axle,
    Contents,
    FilePoint,
    Place,
    SpinAxis,
    finite,
    short,
)
from validate.tables.errors import FileError

CAMBER, TOE = "Camber Angle (deg)", "Toe Angle (deg)"
FORM = "JSON of a Project Chrono suspension"
KINDS = "Type Suspension with a Template, or Type Vehicle with Template WheeledVehicle"
AXLES, SUSPENSION, PLACE = "Axles", "Suspension Input File", "Suspension Location"
STEERINGS, STEERING, ORIENTATION = "Steering Subsystems", "Steering Index", "Orientation"
RACK = "RackPinion"
# A printed quaternion has some eight digits.
ACROSS = 1e-6
# A text in quotes, which is kept, or a comment.
_COMMENT = re.compile(r'"(?:\\.|[^"\\\n])*"|//[^\n]*|/\*[\s\S]*?\*/')


def read(text: str, source: str) -> Contents:
    """The points of a suspension, or of those that a vehicle names, and where their spin axes point.

    Raises:
        FileError: it is no JSON, no suspension and no vehicle, has a point that is none, or names a
            file that is not there.
        SceneError: a file that it names cannot be read.
    """
    return _read(text, source, ())


def _read(text: str, source: str, on_the_way: tuple[str, ...]) -> Contents:
    data, clean = _data(text, source)
    kind, template = data.get("Type"), data.get("Template")
    if kind == "Suspension" and isinstance(template, str):
        return _suspension(data, template, clean, source)
    # A simulation's own files name the vehicle.
    within = data.get("Vehicle")
    vehicle = within.get("Input File") if isinstance(within, dict) else data.get("Vehicle Input File")
    if isinstance(vehicle, str) and source not in on_the_way:
        path, inner = _named(
            vehicle, source, _line(clean, "Input File") or _line(clean, "Vehicle Input File")
        )
        return _read(inner, path, (*on_the_way, source))
    if kind == "Vehicle" and isinstance(data.get(AXLES), list):
        return _vehicle(data, clean, source)
    told = f"is a file of Chrono's of Type {short(str(kind))} and Template {short(str(template))}"
    if not isinstance(kind, str):
        told = "is JSON without a Type, which every file of Chrono's has"
    raise FileError(source, _line(clean, "Type"), told, KINDS)


def _data(text: str, source: str) -> tuple[dict[str, Any], str]:
    """The JSON of a file, and its text without comments."""
    clean = _COMMENT.sub(_blank, text)
    try:
        data = json.loads(clean, parse_float=Decimal, parse_int=Decimal, parse_constant=_no_number)
    except json.JSONDecodeError as error:
        raise FileError(source, error.lineno, f"is no JSON: {error.msg}", FORM) from None
    except (ValueError, RecursionError, DecimalException) as error:
        raise FileError(source, 0, f"is no JSON: {error}", FORM) from None
    if not isinstance(data, dict):
        raise FileError(source, 1, f"is a {type(data).__name__}", FORM)
    return data, clean


def _suspension(data: Mapping[str, Any], template: str, clean: str, source: str) -> Contents:
    points = [
        FilePoint(
            f"{part}: {key}",
            _place(value, clean, source, f"{part}: {key}", part, key),
            _line(clean, part, key),
        )
        for part, keys in data.items()
        if isinstance(keys, dict)
        for key, value in keys.items()
        if key == "COM" or key.startswith("Location")
    ]
    camber, toe = (_angle(data, key, clean, source) for key in (CAMBER, TOE))
    # The left spindle's own y axis: R_z(-toe) R_x(-camber) e_y in Chrono's axes (ChDoubleWishbone.cpp).
    axis = (sin(toe) * cos(camber), cos(toe) * cos(camber), -sin(camber))
    taken = (f"{key} {data[key]}" if key in data else f"no {key}, which is 0 then" for key in (CAMBER, TOE))
    notes = (
        "points are in the frame of the suspension, which the car's own file puts somewhere",
        "the tie rod's inner end runs along a rack, whatever steering the car's own file has",
    )
    return Contents(tuple(points), {"": Axle(template, {}, SpinAxis(axis, " and ".join(taken)), notes)})


# A vehicle, and the files that it names.


def _vehicle(data: Mapping[str, Any], clean: str, source: str) -> Contents:
    """The suspensions of a vehicle, each in the frame of its chassis, by axle."""
    axles = data[AXLES]
    if not axles or not all(isinstance(axle, dict) for axle in axles):
        raise FileError(source, _line(clean, AXLES), f"has no {AXLES}", f"one with {SUSPENSION} each")
    places = [
        _place(axle.get(PLACE), clean, source, f"{PLACE} of axle {number}", PLACE)
        for number, axle in enumerate(axles, 1)
    ]
    points: list[FilePoint] = []
    read: dict[str, Axle] = {}
    for label, axle, place in zip(_labels(places), axles, places, strict=True):
        x, y, z = place
        name = axle.get(SUSPENSION)
        if not isinstance(name, str):
            raise FileError(
                source, _line(clean, AXLES), f"has no {SUSPENSION} of an axle", "the name of a file"
            )
        if y:
            told = f"{PLACE} of its {label} axle has y {y}, beside the middle of the car"
            raise FileError(source, _line(clean, PLACE), told, "y 0")
        path, text = _named(name, source, _line(clean, name))
        inner, inner_clean = _data(text, path)
        template = inner.get("Template")
        if inner.get("Type") != "Suspension" or not isinstance(template, str):
            told = f"is of Type {short(str(inner.get('Type')))}, and {source} has it as a suspension"
            raise FileError(path, _line(inner_clean, "Type"), told, "Type Suspension with a Template")
        one = _suspension(inner, template, inner_clean, path)
        points += [
            replace(point, part=label, place=(point.place[0] + x, point.place[1] + y, point.place[2] + z))
            for point in one.points
        ]
        steered, doubts = _steering(axle, data, clean, source)
        moved = (
            f"points and their lines are those of {path}, moved by its {PLACE} {[float(n) for n in place]} m "
            "into the frame of the chassis"
        )
        read[label] = replace(one.axles[""], notes=(moved, steered), doubts=doubts)
    return Contents(tuple(points), read)


def _labels(places: Sequence[Place]) -> list[str]:
    """Front and rear of two axles, by where they are; the numbers in the file of more; none of one."""
    if len(places) == 1:
        return [""]
    if len(places) == 2 and places[0][0] != places[1][0]:
        ahead = places[0][0] > places[1][0]
        return ["front", "rear"] if ahead else ["rear", "front"]
    return [str(number) for number, _ in enumerate(places, 1)]


def _steering(
    axle: Mapping[str, Any], data: Mapping[str, Any], clean: str, source: str
) -> tuple[str, tuple[str, ...]]:
    """What moves the inner end of an axle's tie rods, and what may be another motion than our rack's."""
    index, steerings = axle.get(STEERING), data.get(STEERINGS)
    # Chrono's -1 is an axle that is not steered.
    if index is None or index == -1:
        return (
            "the axle is not steered: the chassis holds the tie rod's inner end, as an unmoved rack does",
            (),
        )
    there = steerings if isinstance(steerings, list) else []
    if not isinstance(index, Decimal) or index != int(index) or not 0 <= index < len(there):
        told = f"{STEERING} is {short(str(index))}, but there are {len(there)} {STEERINGS}"
        raise FileError(source, _line(clean, STEERING), told, "the number of one, from 0")
    one = there[int(index)]
    name = one.get("Input File") if isinstance(one, dict) else None
    if not isinstance(name, str):
        raise FileError(
            source, _line(clean, STEERINGS), f"has no Input File of {STEERINGS} {index}", "the name of a file"
        )
    path, text = _named(name, source, _line(clean, name))
    kind = short(str(_data(text, path)[0].get("Template")))
    if kind != short(RACK):
        note = f"it is steered by a {kind} ({name}), here by a straight rack"
        return note, (
            f"{note}, which moves the tie rod's inner end otherwise once it is steered; "
            "with the rack as drawn they are the same",
        )
    turned = one.get(ORIENTATION, [Decimal(1), Decimal(0), Decimal(0), Decimal(0)])
    w, x, y, z = (float(n) for n in _numbers(turned, 4, clean, source, ORIENTATION, ORIENTATION))
    # The rack slides along its own y axis (ChRackPinion.cpp), turned by the quaternion.
    along = (2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x))
    note = f"it is steered by a {kind} ({name}), which moves the tie rod's inner end across the car, as here"
    if abs(along[0]) <= ACROSS and abs(along[2]) <= ACROSS:
        return note, ()
    words = ", ".join(f"{part:.6g}" for part in along)
    note = f"it is steered by a {kind} ({name}) that runs along {words}, here straight across the car"
    return note, (f"{note}; with the rack as drawn they are the same",)


def _named(name: str, source: str, line: int) -> tuple[str, str]:
    """The path and text of a file that another one names, from the nearest folder above it that has it."""
    for folder in Path(source).absolute().parents:
        path = folder / name
        if path.is_file():
            text = read_file(path, f"the path of a file that {source} names").decode("utf-8-sig", "replace")
            return str(path), text
    told = f"names {short(name)}, which is in none of the folders above it"
    allowed = "a vehicle in Chrono's folder of data with the files that it names, or a suspension's own file"
    raise FileError(source, line, told, allowed)


# JSON.


def _blank(found: re.Match[str]) -> str:
    """Texts as they are; comments as the line breaks in them."""
    return found[0] if found[0].startswith('"') else "\n" * found[0].count("\n") + " "


def _no_number(word: str) -> NoReturn:
    raise ValueError(f"{word} is no number")


def _line(text: str, *keys: str) -> int:
    """The line of a key inside others, in a text without comments; 0 if it is not there as written."""
    at = 0
    for key in keys:
        written = re.escape(json.dumps(key, ensure_ascii=False))
        found = re.compile(written + r"\s*:").search(text, at) or re.compile(written).search(text, at)
        if found is None:
            return 0
        at = found.start()
    return text.count("\n", 0, at) + 1


def _place(value: Any, text: str, source: str, name: str, *keys: str) -> Place:
    x, y, z = _numbers(value, 3, text, source, name, *keys)
    return x, y, z


def _numbers(value: Any, count: int, text: str, source: str, name: str, *keys: str) -> list[Decimal]:
    """So many numbers, which are called so."""
    line, name = _line(text, *keys), short(name)
    words = {3: "three", 4: "four"}[count]
    if not isinstance(value, list) or len(value) != count:
        told = f"{len(value)} values" if isinstance(value, list) else f"{short(str(value))}"
        raise FileError(source, line, f"{name} has {told}", f"a list of {words} numbers")
    for axis, number in zip("xyz" if count == 3 else "wxyz", value, strict=True):
        if not isinstance(number, Decimal):
            raise FileError(source, line, f"{axis} of {name} is {short(str(number))}", "a number")
        finite(number, source, line, f"{axis} of {name}")
    return value


def _angle(data: Mapping[str, Any], key: str, text: str, source: str) -> float:
    value = data.get(key, Decimal(0))
    if not isinstance(value, Decimal) or not abs(finite(value, source, _line(text, key), key)) < 90:
        allowed = "an angle below 90 deg"
        raise FileError(source, _line(text, key), f"{key} is {short(str(value))}", allowed)
    return radians(float(value))
