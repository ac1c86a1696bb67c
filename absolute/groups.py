"""Groups of bodies that their rows fix one after the other.

The bodies of a group have as many rows among themselves, the chassis and the groups before as they have
freedoms: a driven link alone, then what hangs between such (Assur). In this order of bodies and rows the
Jacobian is block triangular. A block's determinant changes its sign where the assemblies of its group meet,
and so tells more than that of the Jacobian, which is the product of all.
"""

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from absolute.solution import Array

Places = NDArray[np.intp]


class Groups(NamedTuple):
    """The order in which a Jacobian is block triangular.

    Attributes:
        rows, columns: places of the Jacobian's rows and columns in that order.
        ends: after how many each group ends.
    """

    rows: Places
    columns: Places
    ends: tuple[int, ...]

    @property
    def blocks(self) -> list[slice]:
        """Where each group is in that order."""
        return [slice(*ends) for ends in zip((0, *self.ends[:-1]), self.ends, strict=True)]


def groups_of(first: Places, second: Places, bodies: int) -> Groups:
    """Groups of the moving bodies 1 .. bodies - 1, each as small as can be.

    Six rows are matched with each body. A body then waits for all others in its own rows, and
    bodies that wait for each other are a group (Dulmage and Mendelsohn, 1958). Where rows cannot be matched,
    all are one group: some body can still move.

    Args:
        first, second: the two bodies of each row.
    """
    pairs = list(zip(first.tolist(), second.tolist(), strict=True))
    own: list[list[int]] = [[] for _ in range(bodies)]

    def matched(row: int, tried: set[int]) -> bool:
        """Whether a body of the row has a place for it, or one of its rows can go to another body."""
        for body in pairs[row]:
            if body and body not in tried:
                tried.add(body)
                if len(own[body]) < 6:
                    own[body].append(row)
                    return True
                for place, other in enumerate(own[body]):
                    if matched(other, tried):
                        own[body][place] = row
                        return True
        return False

    freedoms = 6 * (bodies - 1)
    if len(pairs) != freedoms or not all(matched(row, set()) for row in range(len(pairs))):
        whole = np.arange(freedoms)
        return Groups(np.arange(len(pairs)), whole, (freedoms,))
    waits = np.eye(bodies, dtype=np.bool_)
    for body, rows in enumerate(own):
        waits[body, [each for row in rows for each in pairs[row]]] = True
    waits[:, 0] = False
    for _ in range(bodies.bit_length()):  # also for those that these wait for
        waits = waits @ waits
    group = (waits & waits.T).argmax(axis=1)
    # Who waits for another waits for more bodies than that one.
    order = sorted(range(1, bodies), key=lambda body: (waits[body].sum(), group[body]))
    ends = [
        6 * place
        for place in range(1, bodies)
        if place == bodies - 1 or group[order[place]] != group[order[place - 1]]
    ]
    columns = np.add.outer(6 * (np.array(order) - 1), np.arange(6)).ravel()
    return Groups(np.array([row for body in order for row in own[body]]), columns, tuple(ends))


def signs_of(groups: Groups, jacobian: Array) -> Array:
    """(..., groups) signs of the determinants of the blocks of Jacobians (..., rows, rows)."""
    signs = np.empty((*jacobian.shape[:-2], len(groups.ends)))
    for numbers, places in _alike(groups.ends):
        blocks = jacobian[..., groups.rows[places][:, :, None], groups.columns[places][:, None, :]]
        signs[..., numbers] = np.sign(np.linalg.det(blocks))
    return signs


@cache
def _alike(ends: tuple[int, ...]) -> tuple[tuple[Places, Places], ...]:
    """Groups of one size together: their numbers (k,), and the places of each, (k, size)."""
    starts = np.array((0, *ends[:-1]))
    sizes = np.array(ends) - starts
    alike = [np.flatnonzero(sizes == size) for size in np.unique(sizes)]
    return tuple((numbers, np.add.outer(starts[numbers], np.arange(sizes[numbers[0]]))) for numbers in alike)
