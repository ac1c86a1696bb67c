"""Other linkages from data alone: nothing in the solver knows a strut."""

import dataclasses

import numpy as np
import pytest
from numpy.typing import NDArray

import absolute
from absolute import Axis, Input, Joint, Model

Array = NDArray[np.float64]
EPS = np.finfo(float).eps


def test_slider_crank_follows_its_closed_form() -> None:
    # Crank r about z at the origin, rod l, slider along x: x = r cos a + sqrt(l^2 - r^2 sin^2 a).
    r, rod = 50.0, 130.0
    z = (0.0, 0.0, 1.0)
    x, y = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)
    drawn = 1.0
    points = {
        "pivot": (0.0, 0.0, 0.0),
        "pin": (r * np.cos(drawn), r * np.sin(drawn), 0.0),
        "piston": (r * np.cos(drawn) + np.sqrt(rod**2 - (r * np.sin(drawn)) ** 2), 0.0, 0.0),
    }
    model = Model(
        points,
        "ground",
        {"ground": ("pivot",), "crank": ("pivot", "pin"), "rod": ("pin", "piston"), "slider": ("piston",)},
        {
            "crank_pivot": Joint("revolute", "ground", "crank", Axis("pivot", z), Axis("pivot", z)),
            "crank_pin": Joint("spherical", "crank", "rod", Axis("pin"), Axis("pin")),
            "piston_pin": Joint("universal", "slider", "rod", Axis("piston", z), Axis("piston", y)),
            "bore": Joint("prismatic", "ground", "slider", Axis("pivot", x), Axis("piston", x)),
        },
        {"angle": Input("ground", Axis("pivot", x), "crank", "pin", "cosine", r)},
    )
    t = np.linspace(-0.8, 1.4, 23)
    angle = np.stack([drawn + t + 0.1 * t**2, 1 + 0.2 * t, np.full_like(t, 0.2)], -1)
    motion = absolute.solve(model, {"angle": angle}, conditions=True)
    a, da, dda = angle.T
    root = np.sqrt(rod**2 - (r * np.sin(a)) ** 2)
    # f = root: f' = -r^2 sin a cos a a' / f, and f f'' + f'^2 = -r^2 (cos 2a a'^2 + sin a cos a a'').
    root1 = -(r**2) * np.sin(a) * np.cos(a) * da / root
    root2 = (-(r**2) * (np.cos(2 * a) * da**2 + np.sin(a) * np.cos(a) * dda) - root1**2) / root
    assert motion.condition is not None
    # Rounding of size and rates, magnified by the condition number; squared for the acceleration,
    # whose right-hand side holds the velocities already magnified.
    tolerance = 4 * EPS * rod * motion.condition
    assert (np.abs(motion.position["piston"][:, 0] - (r * np.cos(a) + root)) < tolerance).all()
    velocity = -r * np.sin(a) * da + root1
    assert (np.abs(motion.velocity["piston"][:, 0] - velocity) < tolerance).all()
    acceleration = -r * (np.cos(a) * da**2 + np.sin(a) * dda) + root2
    assert (np.abs(motion.acceleration["piston"][:, 0] - acceleration) < tolerance * motion.condition).all()
    # The crank turns at the input's own rate.
    assert np.allclose(motion.angular_velocity["crank"][:, 2], da, rtol=0, atol=tolerance.max() / rod)


@pytest.fixture
def wishbones() -> Model:
    points = {
        "lower_front": (-150.0, 0.0, 0.0),
        "lower_rear": (150.0, 5.0, 8.0),
        "lower_ball": (0.0, -400.0, -20.0),
        "upper_front": (-120.0, -90.0, 260.0),
        "upper_rear": (130.0, -85.0, 250.0),
        "upper_ball": (15.0, -370.0, 250.0),
        "tie_outer": (110.0, -390.0, 60.0),
        "tie_inner": (120.0, -40.0, 70.0),
        "rack": (120.0, -40.0, 70.0),
        "wheel": (0.0, -460.0, 90.0),
    }
    right = (0.0, 1.0, 0.0)
    ball = {name: Axis(name) for name in points}
    lower, upper = Axis("lower_front", "lower_rear"), Axis("upper_front", "upper_rear")
    arm = float(np.linalg.norm(np.subtract(points["lower_ball"], points["lower_front"])))
    return Model(
        points,
        "body",
        {
            "body": ("lower_front", "lower_rear", "upper_front", "upper_rear", "rack"),
            "lower": ("lower_front", "lower_rear", "lower_ball"),
            "upper": ("upper_front", "upper_rear", "upper_ball"),
            "upright": ("lower_ball", "upper_ball", "tie_outer", "wheel"),
            "rod": ("tie_outer", "tie_inner"),
            "bar": ("tie_inner",),
        },
        {
            "lower_pivot": Joint("revolute", "body", "lower", lower, lower),
            "upper_pivot": Joint("revolute", "body", "upper", upper, upper),
            "lower_ball": Joint("spherical", "lower", "upright", ball["lower_ball"], ball["lower_ball"]),
            "upper_ball": Joint("spherical", "upper", "upright", ball["upper_ball"], ball["upper_ball"]),
            "outer": Joint("spherical", "upright", "rod", ball["tie_outer"], ball["tie_outer"]),
            "inner": Joint(
                "universal",
                "bar",
                "rod",
                Axis("tie_inner", (1.0, 0.0, 0.0)),
                Axis("tie_inner", (0.0, 0.0, 1.0)),
            ),
            "slide": Joint("prismatic", "body", "bar", Axis("rack", right), Axis("tie_inner", right)),
        },
        {
            "arm": Input("body", Axis("lower_front", (0.0, 0.0, 1.0)), "lower", "lower_ball", "cosine", arm),
            "steer": Input("body", Axis("rack", right), "bar", "tie_inner", "linear", -1.0),
        },
    )


def test_double_wishbone_keeps_its_link_lengths_and_its_rates(wishbones: Model) -> None:
    step = 1e-4
    t = step * np.arange(-1, 2)
    inputs = {
        "arm": np.stack([1.55 + 0.5 * t, np.full_like(t, 0.5), 0 * t], -1),
        "steer": np.stack([10 + 80 * t, np.full_like(t, 80.0), 0 * t], -1),
    }
    motion = absolute.solve(wishbones, inputs, conditions=True)
    assert motion.condition is not None
    rounding = EPS * 500 * float(motion.condition.max())
    p = motion.position
    for a, b in (
        ("lower_ball", "upper_ball"),
        ("tie_outer", "tie_inner"),
        ("upper_ball", "upper_front"),
        ("lower_ball", "tie_outer"),
        ("upper_ball", "tie_outer"),
    ):
        drawn = np.linalg.norm(np.subtract(wishbones.points[a], wishbones.points[b]))
        assert np.allclose(np.linalg.norm(p[a] - p[b], axis=-1), drawn, rtol=0, atol=rounding)
    for name in wishbones.points:
        # Truncation step^2 / 6 times a third derivative below 1e4 mm/s^3; rounding over the step.
        tolerance = step**2 / 6 * 1e4 + rounding / step
        assert np.abs((p[name][2] - p[name][0]) / (2 * step) - motion.velocity[name][1]).max() < tolerance
        slope = (motion.velocity[name][2] - motion.velocity[name][0]) / (2 * step)
        assert np.abs(slope - motion.acceleration[name][1]).max() < 10 * tolerance


def test_wishbones_too_short_to_meet_are_refused_as_unassembled(wishbones: Model) -> None:
    # The line of the rack, further away than the tie rod is long.
    points = {**wishbones.points, "rack": (120.0, -40.0, 2000.0)}
    broken = dataclasses.replace(wishbones, points=points)
    still = {"arm": np.array([[1.6, 0.0, 0.0]]), "steer": np.zeros((1, 3))}
    with pytest.raises(absolute.AssemblyError, match="cannot be assembled") as caught:
        absolute.solve(broken, still)
    assert caught.value.partial is None
    assert caught.value.residual > 0
