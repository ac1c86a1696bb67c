"""What would explain a disagreement, once it is found; `diagnosis` finds it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Explanation:
    """What would explain that numbers disagree.

    Attributes:
        words: which numbers, and what was done to them.
        kind: of fault, as `diagnosis.kinds` calls it; two kinds joined by "and".
        quantities: whose numbers it explains: a quantity where it explains all that disagrees of it and
            undoes nothing that agrees, else quantity.name.
        leftover: the largest difference that is left when the fault is undone / what it is held to; more
            than 1 where it explains a part only.
    """

    words: str
    kind: str
    quantities: tuple[str, ...]
    leftover: float
