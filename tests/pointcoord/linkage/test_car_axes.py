"""Components along a car's directions, of a car that is turned about in space."""

from fractions import Fraction

import numpy as np
import pytest

from pointcoord.linkage.car_axes import CarAxes, Direction
from pointcoord.numerics.enclosure import Enclosed

UP, RIGHT = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
# Rearward is right x up = z x x = y. A left wheel: outboard is minus right.
COMPONENTS: dict[Direction, float] = {"up": 2.0, "rearward": 3.0, "outboard": -5.0}
COMPONENTS |= {"down": -2.0, "forward": -3.0, "inboard": 5.0}


@pytest.mark.parametrize("direction", COMPONENTS)
def test_components_along_each_direction_of_a_car(direction: Direction) -> None:
    axes = CarAxes(UP, RIGHT, -RIGHT)
    vector = np.array([2.0, 3.0, 5.0])
    assert axes.component(vector, direction) == COMPONENTS[direction]
    enclosed = axes.enclosed(Enclosed.of(vector), direction)
    assert enclosed.middle == COMPONENTS[direction]
    assert enclosed.radius[0] < 1e-28


def test_rearward_is_enclosed_as_the_exact_product_of_directions_that_are_rounded() -> None:
    up, right = np.array([0.1, -0.7, 0.9]), np.array([0.3, 0.6, -0.2])
    vector = np.array([0.7, 1.1, -1.3])
    found = CarAxes(up, right, right).enclosed(Enclosed.of(vector), "rearward")
    u, r, v = ([Fraction(x) for x in each.tolist()] for each in (up, right, vector))
    exact = sum(v[i] * (r[i - 2] * u[i - 1] - r[i - 1] * u[i - 2]) for i in range(3))
    error = abs(exact - Fraction(float(found.high)) - Fraction(float(found.low)))
    assert error <= found.radius[0] < 1e-29
