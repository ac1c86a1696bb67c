"""Why a program does not answer for a tree of joints; read without the programs."""

from __future__ import annotations

from collections.abc import Mapping

from validate.spanning_tree.errors import PeerError


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
