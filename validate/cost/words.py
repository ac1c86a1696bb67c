"""Numbers and lists as people read them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence

SECONDS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
BYTES = {"GB": 1e9, "MB": 1e6, "kB": 1e3, "B": 1.0}


def in_units(value: float, units: Mapping[str, float]) -> str:
    """Three digits and the unit that suits them; units from the largest."""
    unit = next((unit for unit, size in units.items() if value >= 0.9995 * size), [*units][-1])
    return f"{float(f'{value / units[unit]:.3g}'):g} {unit}"


def duration(seconds: float) -> str:
    """A time, such as 14.3 us."""
    return in_units(seconds, SECONDS)


def power(number: float) -> str:
    """A number with one digit, such as 1e-9."""
    mantissa, exponent = f"{number:.0e}".split("e")
    return f"{mantissa}e{int(exponent)}"


def times(ratio: float) -> str:
    """A ratio, to two digits."""
    return f"{float(f'{ratio:.2g}'):g}"


def listed(words: Sequence[str]) -> str:
    """Words as a person lists them."""
    return " and ".join(filter(None, (", ".join(words[:-1]), *words[-1:])))


def span(values: Iterable[float], words: Callable[[float], str]) -> str:
    """The least and the largest of some values in words, or the one that there is."""
    ends = [*values]
    return " to ".join(dict.fromkeys((words(min(ends)), words(max(ends)))))
