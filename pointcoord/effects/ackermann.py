r"""How the two wheels of an axle are steered against each other.

With L the wheelbase, t the track as drawn, d_l and d_r the steer angles, positive to the left, and
R = L (cot d_l + cot d_r) / 2, whose size is the turning radius,

    Ackermann = 100 (d_l - d_r) / (arccot((R - t/2) / L) - arccot((R + t/2) / L)) %        (Lotus),

where the inner wheel is the left one if steered to the left; to the right both differences are those of the
other two magnitudes, and the same. The divisor is arccot((R^2 - t^2/4 + L^2) / (L t)), in which nothing
cancels; arccot is between 0 and pi, as a wheel's angle is that rolls about a point nearer than half a track.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from pointcoord.effects.arithmetic import angle, chosen, multiple, positive, ratio
from pointcoord.effects.car_number import CarNumbers, Number
from pointcoord.effects.corner import Corner
from pointcoord.effects.effect import Quantity
from pointcoord.effects.wheel_angles import STEER

ACKERMANN_SHARE = Quantity("ackermann", "Ackermann", "%", "car")
STEER_ERROR = Quantity("steer_error", "steer error", "rad", "car")
PERCENT = 100.0
# rad: doubles do not tell to which side a wheel is steered by less.
STRAIGHT = 1e-12


def turning_radius(left: Corner[Any], right: Corner[Any]) -> Any:
    """|R|."""
    radius = _radius(left, right)
    return chosen(positive(radius), radius, -radius)


def ackermann(left: Corner[Any], right: Corner[Any]) -> Any:
    """The difference of the steer angles, of that which lets both wheels turn about one point; %."""
    radius, wheelbase, half = _radius(left, right), left.car["wheelbase"], multiple(0.5, _track(left, right))
    below = radius * radius - half * half + wheelbase * wheelbase
    # Of as many poses as there are, though the drawing is one.
    ideal = angle(multiple(0.0, below) + wheelbase * (half + half), below)
    return multiple(PERCENT, ratio(STEER.formula(left) - STEER.formula(right), ideal))


def ackermann_error(left: Corner[Any], right: Corner[Any]) -> Any:
    """d_o - arccot(cot d_i + t / L) of the magnitudes, the inner wheel's sine and cosine as they are."""
    more = ratio(_track(left, right), left.car["wheelbase"])
    (one, across), (other, back) = _sides(left, right)
    to_the_left = STEER.formula(right) - angle(one, across + more * one)
    to_the_right = angle(other, back - more * other) - STEER.formula(left)
    return chosen(positive(one), to_the_left, to_the_right)


def _radius(left: Corner[Any], right: Corner[Any]) -> Any:
    """R; no number where the wheels are not steered to the same side."""
    (one, across), (other, back) = _sides(left, right)
    return multiple(0.5, left.car["wheelbase"] * (ratio(across, one) + ratio(back, other)))


def _sides(left: Corner[Any], right: Corner[Any]) -> tuple[tuple[Any, Any], tuple[Any, Any]]:
    """What the steer angles have for sine and cosine."""
    (one, across), (other, back) = STEER.parts(left.seen), STEER.parts(right.seen)
    if isinstance(one, np.ndarray):
        turned = np.minimum(np.abs(one) / np.hypot(one, across), np.abs(other) / np.hypot(other, back))
        known = (np.sign(one) == np.sign(other)) & (turned > STRAIGHT)
        one, other = np.where(known, one, np.nan), np.where(known, other, np.nan)
    return (one, across), (other, back)


def _track(left: Corner[Any], right: Corner[Any]) -> Any:
    """(c_right - c_left) . right as drawn."""
    return right.drawn.along(right.drawn.contact_place() - left.drawn.contact_place(), "outboard")


_number = partial(Number, data=("wheelbase",))
ACKERMANN = CarNumbers.of(
    "ackermann",
    "turning radius, mm, Ackermann, %, and steer error, rad, of the axle",
    _number(
        "turning_radius",
        "turning radius",
        "",
        "R = L abs(cot d_l + cot d_r) / 2, d the steer angles of the left and the right wheel",
        turning_radius,
        source="Lotus",
    ),
    _number(
        "ackermann",
        "Ackermann",
        "where the inner wheel is steered more than the outer one",
        "100 (d_i - d_o) / (arccot((R - t/2) / L) - arccot((R + t/2) / L)), of the inner and the outer "
        "wheel's, t the track as drawn",
        ackermann,
        quantity=ACKERMANN_SHARE,
        power=0,
        source="within 0.04 points of Lotus",
    ),
    _number(
        "ackermann_error",
        "steer error of the outer wheel",
        "where it is steered more than it would have to be",
        "d_o - arccot(cot d_i + t / L)",
        ackermann_error,
        quantity=STEER_ERROR,
        power=0,
    ),
    nowhere="the wheels are not steered to the same side",
    of_axle=True,
)
