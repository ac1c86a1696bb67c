"""What a long study is: numbered tasks whose rows follow from the number and the study's settings alone.

So it does not matter who works a task out, when, or beside what else.
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
"""A value for each column of its study; None, or no key, where it has none."""
PACKAGES = ("numpy", "scipy", "pin", "mpmath", "python-flint")


class Task(NamedTuple):
    """One thing to work out: its number in a part of the study."""

    part: str
    number: int


@dataclass(frozen=True)
class Findings:
    """What the rows of a study come to.

    Attributes:
        parts: for people. data: the same as plain data. status: of a run that ends with them.
    """

    parts: tuple[Part, ...]
    data: Mapping[str, Any]
    status: ExitStatus


@dataclass(frozen=True)
class Study:
    """A long study.

    Attributes:
        name: on the command line, and in the records.
        noun: what a task is about, such as scene; its plural has an s.
        settings: all that a row depends on beside its task.
        columns: of its rows, with what pyarrow calls their types.
        tasks: all that are to be worked out, in this order.
        examine: the rows of a task, at least one; it is sent to other processes.
        summary: what rows come to, those of a task beside each other, in the order of the tasks.
        chunk: how many tasks take some tenths of a second.
    """

    name: str
    noun: str
    settings: Mapping[str, str | int]
    columns: Mapping[str, str]
    tasks: Sequence[Task]
    examine: Callable[[Task], list[Row]]
    summary: Callable[[Sequence[Row]], Findings]
    chunk: int = 1


@cache
def made_by() -> Mapping[str, str]:
    """What makes rows in this process: the program, a digest of its code, and the packages it rests on."""
    code = code_digest(("pointcoord", "absolute", "validate"))
    installed = machine()["packages"]
    return {
        "pointcoord": f"{program_version()}, code {code}",
        **{name: installed[name] or "not installed" for name in PACKAGES},
    }


def differences(there: Mapping[str, Any], here: Mapping[str, Any]) -> str:
    """What is another there than here, in words; empty if nothing is."""
    pairs = [(n, there.get(n, "not known"), here.get(n, "not known")) for n in dict.fromkeys((*there, *here))]
    return "; ".join(f"{name} {theirs}, here {ours}" for name, theirs, ours in pairs if theirs != ours)
