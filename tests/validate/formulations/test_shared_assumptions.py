"""What both models assume alike, each held to a law of geometry or to exact arithmetic.

Two models that share an assumption agree on a wrong answer, so nothing here compares one with the other.
"""

from fractions import Fraction
from itertools import combinations, pairwise
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from pointcoord import Scene
from validate.formulations.input_rates import rates
from validate.formulations.protocol import Solution
from validate.formulations.registry import formulation

Array = NDArray[np.float64]
Points = dict[str, Array]
EVERY = ["velocity", "acceleration", "knuckle_rates", "wheel_angles", "toe", "caster"]
SCENES = {"strut": Scene.load("off-axis-strut"), "wishbone": Scene.load("double-wishbone")}
CARS = {
    car: {name: np.array(place) for name, place in scene.mechanism.points.items()}
    for car, scene in SCENES.items()
}
LAWS: dict[str, dict[str, Any]] = {
    "strut": {
        "arm_angle": {"sine": {"amplitude": 0.15, "angular_frequency": 5.0, "offset": 1.65}},
        "rack": {"polynomial": [2.0, 30.0, -10.0]},
    },
    "wishbone": {
        "arm_angle": {"sine": {"amplitude": 0.1, "angular_frequency": 5.0, "offset": 1.5}},
        "rack": {"polynomial": [2.0, 20.0, -10.0]},
    },
}
# Lengths of 1000 mm in doubles, moved by another route: some hundred roundings, a condition number below
# a hundred, and rates some ten times the lengths.
CLOSE = 1e4 * np.finfo(float).eps * 1000.0

models = pytest.mark.parametrize("name", ["pointcoord", "absolute", "relative"])
cars = pytest.mark.parametrize("car", SCENES)


def solved(name: str, car: str, points: Points | None = None, side: str = "", **laws: Any) -> Solution:
    """A car's motion by a model, with other points, on the other side, or driven otherwise."""
    drawn = SCENES[car].mechanism
    content = {
        "effects": EVERY,
        "mechanism": {
            "type": drawn.type,
            "side": side or drawn.side,
            "points": {point: place.tolist() for point, place in (points or CARS[car]).items()},
        },
        "inputs": LAWS[car] | laws,
        "time": {"start": 0.0, "stop": 1.0, "samples": 7},
    }
    return formulation(name).solve(Scene.from_mapping(content))


@models
@cars
def test_bodies_are_rigid_their_carried_points_too(name: str, car: str) -> None:
    knuckle = {
        "strut": ("lower_ball_joint", "tie_rod_outer", "strut_lower"),
        "wishbone": ("lower_ball_joint", "upper_ball_joint", "tie_rod_outer"),
    }[car]
    bodies = [(*knuckle, "wheel_centre", "wheel_axis_inner"), ("tie_rod_inner", "tie_rod_outer")]
    bodies += [
        (ball, f"{arm}_front", f"{arm}_rear")
        for arm, ball in (("lower_arm", "lower_ball_joint"), ("upper_arm", "upper_ball_joint"))
        if ball in CARS[car]
    ]
    places = solved(name, car).numbers["position"]
    for body in bodies:
        for one, other in combinations(body, 2):
            drawn = np.linalg.norm(CARS[car][one] - CARS[car][other])
            length = np.linalg.norm(places[one] - places[other], axis=-1)
            assert np.abs(length - drawn).max() <= CLOSE, (one, other)
    # A mirrored body has the same lengths: the wheel must stay on its side of the knuckle's plane.
    corners = np.array([places[point] for point in (*knuckle, "wheel_centre")])
    drawing = np.array([CARS[car][point] for point in (*knuckle, "wheel_centre")])
    volumes, volume = (np.linalg.det(np.moveaxis(c[1:] - c[0], 0, -1)) for c in (corners, drawing))
    assert np.abs(volumes / volume - 1.0).max() <= 1e-9


@models
@cars
def test_the_arm_angle_is_the_angle_at_the_front_pivot_between_the_vertical_and_the_ball_joint(
    name: str, car: str
) -> None:
    solution = solved(name, car)
    arm = solution.numbers["position"]["lower_ball_joint"] - CARS[car]["lower_arm_front"]
    sine = LAWS[car]["arm_angle"]["sine"]
    wave = sine["offset"] + sine["amplitude"] * np.sin(sine["angular_frequency"] * solution.times)
    angle = np.arctan2(np.hypot(arm[:, 0], arm[:, 1]), arm[:, 2])
    assert np.abs(angle - wave).max() <= 1e-13


@models
@cars
def test_a_heave_moves_every_point_alike_and_turns_nothing(name: str, car: str) -> None:
    still, heaved = solved(name, car), solved(name, car, heave={"polynomial": [5.0, 100.0, 50.0]})
    t = heaved.times
    for point, path in still.numbers["position"].items():
        lift = heaved.numbers["position"][point] - path
        assert np.abs(lift - np.outer(5.0 + 100.0 * t + 50.0 * t**2, [0.0, 0.0, 1.0])).max() <= CLOSE
    gap = heaved.numbers["angular_velocity"]["knuckle"] - still.numbers["angular_velocity"]["knuckle"]
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


@pytest.mark.parametrize("seed", range(2))
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
