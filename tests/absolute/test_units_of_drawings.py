"""A drawing is measured from its middle in units of its size, at any scale that doubles hold."""

import math

import numpy as np
import pytest
from flat import built_in
from struts import TABLE

import absolute
from absolute.drawing import Drawing

# A frame and a door: four points whose mean is (1, 1, 0), which is 3 and 4 from them.
POINTS = {
    "hinge": (1.0, 1.0, 3.0),
    "low": (1.0, 1.0, -3.0),
    "edge": (5.0, 1.0, 0.0),
    "stop": (-3.0, 1.0, 0.0),
}


def door(scale: float, points: dict[str, tuple[float, float, float]] = POINTS) -> absolute.Model:
    """A door that turns by an angle about the line of its hinge."""
    line = absolute.Axis("hinge", "low")
    across = absolute.Axis("hinge", (0, 1, 0))
    swing = absolute.Input("frame", across, "door", "edge", "linear", 1.0)
    return absolute.Model(
        points={name: (scale * x, scale * y, scale * z) for name, (x, y, z) in points.items()},
        chassis="frame",
        bodies={"frame": ("hinge", "low", "stop"), "door": ("hinge", "low", "edge")},
        joints={"hinges": absolute.Joint("revolute", "frame", "door", line, line)},
        inputs={"swing": swing},
        corner=absolute.Corner((0.0, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
    )


@pytest.mark.parametrize("scale", [1e-100, 1e-30, 1e-3, 1.0, 1e30, 1e99])
def test_size_is_the_furthest_distance_from_the_mean_at_any_scale(scale: float) -> None:
    drawing = Drawing(door(scale))
    assert drawing.size == pytest.approx(4.0 * scale, rel=1e-15, abs=0.0)
    assert drawing.middle == pytest.approx(np.array([1.0, 1.0, 0.0]) * scale, rel=1e-15, abs=1e-15 * scale)
    assert drawing.line("stop", "hinge") == pytest.approx([1.0, 0.0, 0.75], rel=1e-15, abs=0.0)
    assert drawing.origins[0].tolist() == [0.0, 0.0, 0.0]


def test_the_smallest_size_that_is_named_is_allowed_and_half_of_it_refused() -> None:
    # Numbers of one size, so that the mean is zero and nothing is rounded.
    points = {
        "hinge": (0.0, 0.0, 1.0),
        "low": (0.0, 0.0, -1.0),
        "edge": (1.0, 0.0, 0.0),
        "stop": (-1.0, 0.0, 0.0),
    }
    assert Drawing(door(1e-100, points)).size == 1e-100
    with pytest.raises(absolute.DescriptionError, match="at least 1e-100 mm") as caught:
        Drawing(door(0.5e-100, points))
    assert caught.value.value == 0.5e-100


def test_points_that_all_lie_in_the_origin_are_refused_with_their_size() -> None:
    with pytest.raises(absolute.DescriptionError, match="too near to zero") as caught:
        Drawing(door(0.0))
    assert caught.value.value == 0.0


def test_points_too_near_each_other_for_their_coordinates_are_refused() -> None:
    def shifted(by: float) -> dict[str, tuple[float, float, float]]:
        return {name: (x + by, y, z) for name, (x, y, z) in POINTS.items()}

    # Half of the digits is the least: 4 mm at 3e8 mm and less have fewer.
    limit = 4.0 / math.sqrt(np.finfo(float).eps)
    assert Drawing(door(1.0, shifted(0.9 * limit))).size == pytest.approx(4.0)
    with pytest.raises(absolute.DescriptionError, match="nearer to the origin"):
        Drawing(door(1.0, shifted(1.1 * limit)))


@pytest.mark.parametrize("scale", [1e-200, 1.0, 1e200])
def test_directions_of_a_car_are_unit_vectors_at_any_length(scale: float) -> None:
    up, right = (0.0, 0.6 * scale, 0.8 * scale), (0.0, 0.8 * scale, -0.6 * scale)
    corner = built_in("macpherson", TABLE, up=up, right=right, side="right").corner
    assert corner.up == pytest.approx((0.0, 0.6, 0.8), rel=1e-15, abs=0.0)
    assert corner.outboard == pytest.approx((0.0, 0.8, -0.6), rel=1e-15, abs=0.0)
    # right x up = (0.8 * 0.8 + 0.6 * 0.6, 0, 0).
    assert corner.rearward == pytest.approx((1.0, 0.0, 0.0), abs=1e-15)
