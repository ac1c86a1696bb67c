"""Errors of a tree of joints and of the programs that hold it, each with its data."""

from __future__ import annotations

from typing import Any


class PeerError(Exception):
    """A program does not answer for a mechanism.

    Attributes:
        instant: number of the instant that it is about, None if it is the drawing.
        partial: the poses that were solved before; None if there are none.
    """

    partial: Any = None

    def __init__(self, problem: str, instant: int | None = None) -> None:
        self.problem = problem
        self.instant = instant
        super().__init__(problem)


class HardpointsError(PeerError):
    """Hardpoints that make no mechanism; `name` is the point, body or input at fault."""

    def __init__(self, name: str, problem: str, allowed: str) -> None:
        self.name, self.allowed = name, allowed
        super().__init__(f"{name} {problem}; allowed: {allowed}")
