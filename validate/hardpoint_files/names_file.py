"""A file of one's own that says what another file calls our points, or gives points that it does not have.

[names]
wheel_centre = "Hub centre"             # our name = the file's name
wheel_axis_inner = [0.0, 658.0, 210.0]  # or x, y and z in the file's own axes and unit
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from decimal import Decimal, DecimalException
from typing import Any

from pointcoord.errors import UnknownName
from pointcoord.scene.scene_text import read_file
from pointcoord.suspensions import SUSPENSIONS
from validate.hardpoint_files.contents import FilePoint, HardpointFileError, finite, short

FORM = '[names] with lines such as our_name = "its name", or our_name = [x, y, z]'


@dataclass(frozen=True)
class NamesFile:
    """What a file of names says.

    Attributes:
        names: the other file's name of our points. points: those that are given here.
    """

    names: Mapping[str, str]
    points: Mapping[str, FilePoint]


NO_NAMES = NamesFile({}, {})


def read_names(path: str) -> NamesFile:
    """Read a file of names.

    Raises:
        SceneError: it cannot be read.
        HardpointFileError: it is not written as it must be.
        UnknownName: a point is none of ours.
    """
    try:
        data = tomllib.loads(
            read_file(path, "a file of names, TOML").decode("utf-8-sig"), parse_float=Decimal
        )
    except (ValueError, RecursionError, DecimalException) as error:
        found = re.search(r"at line (\d+)", str(error))
        raise HardpointFileError(path, int(found[1]) if found else 0, f"is not TOML: {error}", FORM) from None
    table = data.pop("names", None)
    if data or not isinstance(table, dict):
        told = f"has the key {short(next(iter(data)))}" if data else "has no table [names]"
        raise HardpointFileError(path, 0, told, FORM)
    ours = tuple(dict.fromkeys(point for kind in SUSPENSIONS.values() for point in kind.points))
    names: dict[str, str] = {}
    points: dict[str, FilePoint] = {}
    for name, value in table.items():
        if name not in ours:
            raise UnknownName(f"point of ours in {path}", name, ours)
        if isinstance(value, str):
            names[name] = value
        else:
            points[name] = FilePoint(f"given in {path}", _place(value, path, name), 0)
    return NamesFile(names, points)


def _place(value: Any, path: str, name: str) -> tuple[Decimal, Decimal, Decimal]:
    numbers = value if isinstance(value, list) else []
    if len(numbers) != 3 or any(isinstance(n, bool) or not isinstance(n, int | Decimal) for n in numbers):
        raise HardpointFileError(path, 0, f"{name} is {short(str(value))}", FORM)
    x, y, z = (
        finite(Decimal(n), path, 0, f"{axis} of {name}") for axis, n in zip("xyz", numbers, strict=True)
    )
    return x, y, z
