"""What every command shares: the mistakes of a command line, and where scenes come from."""

from __future__ import annotations

import os
import sys
from pathlib import Path

from pointcoord import Scene, SceneError

STANDARD_INPUT = "-"
STANDARD_INPUT_NAME = "standard input"
SCENE_HELP = "a built-in scene's name, the path of a scene file, or - for standard input"


class UsageError(Exception):
    """The command line is wrong."""


def require_target(target: str | None, option: str, scenes: tuple[str, ...] = ()) -> None:
    """Find a target that is no name, or that is one of the scenes.

    Raises:
        UsageError: it is.
    """
    if target is None:
        return
    if not target.strip():
        raise UsageError(f"{option} {target!r} names no file; allowed: the path of a file")
    for scene in scenes:
        if Path(target).is_file() and Path(scene).is_file() and os.path.samefile(target, scene):
            raise UsageError(f"{option} {target} would overwrite the scene; give another file")


def load_scene(name: str) -> Scene:
    """Read a scene as the command line names it.

    Raises:
        SceneError: there is none, or it is not written as it must be.
    """
    if not name:
        raise SceneError("''", "", "names no scene", SCENE_HELP)
    if name != STANDARD_INPUT:
        return Scene.load(name)
    try:
        if sys.stdin is None:
            raise OSError("it is closed")
        return Scene.read(sys.stdin.buffer, STANDARD_INPUT_NAME)
    except (OSError, ValueError) as error:
        problem = getattr(error, "strerror", None) or str(error)
        raise SceneError(STANDARD_INPUT_NAME, "", f"cannot be read ({problem})", SCENE_HELP) from None
