"""What it takes before anything is solved: to load a scene, to import the package, to run the command.

Processes are started afresh for each repeat. Beside the package stand Python itself and numpy, which it
needs: the part that no change of ours can save. Files are in the system's cache all the time.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from functools import partial

from pointcoord import Scene
from validate.cost.apart import environment
from validate.cost.race import Found, Runner
from validate.cost.table import Row
from validate.cost.way import require

SCENE = "steer"
PATIENCE = 300.0  # s, for a process

LOADED = {
    "python": ("-c", "pass"),
    **{
        line: ("-c", line)
        for line in ("import numpy", "import pointcoord", "from pointcoord import simulate")
    },
    **{f"pointcoord {line}": ("-m", "pointcoord", *line.split()) for line in ("scenes", f"simulate {SCENE}")},
    f"pointcoord validate {SCENE}": ("-m", "pointcoord", "validate", SCENE),
}
"""Words of the command line after Python's own name. `import pointcoord` alone imports no library."""


class NotRun(Exception):
    """A process did not do what it was started for; says what it said."""


def runners_of(quick: bool = False) -> list[Runner]:
    """A runner for each process, and one for a scene that is loaded in this one."""

    def row(way: str) -> Row:
        return Row("loading", "", way, poses=1, quantity="loading", quick=quick)

    def started(words: tuple[str, ...]) -> Callable[[], None]:
        require("pinocchio" if "validate" in words else "")
        return partial(run, *words)

    return [
        Runner(row(f"Scene.load({SCENE!r})"), lambda: partial(Scene.load, SCENE), _timed_alone),
        *(
            Runner(row(way), partial(started, words), _timed_alone)
            for way, words in LOADED.items()
            if not (quick and "validate" in words)
        ),
    ]


def _timed_alone(_: object) -> Found:
    return {"loading": {}}


def run(*words: str) -> None:
    """Run Python to its end, by one thread, with this package first on its path.

    Raises:
        NotRun: it failed.
    """
    try:
        ended = subprocess.run(
            [sys.executable, *words],
            capture_output=True,
            text=True,
            stdin=subprocess.DEVNULL,
            timeout=PATIENCE,
            env=environment(),
            check=False,
        )
    except subprocess.TimeoutExpired:
        raise NotRun(f"was ended after {PATIENCE:g} s") from None
    if ended.returncode != 0:
        said = ended.stderr.strip().splitlines()
        raise NotRun(f"ended with status {ended.returncode}{': ' + said[-1] if said else ''}")
