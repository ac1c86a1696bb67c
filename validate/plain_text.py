"""Makes text safe and short enough to print."""

from __future__ import annotations

import shlex
from collections.abc import Iterable, Sequence
from typing import TypeVar

from pointcoord.errors import visible

Key = TypeVar("Key")
One = TypeVar("One")


def shown(text: str) -> str:
    """Text on one line, with control characters as escapes, so that none acts on the terminal."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in text)


def typed(path: str) -> str:
    """A path as a shell takes it, on one line: in quotes if it has blanks, quotes or the like."""
    return shlex.quote(shown(path))


def counted_as(count: int, noun: str) -> str:
    """A count with its noun: 1 instant, 2,000 instants."""
    return f"{count:,} {noun}" if count == 1 else f"{count:,} {noun}s"


def some_of(words: Sequence[str], most: int) -> str:
    """The first `most` words, and the number of the others."""
    more = f" and {len(words) - most} more" if len(words) > most else ""
    return ", ".join(words[:most]) + more


def gathered(pairs: Iterable[tuple[Key, One]]) -> dict[Key, list[One]]:
    """Group the second parts of pairs by the first; both keep their order."""
    found: dict[Key, list[One]] = {}
    for key, one in pairs:
        found.setdefault(key, []).append(one)
    return found


def named(error: BaseException) -> str:
    """The class and the message of an error, on one line."""
    words = " ".join(str(error).split())
    return f"{type(error).__name__}: {words}" if words else type(error).__name__


def one_line(message: str) -> str:
    """A message without line breaks, with any word longer than a line shortened."""
    return visible(" ".join(message.split()))
