"""Reads values that the command line gives as a range or a list."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pointcoord import WrongArgument
from validate.arrays import Array
from validate.plain_text import shown

MOST_VALUES = 10_000_000


def values_of(what: str, text: str, examples: str) -> Array:
    """START:STOP:COUNT or A,B,C as finite numbers.

    Args:
        what: the option that gives them, for messages.
        examples: what is allowed, for messages.
    Raises:
        WrongArgument: the text is neither.
    """
    parts = text.split(":")
    if len(parts) == 1:
        return finite(what, text.split(","), examples)
    count = parts[-1].strip()
    if len(parts) != 3 or not (count.isascii() and count.isdigit() and 1 <= int(count) <= MOST_VALUES):
        raise WrongArgument(what, "is not a range", f"START:STOP:COUNT, with a COUNT of 1 to {MOST_VALUES}")
    start, stop = finite(what, parts[:2], examples).tolist()
    if int(count) == 1 and start != stop:
        raise WrongArgument(
            what, "has COUNT 1 but START and STOP differ", "START = STOP, or a COUNT of 2 or more"
        )
    return np.linspace(start, stop, int(count))


def finite(what: str, texts: Sequence[str], examples: str) -> Array:
    """Finite numbers from their texts.

    Args:
        what, examples: see `values_of`.
    Raises:
        WrongArgument: a text is not a finite number.
    """
    found = []
    for text in texts:
        try:
            found.append(float(text))
        except ValueError:
            raise WrongArgument(what, f"has {shown(text)!r}, which is not a number", examples) from None
    if not np.isfinite(found).all():
        raise WrongArgument(what, "has a number that is not finite", examples)
    return np.array(found)
