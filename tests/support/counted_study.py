"""A study whose tasks leave a mark whenever they are begun, and take as long as they are told to."""

import time
from functools import partial
from pathlib import Path

from threadpoolctl import threadpool_info

from validate.exit_status import ExitStatus
from validate.studies.cluster import rows_of
from validate.studies.study import Findings, Row, Study, Task

COLUMNS = {"square": "int64", "threads": "int64"}


def counted(count: int, marks: Path, pause: float = 0.0, wrong: int = -1) -> Study:
    """Squares of numbers.

    Args:
        marks: a file that gets a line with a number whenever that one is begun.
        pause: seconds that each takes. wrong: the number that has no square.
    """
    examine = partial(_square, marks=str(marks), pause=pause, wrong=wrong)
    tasks = [Task("all", number) for number in range(count)]
    return Study("counted", "number", {}, COLUMNS, tasks, examine, _nothing)


def _square(task: Task, marks: str, pause: float, wrong: int) -> list[Row]:
    with open(marks, "a") as file:
        file.write(f"{task.number}\n")
    time.sleep(pause)
    if task.number == wrong:
        raise ZeroDivisionError("no square")
    return [{"square": task.number**2, "threads": max(one["num_threads"] for one in threadpool_info())}]


def _nothing(rows: object) -> Findings:
    return Findings((), {}, ExitStatus.AGREE)


def worked_out(study: Study) -> list[Row]:
    """The rows of a study in the order of its tasks, worked out in this process and without a cluster."""
    return [row for task in study.tasks for row in rows_of(study.examine, task, "here")]


def without_who_and_how_long(rows: list[Row]) -> list[Row]:
    """What of rows does not depend on who worked them out, without what they do not have."""
    return [
        {name: v for name, v in row.items() if name not in ("worker", "seconds") and v is not None}
        for row in rows
    ]
