"""Text that stays text wherever it is shown."""

from __future__ import annotations


def shown(text: str) -> str:
    """Text on one line in which nothing acts on a terminal: control characters are shown as escapes."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in text)


def one_line(message: str) -> str:
    """A message without its line breaks."""
    return shown(" ".join(message.split()))
