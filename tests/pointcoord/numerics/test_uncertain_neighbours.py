"""What uncertain coordinates make of neighbours that lie far from the pose whose inverse they share."""

from itertools import product

import numpy as np
import pytest

from pointcoord.numerics.neighbours import Terms
from pointcoord.numerics.quadratic import Product, quadratic_map


@pytest.mark.parametrize("way", [(1.0, 3.0), (3.0, 1.0), (-2.0, 0.0), (0.0, 2.0)])
def test_a_change_carries_the_uncertainty_of_the_other_factor(way: tuple[float, float]) -> None:
    # u + v w = 0 about v = w = 0, where neither doubt has any effect alone; y = (u, v, w, 0, 1).
    system = quadratic_map([(Product(1.0, (0, 3), (4, 3)), Product(1.0, (1, 3), (2, 3)))], 1, 5)
    anchor = np.array([[0.0, 0.0, 0.0, 0.0, 1.0]])
    doubt = np.array([0.05, 0.1])
    data = np.array([[0.0, *doubt, 0.0, 0.0]])
    change = np.zeros((4, 1, 2))
    change[1:3, 0, 1] = way
    terms = Terms.of(system, np.array([0, 1, 2]))
    found = terms.certify(anchor, np.zeros((1, 5)), data, change, np.zeros((1, 4)))
    u = -way[0] * way[1]
    worst = max(abs(-np.prod(way + doubt * signs) - u) for signs in product((-1.0, 1.0), repeat=2))
    # A hundredth of what the doubt grows by is to spare for its own rounding.
    assert worst <= found.spread[0, 0, 0] <= 1.02 * worst
    assert found.step[0, 0].tolist() == [0.0, -u]
