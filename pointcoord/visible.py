"""Text of a user shown as text: what would steer a terminal is spelled out."""

from __future__ import annotations


def visible(text: str) -> str:
    r"""The text with each character that does not print as its escape, such as \x1b, \n or \u202e.

    These are the controls, the marks that turn the direction of writing, the separators but for the space,
    and halves of characters, which file names may hold. What prints stays as it is.
    """
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in text)
