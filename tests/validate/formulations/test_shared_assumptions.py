"""What both models assume alike, each held to a law of geometry or to exact arithmetic.

Two models that share an assumption agree on a wrong answer, so nothing here compares one with the other.
"""

from collections.abc import Mapping
from fractions import Fraction
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from pointcoord import Scene
from validate.formulations.input_rates import rates
from validate.formulations.protocol import Solution
from validate.formulations.registry import formulation

Array = NDArray[np.float64]
CAR = {name: np.array(p) for name, p in Scene.load("off-axis-strut").mechanism.points.items()}
LAWS: dict[str, Any] = {
    "arm_angle": {"sine": {"amplitude": 0.15, "angular_frequency": 5.0, "offset": 1.65}},
    "rack": {"polynomial": [2.0, 30.0, -10.0]},
}
# Lengths of 1000 mm in doubles, moved by another route: some hundred roundings, a condition number below
# a hundred, and rates some ten times the lengths.
CLOSE = 1e4 * np.finfo(float).eps * 1000.0

models = pytest.mark.parametrize("name", ["pointcoord", "pointcoord-newton", "absolute"])


def solved(name: str, points: Mapping[str, Array], side: str = "left", **laws: Any) -> Solution:
    content = {
        "effects": ["velocity", "acceleration", "knuckle_rates", "wheel_angles"],
        "mechanism": {
            "type": "macpherson",
            "side": side,
            "points": {point: place.tolist() for point, place in points.items()},
        },
        "inputs": LAWS | laws,
        "time": {"start": 0.0, "stop": 1.0, "samples": 7},
    }
    return formulation(name).solve(Scene.from_mapping(content))


def same_knuckle(one: Solution, other: Solution, points: tuple[str, ...]) -> None:
    for quantity in ("position", "velocity", "acceleration"):
        for point in points:
            gap = np.abs(getattr(one, quantity)[point] - getattr(other, quantity)[point]).max()
            assert gap <= CLOSE * {"position": 1.0, "velocity": 10.0, "acceleration": 100.0}[quantity]
    for angle in ("camber", "kingpin"):
        assert np.abs(one.wheel[angle] - other.wheel[angle]).max() <= CLOSE / 100.0


@models
@pytest.mark.parametrize("place", [-0.4, 0.3, 1.7])
def test_the_strut_axis_is_a_line_wherever_on_it_strut_lower_is_drawn(name: str, place: float) -> None:
    top, lower = CAR["strut_top"], CAR["strut_lower"]
    elsewhere = {**CAR, "strut_lower": top + place * (lower - top)}
    points = ("lower_ball_joint", "tie_rod_outer", "wheel_centre", "tie_rod_inner")
    if place < 0.0:
        # Above the strut top the axis points the other way, and so does the rod's end on it.
        elsewhere["strut_rod_end"] = CAR["strut_rod_end"]
    same_knuckle(solved(name, CAR), solved(name, elsewhere), (*points, "strut_rod_end"))


@models
def test_the_spin_axis_is_a_line_wherever_on_it_its_inner_point_is_drawn(name: str) -> None:
    inner, centre = CAR["wheel_axis_inner"], CAR["wheel_centre"]
    elsewhere = {**CAR, "wheel_axis_inner": centre + 2.5 * (inner - centre)}
    same_knuckle(solved(name, CAR), solved(name, elsewhere), ("wheel_centre", "tie_rod_outer"))


@models
def test_the_spin_axis_is_drawn_through_strut_lower_where_it_has_no_point_of_its_own(name: str) -> None:
    without = {point: place for point, place in CAR.items() if point != "wheel_axis_inner"}
    through = {**CAR, "wheel_axis_inner": CAR["strut_lower"]}
    same_knuckle(solved(name, without), solved(name, through), ("wheel_centre", "tie_rod_outer"))


@models
def test_the_line_of_the_rack_is_a_line_wherever_on_it_its_centre_is_drawn(name: str) -> None:
    shift = 17.0  # towards -y, as a positive travel goes
    elsewhere = {**CAR, "rack_centre": CAR["tie_rod_inner"] + [0.0, shift, 0.0]}
    later = {"polynomial": [2.0 + shift, 30.0, -10.0]}
    same_knuckle(
        solved(name, CAR),
        solved(name, elsewhere, rack=later),
        ("wheel_centre", "tie_rod_inner", "tie_rod_outer"),
    )


@models
def test_the_arm_angle_is_the_angle_at_the_front_pivot_between_the_vertical_and_the_ball_joint(
    name: str,
) -> None:
    solution = solved(name, CAR)
    arm = solution.position["lower_ball_joint"] - CAR["lower_arm_front"]
    wave = 1.65 + 0.15 * np.sin(5.0 * solution.times)
    angle = np.arctan2(np.hypot(arm[:, 0], arm[:, 1]), arm[:, 2])
    assert np.abs(angle - wave).max() <= 1e-13


@models
def test_a_right_wheel_is_a_left_wheel_in_a_mirror(name: str) -> None:
    flip = np.array([1.0, -1.0, 1.0])
    left = solved(name, CAR)
    # In the mirror the rack that moves to the left moves to the right.
    right = solved(
        name,
        {point: place * flip for point, place in CAR.items()},
        "right",
        rack={"polynomial": [-2.0, -30.0, 10.0]},
    )
    for point, path in left.position.items():
        assert np.abs(right.position[point] - path * flip).max() <= CLOSE
    # Velocities turn with the mirror, turns against it; camber and kingpin say the same of both wheels.
    axial = -flip
    assert np.abs(right.angular_velocity["knuckle"] - left.angular_velocity["knuckle"] * axial).max() <= CLOSE
    for angle in ("camber", "kingpin"):
        assert np.abs(right.wheel[angle] - left.wheel[angle]).max() <= CLOSE / 100.0


@models
def test_a_heave_moves_every_point_alike_and_turns_nothing(name: str) -> None:
    still, heaved = solved(name, CAR), solved(name, CAR, heave={"polynomial": [5.0, 100.0, 50.0]})
    t = heaved.times
    for point, path in still.position.items():
        lift = heaved.position[point] - path
        assert np.abs(lift - np.outer(5.0 + 100.0 * t + 50.0 * t**2, [0.0, 0.0, 1.0])).max() <= CLOSE
    gap = heaved.angular_velocity["knuckle"] - still.angular_velocity["knuckle"]
    assert np.abs(gap).max() <= CLOSE


def exact_not_a_knot(times: list[Fraction], values: list[Fraction]) -> list[list[Fraction]]:
    """Cubics of every interval, lowest power of t - t_i first, in rational arithmetic.

    Second derivatives M solve the usual equations of a cubic spline; not-a-knot makes the third derivative
    continuous at the second time and at the last but one.
    """
    n = len(times)
    h = [b - a for a, b in pairwise(times)]
    slope = [(b - a) / s for a, b, s in zip(values[:-1], values[1:], h, strict=True)]
    rows = [[Fraction(0)] * n for _ in range(n)]
    right = [Fraction(0)] * n
    rows[0][:3] = [h[1], -(h[0] + h[1]), h[0]]
    rows[-1][-3:] = [h[-1], -(h[-2] + h[-1]), h[-2]]
    for i in range(1, n - 1):
        rows[i][i - 1 : i + 2] = [h[i - 1], 2 * (h[i - 1] + h[i]), h[i]]
        right[i] = 6 * (slope[i] - slope[i - 1])
    for i in range(n):
        pivot = next(k for k in range(i, n) if rows[k][i])
        rows[i], rows[pivot], right[i], right[pivot] = rows[pivot], rows[i], right[pivot], right[i]
        for k in range(n):
            if k != i and rows[k][i]:
                factor = rows[k][i] / rows[i][i]
                rows[k] = [a - factor * b for a, b in zip(rows[k], rows[i], strict=True)]
                right[k] -= factor * right[i]
    m = [right[i] / rows[i][i] for i in range(n)]
    return [
        [
            values[i],
            slope[i] - h[i] * (2 * m[i] + m[i + 1]) / 6,
            m[i] / 2,
            (m[i + 1] - m[i]) / (6 * h[i]),
        ]
        for i in range(n - 1)
    ]


@pytest.mark.parametrize("seed", range(6))
def test_a_table_is_the_not_a_knot_spline_of_exact_arithmetic(seed: int) -> None:
    rng = np.random.default_rng(seed)
    count = int(rng.integers(4, 12))
    times = np.cumsum(rng.uniform(0.05, 0.5, count))
    values = rng.uniform(-30.0, 30.0, count)
    cubics = exact_not_a_knot([Fraction(t) for t in times], [Fraction(v) for v in values])
    scene = Scene.from_mapping(
        Scene.load("off-axis-strut").model_dump(exclude_none=True)
        | {
            "inputs": {
                "arm_angle": {"constant": 1.63},
                "rack": {"table": {"times": times.tolist(), "values": values.tolist()}},
            },
            "time": {"start": float(times[0]), "stop": float(times[-1]), "samples": 23},
        }
    )
    instants = scene.instants
    found = rates(scene.inputs["rack"], instants)
    series = scene.functions["rack"].series(instants, 2) * np.array([1.0, 1.0, 2.0])
    for t, ours, theirs in zip(instants.tolist(), found, series, strict=True):
        i = min(int(np.searchsorted(times, t, side="right")) - 1, count - 2)
        s = Fraction(t) - Fraction(times[i])
        a, b, c, d = cubics[i]
        exact = (a + s * (b + s * (c + s * d)), b + s * (2 * c + 3 * s * d), 2 * c + 6 * s * d)
        for order, meant in enumerate(exact):
            # The spline's equations have a condition number below 10 times the ratio of its intervals, and a
            # derivative divides by the shortest one.
            limit = 1e3 * np.finfo(float).eps * 30.0 / 0.05**order
            assert abs(Fraction(float(ours[order])) - meant) <= limit
            assert abs(Fraction(float(theirs[order])) - meant) <= limit
