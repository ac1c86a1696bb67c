"""What every command shares: the mistakes of a command line, and where scenes come from."""

from __future__ import annotations

import os
import stat
import sys
from pathlib import Path

from pointcoord import Scene, SceneError

STANDARD_INPUT = "-"
STANDARD_INPUT_NAME = "standard input"
SCENE_HELP = "a built-in scene's name, the path of a scene file, or - for standard input"


class UsageError(Exception):
    """The command line is wrong."""


def require_target(target: str | None, option: str, scenes: tuple[str, ...] = ()) -> None:
    """Find a target that is no name, or that is one of the scenes, or where the text goes already.

    Raises:
        UsageError: it is.
    """
    if target is None:
        return
    if not target.strip():
        raise UsageError(
            f"{option} {target!r} names no file; allowed: the path of a file, or - for standard output"
        )
    if _is_standard_output(target):
        raise UsageError(f"{option} {target} is standard output; use {option} - for that")
    for scene in scenes:
        if Path(target).is_file() and Path(scene).is_file() and os.path.samefile(target, scene):
            raise UsageError(f"{option} {target} would overwrite the scene; give another file")


def _is_standard_output(target: str) -> bool:
    """Whether a file or pipe is standard output by another name; a terminal or /dev/null may be both."""
    try:
        out, place = os.fstat(1), os.stat(target)
    except (OSError, ValueError):
        return False
    return os.path.samestat(out, place) and not stat.S_ISCHR(out.st_mode)


def load_scene(name: str) -> Scene:
    """Read a scene as the command line names it.

    Raises:
        SceneError: there is none, or it is not written as it must be.
    """
    if not name:
        raise SceneError("''", "", "names no scene", SCENE_HELP)
    if name != STANDARD_INPUT:
        return Scene.load(name)
    if sys.stdin is None:
        raise SceneError(STANDARD_INPUT_NAME, "", "cannot be read (it is closed)", SCENE_HELP)
    return Scene.read(sys.stdin.buffer, STANDARD_INPUT_NAME)
