"""Why a long study cannot begin, or cannot go on."""

from __future__ import annotations

from pathlib import Path

from validate.plain_text import shown


class RecordsError(Exception):
    """A folder of records cannot be used.

    Args:
        folder: that it is.
        problem: why not, and what to do.
    """

    def __init__(self, folder: Path, problem: str) -> None:
        self.folder = folder
        self.problem = problem
        super().__init__(f"--records {shown(str(folder))}: {problem}")


class NoCluster(Exception):
    """There is no cluster at an address that could work out a study; the message says what to do."""


class ClusterLost(Exception):
    """A cluster that worked does not any more; the message says how."""
