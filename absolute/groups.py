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
    of_column = np.repeat(np.arange(len(sizes)), sizes)
    touched = csr_array((of_column == first[:, None]) | (of_column == second[:, None]))
    column = maximum_bipartite_matching(touched, perm_type="column")
    if len(first) != len(of_column) or (column < 0).any():
        return [Group(np.arange(len(first)), np.arange(len(of_column)))]
    own, waits = of_column[column], np.zeros((len(sizes), len(sizes)))
    waits[own, first] = waits[own, second] = 1.0
    group = connected_components(csr_array(waits), connection="strong")[1]
    return [
        Group(np.flatnonzero(group[own] == one), np.flatnonzero(group[of_column] == one))
        for one in dict.fromkeys(group[1:])
    ]
