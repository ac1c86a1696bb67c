"""A long study: numbered tasks. The rows of a task depend only on its number and on the study's settings.

So any worker may run a task, at any time and in any order.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, NamedTuple

from validate.exit_status import ExitStatus
from validate.output.document import code_digest, machine, program_version
from validate.output.table import Part

Row = dict[str, Any]
"""A value for each column of the study; None, or no key, for no value."""
PACKAGES = ("numpy", "scipy", "pin", "mpmath", "python-flint")


class Task(NamedTuple):
    """One task: a number in a part of the study."""

    part: str
    number: int


@dataclass(frozen=True)
class Findings:
    """The findings from the rows of a study.

    Attributes:
        parts: lines and tables to print. data: the findings as plain data. status: exit status of the run.
    """

    parts: tuple[Part, ...]
    data: Mapping[str, Any]
    status: ExitStatus


@dataclass(frozen=True)
class Study:
    """A long study.

    Attributes:
        name: on the command line, and in the records.
        noun: what a task is, such as `scene`; its plural has an s.
        settings: all that a row depends on in addition to its task.
        columns: columns of the rows, with the names of their types in pyarrow.
        tasks: all tasks, in the order in which they are run.
        examine: returns the rows of a task, at least one; it is sent to other processes.
        summary: returns the findings from all rows, in the order of the tasks.
    """

    name: str
    noun: str
    settings: Mapping[str, str | int]
    columns: Mapping[str, str]
    tasks: Sequence[Task]
    examine: Callable[[Task], list[Row]]
    summary: Callable[[Sequence[Row]], Findings]


@cache
def made_by() -> Mapping[str, str]:
    """The versions in this process: the program, a digest of its code, and the packages that it uses."""
    code = code_digest(("pointcoord", "absolute", "validate"))
    installed = machine()["packages"]
    return {
        "pointcoord": f"{program_version()}, code {code}",
        **{name: installed[name] or "not installed" for name in PACKAGES},
    }


def differences(there: Mapping[str, Any], here: Mapping[str, Any]) -> str:
    """The differing values of two mappings, in words; empty if there are none."""
    pairs = [(n, there.get(n, "not known"), here.get(n, "not known")) for n in dict.fromkeys((*there, *here))]
    return "; ".join(f"{name} {theirs}, here {ours}" for name, theirs, ours in pairs if theirs != ours)
