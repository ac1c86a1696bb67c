"""The angle of a line as seen along a direction of the car: its projection on two other directions.

angle = atan2(a . rise, a . run)
"""

from collections.abc import Callable

import numpy as np

from absolute.description import Corner, Vector
from absolute.effects.effect import Effect, Lines
from absolute.solution import Array


def projected_angle(
    name: str,
    gives: str,
    sign: str,
    role: str,
    rise: Callable[[Corner], Vector],
    run: Callable[[Corner], Vector],
) -> Effect:
    """The effect that is the angle of a line of the corner, rad, between -pi and pi.

    Args:
        role: the two points of the line, see `Corner`.
        rise, run: directions of the car; the angle is 0 along run, and grows toward rise.
    """

    def value(lines: Lines) -> Array:
        along = lines.line(lines.corner.ends(role))
        # A product of zeros may be -0, which would turn pi into -pi.
        return np.asarray(np.arctan2(along @ rise(lines.corner) + 0.0, along @ run(lines.corner)))

    return Effect(name, "rad", gives, sign, role, 0, value)
