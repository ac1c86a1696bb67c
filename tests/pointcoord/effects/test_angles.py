"""Angles of a wheel and a steering axis: limits of the drawing, and what is proven.

What they are, with their signs, is in tests/mechanisms.
"""

from types import SimpleNamespace

import numpy as np
import pytest

from pointcoord.effects.corner import Wheel
from pointcoord.effects.registry import ANGLES
from pointcoord.effects.wheel_angles import WHEEL_ANGLES
from pointcoord.linkage.car_axes import CarAxes
from pointcoord.numerics.enclosure import Enclosed, angle_error

EPS = float(np.finfo(float).eps)
UP, RIGHTWARD = np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0])  # x rearward
AXES = CarAxes(UP, RIGHTWARD, RIGHTWARD)
LOW = np.array([10.0, 600.0, 100.0])
CAMBER, KINGPIN = ANGLES["camber"], ANGLES["kingpin"]


def topology(stand_ins: dict[str, str]) -> SimpleNamespace:
    """A linkage whose wheel turns about inner - centre, steered about low - high."""
    lines = {"wheel_axis": ("inner", "centre"), "steering_axis": ("low", "high")}
    own = {"inner", "centre", "low", "high"}
    return SimpleNamespace(role=lambda name: lines.get(name, ()), sides={}, stand_ins=stand_ins, points=own)


def drawn(camber: float, kingpin: float) -> dict[str, np.ndarray]:
    """Of a right wheel, deg."""
    c, k = np.radians([camber, kingpin])
    wheel, axis = (0.1, np.cos(c), -np.sin(c)), (0.1, -np.sin(k), np.cos(k))
    return {"inner": LOW, "centre": LOW + 80.0 * np.array(wheel), "low": LOW, "high": LOW + np.array(axis)}


@pytest.mark.parametrize(
    ("stand_ins", "camber"),
    # Another limit where the wheel's axis starts at a point that stands in for one that is missing.
    [({}, 45.0), ({"axis": "inner"}, 10.0), ({"axis": "low"}, 45.0), ({"inner": "inner"}, 45.0)],
)
def test_lines_look_misdrawn_beyond_their_limits_only(stand_ins: dict[str, str], camber: float) -> None:
    right, known = CarAxes(UP, RIGHTWARD, RIGHTWARD), np.array(False)
    for sign in (-1.0, 1.0):
        for by in (-0.5, 0.5):
            points = drawn(sign * (camber + by), sign * (45.0 + by))
            for angle in (CAMBER, KINGPIN):
                assert angle.doubt(Wheel(topology(stand_ins)), points, right, known).where == (by > 0.0)
                assert not angle.doubt(Wheel(topology(stand_ins)), points, right, ~known).where
                assert not ANGLES["caster"].doubt(Wheel(topology(stand_ins)), points, right, known).where
    wrong = [
        a.doubt(Wheel(topology({})), drawn(89.5, 90.5), right, known).words(()) for a in (CAMBER, KINGPIN)
    ]
    assert ["swapped" in words for words in wrong] == [False, True]


def test_a_line_without_a_length_is_refused_where_a_point_of_its_own_is_missing() -> None:
    apart = {name: tuple(place.tolist()) for name, place in drawn(3.0, 8.0).items()}
    together = apart | {"centre": apart["inner"]}
    missing = topology({"axis": "inner"})
    assert WHEEL_ANGLES.refusal(missing, apart, AXES) == ""
    assert "give the axis a point of its own, axis" in WHEEL_ANGLES.refusal(missing, together, AXES)
    assert WHEEL_ANGLES.refusal(topology({}), together, AXES) == ""


def error(sine: float, cosine: float, found: float, *boxes: float) -> float:
    """Proven of a line; `boxes` are the radii of sine and cosine."""
    parts = (Enclosed.of(np.array([v]), 0.0, r, 0.0) for v, r in zip((sine, cosine), boxes, strict=True))
    return float(angle_error(*parts, np.array([found]))[0, 0])


@pytest.mark.parametrize("length", [2.0**-9, 1.0, 2.0**9])
def test_a_proven_error_is_what_the_worst_line_in_its_box_is_off(length: float) -> None:
    random = np.random.default_rng(3)
    for angle in random.uniform(-np.pi, np.pi, 30):
        sine, cosine = length * np.sin(angle), length * np.cos(angle)
        r = length * 1e-6 * random.uniform(0.2, 1.0, 2)
        corners = [np.arctan2(sine + a, cosine + b) for a in (-r[0], r[0]) for b in (-r[1], r[1])]
        worst = np.abs(np.remainder(np.array(corners) - angle + np.pi, 2.0 * np.pi) - np.pi).max()
        # Of second order is what a line that is shorter by its box gives away.
        assert worst - 4.0 * EPS <= error(sine, cosine, angle, *r) <= worst * (1.0 + 4e-6) + 8.0 * EPS


def test_of_an_angle_that_points_elsewhere_or_of_a_line_without_a_length_nothing_is_proven() -> None:
    for off in (np.pi, np.pi - 0.1, 3.4, 1.0, -1.0):
        assert error(3.0, 4.0, float(np.arctan2(3.0, 4.0)) + off, 0.0, 0.0) == np.pi
    for box in ((0.5, 0.0), (0.0, 0.5), (0.7, 0.7)):
        assert error(0.0, 1.0, 0.0, *box) == np.pi
