r"""The angle of a line as seen along a direction of the car: its projection on two other directions.

    angle = atan2(a . rise, a . run)

A line that is off by d a turns its projection z = (a . run, a . rise) by no more than

    atan(across / (|z| - |d z|)),    across = |(a . run) rise - (a . rise) run| . |d a| / |z|,
                                     |d z| <= (|run| + |rise|) . |d a|,

where vectors between bars are taken without the signs of their components. From |d z| = |z| on the angle
may be anything. To |d a| come 3 eps |a| for the roundings of the two products, each of three
terms (three halves of eps at worst), and of the directions (two halves); to the angle 2 eps of it, since an
arc tangent is off by no more than one of its own last digits.
"""

from collections.abc import Callable

import numpy as np

from absolute.description import Corner, Vector
from absolute.effects.effect import Effect, Lines
from absolute.precision import EPS
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

    def error(lines: Lines) -> Array:
        ends = lines.corner.ends(role)
        along = lines.line(ends)
        p, q = np.array(rise(lines.corner)), np.array(run(lines.corner))
        off = lines.error(ends) + 3.0 * EPS * np.abs(along)
        y, x = along @ p, along @ q
        seen = np.hypot(x, y)
        across = np.sum(np.abs(x[:, None] * p - y[:, None] * q) * off, axis=1)
        across = np.divide(across, seen, out=np.zeros_like(seen), where=seen > 0.0)
        left = seen - off @ (np.abs(p) + np.abs(q))
        turned = np.where(left > 0.0, np.arctan2(across, left), np.pi)
        return np.asarray(turned + 2.0 * EPS * np.abs(np.arctan2(y, x)))

    return Effect(name, "rad", gives, sign, role, 0, value, error)
