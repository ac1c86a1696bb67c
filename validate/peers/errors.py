"""The error of other people's programs: by itself, so that a refusal is read without them."""

from __future__ import annotations


class PeerError(Exception):
    """A peer does not answer: it cannot hold the mechanism, or a pose is not reached.

    Attributes:
        instant: its number, None if it is the drawing.
    """

    def __init__(self, problem: str, instant: int | None = None) -> None:
        self.problem = problem
        self.instant = instant
        super().__init__(problem)
