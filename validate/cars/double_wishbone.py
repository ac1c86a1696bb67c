"""The double wishbone on the cars' side: its closed form, base car and random drawings.

The upper arm's ball joint goes round the upper pivots on a circle, and is as far from the lower ball joint as
the knuckle is high: the question of `closed_form.swing`, asked once more. Where it has no answer, the upper
arm and the kingpin lie in one plane with the upper pivots and lock.

A random car is drawn about the front suspension of the base car. Free points lie up to a hundred millimetres
from it in every coordinate; the ball joints stay outboard of their pivots and the upper one above the lower,
and a tie rod lies behind the kingpin or ahead of it. One car in two is out of the ordinary besides: its arm
pivots lie close together, its arms are long, its kingpin is short, or it leans.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from validate.cars import random_parts as parts
from validate.cars.arithmetic import Array, dot, sign, unit
from validate.cars.car import Car, Closure, Drawing, Points, Uniform, mirrored
from validate.cars.closed_form import BALL, FRONT, INNER, OUTER, RACK, REAR, ClosedForm, Kingpin, swing
from validate.cars.suspension import Suspension

UPPER_FRONT, UPPER_REAR, UPPER_BALL = "upper_arm_front", "upper_arm_rear", "upper_ball_joint"
CENTRE, AXIS = "wheel_centre", "wheel_axis_inner"
UPPER_ARM = "upper_arm"

# The front suspension of a small sports car, right wheel: the example of Lotus Suspension Analysis (SHARK)
# 4.03, as printed in its report; x rearward, y right, z up, mm.
LOTUS: Points = {
    FRONT: (-110.0, 257.0, 69.0),
    REAR: (90.0, 257.0, 78.0),
    UPPER_FRONT: (-91.0, 388.0, 255.0),
    UPPER_REAR: (109.0, 388.0, 255.0),
    BALL: (-10.0, 673.0, 95.0),
    UPPER_BALL: (9.0, 646.0, 315.0),
    OUTER: (-120.0, 650.0, 225.0),
    INNER: (-10.0, 178.0, 154.0),
    CENTRE: (0.0, 718.0, 210.0),
    AXIS: (0.0, 658.0, 210.0),
}


@dataclass(frozen=True)
class WishboneForm(ClosedForm):
    """A double wishbone with what its drawing fixes.

    Attributes:
        upper_side: sign of the drawing: the upper ball joint beside the plane of the upper pivots and the
            lower ball joint.
    """

    upper_side: int

    chassis = (FRONT, REAR, UPPER_FRONT, UPPER_REAR, RACK)
    knuckle = (BALL, UPPER_BALL, OUTER, CENTRE, AXIS)

    @classmethod
    def own_of(cls, p: Mapping[str, Array], car: Car) -> tuple[dict[str, Any], Array]:
        """The upper arm's side; the kingpin is drawn from one ball joint to the other."""
        pivot, upper, ball = p[UPPER_FRONT], p[UPPER_BALL], p[BALL]
        side = sign(dot(np.cross(p[UPPER_REAR] - pivot, ball - pivot), upper - pivot))
        return {"upper_side": side}, upper - ball

    def kingpin(self, angle: ArrayLike) -> Kingpin:
        """The line from the lower ball joint to the upper one.

        Its `spare` is the square of the upper ball joint's height over the plane of the upper pivots and the
        lower ball joint, in parts of the square of the ball joints' distance.
        """
        ball = self.ball_joint(angle)
        pivot = self.p[UPPER_FRONT]
        arm, drawn = self.p[UPPER_BALL] - pivot, self.p[UPPER_BALL] - self.p[BALL]
        along = np.broadcast_to(unit(self.p[UPPER_REAR] - pivot), ball.shape)
        upper_arm = swing(arm, along, along, ball - pivot, drawn)
        climb = dot(np.broadcast_to(arm, along.shape), along)
        outwards = upper_arm.outwards(along, self.upper_side)
        upper = pivot + climb[..., None] * along + upper_arm.radius[..., None] * outwards
        in_knuckle = np.broadcast_to(unit(drawn), ball.shape)
        return Kingpin(ball, unit(upper - ball), in_knuckle, np.asarray(upper_arm.spare / dot(drawn, drawn)))


OUTBOARD = 60.0  # mm, of a ball joint from its pivots, at least, and of the wheel from both ball joints
HIGH = 80.0  # mm, of the upper ball joint above the lower one, at least
FREE = (FRONT, REAR, UPPER_FRONT, UPPER_REAR, BALL, UPPER_BALL, OUTER, RACK, CENTRE)
LEFT = mirrored(LOTUS | {RACK: LOTUS[INNER]})
PIVOTS = {BALL: (FRONT, REAR), UPPER_BALL: (UPPER_FRONT, UPPER_REAR)}


def random_wishbone(uniform: Uniform, closure: Closure, reach: float, left_over: float) -> Drawing:
    """A left-hand double wishbone (see `suspension.RandomDrawing`)."""
    # The base car is half as large as the paper's strut, and so are its free points' ways.
    points = parts.free_points(uniform, LEFT, FREE, 0.5 * reach)
    for joint, pivots in PIVOTS.items():
        points[joint][1] = min(points[joint][1], *(points[name][1] - OUTBOARD for name in pivots))
    points[UPPER_BALL][2] = max(points[UPPER_BALL][2], points[BALL][2] + HIGH)
    if uniform(0.0, 1.0) < 0.5:
        points = _out_of_the_ordinary(uniform, points)
    points[CENTRE][1] = min(points[CENTRE][1], *(points[name][1] - OUTBOARD for name in PIVOTS))
    points = parts.steered_from_ahead(uniform, points)
    return parts.with_rack(uniform, points, left_over) | parts.spin_axis(uniform, points[CENTRE])


def _out_of_the_ordinary(uniform: Uniform, points: Drawing) -> Drawing:
    """Thin, far, flat or leaning: one joint's proportions changed."""
    what, share = int(uniform(0.0, 4.0)) % 4, uniform(0.0, 1.0)
    if what == 0:
        # Both arms turn about lines through points that are close together.
        for front, rear in PIVOTS.values():
            points = points | {rear: points[front] + (0.1 + 0.3 * share) * (points[rear] - points[front])}
        return points
    if what == 1:
        # Arms up to four times as long, as of a car whose pivots are on its middle or beyond.
        inwards = np.array([0.0, 3.0 * share * 400.0, 0.0])
        return points | {name: points[name] + inwards for pair in PIVOTS.values() for name in pair}
    if what == 2:
        # The knuckle as low as a fifth of its height.
        upper, lower = points[UPPER_BALL], points[BALL]
        return points | {UPPER_BALL: lower + (0.2 + 0.6 * share) * (upper - lower)}
    lean = np.array([uniform(-150.0, 150.0), uniform(-60.0, 60.0), 0.0])
    return points | {UPPER_BALL: points[UPPER_BALL] + lean}


def with_short_lower_arm(uniform: Uniform, drawn: Drawing) -> Drawing:
    """The lower pivots moved outboard until the ball joint's circle is small enough for the upper arm."""
    ball = drawn[BALL]
    middle = 0.5 * (drawn[FRONT] + drawn[REAR])
    wanted = uniform(40.0, 120.0)
    away = (1.0 - wanted / float(np.linalg.norm(ball - middle))) * (ball - middle)
    return drawn | {name: drawn[name] + away for name in (FRONT, REAR)}


def with_short_upper_arm(uniform: Uniform, drawn: Drawing) -> Drawing:
    """The upper pivots moved outboard until the upper arm is too short for the lower arm's whole way."""
    ball = drawn[UPPER_BALL]
    middle = 0.5 * (drawn[UPPER_FRONT] + drawn[UPPER_REAR])
    wanted = uniform(60.0, 160.0)
    away = (1.0 - wanted / float(np.linalg.norm(ball - middle))) * (ball - middle)
    return drawn | {name: drawn[name] + away for name in (UPPER_FRONT, UPPER_REAR)}


def _flat_upper_arm(rng: np.random.Generator, points: Drawing, left: float) -> Drawing:
    """The upper ball joint moved towards the plane of the upper pivots and the lower ball joint."""
    pivot, upper = points[UPPER_FRONT], points[UPPER_BALL]
    normal = unit(np.cross(points[UPPER_REAR] - pivot, points[BALL] - pivot))
    return points | {UPPER_BALL: upper - (1.0 - left) * ((upper - pivot) @ normal) * normal}


DOUBLE_WISHBONE = Suspension(
    name="double_wishbone",
    form=WishboneForm,
    base={"drawn": Car(LOTUS, "right", suspension="double_wishbone")},
    drawing=random_wishbone,
    kingpin=(BALL, UPPER_BALL),
    links=(
        *((FRONT, BALL), (UPPER_FRONT, UPPER_BALL), (BALL, UPPER_BALL)),
        *((BALL, OUTER), (UPPER_BALL, OUTER), (OUTER, INNER)),
    ),
    upper_lock=UPPER_ARM,
    with_arm_lock=with_short_lower_arm,
    with_upper_lock=with_short_upper_arm,
    sides={
        "drawn": {
            "upper arm": (UPPER_FRONT, UPPER_REAR, BALL, UPPER_BALL),
            "tie": (BALL, UPPER_BALL, INNER, OUTER),
        }
    },
    nearly_singular={
        "drawn": {
            name: parts.without_rack_centre(nearly)
            for name, nearly in (
                ("dead arm", parts.dead_arm),
                ("toggle", parts.flat_tie_rod(UPPER_BALL)),
                ("thin knuckle", parts.thin_knuckle(UPPER_BALL)),
                ("flat upper arm", _flat_upper_arm),
            )
        }
    },
)
