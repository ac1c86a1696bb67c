"""Error and time of every way with every setting on every scene, as rows."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

from validate.cost.row import Row
from validate.cost.scenes import StudyScene
from validate.cost.store import Store
from validate.cost.way import Way

Progress = Callable[[str, int, int], None]
"""Told before anything is measured: what, how many measurements are done, of how many."""

Clock = Callable[[], int]
"""Nanoseconds since some instant."""


def silent(what: str, done: int, of: int) -> None:
    """Tell nobody."""


def accuracy_rows(
    scenes: Sequence[StudyScene],
    store: Store,
    ways: Sequence[Way],
    *,
    quick: bool = False,
    configurations: int | None = None,
    progress: Progress = silent,
    clock: Clock = time.perf_counter_ns,
) -> tuple[Row, ...]:
    """Measure what the store does not hold yet, and give all rows of these scenes and ways.

    Args:
        configurations: at how many instants; as many as the scene has samples, within limits, if None.
    Raises:
        StoreError: the store cannot be written.
        NoReferenceError: a scene has no reference at one of the instants.
    """
    raise NotImplementedError
