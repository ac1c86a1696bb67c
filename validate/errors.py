"""Errors of the program: a wrong command line, work that cannot be finished, a solver without an answer."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any


class UsageError(Exception):
    """The command line is wrong, or it names a scene, file or cluster that cannot be used.

    The message names the option or file, and says what is wrong and what is allowed.
    """


class NotFinished(Exception):
    """The program cannot finish: a result cannot be written, a task fails, the cluster is lost.

    Args:
        what: the file, `standard output`, the task or the cluster.
        problem: what is wrong with it, and what to try.
    """

    def __init__(self, what: str, problem: str) -> None:
        self.what, self.problem = what, problem
        # Both arguments, so that the error can be pickled and raised in another process.
        super().__init__(what, problem)

    def __str__(self) -> str:
        return f"{self.what}: {self.problem}"


class NotSolved(Exception):
    """A scene that the command line names is well written, and cannot be solved; the message names both."""


class NoAnswer(Exception):
    """A spanning tree, a peer program or another solver has no answer for a mechanism.

    Args:
        what: the hardpoint, body, input, instant or number at fault.
        problem: what is wrong with it, with the value.
        allowed: what would be right, or what to try.
        name: name of the part at fault; `what` if not given, empty if a pose is at fault.
        value: value of the input at fault.
        instant: index of the instant; None for the drawing.
        wanted, reached: inputs of a pose that cannot be reached, rad and mm: the requested values, and the
            last values that could be solved.
        condition: condition number of the Jacobian of the constraints there.
        links: the links that lock the mechanism there, the strongest first.

    Attributes:
        partial: the poses solved before the error; None if there are none.
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
