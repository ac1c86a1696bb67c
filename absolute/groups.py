"""Groups of bodies that their rows fix one after the other.

The bodies of a group have as many rows among themselves, the chassis and the groups before as they have
freedoms: a driven link alone, then what hangs between such (Assur). A group's determinant changes its sign
where the assemblies of it meet, and so tells more than that of the Jacobian, which is the product of all.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Places = NDArray[np.intp]


class Group(NamedTuple):
    """Places of its rows and columns, as many, in the Jacobian."""

    rows: Places
    columns: Places


def groups_of(first: Places, second: Places, sizes: Places) -> list[Group]:
    """Groups of the moving bodies, each as small as can be.

    With each body as many rows are matched as it has freedoms. A body then waits for all others in its own
    rows, and bodies that wait for each other are a group (Dulmage and Mendelsohn, 1958). Where rows cannot be
    matched, all are one group: some body can still move.

    Args:
        first, second: the two bodies of each row. sizes: freedoms of each body, none of the chassis.
    """
    pairs, ends = list(zip(first.tolist(), second.tolist(), strict=True)), np.cumsum(sizes)
    own = _matched(pairs, sizes.tolist()) if len(pairs) == ends[-1] else None
    if own is None:
        return [Group(np.arange(len(pairs)), np.arange(ends[-1]))]
    waits = np.eye(len(sizes), dtype=np.bool_)
    for body, rows in enumerate(own):
        waits[body, [each for row in rows for each in pairs[row]]] = True
    waits[:, 0] = False
    for _ in range(len(sizes).bit_length()):  # also for those that these wait for
        waits = waits @ waits
    group = (waits & waits.T).argmax(axis=1)
    together = [np.flatnonzero(group == one) for one in np.unique(group[1:])]
    return [
        Group(
            np.sort(np.concatenate([own[body] for body in some])),
            np.concatenate([np.arange(ends[body] - sizes[body], ends[body]) for body in some]),
        )
        for some in together
    ]


def _matched(pairs: Sequence[tuple[int, int]], sizes: Sequence[int]) -> list[list[int]] | None:
    """Rows of each body, so many as its size, each row once, by augmenting paths; None if there are none."""
    own: list[list[int]] = [[] for _ in sizes]

    def placed(row: int, tried: set[int]) -> bool:
        """Whether a body of the row has a place for it, or one of its rows can go to another body."""
        for body in pairs[row]:
            if body and body not in tried:
                tried.add(body)
                if len(own[body]) < sizes[body]:
                    own[body].append(row)
                    return True
                for place, other in enumerate(own[body]):
                    if placed(other, tried):
                        own[body][place] = row
                        return True
        return False

    return own if all(placed(row, set()) for row in range(len(pairs))) else None
