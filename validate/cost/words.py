"""Numbers and lists as people read them."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from textwrap import fill

WIDTH = 110  # columns of a terminal


def power(number: float) -> str:
    """A number with one digit, such as 1e-9."""
    mantissa, exponent = f"{number:.0e}".split("e")
    return f"{mantissa}e{int(exponent)}"


def listed(words: Sequence[str]) -> str:
    """Words as a person lists them."""
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}" if words else ""


def span(values: Iterable[float], words: Callable[[float], str]) -> str:
    """The least and the largest of some values in words, or the one that there is."""
    low, high = (words(end(values)) for end in (min, max))
    return low if low == high else f"{low} to {high}"


def times(ratio: float) -> str:
    """A ratio, to two digits."""
    return f"{float(f'{ratio:.2g}'):g}"


def duration(seconds: float) -> str:
    """Three digits and the unit that suits them."""
    unit, size = next(
        ((u, s) for u, s in (("s", 1.0), ("ms", 1e-3), ("us", 1e-6)) if seconds >= s * 0.9995), ("ns", 1e-9)
    )
    return f"{float(f'{seconds / size:.3g}'):g} {unit}"


def bytes_words(count: float) -> str:
    """Three digits and the unit that suits them."""
    unit, size = next(
        ((u, s) for u, s in (("GB", 1e9), ("MB", 1e6), ("kB", 1e3)) if count >= s * 0.9995), ("B", 1.0)
    )
    return f"{float(f'{count / size:.3g}'):g} {unit}"


def wrapped(text: str) -> str:
    """A paragraph for a terminal; lines after the first stand further in."""
    return fill(text, WIDTH, subsequent_indent="  ", break_long_words=False, break_on_hyphens=False)


def literal(text: str) -> str:
    """Text in which Markdown sees no marks of its own."""
    return re.sub(r"([*_<>|`\[\]])", r"\\\1", text)
