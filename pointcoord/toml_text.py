"""Reads the text of a scene from a file or a stream, up to a largest size, and parses it as TOML."""

from __future__ import annotations

import os
import stat
import sys
from pathlib import Path
from typing import IO, Any

from pointcoord.errors import SceneError

# 64 MB hold a table of some two million rows; anything longer is not a scene, or is endless.
LARGEST = 64_000_000  # bytes


def read_file(path: str | Path, allowed: str) -> bytes:
    """The bytes of a file.

    Args:
        allowed: what the message says is allowed if the path cannot be read.
    Raises:
        SceneError: the file cannot be read, is not a regular file (a device or a pipe may be endless, or
            never send anything), or is larger than a scene may be.
    """
    source = str(path)
    try:
        if not stat.S_ISREG(os.stat(path).st_mode) and not os.path.isdir(path):
            raise SceneError(source, "", "is a device, a pipe or a socket", "a regular file")
        with open(path, "rb") as stream:
            return read_stream(stream, source)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise SceneError(source, "", f"cannot be read ({reason})", allowed) from None


def read_stream(stream: IO[bytes], source: str) -> bytes:
    """All bytes of a stream, read up to the size of the largest scene.

    Raises:
        SceneError: the stream is longer, or cannot be read.
    """
    pieces, left = [], LARGEST + 1
    try:
        # An unbuffered stream returns what is available, and nothing at its end.
        while left and (piece := stream.read(left)):
            pieces.append(piece)
            left -= len(piece)
    except OSError as error:
        raise SceneError(source, "", f"cannot be read ({error.strerror})") from None
    if not left:
        raise SceneError(source, "", "has no end within 64 MB", "at most 64 MB")
    return b"".join(pieces)


def parsed(text: bytes, source: str) -> dict[str, Any]:
    """TOML in UTF-8, with or without a byte order mark, as plain data.

    Raises:
        SceneError: the text is not TOML in UTF-8.
    """
    # Imported here: a scene need not come from a file.
    import tomllib

    try:
        return tomllib.loads(text.decode("utf-8-sig"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, RecursionError) as error:
        raise SceneError(source, "", f"is not TOML: {error}", "TOML 1.0 in UTF-8") from None
    except ValueError:
        # Python's own limit, which `tomllib` passes on.
        digits = sys.get_int_max_str_digits()
        raise SceneError(
            source, "", "a whole number has too many digits", f"at most {digits} digits"
        ) from None
