r"""Ackermann numbers: how the steer angles of an axle's two wheels relate to each other.

With L the wheelbase, t the track as drawn, d_l and d_r the steer angles, positive to the left, and
R = L (cot d_l + cot d_r) / 2, whose size is the turning radius,

    Ackermann = 100 (d_l - d_r) / (arccot((R - t/2) / L) - arccot((R + t/2) / L)) %        (Lotus),

where the inner wheel is the left one if steered to the left. If steered to the right, inner and outer wheel
are exchanged, both differences change sign, and the quotient is the same. The divisor is computed without
cancellation as arccot((R^2 - t^2/4 + L^2) / (L t)). arccot is between 0 and pi: a wheel whose turning point
is nearer than half a track has an angle above pi / 2.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from pointcoord.effects.arithmetic import angle, chosen, multiple, positive, ratio
from pointcoord.effects.corner import Corner

PERCENT = 100.0
# rad: for smaller steer angles, doubles do not tell to which side a wheel is steered.
STRAIGHT = 1e-12


def turning_radius(left: Corner[Any], right: Corner[Any]) -> Any:
    """|R|."""
    radius = _radius(left, right)
    return chosen(positive(radius), radius, -radius)


def ackermann(left: Corner[Any], right: Corner[Any]) -> Any:
    """100 times the difference of the steer angles over the ideal one, with one turning point; %."""
    radius, wheelbase, half = _radius(left, right), left.car["wheelbase"], multiple(0.5, _track(left, right))
    below = radius * radius - half * half + wheelbase * wheelbase
    # Multiplied by 0 for the shape: the drawing is one pose, the result has one number per pose.
    ideal = angle(multiple(0.0, below) + wheelbase * (half + half), below)
    return multiple(PERCENT, ratio(angle(*_steer(left)) - angle(*_steer(right)), ideal))


def ackermann_error(left: Corner[Any], right: Corner[Any]) -> Any:
    """d_o - arccot(cot d_i + t / L), with the magnitudes of the inner and the outer wheel's steer angles."""
    more = ratio(_track(left, right), left.car["wheelbase"])
    (one, across), (other, back) = _sides(left, right)
    to_the_left = angle(*_steer(right)) - angle(one, across + more * one)
    to_the_right = angle(other, back - more * other) - angle(*_steer(left))
    return chosen(positive(one), to_the_left, to_the_right)


def _radius(left: Corner[Any], right: Corner[Any]) -> Any:
    """R; NaN where the wheels are not steered to the same side."""
    (one, across), (other, back) = _sides(left, right)
    return multiple(0.5, left.car["wheelbase"] * (ratio(across, one) + ratio(back, other)))


def _sides(left: Corner[Any], right: Corner[Any]) -> tuple[tuple[Any, Any], tuple[Any, Any]]:
    """Sine and cosine of both steer angles, of any common size; NaN where R does not exist."""
    (one, across), (other, back) = _steer(left), _steer(right)
    if isinstance(one, np.ndarray):
        turned = np.minimum(np.abs(one) / np.hypot(one, across), np.abs(other) / np.hypot(other, back))
        known = (np.sign(one) == np.sign(other)) & (turned > STRAIGHT)
        one, other = np.where(known, one, np.nan), np.where(known, other, np.nan)
    return (one, across), (other, back)


def _steer(corner: Corner[Any]) -> tuple[Any, Any]:
    """Sine and cosine of the steer angle, times any common factor."""
    view = corner.seen
    return view.along(view.spin, "to_the_left"), view.along(view.spin, "outboard")


def _track(left: Corner[Any], right: Corner[Any]) -> Any:
    """The track as drawn, (c_right - c_left) . right."""
    return right.drawn.along(right.drawn.contact_place() - left.drawn.contact_place(), "outboard")
