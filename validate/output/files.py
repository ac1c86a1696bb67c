"""Files that are whole or not there: written beside their place under another name, and then renamed.

A full disk, a kill or Ctrl-C leaves what was there before.
"""

from __future__ import annotations

import errno
import os
import stat
from collections.abc import Callable, Iterable
from contextlib import suppress
from pathlib import Path
from typing import BinaryIO

from validate.errors import NotFinished, UsageError


def require_known_ending(target: str, endings: Iterable[str]) -> None:
    """Refuse a name whose ending does not say how to write the file.

    Raises:
        UsageError: it is none of these.
    """
    if Path(target).suffix not in endings:
        raise UsageError(f"{target}: has no known ending; allowed: {', '.join(endings)}")


def unwritable(target: str, error: OSError) -> NotFinished:
    """The error of a target that the operating system does not let us write."""
    hint = "; make room, or write elsewhere" if error.errno in (errno.ENOSPC, errno.EDQUOT) else ""
    return NotFinished(target, f"cannot be written ({error.strerror or error}){hint}")


def require_writable(target: str) -> None:
    """Refuse a file that cannot be written, before anything is solved; what is there stays as it is.

    Raises:
        NotFinished: it cannot be.
    """
    try:
        if not _is_special(target):
            beside = _beside(target)
            there = beside.exists()
            with beside.open("ab"):
                pass
            if not there:
                beside.unlink()
    except OSError as error:
        raise unwritable(target, error) from None


def write_whole(target: str, write: Callable[[BinaryIO], object]) -> None:
    """Write a file beside its place, bring it to the disk, and rename it into its place.

    A pipe or a device has no place to rename into and is written as it is.

    Raises:
        NotFinished: it cannot be written; what was there is whole.
    """
    try:
        if _is_special(target):
            with open(target, "wb") as stream:
                write(stream)
            return
        beside = _beside(target)
        try:
            with beside.open("wb") as stream:
                write(stream)
                stream.flush()
                os.fsync(stream.fileno())
            _replace(beside, Path(os.path.realpath(target)))
        except BaseException:
            # Ctrl-C as well: nothing half written stays behind.
            with suppress(OSError):
                beside.unlink()
            raise
    except OSError as error:
        raise unwritable(target, error) from None


def write_content(target: str, content: str | bytes) -> None:
    """Write a file of a content at hand, see `write_whole`.

    Raises:
        NotFinished: it cannot be written; what was there is whole.
    """
    # The name of a file may hold bytes that are no text.
    data = content.encode("utf-8", "backslashreplace") if isinstance(content, str) else content
    write_whole(target, lambda stream: stream.write(data))


def _replace(beside: Path, place: Path) -> None:
    """Rename a file into its place, with the rights of the one that is there; a link stays one."""
    if place.exists():
        beside.chmod(stat.S_IMODE(place.stat().st_mode))
    os.replace(beside, place)
    with suppress(OSError):
        # The name too is on the disk; a folder that cannot be opened for that keeps its old habits.
        folder = os.open(place.parent, os.O_RDONLY)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)


def _is_special(target: str) -> bool:
    """Whether a target is something else than a file, such as a pipe.

    Raises:
        OSError: it is a folder, or a file that may not be written.
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
    """Where a target is written first: what a kill leaves there goes when the same file is written again."""
    place = Path(os.path.realpath(target))
    if not place.parent.is_dir():
        raise FileNotFoundError(errno.ENOENT, f"there is no folder {str(place.parent)!r}")
    with suppress(FileNotFoundError):
        os.stat(place)  # a name that is too long is refused
    return place.with_name(f".pointcoord-{place.name[:200]}.part")
