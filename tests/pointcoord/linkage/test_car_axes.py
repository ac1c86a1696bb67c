"""Components along a car's directions, of a car that is turned about in space."""

import numpy as np
import pytest

from pointcoord.linkage.car_axes import CarAxes, Direction
from pointcoord.numerics.enclosure import Enclosed

# Up is x, right is z: rearward is right x up = z x x = y. A left wheel: outboard is minus right.
AXES = CarAxes(np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0]), np.array([0.0, 0.0, -1.0]))


@pytest.mark.parametrize(
    ("direction", "component"),
    [("up", 2.0), ("down", -2.0), ("rearward", 3.0), ("forward", -3.0), ("outboard", -5.0), ("inboard", 5.0)],
)
def test_components_along_each_direction_of_a_car(direction: Direction, component: float) -> None:
    vector = np.array([2.0, 3.0, 5.0])
    assert AXES.component(vector, direction) == component
    enclosed = AXES.enclosed(Enclosed.of(vector), direction)
    assert enclosed.middle == component
    assert enclosed.radius[0] < 1e-28
