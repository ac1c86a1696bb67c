"""Printed tables of other programs, and the built-in car that they are about.

A table is a file of results with a map of its columns, as `pointcoord validate --data --map` takes them. What
is shipped here are printed numbers, with their source and under which licence that is to be had.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass, replace
from pathlib import Path

from pointcoord import Scene
from validate.measured.comparing import DataOutcome, compare_results
from validate.measured.mapping import read_results

FOLDER = Path(__file__).parent


@dataclass(frozen=True)
class Table:
    """A printed table.

    Attributes:
        name: of its files in this folder. title: for people. scene: the built-in car that it is about.
        source: where it was printed. note: what must be known to read it.
    """

    name: str
    title: str
    scene: str
    source: str
    note: str = ""

    @property
    def files(self) -> tuple[Path, Path]:
        """The table, and the map of its columns."""
        return FOLDER / f"{self.name}.csv", FOLDER / f"{self.name}.toml"


_KNOWN = tomllib.loads((FOLDER / "tables.toml").read_text(encoding="utf-8"))
TABLES = tuple(Table(name, **about) for name, about in _KNOWN.items())


@dataclass(frozen=True)
class Published:
    """A printed table beside what the car gives at the same places."""

    table: Table
    found: DataOutcome


def compare_published() -> tuple[Published, ...]:
    """Every table, held to its own printed digits."""
    return tuple(Published(table, _compared(table)) for table in TABLES)


def _compared(table: Table) -> DataOutcome:
    scene = Scene.load(table.scene)
    data, map = table.files
    measured = replace(read_results(str(data), str(map), scene), source=table.title)
    return compare_results(measured, scene, table.scene)
