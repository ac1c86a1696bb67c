"""Camber and kingpin angle on geometry drawn by hand, and in the mirror."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pointcoord.effects.angle import Angle
from pointcoord.effects.camber import LEAN as CAMBER
from pointcoord.effects.wheel_angles import KINGPIN
from pointcoord.linkage.car_axes import CarAxes

EPS = np.finfo(float).eps
UP, RIGHTWARD = np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0])
LEFT, RIGHT = CarAxes(UP, RIGHTWARD, -RIGHTWARD), CarAxes(UP, RIGHTWARD, RIGHTWARD)
coordinate = st.floats(-500.0, 500.0, allow_subnormal=False)
point = st.tuples(coordinate, coordinate, coordinate).map(np.array)


@pytest.mark.parametrize("degrees", [-20.0, -3.0, 0.0, 5.0, 12.5, 45.0])
@pytest.mark.parametrize("caster", [0.0, 40.0])
def test_kingpin_is_the_lean_of_the_axis_inboard_at_the_top(degrees: float, caster: float) -> None:
    lean = np.deg2rad(degrees)
    lower = np.array([10.0, -600.0, 100.0])
    # Left wheel: inboard is +y. Caster, along x, is not seen in the transverse plane.
    upper = lower + 300.0 * np.array([0.0, np.sin(lean), np.cos(lean)]) + [caster, 0.0, 0.0]
    # A few roundings of coordinates up to 600 over the length of 300.
    assert KINGPIN.value(lower, upper, LEFT) == pytest.approx(lean, abs=16 * EPS * 600 / 300)


@pytest.mark.parametrize("degrees", [-20.0, -3.0, 0.0, 5.0, 12.5, 45.0])
@pytest.mark.parametrize("toe", [0.0, 40.0])
def test_camber_is_the_lean_of_the_wheel_outwards_at_the_top(degrees: float, toe: float) -> None:
    lean = np.deg2rad(degrees)
    # A wheel that leans out at the top has a spin axis that points down on its way outboard (-y).
    inner = np.array([10.0, -500.0, 300.0])
    centre = inner + 90.0 * np.array([0.0, -np.cos(lean), -np.sin(lean)]) + [toe, 0.0, 0.0]
    # A few roundings of coordinates up to 590 over the length of 90.
    assert CAMBER.value(inner, centre, LEFT) == pytest.approx(lean, abs=16 * EPS * 590 / 90)


@settings(deadline=None)
@given(first=point, second=point)
def test_mirrored_wheel_has_the_same_angles(first: np.ndarray, second: np.ndarray) -> None:
    mirror = np.array([1.0, -1.0, 1.0])
    for angle in (KINGPIN, CAMBER):
        # A change of sign rounds nothing.
        assert angle.value(first * mirror, second * mirror, RIGHT) == angle.value(first, second, LEFT)


@settings(deadline=None)
@given(first=point, second=point, power=st.integers(-30, 30))
def test_angles_do_not_depend_on_size(first: np.ndarray, second: np.ndarray, power: int) -> None:
    for angle in (KINGPIN, CAMBER):
        assert angle.value(np.ldexp(first, power), np.ldexp(second, power), LEFT) == angle.value(
            first, second, LEFT
        )


def test_angles_of_many_poses_are_those_of_each() -> None:
    first, second = np.random.default_rng(1).normal(size=(2, 4, 3))
    for angle in (KINGPIN, CAMBER):
        together = angle.value(first, second, LEFT)
        assert together.shape == (4,)
        # The same products, which may be summed in another order.
        alone = [float(angle.value(a, b, LEFT)) for a, b in zip(first, second, strict=True)]
        assert np.abs(together - alone).max() <= 16 * EPS


def test_paper_formulas_for_the_left_wheel() -> None:
    p5, p7, p10 = (
        np.array([450.0, -330.0, -40.0]),
        np.array([452.0, -320.0, 20.0]),
        np.array([452.0, -410.0, 25.0]),
    )
    # eqs. (16) and (17), in the quadrant where the arc tangent is its own branch
    assert KINGPIN.value(p5, p7, LEFT) == pytest.approx(np.arctan(10.0 / 60.0), abs=4 * EPS)
    assert CAMBER.value(p7, p10, LEFT) == pytest.approx(np.arctan(-5.0 / 90.0), abs=4 * EPS)


def test_an_angle_that_names_no_limit_never_looks_misdrawn() -> None:
    free = Angle("lean", "lean", "up", "wheel_axis", "up", "outboard")
    # atan2 gives no more than pi.
    assert free.steepest >= 180.0
    assert free.steepest_by_default >= 180.0
