"""Shipped cars that arm angle and rack drive, one of each suspension and closure, for tests of all."""

import pytest

CARS = ("bounce", "off-axis-strut", "double-wishbone")
by_car = pytest.mark.parametrize("car", CARS)
by_drawn_car = pytest.mark.parametrize("car", CARS[1:])
