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
from validate.cost.race import Found, Runner
from validate.cost.table import Row
from validate.cost.way import require

SCENE = "steer"

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


def runners_of(quick: bool = False) -> list[Runner]:
    """A runner for each process, and one for a scene that is loaded in this one."""

    def row(way: str) -> Row:
        return Row("loading", "", way, poses=1, quantity="loading", quick=quick)

    def started(words: tuple[str, ...]) -> Callable[[], object]:
        require("pinocchio" if "validate" in words else "")
        command = [sys.executable, *words]
        return partial(subprocess.run, command, check=True, capture_output=True, timeout=300.0)

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
