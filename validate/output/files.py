"""Files that are whole or not there: written beside their place under another name, and then renamed.

A full disk, a kill or Ctrl-C leaves what was there before. What a kill leaves half written goes when the
next run asks whether it can write there.
"""

from __future__ import annotations

import errno
import fcntl
import os
import stat
from collections.abc import Callable, Iterable
from contextlib import suppress
from pathlib import Path
from typing import BinaryIO

from validate.errors import UsageError

PART = ".pointcoord-{}.part"
"""The name of what is being written."""


class OutputError(Exception):
    """A result cannot be written where it was asked for.

    Args:
        target: the file, or `standard output`.
        problem: why not.
    """

    def __init__(self, target: str, problem: str) -> None:
        self.target = target
        self.problem = problem
        super().__init__(f"{target}: {problem}")


def require_known_ending(target: str, endings: Iterable[str]) -> None:
    """Refuse a name whose ending does not say how to write the file.

    Raises:
        UsageError: it is none of these.
    """
    if Path(target).suffix not in endings:
        raise UsageError(f"{target}: has no known ending; allowed: {', '.join(endings)}")


def unwritable(target: str, error: OSError) -> OutputError:
    """The error of a target that the operating system does not let us write."""
    hint = "; make room, or write elsewhere" if error.errno in (errno.ENOSPC, errno.EDQUOT) else ""
    return OutputError(target, f"cannot be written ({error.strerror or error}){hint}")


def require_writable(target: str) -> None:
    """Refuse a file that cannot be written, before anything is solved; what is there stays as it is.

    Raises:
        OutputError: it cannot be.
    """
    try:
        if not _is_special(target):
            descriptor, beside = _open_beside(target)
            os.close(descriptor)
            beside.unlink()
            remove_left_over(beside.parent)
    except OSError as error:
        raise unwritable(target, error) from None


def remove_left_over(folder: Path) -> None:
    """Remove what runs that were killed have left half written in a folder.

    A file that is being written is locked by who writes it, and the lock goes with the process.
    """
    for path in folder.glob(PART.format("*")):
        # Gone meanwhile, another user's, being written, or on a disk that knows no locks: it stays.
        with suppress(OSError), path.open("r+b") as stream:  # network disks lock only what can be written
            fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
            path.unlink()


def write_whole(target: str, write: Callable[[BinaryIO], object]) -> None:
    """Write a file beside its place, bring it to the disk, and rename it into its place.

    A pipe or a device has no place to rename into and is written as it is.

    Raises:
        OutputError: it cannot be written; what was there is whole.
    """
    try:
        if _is_special(target):
            with open(target, "wb") as stream:
                write(stream)
            return
        _write_beside(target, write)
    except OSError as error:
        raise unwritable(target, error) from None


def write_content(target: str, content: str | bytes) -> None:
    """Write a file of a content at hand, see `write_whole`.

    Raises:
        OutputError: it cannot be written; what was there is whole.
    """
    # The name of a file may hold bytes that are no text.
    data = content.encode("utf-8", "backslashreplace") if isinstance(content, str) else content
    write_whole(target, lambda stream: stream.write(data))


def _write_beside(target: str, write: Callable[[BinaryIO], object]) -> None:
    descriptor, beside = _open_beside(target)
    try:
        with open(descriptor, "wb") as stream:
            write(stream)
            stream.flush()
            os.fsync(stream.fileno())
            # Before it is closed, which ends its lock.
            os.replace(beside, _place(target))
    except BaseException:
        # Ctrl-C as well: nothing half written stays behind.
        with suppress(OSError):
            beside.unlink()
        raise
    with suppress(OSError):
        # The name too is on the disk; a folder that cannot be opened for that keeps its old habits.
        folder = os.open(_place(target).parent, os.O_RDONLY)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)


def _place(target: str) -> Path:
    """Where the file really is: a link stays a link to it."""
    return Path(os.path.realpath(target))


def _is_special(target: str) -> bool:
    """Whether a target is something else than a file, such as a pipe; a folder is no target at all."""
    try:
        mode = os.stat(target).st_mode
    except FileNotFoundError:
        mode = 0
    except ValueError as error:
        # A path with a zero byte in it.
        raise OSError(errno.EINVAL, str(error)) from None
    if stat.S_ISDIR(mode) or target.endswith(os.sep):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
    return bool(mode) and not stat.S_ISREG(mode)


def _open_beside(target: str) -> tuple[int, Path]:
    """A new file in the folder of the target, with the rights of the one that is there."""
    place = _place(target)
    mode = stat.S_IMODE(place.stat().st_mode) if place.exists() else None
    if mode is not None and not os.access(place, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
    if mode is None:
        _require_name(place)
    beside = place.parent / PART.format(f"{os.getpid()}-{os.urandom(4).hex()}")
    descriptor = os.open(beside, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666)
    with suppress(OSError):  # A disk that knows no locks: nothing is removed there.
        fcntl.flock(descriptor, fcntl.LOCK_EX)
    if not beside.exists():
        # Removed by another run before it was locked.
        os.close(descriptor)
        return _open_beside(target)
    if mode is not None:
        with suppress(OSError):
            os.fchmod(descriptor, mode)
    return descriptor, beside


def _require_name(place: Path) -> None:
    """Refuse a folder that is not there, and a name that it does not take, such as one that is too long."""
    if not place.parent.is_dir():
        raise FileNotFoundError(errno.ENOENT, f"there is no folder {str(place.parent)!r}")
    with suppress(FileNotFoundError):
        os.stat(place)
