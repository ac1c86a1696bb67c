"""Groups of bodies that their rows fix one after the other.

The bodies of a group have as many rows among themselves, the chassis and the groups before as they have
freedoms: a driven link alone, then what hangs between such (Assur). A group's determinant changes its sign
where the assemblies of it meet, and so tells more than that of the Jacobian, which is the product of all.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components, maximum_bipartite_matching

from absolute.solution import Array

Places = NDArray[np.intp]


class Group(NamedTuple):
    """Places of its rows and columns, as many, in the Jacobian."""

    rows: Places
    columns: Places


def groups_of(first: Places, second: Places, bodies: int) -> list[Group]:
    """Groups of the moving bodies 1 .. bodies - 1, each as small as can be.

    Rows are matched with freedoms. A freedom then waits for all others in its row, and freedoms that wait for
    each other are a group (Dulmage and Mendelsohn, 1958). Where rows cannot be matched, all are one group:
    some body can still move.

    Args:
        first, second: the two bodies of each row.
    """
    numbers, freedoms = np.arange(len(first)), 6 * (bodies - 1)
    touched = np.zeros((len(first), bodies), dtype=np.bool_)
    touched[numbers, first] = touched[numbers, second] = True
    touched = np.repeat(touched[:, 1:], 6, axis=1)
    matched = maximum_bipartite_matching(csr_array(touched), perm_type="column")
    if len(first) != freedoms or (matched < 0).any():
        return [Group(numbers, np.arange(freedoms))]
    waits = np.zeros((freedoms, freedoms), dtype=np.bool_)
    waits[matched] = touched
    count, group = connected_components(csr_array(waits), connection="strong")
    return [Group(np.flatnonzero(group[matched] == k), np.flatnonzero(group == k)) for k in range(count)]


def signs_of(groups: list[Group], jacobian: Array) -> Array:
    """(..., groups) signs of the determinants of the blocks of Jacobians (..., rows, rows)."""
    blocks = (jacobian[..., rows[:, None], columns] for rows, columns in groups)
    return np.stack([np.sign(np.linalg.det(block)) for block in blocks], axis=-1)
