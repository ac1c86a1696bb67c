"""A study whose numbers leave a mark whenever they are begun, and take as long as they are told to."""

import os
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from threadpoolctl import threadpool_info

from validate.exit_status import ExitStatus
from validate.long_studies.study import Findings, Kind, Number, Row


@dataclass(frozen=True)
class CountedStudy:
    """Squares of numbers.

    Attributes:
        marks: a file that gets a line with a number whenever that one is begun.
        pause: seconds that each takes.
    """

    count: int
    marks: str
    pause: float = 0.0

    name = "counted"
    noun = "number"
    chunk = 2
    columns: ClassVar[Mapping[str, Kind]] = {"square": "int64", "threads": "int64", "told": "string"}

    @property
    def settings(self) -> Mapping[str, str | int]:
        return {}

    @property
    def numbers(self) -> Sequence[Number]:
        return [Number("all", number) for number in range(self.count)]

    def examine(self, number: Number) -> list[Row]:
        with open(self.marks, "a") as marks:
            marks.write(f"{number.number}\n")
        time.sleep(self.pause)
        threads = max(one["num_threads"] for one in threadpool_info())
        told = os.environ.get("OPENBLAS_NUM_THREADS")
        return [{"square": number.number**2, "threads": threads, "told": told}]

    def findings(self, rows: Sequence[Row]) -> Findings:
        return Findings((), {}, ExitStatus.AGREE)

    def begun(self) -> list[int]:
        """The numbers that were begun, in that order."""
        return [int(line) for line in Path(self.marks).read_text().split()]
