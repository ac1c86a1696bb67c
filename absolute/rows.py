"""Joint kinds and inputs as rows: a direction of one body times a vector, a distance, or a turn.

A joint is a pair of frames, one on each body, with z along the axis. With R and t the rotation and
translation of the second frame seen from the first, the rows are picked from
    t = (x1 . d, y1 . d, z1 . d), d from origin 1 to origin 2;    R_ij = (axis i of 1) . (axis j of 2).
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from absolute.description import WITHOUT_LINE, Joint, Model
from absolute.drawing import Drawing
from absolute.errors import DescriptionError
from absolute.solution import Array
from absolute.vectors import cross

X, Y, Z = 0, 1, 2

# Axis i of the first frame along which the two origins may not part.
OFFSETS = {
    "spherical": (X, Y, Z),
    "revolute": (X, Y, Z),
    "prismatic": (X, Y),
    "on_line": (X, Y),
    "key": (),
    "parallel": (),
    "level": (),
    "distance": (),
}
# Axes (i of the first, j of the second) that stay at a right angle.
RIGHT_ANGLES = {
    "spherical": (),
    "revolute": ((Y, Z), (X, Z)),
    "prismatic": ((Y, Z), (X, Z), (Y, X)),
    "on_line": (),
    "key": ((Y, X),),
    "parallel": ((Y, Z), (X, Z), (Y, X)),
    "level": ((Z, Z),),
    "distance": (),
}
# Axes whose product must stay positive: a right angle alone also allows the reversed joint.
SENSES = {
    "spherical": (),
    "revolute": ((Z, Z),),
    "prismatic": ((Z, Z), (X, X)),
    "on_line": (),
    "key": ((X, X),),
    "parallel": ((Z, Z), (X, X)),
    "level": (),
    "distance": (),
}


class Angle(NamedTuple):
    """Row `direction . partner`, the directions fixed to bodies `first` and `second` (indices)."""

    owner: str
    first: int
    second: int
    direction: Array
    partner: Array


class Offset(NamedTuple):
    """Row `direction . (point 2 - point 1)`, points given by their arms from the body origins; without a
    direction it is the distance of the points, in the drawing `length`."""

    owner: str
    first: int
    second: int
    direction: Array | None
    first_arm: Array
    second_arm: Array
    length: float = 0.0


class Turn(NamedTuple):
    """The angle by which axes x, y, z (as rows) of both bodies have turned about z against each other."""

    owner: str
    first: int
    second: int
    frame: Array


class Rows(NamedTuple):
    """All rows of a model: right angles, offsets and distances of joints and then of inputs, and turns."""

    angles: tuple[Angle, ...]
    offsets: tuple[Offset, ...]
    turns: tuple[Turn, ...]
    senses: tuple[Angle, ...]

    def part(self, kept: Callable[[int], bool]) -> "Rows":
        """Some of the rows, by their numbers; all senses."""
        offsets, turns = len(self.angles), len(self.angles) + len(self.offsets)
        return Rows(
            tuple(row for number, row in enumerate(self.angles) if kept(number)),
            tuple(row for number, row in enumerate(self.offsets, offsets) if kept(number)),
            tuple(row for number, row in enumerate(self.turns, turns) if kept(number)),
            self.senses,
        )


def rows_of(model: Model, drawing: Drawing) -> Rows:
    """Rows of every joint and input, in body axes and units of size."""
    angles: list[Angle] = []
    offsets: list[Offset] = []
    turns: list[Turn] = []
    senses: list[Angle] = []
    for name, joint in model.joints.items():
        first, second = drawing.bodies[joint.first], drawing.bodies[joint.second]
        frame1, frame2 = joint_frames(name, joint, drawing)
        arms = (
            drawing.arm(joint.first, joint.on_first.through),
            drawing.arm(joint.second, joint.on_second.through),
        )
        if joint.kind == "distance":
            ends = joint.on_first.through, joint.on_second.through
            offsets.append(Offset(name, first, second, None, *arms, drawing.length(f"joint {name!r}", *ends)))
        offsets += [Offset(name, first, second, frame1[i], *arms) for i in OFFSETS[joint.kind]]
        angles += [Angle(name, first, second, frame1[i], frame2[j]) for i, j in RIGHT_ANGLES[joint.kind]]
        senses += [Angle(name, first, second, frame1[i], frame2[j]) for i, j in SENSES[joint.kind]]
    for name, drive in model.inputs.items():
        what, of = f"input {name!r}", (name, drawing.bodies[drive.first], drawing.bodies[drive.second])
        arms = drawing.arm(drive.first, drive.axis.through), drawing.arm(drive.second, drive.point)
        if drive.law == "turn":
            turns.append(Turn(*of, frame_about(drawing.direction(what, drive.axis))))
        elif drive.law == "distance":
            length = drawing.length(what, drive.axis.through, drive.point)
            offsets.append(Offset(*of, None, *arms, length))
        else:
            offsets.append(Offset(*of, drawing.direction(what, drive.axis), *arms))
    return Rows(tuple(angles), tuple(offsets), tuple(turns), tuple(senses))


def joint_frames(name: str, joint: Joint, drawing: Drawing) -> tuple[Array, Array]:
    """Axes x, y, z (as rows) of the joint frame of each body, as drawn.

    Where the two lines shall become one, the second frame is the first turned by the smallest
    rotation between the drawn lines: so a prismatic joint holds the turn of the drawing.
    """
    if joint.kind in WITHOUT_LINE:
        return np.eye(3), np.eye(3)
    z1 = drawing.direction(f"joint {name!r}", joint.on_first)
    z2 = drawing.direction(f"joint {name!r}", joint.on_second)
    frame1 = frame_about(z1)
    if joint.kind == "level":
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
