"""The scenes of a folder."""

from __future__ import annotations

import os
from pathlib import Path

from validate.errors import UsageError


def scenes_below(folder: str) -> tuple[str, ...]:
    """The paths of all scene files (*.toml) in a folder and in those below it, sorted.

    Links to folders are not followed.

    Raises:
        UsageError: there is no such folder, a part of it cannot be read, or it holds no scene.
    """

    def stop(error: OSError) -> None:
        where = f" {error.filename!r}" if error.filename not in (None, folder) else ""
        raise _unusable(folder, f"cannot be read{where} ({error.strerror or error})") from None

    try:
        places = [(place, names) for place, _, names in os.walk(folder, onerror=stop)]
    except ValueError as error:  # a zero byte in the name
        raise _unusable(folder, f"names no folder ({error})") from None
    found = [Path(place, name) for place, names in places for name in names if name.endswith(".toml")]
    if not found:
        raise _unusable(folder, "holds no scene")
    return tuple(str(path) for path in sorted(found, key=lambda path: path.parts))


def _unusable(folder: str, problem: str) -> UsageError:
    return UsageError(f"--scenes-dir {folder}: {problem}; allowed: a folder with a .toml file below it")
