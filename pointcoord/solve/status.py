"""How a solver ended, as data. The caller who needs the whole motion raises the error."""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass
from typing import Any

from pointcoord.errors import PointcoordError


@dataclass(frozen=True)
class Status:
    """Whether a solver reached the end, or what stopped it.

    Attributes:
        stopped: the error that stopped the solver before the end; None if the solver reached the end.
    """

    stopped: PointcoordError | None = None

    @property
    def complete(self) -> bool:
        """Whether the solver reached the end."""
        return self.stopped is None

    def error(self, partial: Any = None) -> PointcoordError | None:
        """The exception for a caller who needs the whole motion; None if the motion is complete.

        Args:
            partial: the motion up to the instant where it stopped, if any of it was solved.
        """
        error = copy(self.stopped)
        if error is not None:
            error.partial = partial
        return error


COMPLETE = Status()
