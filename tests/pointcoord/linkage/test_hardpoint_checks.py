"""Hardpoints put on a topology: what is refused, and that no place costs a digit."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pointcoord import MechanismError, Scene
from pointcoord.linkage.hardpoints import build_mechanism
from pointcoord.mechanism import mechanism_file

COLLINEAR = mechanism_file("macpherson").topology(Scene.load("bounce").mechanism.points, "collinear")
Points = dict[str, tuple[float, float, float]]
AXES = {"up": (0.0, 0.0, 1.0), "right": (0.0, 1.0, 0.0)}


@pytest.mark.parametrize("size", [0.0, 1e-110, 1e308])
def test_car_without_a_usable_size_is_refused(table: Points, size: float) -> None:
    points = {name: tuple(size * np.sign(place)) for name, place in table.items()}
    with pytest.raises(MechanismError, match="the points span"):
        build_mechanism(COLLINEAR, points, AXES)


far = st.floats(-1e12, 1e12, allow_subnormal=False)


@settings(deadline=None)
@given(shift=st.tuples(far, far, far), seed=st.integers(0, 2**32 - 1))
def test_origin_and_size_are_taken_off_without_rounding(
    table: Points, shift: tuple[float, float, float], seed: int
) -> None:
    rng = np.random.default_rng(seed)
    # What the user gives is rounded at its distance; from there on nothing is lost.
    points = {name: np.array(p) + rng.normal(size=3) + np.array(shift) for name, p in table.items()}
    try:
        mechanism = build_mechanism(COLLINEAR, points, AXES)
    except MechanismError:
        # so far out that rounding has put two points together or in line
        assert max(abs(s) for s in shift) > 1e11
        return
    unit, origin = Fraction(float(mechanism.unit)), mechanism.origin
    for name, place in points.items():
        own = mechanism.drawing.vectors[name]
        for axis in range(3):
            assert Fraction(own[axis]) * unit + Fraction(origin[axis]) == Fraction(place[axis])
        assert np.abs(own).max() < 8.0  # the origin lies near the car, within four of its sizes
