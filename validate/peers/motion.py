"""What a program found: poses of a linkage at driven inputs, how they change, and how that is reported."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from validate.peers.linkage import Linkage

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Poses:
    """Poses of a linkage, in its unit and from its origin.

    Attributes:
        driven: turn of the arm and travel of the rack, (N, 2).
        coordinates: the program's own, (N, ...).
        places: of every moving point, (N, 3).
        last_step: the last correction of Newton's method, rad and car sizes, (N,).
        counts: what was done.
    """

    driven: Array
    coordinates: Array
    places: Mapping[str, Array]
    last_step: Array
    counts: Mapping[str, int]


@dataclass(frozen=True)
class Rates:
    """Velocities and accelerations of poses, in the linkage's unit.

    Attributes:
        velocity, acceleration: of every moving point, (N, 3).
        spin, spin_rate: angular velocity and acceleration of the knuckle, (N, 3), in the car's axes.
    """

    velocity: Mapping[str, Array]
    acceleration: Mapping[str, Array]
    spin: Array
    spin_rate: Array


def numbers(
    linkage: Linkage, chassis: Array, poses: Poses, rates: Rates | None = None
) -> dict[str, dict[str, Array]]:
    """All that is known of a motion, by quantity and name, in the car's axes, mm, s and rad.

    Args:
        chassis: its displacement and two time derivatives, (N, 3, 3), mm.
    """
    near, unit = linkage.with_chassis(poses.places), linkage.unit
    shift = linkage.origin + chassis[:, 0]
    found = {
        "position": {name: place * unit + shift for name, place in near.items()},
        "wheel": angles(linkage, near),
    }
    if rates is None:
        return found
    for order, (quantity, moving) in enumerate(
        (("velocity", rates.velocity), ("acceleration", rates.acceleration)), 1
    ):
        found[quantity] = {
            name: moving[name] * unit + chassis[:, order] if name in moving else chassis[:, order]
            for name in near
        }
    found["angular_velocity"] = {"knuckle": rates.spin}
    found["angular_acceleration"] = {"knuckle": rates.spin_rate}
    return found


def angles(linkage: Linkage, places: Mapping[str, Array]) -> dict[str, Array]:
    """Camber, kingpin, toe and caster by their definitions, (N,), rad, from places of any size.

    With n along the wheel's axis outboard, k along the steering axis upward, and o, u, r outboard, up and
    rearward: atan2(-n.u, n.o), atan2(-k.o, k.u), atan2(-n.r, n.o) and atan2(k.r, k.u).
    """
    n, k = (places[end] - places[start] for start, end in (linkage.spin_axis, linkage.leaning))
    o, u = linkage.outboard, linkage.up
    r = np.cross(linkage.right, u)
    return {
        "camber": np.arctan2(-n @ u, n @ o),
        "kingpin": np.arctan2(-k @ o, k @ u),
        "toe": np.arctan2(-n @ r, n @ o),
        "caster": np.arctan2(k @ r, k @ u),
    }
