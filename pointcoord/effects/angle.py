r"""Effects that are angles: how a line of the car leans, seen along one of the car's axes.

An angle is atan2(p, q) with p and q the components of the line along two directions of the car, so that it is
measured in the plane of the two. It is positive where the line has a part along the first. One that was found
as f is off by d with sin d = (p cos f - q sin f) / |(p, q)|.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from pointcoord.effects.effect import Doubt, Effect, Point, Poses, Quantity, no_role
from pointcoord.errors import UnknownName
from pointcoord.linkage.car_axes import CarAxes, Direction
from pointcoord.linkage.topology import Topology
from pointcoord.numerics.enclosure import Enclosed
from pointcoord.numerics.rounding import EPS, UNIT_ROUNDOFF

if TYPE_CHECKING:
    from pointcoord.bounds.enclosed_points import EnclosedPoses
    from pointcoord.bounds.proof import Numbers

Array = NDArray[np.float64]

WHEEL = Quantity("wheel", "wheel angle", "rad", "car")
AXES = {"wheel_axis": "the wheel's spin axis", "steering_axis": "the steering axis"}


@dataclass(frozen=True)
class Angle:
    """An angle of a line of the car, in a plane of the car's axes; rad.

    Attributes:
        name: in results and files.
        words: for people.
        sign: where it is positive, in words.
        line: the axis that the topology names so, from its first point to its second.
        sine, cosine: the directions along which the line has the angle's sine and cosine.
        steepest: degrees beyond which a drawing looks misdrawn.
        steepest_by_default: the same where the line starts at a point that only stands in for its own.
    """

    name: str
    words: str
    sign: str
    line: Literal["wheel_axis", "steering_axis"]
    sine: Direction
    cosine: Direction
    steepest: float = 180.0
    steepest_by_default: float = 180.0

    def ends(self, topology: Topology) -> tuple[str, str]:
        """The two points that the line runs through."""
        ends = self.axis(topology)
        if not ends:
            raise UnknownName("role", self.line, ())
        start, end = ends
        return start, end

    def axis(self, topology: Topology) -> tuple[str, ...]:
        """The same; empty where the mechanism has no such role."""
        return topology.wheel_axis if self.line == "wheel_axis" else topology.steering_axis

    def value(self, start: Array, end: Array, axes: CarAxes) -> Array:
        """atan2(line . sine, line . cosine) of a line from start to end, (..., 3); shape (...,)."""
        line = end - start
        return np.asarray(np.arctan2(axes.component(line, self.sine), axes.component(line, self.cosine)))

    def errors(self, start: Enclosed, end: Enclosed, axes: CarAxes, found: Array) -> Array:
        """Proven and expected error of a value that was found, (2, N), rad."""
        line = end - start
        return angle_error(axes.enclosed(line, self.sine), axes.enclosed(line, self.cosine), found)


@dataclass(frozen=True)
class WheelAngles(Effect):
    """Angles of the wheel or of what it turns about."""

    angles: tuple[Angle, ...]

    @classmethod
    def of(cls, name: str, gives: str, *angles: Angle) -> WheelAngles:
        """The effect that gives some angles."""
        sign = "; ".join(f"{angle.words}: positive {angle.sign}" for angle in angles)
        return cls(name, gives, sign, derivative=0, quantities=(WHEEL,), angles=angles)

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the angles."""
        return tuple(angle.name for angle in self.angles)

    @property
    def lines(self) -> tuple[str, ...]:
        """The axes whose angles they are."""
        return tuple(dict.fromkeys(angle.line for angle in self.angles))

    @property
    def lengthwise(self) -> tuple[str, ...]:
        """The angles that are measured from the front or the rear."""
        along = {"forward", "rearward"}
        return tuple(angle.words for angle in self.angles if along & {angle.sine, angle.cosine})

    def needs(self, topology: Topology) -> Collection[str]:
        """The points on these axes."""
        return {point for angle in self.angles for point in angle.ends(topology)}

    def evaluate(self, poses: Poses) -> dict[str, dict[str, Array]]:
        """Each angle, (..., N), rad."""
        places, found = poses.states[0], {}
        for angle in self.angles:
            start, end = angle.ends(poses.mechanism.topology)
            found[angle.name] = angle.value(places[start], places[end], poses.axes)
        return {WHEEL.name: found}

    def errors(self, poses: EnclosedPoses, numbers: Numbers) -> dict[str, dict[str, Array]]:
        """From the exact components of each line along the two directions (see `angle_error`)."""
        places, found = poses.points[0], {}
        for angle in self.angles:
            start, end = angle.ends(poses.mechanism.topology)
            reported = numbers[WHEEL.name][angle.name]
            found[angle.name] = angle.errors(places[start], places[end], poses.axes, reported)
        return {WHEEL.name: found}

    def refusal(self, topology: Topology, drawn: Mapping[str, Point]) -> str:
        """A line has no direction where the point that stands in for one of its own lies on the other."""
        for angle in self.angles:
            if not angle.axis(topology):
                return no_role(self.name, angle.line, topology)
            start, end = angle.ends(topology)
            own = _missing(topology, start)
            if own and drawn[start] == drawn[end]:
                return (
                    f"{start} and {end} are at the same place, so that {AXES[angle.line]} has no direction; "
                    f"give the axis a point of its own, {own}, or leave {self.name!r} out"
                )
        return ""

    def doubts(
        self,
        topology: Topology,
        drawn: Mapping[str, Array],
        axes: CarAxes,
        told: Mapping[str, NDArray[np.bool_]],
    ) -> tuple[Doubt, ...]:
        """Angles of drawings that are steeper than any car's."""
        return tuple(
            _steep(angle, topology, drawn, axes, told.get(angle.line, np.array(False)))
            for angle in self.angles
            if angle.axis(topology)
        )


def _steep(
    angle: Angle, topology: Topology, drawn: Mapping[str, Array], axes: CarAxes, told: NDArray[np.bool_]
) -> Doubt:
    start, end = angle.ends(topology)
    limit = angle.steepest_by_default if _missing(topology, start) else angle.steepest
    degrees = np.degrees(angle.value(drawn[start], drawn[end], axes))

    def words(member: tuple[int, ...]) -> str:
        steepness = float(degrees[member])
        return (
            f"the drawn {angle.words} is {steepness:.4g} deg, that of the line from {start} to {end}: "
            f"{'are they swapped' if abs(steepness) > 90.0 else 'is one of them misdrawn'}?"
        )

    return Doubt(~told & (np.abs(degrees) > limit), words)


def _missing(topology: Topology, point: str) -> str:
    """The point that another one stands in for; empty if it stands for itself only."""
    missing = (name for name, other in topology.stand_ins.items() if other == point)
    return next((name for name in missing if name not in topology.points), "")


def angle_error(sine: Enclosed, cosine: Enclosed, found: Array) -> Array:
    """Proven and expected error of an angle atan2(sine, cosine) that was found, (2, N), rad; at most pi."""
    c, s = (
        sine.like(part, 2.0 * UNIT_ROUNDOFF, 2.0 * UNIT_ROUNDOFF) for part in (np.cos(found), np.sin(found))
    )
    off = sine * c - cosine * s
    with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
        long = np.hypot(sine.middle, cosine.middle)
        reach = long - 2.0 * np.maximum(sine.radius[0], cosine.radius[0])
        proven = (np.abs(off.middle) + off.radius[0]) / np.where(reach > 0.0, reach, 0.0)
        expected = off.radius[1] / long + 4.0 * EPS
        # The arc of a sine below 1/2 is at most 1 + x^2 times as long as the sine.
        turn = np.stack([proven, expected])
        ahead = sine.middle * np.sin(found) + cosine.middle * np.cos(found) > 0.0
        return np.where((turn < 0.5) & np.stack([ahead, ahead | True]), turn * (1.0 + turn**2), np.pi)
