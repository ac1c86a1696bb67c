"""Joint kinds and inputs as rows, each the product of a direction of one body with a vector.

A joint is a pair of frames, one on each body, with z along the axis. With R and t the rotation and
translation of the second frame seen from the first, the rows are picked from
    t = (x1 . d, y1 . d, z1 . d), d from origin 1 to origin 2;    R_ij = (axis i of 1) . (axis j of 2).
"""

from typing import NamedTuple

import numpy as np

from absolute.description import Joint, Model
from absolute.drawing import Drawing
from absolute.errors import DescriptionError
from absolute.solution import Array
from absolute.vectors import cross

X, Y, Z = 0, 1, 2

# Axis i of the first frame along which the two origins may not part.
OFFSETS = {
    "spherical": (X, Y, Z),
    "universal": (X, Y, Z),
    "cylindrical": (X, Y),
    "revolute": (X, Y, Z),
    "prismatic": (X, Y),
}
# Axes (i of the first, j of the second) that stay at a right angle.
RIGHT_ANGLES = {
    "spherical": (),
    "universal": ((Z, Z),),
    "cylindrical": ((Y, Z), (X, Z)),
    "revolute": ((Y, Z), (X, Z)),
    "prismatic": ((Y, Z), (X, Z), (Y, X)),
}
# Axes whose product must stay positive: a right angle alone also allows the reversed joint.
SENSES = {
    "spherical": (),
    "universal": (),
    "cylindrical": ((Z, Z),),
    "revolute": ((Z, Z),),
    "prismatic": ((Z, Z), (X, X)),
}


class Angle(NamedTuple):
    """Row `direction . partner`, the directions fixed to bodies `first` and `second` (indices)."""

    owner: str
    first: int
    second: int
    direction: Array
    partner: Array


class Offset(NamedTuple):
    """Row `direction . (point 2 - point 1)`, points given by their arms from the body origins."""

    owner: str
    first: int
    second: int
    direction: Array
    first_arm: Array
    second_arm: Array


class Rows(NamedTuple):
    """All rows of a model: right angles, then offsets of joints, then one offset per input."""

    angles: tuple[Angle, ...]
    offsets: tuple[Offset, ...]
    senses: tuple[Angle, ...]


def rows_of(model: Model, drawing: Drawing) -> Rows:
    """Rows of every joint and input, in body axes and units of size."""
    angles: list[Angle] = []
    offsets: list[Offset] = []
    senses: list[Angle] = []
    for name, joint in model.joints.items():
        first, second = drawing.bodies[joint.first], drawing.bodies[joint.second]
        frame1, frame2 = joint_frames(name, joint, drawing)
        arms = (
            drawing.arm(joint.first, joint.on_first.through),
            drawing.arm(joint.second, joint.on_second.through),
        )
        offsets += [Offset(name, first, second, frame1[i], *arms) for i in OFFSETS[joint.kind]]
        angles += [Angle(name, first, second, frame1[i], frame2[j]) for i, j in RIGHT_ANGLES[joint.kind]]
        senses += [Angle(name, first, second, frame1[i], frame2[j]) for i, j in SENSES[joint.kind]]
    for name, drive in model.inputs.items():
        offsets.append(
            Offset(
                name,
                drawing.bodies[drive.first],
                drawing.bodies[drive.second],
                drawing.direction(f"input {name!r}", drive.axis),
                drawing.arm(drive.first, drive.axis.through),
                drawing.arm(drive.second, drive.point),
            )
        )
    return Rows(tuple(angles), tuple(offsets), tuple(senses))


def joint_frames(name: str, joint: Joint, drawing: Drawing) -> tuple[Array, Array]:
    """Axes x, y, z (as rows) of the joint frame of each body, as drawn.

    Where the two lines shall become one, the second frame is the first turned by the smallest
    rotation between the drawn lines: so a prismatic joint holds the turn of the drawing.
    """
    if joint.kind == "spherical":
        return np.eye(3), np.eye(3)
    z1 = drawing.direction(f"joint {name!r}", joint.on_first)
    z2 = drawing.direction(f"joint {name!r}", joint.on_second)
    frame1 = frame_about(z1)
    if joint.kind == "universal":
        return frame1, frame_about(z2)
    cosine = float(z1 @ z2)
    if cosine <= 0:
        apart = np.degrees(np.arccos(max(cosine, -1.0)))
        raise DescriptionError(
            f"joint {name!r}: its two lines are drawn {apart:.1f} degrees apart; "
            "they shall become one line of the same sense, so less than 90 degrees is needed: "
            "swap the points of one line or correct the drawing",
            name,
            cosine,
        )
    axis = cross(z1, z2)
    turned = frame1 + cross(axis, frame1) + cross(axis, cross(axis, frame1)) / (1.0 + cosine)
    return frame1, np.asarray(turned, dtype=float)


def frame_about(z: Array) -> Array:
    """Right-handed unit axes x, y, z as rows, with z given."""
    x = cross(np.eye(3)[int(np.argmin(np.abs(z)))], z)
    x = x / np.linalg.norm(x)
    return np.array([x, cross(z, x), z])
