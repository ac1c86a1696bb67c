"""Values as messages show them, and suggestions for misspelt names."""

from __future__ import annotations

from collections.abc import Iterable

from pointcoord.errors import LONGEST


def shown(value: object) -> str:
    """A value in at most 60 characters."""
    try:
        text = repr(value)
    except (ValueError, RecursionError):
        # Whole numbers of thousands of digits, and lists in lists hundreds deep, have no text in Python.
        return f"something too long to show ({type(value).__name__})"
    return text if len(text) <= LONGEST else text[: LONGEST - 3] + "..."


def meant(name: str, known: Iterable[str]) -> str:
    """The suggestion that follows an unknown name in a message; empty if no known name is near."""
    near = nearest(name, known)
    return f" (did you mean {near!r}?)" if near else ""


def nearest(name: str, known: Iterable[str]) -> str:
    """The known name that is nearest to a misspelt one; empty if none is near."""
    # Imported here: few names are misspelt.
    from difflib import get_close_matches

    near = get_close_matches(name.lower(), tuple(known), n=1)
    return near[0] if near else ""


def shown_key(key: int | str) -> str:
    """A key or an index in a list, in at most 60 characters."""
    text = str(key)
    return text if len(text) <= LONGEST else text[: LONGEST - 3] + "..."
