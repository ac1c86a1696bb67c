"""What can be wrong with what the program is asked for, or with what it asks others."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any


class UsageError(Exception):
    """The command line is wrong, or a name, a file or a cluster that it gives cannot be used.

    The message says which, what is wrong with it, and what is allowed.
    """


class NotFinished(Exception):
    """What was begun cannot be finished: a result cannot be written, a task fails, a cluster is gone.

    Args:
        what: the file, `standard output`, the task or the cluster. problem: why not, and what to try.
    """

    def __init__(self, what: str, problem: str) -> None:
        self.what, self.problem = what, problem
        # Both, so that it comes back from another process.
        super().__init__(what, problem)

    def __str__(self) -> str:
        return f"{self.what}: {self.problem}"


class NoAnswer(Exception):
    """A tree of joints, a program or another way to solve does not answer for a mechanism.

    Args:
        what: the hardpoint, body, input, instant or number at fault.
        problem: what is wrong with it, with the value.
        allowed: what would be right, or what to try.
        name: of what is at fault; as `what` unless given, and empty if a pose is.
        value: of an input that is at fault.
        instant: number of the instant that it is about, None if it is the drawing.
        wanted, reached: inputs of a pose that is not reached, rad and mm: those asked for, and the last that
            could be solved.
        condition: condition number of the rows' Jacobian there.
        links: what holds each other there, the strongest first.

    Attributes:
        partial: the poses that were solved before; None if there are none.
    """

    partial: Any = None

    def __init__(
        self,
        what: str,
        problem: str,
        allowed: str,
        *,
        name: str | None = None,
        value: float | str | None = None,
        instant: int | None = None,
        wanted: Mapping[str, float] | None = None,
        reached: Mapping[str, float] | None = None,
        condition: float = math.nan,
        links: tuple[str, ...] = (),
    ) -> None:
        self.what, self.problem, self.allowed = what, problem, allowed
        self.name = what if name is None else name
        self.value, self.instant = value, instant
        self.wanted, self.reached = dict(wanted or {}), dict(reached or {})
        self.condition, self.links = condition, links
        super().__init__(f"{what} {problem}; allowed: {allowed}")
