"""Conventions: which of pointcoord's numbers other programs and standards mean by a name.

A convention changes no number. It says which number a name stands for, and whether its sign is reversed. In
scenes and comparisons every name has one meaning, so that two people who write "camber" mean the same.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from pointcoord.effects.numbers import TABLES, WAYS

ConventionName = Literal["iso", "paper", "lotus", "optimumk", "adams"]


@dataclass(frozen=True)
class Convention:
    """Names that stand for other numbers of pointcoord in a program or standard.

    Attributes:
        means: name -> pointcoord's number of that meaning, with a minus in front if the sign is reversed.
    """

    means: Mapping[str, str]

    def number(self, name: str) -> tuple[str, int]:
        """The number that a name stands for, and its sign; the name may be a part's or a gradient's.

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
"""The conventions by name."""
