"""The numbers of a car once more, from points in many digits, and their derivatives along exact velocities.

They are made another way than in the model: points on lines by their height, the tyre's forward by the angle
of its axle, the wheel's lowest point by two directions in its plane. Axes x rearward, y right, z up.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from mpmath import asin, atan2, cos, matrix, mpf, sin, sqrt

Vector = Any
Place = Callable[[str], Vector]


def vector(values: Any) -> Vector:
    return matrix([mpf(x) for x in values])


def dot(a: Vector, b: Vector) -> Any:
    return sum(x * y for x, y in zip(a, b, strict=True))


def cross(a: Vector, b: Vector) -> Vector:
    return matrix([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def lowest(inner: Vector, centre: Vector, radius: float) -> Vector:
    """The lowest point of a thin disc."""
    a = centre - inner
    across = matrix([a[1], -a[0], 0])
    steep = cross(a, across / sqrt(dot(across, across)))
    steep = steep / sqrt(dot(steep, steep))
    return centre - steep * (mpf(radius) * (1 if steep[2] > 0 else -1))


def numbers(
    at: Place, still: Place, drawn: Place, roles: Mapping[str, Sequence[str]], radius: float | None, out: int
) -> dict[str, Any]:
    """Those numbers for which there are roles and a radius.

    Args:
        at, still, drawn: where a point is, where it were if the car were not turned, and where it is drawn.
        out: y of outboard, 1 or -1.
    """
    inner, hub = roles["wheel_axis"]
    centre = at(hub)
    spin = centre - at(inner)
    # From outboard toward rearward.
    heading = atan2(spin[0], out * spin[1])
    found = {
        "camber": atan2(-spin[2], out * spin[1]),
        "toe": -heading,
        "steer_angle": -out * heading,
        "camber_by_arcsine": -asin(spin[2] / sqrt(dot(spin, spin))),
        "toe_by_arcsine": -asin(spin[0] / sqrt(dot(spin, spin))),
        "travel": (still(hub) - drawn(hub))[2],
    }
    if "damper" in roles:
        ends = [at(end) for end in roles["damper"]]
        found["damper_length"] = sqrt(dot(ends[1] - ends[0], ends[1] - ends[0]))
    if radius is not None:
        c, before, level = (lowest(of(inner), of(hub), radius) for of in (at, drawn, still))
        found["contact_travel"] = level[2] - before[2]
        found["half_track_change"], found["recession"] = out * (c - before)[1], (c - before)[0]
    if "steering_axis" in roles:
        lower, upper = (at(end) for end in roles["steering_axis"])
        steer = upper - lower
        found["kingpin"], found["caster"] = atan2(-out * steer[1], steer[2]), atan2(steer[0], steer[2])

        def beside(z: Any) -> Vector:
            share = (z - lower[2]) / (upper[2] - lower[2])
            return matrix([(1 - share) * a + share * b for a, b in zip(lower, upper, strict=True)])

        hub_off = centre - beside(centre[2])
        found["kingpin_offset_at_wheel"], found["hub_trail"] = out * hub_off[1], -hub_off[0]
        if radius is not None:
            off = c - beside(c[2])
            found["kingpin_offset"], found["castor_offset"] = out * off[1], off[0]
            found["scrub_radius"] = sqrt(off[0] ** 2 + off[1] ** 2)
            found["mechanical_trail"] = off[0] * cos(heading) - out * off[1] * sin(heading)
    return found
