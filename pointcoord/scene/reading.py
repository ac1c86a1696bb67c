"""What the numbers and paths of a scene mean while it is read: folder, unit of length, drawing and time.

The numbers of a scene become mm where its models read them. Angles and times have one unit only.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

MM = "mm"
UNITS = {MM: 1.0, "m": 1000.0, "in": 25.4}
"""The units of length that a scene may be written in, in mm."""


@dataclass(frozen=True)
class Reading:
    """What a number or a path means where it stands.

    Attributes:
        folder: the folder from which paths start.
        unit: unit of lengths, and of the values of an input that is a length; `rad` in the law of an angle.
        drawn: value of the input in the drawing, which "drawn" stands for, mm or rad.
        span: first and last instant of the scene, between which an input sweeps, s; None if not given.
    """

    folder: Path = Path()
    unit: str = MM
    drawn: Callable[[], float] = float
    span: tuple[float, float] | None = None


_PLAIN = Reading()
_NOW = ContextVar("reading", default=_PLAIN)


def now() -> Reading:
    """The reading that holds for the part that is being read."""
    return _NOW.get()


@contextmanager
def reading(**changes: Any) -> Iterator[None]:
    """What is read within this context has other values of the attributes of `Reading`."""
    token = _NOW.set(replace(now(), **changes))
    try:
        yield
    finally:
        _NOW.reset(token)


def in_mm(length: float) -> float:
    """A length in mm, given in the unit of the scene; the value of an angle stays."""
    return UNITS.get(now().unit, 1.0) * length


def per_mm(rate: float) -> float:
    """A rate per mm, given per unit of length of the scene."""
    return rate / UNITS[now().unit]
