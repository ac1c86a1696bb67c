"""Cars whose suspension has a closed form, wherever they are drawn."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from hypothesis import strategies as st
from many_digits import DIGITS, Points, vector
from mechanism_closed_forms import closed_form
from mpmath import mp, mpf

from validate.cars.base_cars import Variant, variants
from validate.cars.car import Car
from validate.strategies import cars

STEERED: Mapping[str, tuple[str, str]] = {
    "macpherson": ("lower_ball_joint", "strut_top"),
    "double_wishbone": ("lower_ball_joint", "upper_ball_joint"),
}
"""Suspensions that arm angle and rack drive, with the points of their steering axes."""
VARIANTS: tuple[Variant, ...] = tuple(one for one in variants() if one.suspension in STEERED)
DRAWN = tuple(one for one in VARIANTS if one.closure == "drawn")


def cars_of(these: Sequence[Variant] = VARIANTS) -> st.SearchStrategy[Car]:
    """Random cars that have a closed form."""
    return st.one_of([cars(one.suspension, one.closure).map(lambda drawn: drawn[0]) for one in these])


def pose_of(car: Car, **inputs: Any) -> Points:
    """Every point at an arm angle, rad, and a rack travel, mm, and a heave if there is one, mm.

    Raises:
        NoPoseError: there is none.
    """
    form = car.suspension if car.closure == "drawn" else f"{car.suspension} {car.closure}"
    with mp.workdps(DIGITS):
        up, right = vector(car.up), vector(car.right)
        axes = np.stack([np.cross(right, up), right, up])
        points = {name: axes @ vector(place) for name, place in car.points.items()}
        (found,) = closed_form(form, points, [{name: inputs[name] for name in ("arm_angle", "rack")}])
        lift = mpf(inputs.get("heave", 0)) * up
        return {name: place @ axes + lift for name, place in found.items() if name in car.points}
