"""Powers of several variables and their rates, in whole numbers that doubles hold exactly."""

from itertools import combinations_with_replacement

import numpy as np
import pytest
from numpy.polynomial import Polynomial
from numpy.typing import NDArray

from pointcoord.numerics.monomials import monomials

Array = NDArray[np.float64]
ORDER, COUNT = 4, 5


def by_hand(states: Array) -> list[Array]:
    """Values and derivatives at t = 0 of the powers of s + s' t + s'' t^2 / 2."""
    inputs = states.shape[1]
    found = []
    for degree in range(ORDER + 1):
        for chosen in combinations_with_replacement(range(inputs), degree):
            row = []
            for n in range(COUNT):
                law = Polynomial([1.0])
                for i in chosen:
                    law = law * Polynomial([states[0, i, n], states[1, i, n], 0.5 * states[2, i, n]])
                row.append([law(0.0), law.deriv()(0.0), law.deriv(2)(0.0)])
            found.append(row)
    return list(np.moveaxis(np.array(found), -1, 0))


@pytest.mark.parametrize("inputs", [1, 2, 3])
@pytest.mark.parametrize("rates", [0, 1, 2])
def test_powers_and_rates_are_those_of_the_product_rule(inputs: int, rates: int) -> None:
    states = np.random.default_rng(inputs).integers(-4, 5, (3, inputs, COUNT)).astype(float)
    wanted = by_hand(states)[: rates + 1]
    # Room for more derivatives and instants than are asked for, and none.
    for room in (np.full((rates + 4, len(wanted[0]), COUNT + 3), np.nan), None):
        found = monomials(list(states[: rates + 1]), ORDER, room)
        assert len(found) == rates + 1
        for mine, exact in zip(found, wanted, strict=True):
            assert np.array_equal(mine, exact)
