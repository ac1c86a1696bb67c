"""Which of our numbers other programs and standards mean by a name, where that is not ours of the name.

A convention changes no number: it says which of ours carries the name, and whether it counts the other way.
What a scene gives and what is compared has one meaning, so that two people who write "camber" mean the same.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from pointcoord.effects.numbers import TABLES, WAYS

ConventionName = Literal["iso", "paper", "lotus", "optimumk", "adams"]


@dataclass(frozen=True)
class Convention:
    """Names that mean others of our numbers.

    Attributes:
        means: by name, our number of that meaning; a minus before it where it counts the other way.
    """

    means: Mapping[str, str]

    def number(self, name: str) -> tuple[str, int]:
        """Our number of a name, which may be a part's or a gradient's, and its sign.

        >>> CONVENTIONS["optimumk"].number("left.toe_by_travel")
        ('left.toe_by_arcsine_by_travel', -1)
        """
        part, dot, own = name.rpartition(".")
        way = next((f"_{way}" for way in WAYS if own.endswith(f"_{way}")), "")
        plain = own.removesuffix(way)
        meant = self.means.get(plain, plain)
        return f"{part}{dot}{meant.removeprefix('-')}{way}", -1 if meant.startswith("-") else 1


CONVENTIONS: Mapping[ConventionName, Convention] = {
    name: Convention(means) for name, means in TABLES["conventions"].items()
}
"""By name."""
