"""Other linkages from data alone: nothing in the solver knows a strut."""

import numpy as np
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
