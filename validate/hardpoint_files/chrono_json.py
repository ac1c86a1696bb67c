"""A suspension of Project Chrono's vehicle models: JSON, with comments as Chrono allows them.

A point is a key `Location ...` or `COM` of a part, with three numbers; here it is called `Part: Key`.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from decimal import Decimal, DecimalException
from math import cos, radians, sin
from typing import Any, NoReturn

from validate.hardpoint_files.contents import Contents, FilePoint, HardpointFileError, finite, short

CAMBER, TOE = "Camber Angle (deg)", "Toe Angle (deg)"
FORM = "JSON of a Project Chrono suspension"
# A text in quotes, which is kept, or a comment.
_COMMENT = re.compile(r'"(?:\\.|[^"\\\n])*"|//[^\n]*|/\*[\s\S]*?\*/')


def read(text: str, source: str) -> Contents:
    """The points of a suspension, and where its spin axis points.

    Raises:
        HardpointFileError: it is no JSON, no suspension, or has a point that is none.
    """
    clean = _COMMENT.sub(_blank, text)
    try:
        data = json.loads(clean, parse_float=Decimal, parse_int=Decimal, parse_constant=_no_number)
    except json.JSONDecodeError as error:
        raise HardpointFileError(source, error.lineno, f"is no JSON: {error.msg}", FORM) from None
    except (ValueError, RecursionError, DecimalException) as error:
        raise HardpointFileError(source, 0, f"is no JSON: {error}", FORM) from None
    if not isinstance(data, dict):
        raise HardpointFileError(source, 1, f"is a {type(data).__name__}", FORM)
    kind, template = data.get("Type"), data.get("Template")
    if kind != "Suspension" or not isinstance(template, str):
        told = f"has Type {short(str(kind))} and Template {short(str(template))}"
        raise HardpointFileError(source, _line(clean, "Type"), told, "Type Suspension with a Template")
    points = [
        FilePoint(f"{part}: {key}", _place(value, clean, source, part, key), _line(clean, part, key))
        for part, keys in data.items()
        if isinstance(keys, dict)
        for key, value in keys.items()
        if key == "COM" or key.startswith("Location")
    ]
    camber, toe = (_angle(data, key, clean, source) for key in (CAMBER, TOE))
    # The spindle's own y axis, turned about x by the camber and then about z by the toe: R_z R_x e_y.
    axis = (sin(toe) * cos(camber), cos(toe) * cos(camber), -sin(camber))
    taken = (f"{key} {data[key]}" if key in data else f"no {key}, which is 0 then" for key in (CAMBER, TOE))
    words = " and ".join(taken)
    return Contents(tuple(points), called={"": template}, spin_axis=axis, spin_words=words)


def _blank(found: re.Match[str]) -> str:
    """Texts as they are; comments as the line breaks in them."""
    return found[0] if found[0].startswith('"') else "\n" * found[0].count("\n") + " "


def _no_number(word: str) -> NoReturn:
    raise ValueError(f"{word} is no number")


def _line(text: str, *keys: str) -> int:
    """The line of a key inside others, in a text without comments; 0 if it is not there as written."""
    at = 0
    for key in keys:
        found = re.compile(re.escape(json.dumps(key, ensure_ascii=False)) + r"\s*:").search(text, at)
        if found is None:
            return 0
        at = found.start()
    return text.count("\n", 0, at) + 1


def _place(value: Any, text: str, source: str, part: str, key: str) -> tuple[Decimal, Decimal, Decimal]:
    line, name = _line(text, part, key), short(f"{part}: {key}")
    if not isinstance(value, list) or len(value) != 3:
        told = f"{len(value)} values" if isinstance(value, list) else f"{short(str(value))}"
        raise HardpointFileError(source, line, f"{name} has {told}", "a list of three numbers")
    for axis, number in zip("xyz", value, strict=True):
        if not isinstance(number, Decimal):
            raise HardpointFileError(source, line, f"{axis} of {name} is {short(str(number))}", "a number")
        finite(number, source, line, f"{axis} of {name}")
    return value[0], value[1], value[2]


def _angle(data: Mapping[str, Any], key: str, text: str, source: str) -> float:
    value = data.get(key, Decimal(0))
    if not isinstance(value, Decimal) or not abs(finite(value, source, _line(text, key), key)) < 90:
        allowed = "an angle below 90 deg"
        raise HardpointFileError(source, _line(text, key), f"{key} is {short(str(value))}", allowed)
    return radians(float(value))
