"""A study run: what is not recorded is worked out by a cluster, and recorded as it comes."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from pathlib import Path

from validate.long_studies.records import Records
from validate.long_studies.scheduler import Cluster
from validate.long_studies.study import Number, Row, Study

WRITTEN = 2.0  # seconds of what is worked out that one file holds: all that the end of this process can cost
MOST_TASKS = 5000  # of a run: a scheduler needs a millisecond for each


def run(
    study: Study,
    numbers: Sequence[Number],
    records: Records,
    cluster: Cluster,
    told: Callable[[int], None] = lambda done: None,
) -> None:
    """Work out numbers of a study and record them; whatever ends it, what was done before is recorded.

    Args:
        told: how many of the numbers are recorded, whenever there are more.
    Raises:
        NoCluster, ClusterLost: the cluster cannot go on.
        OutputError: the records cannot be written.
    """
    size = max(study.chunk, -(-len(numbers) // MOST_TASKS))
    tasks = [numbers[i : i + size] for i in range(0, len(numbers), size)]
    held: list[Row] = []
    file: Path | None = None
    done = recorded = 0
    last = time.monotonic()

    def record() -> None:
        nonlocal held, file, recorded, last
        if held:
            # Ctrl-C may come between any two steps. What is not known to be written is written again,
            # into the same file, so that nothing is there twice.
            file = file or records.next_file()
            records.write(file, held)
            recorded = done
            held = []
            file, last = None, time.monotonic()
        told(recorded)

    try:
        for one in cluster.done(study, tasks):
            if one is not None:
                held += one.rows
                done += len(one.numbers)
            if held and time.monotonic() - last >= WRITTEN:
                record()
    finally:
        record()
