"""Angles that count forwards: a mirror changes their sign where it leaves the car's front behind."""

import numpy as np
from numpy.typing import NDArray

from pointcoord import Motion
from pointcoord.effects.registry import ANGLES

Array = NDArray[np.float64]

LENGTHWISE = {name for name, angle in ANGLES.items() if {angle.sine, angle.cosine} & {"forward", "rearward"}}
LENGTHWISE |= {"toe_by_arcsine", "screw_caster"}


def forward(motion: Motion) -> Array:
    """Where the car's front is: up x right, as in right-handed axes."""
    axes = motion.solved.readout.axes
    return np.cross(axes.up, axes.right)


def expected_angle(name: str, plain: Motion, other: Motion, matrix: Array) -> Array:
    """An angle of a car whose points were turned or mirrored by a matrix, from that of the plain one."""
    ahead = np.sign(forward(other) @ matrix @ forward(plain))
    return np.asarray(plain.wheel[name] * (ahead if name in LENGTHWISE else 1.0))
