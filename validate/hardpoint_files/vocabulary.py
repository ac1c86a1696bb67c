"""Names of points in many words: `LCA_IN_FRONT` and `Lower wishbone, front pivot` are one point.

A name is brought to few words, in the order of the alphabet. Two names are one if these are the same: a word
too many, such as that of a damper, is another point, and so is one said twice, as in `Rear upper rear pivot`.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass

from validate.hardpoint_files.contents import plain


@dataclass(frozen=True)
class Vocabulary:
    """What other words are for ours.

    Attributes:
        phrases: our words for others, each a few words; none for words that say nothing.
    """

    phrases: Mapping[tuple[str, ...], tuple[str, ...]]

    @classmethod
    def of(cls, others: Mapping[str, list[str]]) -> Vocabulary:
        """From our words with others for each; words that say nothing are others for the empty text."""
        return cls(
            {tuple(plain(theirs).split()): tuple(ours.split()) for ours in others for theirs in others[ours]}
        )

    def words(self, name: str) -> tuple[str, ...]:
        """A name in our words, in order; numbers count where there is nothing else."""
        apart = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name)
        left = plain(apart).split()
        longest = max(map(len, self.phrases), default=1)
        found: list[str] = []
        while left:
            size = next(
                (n for n in range(min(longest, len(left)), 0, -1) if tuple(left[:n]) in self.phrases), 0
            )
            found += self.phrases[tuple(left[:size])] if size else left[:1]
            left = left[max(size, 1) :]
        return tuple(sorted([word for word in found if not word.isdigit()] or found))
