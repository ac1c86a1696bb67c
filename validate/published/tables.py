"""Printed tables of other programs, and the built-in car that they are about.

A table is a file of results with a map of its columns, as `pointcoord validate --data --map` takes them. What
is shipped here are printed numbers, with their source and under which licence that is to be had.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from pointcoord import Scene
from validate.measured.comparing import DataOutcome, compare_results
from validate.measured.mapping import read_results

FOLDER = Path(__file__).parent
SHARK = (
    "printed report of Lotus Suspension Analysis (SHARK) v4.03, tests/fixtures/front_type1_report.txt of the "
    "Python package voila-sus 0.2.0 (MIT licence)"
)


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


TABLES = (
    Table("lotus-bump", "Lotus: angles over bump", "double-wishbone", SHARK),
    Table(
        "lotus-steering",
        "Lotus: angles over rack travel",
        "double-wishbone",
        SHARK,
        "its rack moves the other way than ours, and travels are shown with our sign; the tyre's contact "
        "point keeps its height",
    ),
)


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
