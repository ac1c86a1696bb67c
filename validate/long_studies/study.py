"""What a long study is: numbered parts of work whose results are rows, and what the rows come to.

What a number stands for follows from the number and the study's settings alone. So it does not matter who
works it out, when, or beside what else.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple, Protocol

from validate.exit_status import ExitStatus
from validate.output.terminal import Part

Row = dict[str, Any]
"""A record: a value, or None, for each column of its study."""
Kind = Literal["string", "int64", "float64", "bool_"]
"""What a column holds, as pyarrow calls it."""


class Number(NamedTuple):
    """One thing to work out: its number in a part of the study."""

    part: str
    number: int


@dataclass(frozen=True)
class Findings:
    """What the rows of a study come to.

    Attributes:
        parts: for people.
        data: the same as plain data.
        status: of a run that ends with them.
    """

    parts: tuple[Part, ...]
    data: Mapping[str, Any]
    status: ExitStatus


class Study(Protocol):
    """A long study. It is sent to other processes, so that it holds settings only.

    Attributes:
        name: on the command line, and in the records.
        noun: what a number stands for, such as scene; its plural has an s.
        columns: of its rows, beside those that every study has (see `records`).
        numbers: all that are to be worked out, in this order.
        settings: all that a row depends on beside its number.
        chunk: how many numbers take some tenths of a second: one task of a worker.
    """

    @property
    def name(self) -> str: ...

    @property
    def noun(self) -> str: ...

    @property
    def columns(self) -> Mapping[str, Kind]: ...

    @property
    def numbers(self) -> Sequence[Number]: ...

    @property
    def settings(self) -> Mapping[str, str | int]: ...

    @property
    def chunk(self) -> int: ...

    def examine(self, number: Number) -> list[Row]:
        """Work out one number: at least one row."""
        ...

    def findings(self, rows: Sequence[Row]) -> Findings:
        """What rows come to; each number has all of its rows or none, in the order of `numbers`."""
        ...


def counted(count: int, noun: str) -> str:
    """A count with its noun: 1 scene, 2,000 scenes."""
    return f"{count:,} {noun}{'' if count == 1 else 's'}"
