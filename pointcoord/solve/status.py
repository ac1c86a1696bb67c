"""How a solver ended, as data: whoever asked for the whole motion raises what stopped it."""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass
from typing import Any

from pointcoord.errors import PointcoordError


@dataclass(frozen=True)
class Status:
    """How far a solver came.

    Attributes:
        stopped: what stopped it before the end; None where it reached the end.
    """

    stopped: PointcoordError | None = None

    @property
    def complete(self) -> bool:
        """Whether it reached the end."""
        return self.stopped is None

    def error(self, partial: Any = None) -> PointcoordError | None:
        """The exception for those who wanted the whole; None where it is whole.

        Args:
            partial: the motion up to where it stopped, if any of it is solved.
        """
        error = copy(self.stopped)
        if error is not None:
            error.partial = partial
        return error


COMPLETE = Status()
