"""Text that stays text wherever it is shown."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from pointcoord.errors import visible


def shown(text: str) -> str:
    """Text on one line in which nothing acts on a terminal: control characters are shown as escapes."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in text)


def some_of(words: Sequence[str], most: int) -> str:
    """The first of many, and how many more there are."""
    more = f" and {len(words) - most} more" if len(words) > most else ""
    return ", ".join(words[:most]) + more


def gathered(pairs: Iterable[tuple[str, str]]) -> dict[str, list[str]]:
    """Second words under the first ones that they stand with, both in their order."""
    found: dict[str, list[str]] = {}
    for key, word in pairs:
        found.setdefault(key, []).append(word)
    return found


def one_line(message: str) -> str:
    """A message without its line breaks, and with no word that is longer than a line."""
    return visible(" ".join(message.split()))
