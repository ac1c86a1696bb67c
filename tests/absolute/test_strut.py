"""The strut whose axis passes beside its ball joint: the car that is drawn is the car that is solved."""

from collections.abc import Callable

import numpy as np
import pytest
import strut_motion as form
import struts
from flat import built_in
from numpy.typing import NDArray

import absolute

Array = NDArray[np.float64]
Held = Callable[[float, float], dict[str, Array]]
Table = dict[str, tuple[float, float, float]]
EPS = float(np.finfo(float).eps)
SIZE = 500.0


def with_rack(car: dict[str, Array]) -> dict[str, Array]:
    """The default of the rack's line, written out."""
    return {"rack_centre": car["tie_rod_inner"], **car}


@pytest.mark.parametrize("seed", range(12))
def test_a_collinear_strut_that_closes_moves_the_same_under_both_closures(seed: int) -> None:
    car = struts.collinear_strut(seed)
    angle, rack = form.drawn_inputs(with_rack(car))
    t = np.linspace(0.0, 1.0, 5)
    inputs = {
        "arm_angle": np.stack([angle + 0.2 * t, np.full_like(t, 0.2), 0 * t], -1),
        "rack": np.stack([rack + 20 * t, np.full_like(t, 20.0), 0 * t], -1),
    }
    drawn, collinear = (
        absolute.solve(built_in("macpherson", car, closure=closure), inputs, conditions=True)
        for closure in ("drawn", "collinear")
    )
    assert drawn.condition is not None
    # The ball joint is on the axis to rounding of its coordinates; its lever to the top mount, five
    # times the strut's lower part, magnifies that. Then two solutions.
    tolerance = (5 + 2) * EPS * SIZE * drawn.condition.max()
    for name in car:
        for a, b in (
            (drawn.position, collinear.position),
            (drawn.velocity, collinear.velocity),
            (drawn.acceleration, collinear.acceleration),
        ):
            assert np.allclose(a[name], b[name], rtol=0, atol=tolerance), name


def test_the_rod_end_is_put_on_the_axis_at_its_distance_and_on_its_side(held: Held) -> None:
    car = struts.off_axis_strut(3)
    top, low = car["strut_top"], car["strut_lower"]
    axis = (top - low) / np.linalg.norm(top - low)
    for along in (-150.0, -10.0, 10.0, 150.0):
        off = np.cross(axis, [1.0, 0.0, 0.0]) * 9.0
        length = float(np.hypot(along, np.linalg.norm(off)))
        closed = absolute.close_drawing(
            built_in("macpherson", {**car, "strut_rod_end": top + along * axis + off})
        )
        wanted = top + np.copysign(length, along) * axis
        assert np.allclose(closed.position["strut_rod_end"], wanted, rtol=0, atol=60 * EPS * SIZE)
        others = {name: move for name, move in closed.movement.items() if name != "strut_rod_end"}
        assert max(others.values()) <= 60 * EPS * SIZE


def test_the_inner_tie_rod_end_is_put_on_the_line_of_the_rack() -> None:
    car = struts.off_axis_strut(3)
    away = np.array([3.0, 25.0, -4.0])
    closed = absolute.close_drawing(
        built_in("macpherson", {**car, "rack_centre": car["tie_rod_inner"] + away})
    )
    wanted = car["tie_rod_inner"] + away * [1, 0, 1]
    assert np.allclose(closed.position["tie_rod_inner"], wanted, rtol=0, atol=60 * EPS * SIZE)
    assert closed.movement["lower_ball_joint"] <= 60 * EPS * SIZE
    assert closed.movement["tie_rod_outer"] > 0.01


def test_the_rack_passes_through_the_drawn_tie_rod_where_no_centre_is_given(table: Table, held: Held) -> None:
    bare = {name: place for name, place in table.items() if name != "rack_centre"}
    model = built_in("macpherson", bare, closure="collinear")
    assert model.points["rack_centre"] == table["tie_rod_inner"]
    given = absolute.solve(built_in("macpherson", table, closure="collinear"), held(1.6, 5.0))
    for name, place in absolute.solve(model, held(1.6, 5.0)).position.items():
        assert (place == given.position[name]).all()


def test_the_inner_point_of_the_spin_axis_rides_on_the_knuckle_and_changes_nothing_else(
    table: Table, held: Held
) -> None:
    car = {**table, "wheel_axis_inner": (452.0, -340.0, 18.0)}
    plain = absolute.solve(built_in("macpherson", table, closure="collinear"), held(1.6, 5.0))
    motion = absolute.solve(built_in("macpherson", car, closure="collinear"), held(1.6, 5.0))
    for name, place in plain.position.items():
        assert np.allclose(motion.position[name], place, rtol=0, atol=60 * EPS * SIZE)
    for other in ("lower_ball_joint", "tie_rod_outer", "wheel_centre"):
        drawn = np.linalg.norm(np.subtract(car["wheel_axis_inner"], car[other]))
        found = np.linalg.norm(motion.position["wheel_axis_inner"] - motion.position[other])
        assert abs(drawn - found) <= 60 * EPS * SIZE
    assert "wheel_axis_inner" not in plain.position
