"""How a solver ended, as data: whoever asked for the whole motion makes an exception of it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any

from pointcoord.errors import (
    AssemblyError,
    MotionNotMapped,
    MotionTooLong,
    MotionTooRough,
    PointcoordError,
)


class Status(ABC):
    """How far a solver came."""

    @property
    def complete(self) -> bool:
        """Whether it reached the end."""
        return False

    @abstractmethod
    def error(self, partial: Any = None) -> PointcoordError | None:
        """The exception for those who wanted the whole; None where it is whole.

        Args:
            partial: the motion up to where it stopped, if any of it is solved.
        """


@dataclass(frozen=True)
class Complete(Status):
    """It reached the end."""

    @property
    def complete(self) -> bool:
        """It did."""
        return True

    def error(self, partial: Any = None) -> None:
        """None."""
        return


COMPLETE = Complete()


@dataclass(frozen=True)
class Blocked(Status):
    """The mechanism cannot follow its inputs beyond a pose; see `AssemblyError` for the attributes."""

    problem: str
    reached: dict[str, float]
    wanted: dict[str, float]
    condition: float
    reduce: str
    limits: tuple[str, ...]
    instant: float | None

    def error(self, partial: Any = None) -> AssemblyError:
        """What stopped it, where, and which input to bring back."""
        return AssemblyError(
            self.problem,
            reached=self.reached,
            wanted=self.wanted,
            condition=self.condition,
            reduce=self.reduce,
            limits=self.limits,
            instant=self.instant,
            partial=partial,
        )


def blocked_by(error: AssemblyError) -> Blocked:
    """The status of a path that ended with an error."""
    return Blocked(
        error.problem,
        reached=error.reached,
        wanted=error.wanted,
        condition=error.condition,
        reduce=error.reduce,
        limits=error.limits,
        instant=error.instant,
    )


@dataclass(frozen=True)
class TooLong(Status):
    """The motion takes more segments than the limit; see `MotionTooLong` for the attributes."""

    limit: int
    instant: float
    start: float
    stop: float

    def error(self, partial: Any = None) -> MotionTooLong:
        """How many it would take."""
        return MotionTooLong(self.limit, self.instant, self.start, self.stop, partial)


@dataclass(frozen=True)
class TooRough(Status):
    """No step of a series follows an input; see `MotionTooRough` for the attributes."""

    name: str
    instant: float
    coarsest: bool

    def error(self, partial: Any = None) -> MotionTooRough:
        """Which input, and from when on."""
        return MotionTooRough(self.name, self.instant, partial, coarsest=self.coarsest)


@dataclass(frozen=True)
class NotMapped(Status):
    """No patch of a map covers where the inputs go; see `MotionNotMapped` for the attributes."""

    instant: float
    inputs: dict[str, float]
    reason: str

    def error(self, partial: Any = None) -> MotionNotMapped:
        """Where, and why not."""
        return MotionNotMapped(self.instant, self.inputs, self.reason, partial)
