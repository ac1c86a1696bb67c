"""An input's table in a file of its own: a column of times, s, and one of values, under titles or not."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pointcoord.errors import SceneError
from pointcoord.toml_text import read_file
from pointcoord.wording import shown

TABLE = "table"


def read_in(part: Any, folder: Path = Path()) -> Any:
    """A scene's inputs, or a law or terms of one, with tables in place of their paths, counted from a folder.

    Raises:
        SceneError: a file cannot be read, or is not two columns of numbers.
    """
    if isinstance(part, Mapping) and part.keys() == {TABLE} and isinstance(part[TABLE], str):
        return {TABLE: _table_of(str(folder / part[TABLE]))}
    if isinstance(part, Mapping):
        return {name: read_in(each, folder) for name, each in part.items()}
    return [read_in(each, folder) for each in part] if isinstance(part, list | tuple) else part


def _table_of(path: str) -> dict[str, list[float]]:
    allowed = "two columns of numbers, time in s and the input's value, with commas between them"
    try:
        text = read_file(path, "the path of a file of two columns").decode("utf-8-sig")
    except UnicodeDecodeError:
        raise SceneError(path, "", "is no text in UTF-8", allowed) from None
    rows: list[list[Any]] = []
    for number, cells in enumerate(csv.reader(text.splitlines()), start=1):
        numbers = [_number(cell) for cell in cells]
        titles = number == 1 and all(one is None for one in numbers)
        if not cells or titles:
            continue
        if len(numbers) != 2 or None in numbers:
            raise SceneError(path, f"line {number}", f"is {shown(','.join(cells))}", allowed)
        rows.append(numbers)
    times, values = ([row[i] for row in rows] for i in range(2))
    return {"times": times, "values": values}


def _number(cell: str) -> float | None:
    try:
        return float(cell)
    except ValueError:
        return None
