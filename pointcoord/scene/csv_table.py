"""An input's table in a file of its own: a column of times, s, and one of values, under titles or not."""

from __future__ import annotations

import csv
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from pointcoord.errors import SceneError
from pointcoord.toml_text import read_file
from pointcoord.wording import shown

TABLE = "table"


def beside(inputs: Any, folder: Path) -> Any:
    """A scene's inputs with the paths of their tables counted from a folder."""
    return _with_files(inputs, lambda path: str(folder / path))


def read_in(inputs: Any) -> Any:
    """A scene's inputs with tables in place of their paths.

    Raises:
        SceneError: a file cannot be read, or is not two columns of numbers.
    """
    return _with_files(inputs, _table_of)


def _with_files(part: Any, change: Callable[[str], Any]) -> Any:
    """Inputs, laws or terms with something else for the path of each table."""
    if _of_a_file(part):
        return {TABLE: change(part[TABLE])}
    if isinstance(part, Mapping):
        return {name: _with_files(each, change) for name, each in part.items()}
    return [_with_files(each, change) for each in part] if isinstance(part, list | tuple) else part


def _of_a_file(law: Any) -> bool:
    return isinstance(law, Mapping) and law.keys() == {TABLE} and isinstance(law[TABLE], str)


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
