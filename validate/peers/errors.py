"""Errors of the programs that hold a tree of joints, each with its data; read without the programs."""

from __future__ import annotations

from collections.abc import Mapping
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


class InputError(PeerError):
    """An input with a value that it cannot have: its name, the value and what is allowed."""

    def __init__(self, name: str, value: float | str, allowed: str, instant: int | None = None) -> None:
        self.name, self.value, self.allowed = name, value, allowed
        where = "" if instant is None else f" at instant number {instant}"
        super().__init__(f"input {name!r} is {value}{where}; allowed: {allowed}", instant)


class PoseError(PeerError):
    """A pose that is not reached on the branch of the drawing.

    Attributes:
        wanted, reached: inputs, rad and mm: those asked for, and the last that could be solved.
        condition: condition number of the rows' Jacobian there.
        links: what holds each other there, the strongest first.
    """

    def __init__(
        self,
        problem: str,
        instant: int | None,
        wanted: Mapping[str, float],
        reached: Mapping[str, float],
        condition: float,
        links: tuple[str, ...] = (),
    ) -> None:
        self.wanted, self.reached = dict(wanted), dict(reached)
        self.condition, self.links = condition, links
        where = "the drawing" if instant is None else f"instant number {instant}"
        super().__init__(
            f"{where} {problem}: wanted {_told(wanted)}; reached {_told(reached)}, where the condition "
            f"number is {condition:.3g}; try inputs on this side of it, or check the hardpoints",
            instant,
        )


def _told(inputs: Mapping[str, float]) -> str:
    return ", ".join(f"{name} = {value:.10g}" for name, value in inputs.items())
