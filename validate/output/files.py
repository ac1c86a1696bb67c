"""Atomic writing: a file is written under a temporary name in the same folder, and then renamed.

After a full disk, a kill or Ctrl-C the old file is still there, unchanged.
"""

from __future__ import annotations

import errno
import os
import secrets
import stat
from collections.abc import Callable, Iterable
from contextlib import suppress
from pathlib import Path
from typing import BinaryIO

from validate.errors import NotFinished, UsageError


def require_known_ending(target: str, endings: Iterable[str]) -> None:
    """Refuse a file name whose ending gives no known format.

    Raises:
        UsageError: the ending is not in `endings`.
    """
    if Path(target).suffix not in endings:
        raise UsageError(f"{target}: has no known ending; allowed: {', '.join(endings)}")


def unwritable(target: str, error: OSError) -> NotFinished:
    """The error for a target that the operating system cannot write."""
    hint = "; free some space, or write elsewhere" if error.errno in (errno.ENOSPC, errno.EDQUOT) else ""
    return NotFinished(target, f"cannot be written ({error.strerror or error}){hint}")


def require_writable(target: str) -> None:
    """Refuse a file that cannot be written, before anything is solved; an old file is not changed.

    Raises:
        NotFinished: the file cannot be written.
    """
    try:
        if not _is_special(target):
            beside = _beside(target)
            beside.touch(exist_ok=False)
            beside.unlink()
    except OSError as error:
        raise unwritable(target, error) from None


def write_whole(target: str, write: Callable[[BinaryIO], object]) -> None:
    """Write a file under a temporary name, sync it to the disk, and rename it to the target.

    The new file has the permissions of the old one; a symbolic link is kept. A pipe or a device cannot be
    replaced by renaming, and is written directly.

    Raises:
        NotFinished: the file cannot be written; an old file is unchanged.
    """
    try:
        if _is_special(target):
            with open(target, "wb") as stream:
                write(stream)
            return
        beside, place = _beside(target), Path(os.path.realpath(target))
        try:
            with beside.open("wb") as stream:
                write(stream)
                stream.flush()
                os.fsync(stream.fileno())
            if place.exists():
                beside.chmod(stat.S_IMODE(place.stat().st_mode))
            os.replace(beside, place)
        except BaseException:
            # Also after Ctrl-C: no temporary file stays behind.
            with suppress(OSError):
                beside.unlink()
            raise
        with suppress(OSError):
            # Sync the folder too, so that the new name is on the disk; some systems cannot open a folder.
            folder = os.open(place.parent, os.O_RDONLY)
            os.fsync(folder)
            os.close(folder)
    except OSError as error:
        raise unwritable(target, error) from None


def write_content(target: str, content: str | bytes) -> None:
    """Write a file with the given content, see `write_whole`.

    Raises:
        NotFinished: the file cannot be written; an old file is unchanged.
    """
    # The content may quote a file name with bytes that are not valid text.
    data = content.encode("utf-8", "backslashreplace") if isinstance(content, str) else content
    write_whole(target, lambda stream: stream.write(data))


def _is_special(target: str) -> bool:
    """Whether a target exists and is not a regular file, such as a pipe.

    Raises:
        OSError: the target is a folder, or a file without write permission.
    """
    if "\0" in target:
        raise OSError(errno.EINVAL, "a null character in its name")
    place = Path(target)
    if place.is_dir() or target.endswith(os.sep):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
    if place.is_file() and not os.access(place, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
    return place.exists() and not place.is_file()


def _beside(target: str) -> Path:
    """A new temporary file of a target; runs at the same time with this target have files of their own."""
    place = Path(os.path.realpath(target))
    if not place.parent.is_dir():
        raise FileNotFoundError(errno.ENOENT, f"there is no folder {str(place.parent)!r}")
    with suppress(FileNotFoundError):
        os.stat(place)  # raises OSError if the name is too long
    return place.with_name(f".pointcoord-{secrets.token_hex(4)}.part")
