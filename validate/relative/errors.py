"""Errors of the relative-coordinate model, each with its data."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


class RelativeError(Exception):
    """Anything that the relative-coordinate model refuses.

    Attributes:
        partial: what was solved before, as the model returns it; None if nothing.
    """

    partial: Any = None


class HardpointsError(RelativeError):
    """Hardpoints that make no mechanism.

    Attributes:
        name: of the point or axis at fault.
    """

    def __init__(self, name: str, problem: str, allowed: str) -> None:
        self.name = name
        self.allowed = allowed
        super().__init__(f"{name} {problem}; allowed: {allowed}")


class InputError(RelativeError):
    """An input with a value that it cannot have.

    Attributes:
        name: of the input. value: what it was to be. allowed: what it can be, in words.
        instant: number of the instant; None where it is about none.
    """

    def __init__(self, name: str, value: float | str, allowed: str, instant: int | None = None) -> None:
        self.name = name
        self.value = value
        self.allowed = allowed
        self.instant = instant
        where = "" if instant is None else f" at instant number {instant}"
        super().__init__(f"input {name!r} is {value}{where}; allowed: {allowed}")


class PoseError(RelativeError):
    """A pose that does not exist on the branch of the drawing, or that cannot be told from another.

    Attributes:
        problem: in words.
        instant: number of the instant; None for the drawing itself.
        wanted, reached: inputs, rad and mm: those asked for, and the last that could be solved.
        condition: condition number of the rows' Jacobian at the last pose.
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
        self.problem = problem
        self.instant = instant
        self.wanted = dict(wanted)
        self.reached = dict(reached)
        self.condition = condition
        self.links = links
        where = "the drawing" if instant is None else f"instant number {instant}"
        super().__init__(
            f"{where} {problem}: wanted {_told(wanted)}; reached {_told(reached)}, where the condition "
            f"number is {condition:.3g}; try inputs on this side of it, or check the hardpoints"
        )


def _told(inputs: Mapping[str, float]) -> str:
    return ", ".join(f"{name} = {value:.10g}" for name, value in inputs.items())
