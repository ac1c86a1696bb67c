"""What it takes before anything is solved: to load a scene, to import the package, to run the command.

Processes are started afresh for each repeat, all kinds once in a round and in another order in the next, so
that a busy machine hurts all alike. The phase `process` is from the start of Python to its end, `import` is
what the statement itself takes inside, by that process' own clock. Beside the package stands numpy, which it
needs: what is told of it, in the same rounds, is the part of an import that no change of ours can save. Files
are in the system's cache all the time; what an import takes from a cold disk is left out, with the reason.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from importlib.util import find_spec
from pathlib import Path

import validate
from pointcoord import Scene
from pointcoord.errors import visible
from validate.cost.accuracy import Progress, silent
from validate.cost.row import Row, Status
from validate.cost.stopwatch import Clock, Laps, loops_for, round_order, sample, times_of
from validate.cost.store import THREADS, Key, Store

SCENE = "steer"
REPEATS = 9
REPEATS_QUICK = 3
LEAST = 0.02  # s, of a sample of what is not a process
PATIENCE = 300.0  # s, for a process

TIMED_IMPORT = "from time import perf_counter as now; t = now(); {}; t = now() - t; print(t)"


class NotRun(Exception):
    """A process did not do what it was started for; says what it said."""


@dataclass(frozen=True)
class Loading:
    """Something that is loaded.

    Attributes:
        way, scene: as in the row.
        words: of the command line after Python's own name; none loads the scene in this process.
        statement: whether the process prints what its statement took.
        needs: a package without which it is left out.
    """

    way: str
    scene: str = ""
    words: tuple[str, ...] = ()
    statement: bool = False
    needs: str = ""

    def key(self, quick: bool) -> Key:
        """Of its row."""
        return Key(part="loading", scene=self.scene, digest="", way=self.way, quick=quick)

    def seconds(self, loops: int = 1, clock: Clock = time.perf_counter_ns) -> dict[str, float]:
        """One sample of each phase.

        Raises:
            NotRun: the process failed.
        """
        printed: list[str] = []

        def job(laps: Laps) -> None:
            if self.words:
                printed.append(_run(self.words))
                laps.lap("process")
            else:
                Scene.load(self.scene)
                laps.lap("load")

        found = sample(job, loops, clock)
        return {**found, "import": float(printed[-1])} if self.statement else found


def _import(statement: str) -> Loading:
    return Loading(statement, words=("-c", TIMED_IMPORT.format(statement)), statement=True)


def _command(word: str, scene: str = "", needs: str = "") -> Loading:
    words = ("-m", "pointcoord", word, *filter(None, [scene]))
    return Loading(f"pointcoord {word}", scene, words, needs=needs)


LOADED: Sequence[Loading] = (
    Loading("Scene.load", SCENE),
    Loading("python", words=("-c", "pass")),
    _import("import numpy"),
    _import("import pointcoord"),
    _import("from pointcoord import Scene, simulate"),
    _command("scenes"),
    _command("simulate", SCENE),
    _command("validate", SCENE, needs="pinocchio"),
)
"""What is loaded. `import pointcoord` alone imports no library; the names that it gives do."""
LOADED_QUICK = tuple(one for one in LOADED if one.way not in ("pointcoord scenes", "pointcoord validate"))

COLD = Row(
    part="loading",
    scene="",
    way="import pointcoord",
    setting="files not in the system's cache",
    status="left out",
    reason="emptying the system's cache of files takes an administrator's rights",
)


def measure_loading(
    store: Store,
    quick: bool = False,
    progress: Progress = silent,
    *,
    loaded: Sequence[Loading] | None = None,
    clock: Clock = time.perf_counter_ns,
) -> tuple[Row, ...]:
    """Measure what the store does not hold yet, and give all loading rows.

    Args:
        loaded: what is loaded, if not what `quick` says.
    Raises:
        StoreError: the store cannot be written.
    """
    repeats = REPEATS_QUICK if quick else REPEATS
    if loaded is None:
        loaded = LOADED_QUICK if quick else LOADED
    wanted = {one.key(quick): one for one in loaded}
    racing = {key: one for key, one in wanted.items() if store.row(key) is None}
    loops: dict[Key, int] = {}
    samples: dict[Key, list[dict[str, float]]] = {key: [] for key in racing}
    failed: dict[Key, Row] = {}
    done, total = 0, (repeats + 1) * len(racing)
    # The first round warms up, and says how many runs make a sample.
    for number in range(-1, repeats):
        for key in round_order(list(racing), number):
            one = racing[key]
            progress(f"loading: {one.way} {one.scene}".rstrip(), done, total)
            done += 1
            if key in failed:
                continue
            if one.needs and find_spec(one.needs) is None:
                reason = f"needs the package {one.needs!r}, which is not installed"
                failed[key] = _without_times(one, "left out", reason)
                continue
            try:
                seconds = one.seconds(loops.get(key, 1), clock)
            except NotRun as error:
                failed[key] = _without_times(one, "failed", str(error))
                continue
            if number < 0:
                loops[key] = 1 if one.words else loops_for(sum(seconds.values()), LEAST)
            else:
                samples[key].append(seconds)
    for key, one in racing.items():
        whole = Row(part="loading", scene=one.scene, way=one.way, configurations=1)
        store.write(key, failed.get(key) or replace(whole, times=times_of(samples[key])))
    cold = Key(part="loading", scene="", digest="", way=COLD.way, setting=COLD.setting, quick=quick)
    if store.row(cold) is None:
        store.write(cold, COLD)
    found = (store.row(key) for key in (*wanted, cold))
    return tuple(row for row in found if row is not None)


def _run(words: Sequence[str]) -> str:
    """Run Python to its end, with this package first on its path, and give what it printed."""
    source = str(Path(validate.__file__).parents[1])
    path = os.pathsep.join(filter(None, (source, os.environ.get("PYTHONPATH"))))
    try:
        ended = subprocess.run(
            [sys.executable, *words],
            capture_output=True,
            text=True,
            stdin=subprocess.DEVNULL,
            timeout=PATIENCE,
            env={**os.environ, **dict.fromkeys(THREADS, "1"), "PYTHONPATH": path},
            check=False,
        )
    except subprocess.TimeoutExpired:
        raise NotRun(f"was ended after {PATIENCE:g} s") from None
    if ended.returncode != 0:
        said = ended.stderr.strip().splitlines()
        raise NotRun(f"ended with status {ended.returncode}{': ' + said[-1] if said else ''}")
    return ended.stdout


def _without_times(one: Loading, status: Status, reason: str) -> Row:
    return Row(part="loading", scene=one.scene, way=one.way, status=status, reason=visible(reason))
