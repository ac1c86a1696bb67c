"""How far the inputs of a car go before its links cannot follow, in plain floating point.

The lower arm has two dead points, where its ball joint is highest or lowest on its circle. What holds the
knuckle's upper end locks by itself: the slide of a strut runs out where the ball joint is as near to the
strut's top as it lies beside the strut's axis; upper arm and kingpin of a double wishbone come to lie in one
plane with the upper pivots. Tie rod and steering arm can come to lie in line. All three are taken from the
closed form, apart from the models and from the reference.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from validate.cars.car import Car
from validate.cars.closed_form import BALL, INNER, OUTER, RACK, REAR, ClosedForm
from validate.cars.registry import suspension_of
from validate.cars.suspension import Suspension

Array = NDArray[np.float64]
Inputs = dict[str, float]

DRIVEN = ("arm_angle", "rack")
ARM, TIE_ROD = "arm", "tie_rod"
SCAN = 200  # places between the drawing and the end of an input where a lock is looked for
PATH = 60  # places on the way from the drawing where there must be room
PARTS, ROUNDS = 64, 10  # dividing an interval in 64 parts ten times leaves 2^-60 of it: rounding
SHORT = 0.05  # of the car: links no shorter make a sound car


@dataclass(frozen=True)
class Linkage:
    """How far a car's inputs go; arrays of inputs at once."""

    form: ClosedForm
    suspension: Suspension

    @classmethod
    def of(cls, car: Car) -> Linkage:
        """Taken from a car's hardpoints."""
        suspension = suspension_of(car)
        return cls(suspension.form.of(car), suspension)

    @property
    def p(self) -> Mapping[str, Array]:
        """The drawing, from the arm's front pivot."""
        return self.form.p

    @property
    def up(self) -> Array:
        """Upward."""
        return self.form.up

    @property
    def right(self) -> Array:
        """To the right."""
        return self.form.right

    @property
    def size(self) -> float:
        """Largest distance of a point from the arm's front pivot."""
        return max(float(np.linalg.norm(place)) for place in self.p.values())

    @property
    def arm_length(self) -> float:
        """From the front pivot to the ball joint."""
        return float(np.linalg.norm(self.p[BALL]))

    @property
    def steering_arm(self) -> float:
        """From the ball joint to the tie rod's outer end."""
        return float(np.linalg.norm(self.p[OUTER] - self.p[BALL]))

    @property
    def drawn_angle(self) -> float:
        """Arm angle of the drawing."""
        return math.acos(float(self.p[BALL] @ self.up) / self.arm_length)

    @property
    def drawn_rack(self) -> float:
        """Rack travel of the drawing; positive against `right`."""
        return -float((self.p[INNER] - self.p[RACK]) @ self.right)

    @property
    def home(self) -> Inputs:
        """The inputs of the drawing."""
        return {"arm_angle": self.drawn_angle, "rack": self.drawn_rack}

    @property
    def sound(self) -> bool:
        """Whether no link is shorter than a twentieth of the car, nor the arm drawn at its dead point."""
        axis, ball = self.p[REAR], self.p[BALL]
        flat = abs(float(np.cross(axis, self.up) @ ball)) / float(np.linalg.norm(axis) * self.arm_length)
        lengths = (float(np.linalg.norm(self.p[a] - self.p[b])) for a, b in self.suspension.links)
        return min(lengths) > SHORT * self.size and flat > SHORT

    def dead_points(self) -> tuple[float, float]:
        """Arm angles at which the ball joint is highest and lowest on its circle about the arm's axis."""
        axis, ball = self.p[REAR], self.p[BALL]
        along = float(axis @ ball) / float(axis @ axis)
        radius = float(np.linalg.norm(ball - along * axis))
        middle = along * float(axis @ self.up)
        across = self.up - axis * float(axis @ self.up) / float(axis @ axis)
        swing = radius * float(np.linalg.norm(across))
        high, low = (min(1.0, max(-1.0, (middle + s) / self.arm_length)) for s in (swing, -swing))
        return math.acos(high), math.acos(low)

    def spare(self, angle: Array, rack: Array) -> Array:
        """How far upper end and tie rod are from their ends, the nearer of both; see `ClosedForm`.

        Negative or not a number where there is no pose.
        """
        with np.errstate(invalid="ignore", divide="ignore"):
            upper = self.form.upper_spare(angle)
            return np.asarray(np.minimum(upper, self.form.tie_spare(angle, rack)))

    def end(self, inputs: Inputs, driven: str, ahead: bool) -> tuple[float, str] | None:
        """Last value of an input that can be reached from `inputs`, and what locks there; None if none."""
        start = inputs[driven]
        if driven == "arm_angle":
            low, high = self.dead_points()
            limit, lock = (high if ahead else low), ARM
        else:
            limit, lock = start + (2.0 if ahead else -2.0) * self.size, ""

        def spare(values: Array) -> Array:
            pair = {name: np.full_like(values, inputs[name]) for name in DRIVEN} | {driven: values}
            return self.spare(pair["arm_angle"], pair["rack"])

        s = np.linspace(1.0, 0.0, SCAN + 1)
        if driven == "arm_angle":
            # The ball joint moves as the root of the way to a dead point, where the root is of rounding.
            s = s[:-1] ** 2
        values = limit + s * (start - limit)
        open_ = spare(values) > 0.0
        if not open_[0]:
            return None
        if open_.all():
            return (limit, lock) if lock else None
        first = int(np.argmin(open_))
        inside, outside = _narrowed(spare, float(values[first - 1]), float(values[first]))
        return inside, self._lock(np.array(outside)) if driven == "arm_angle" else TIE_ROD

    def _lock(self, angle: Array) -> str:
        """What has no place any more at an arm angle beyond an end."""
        if np.isnan(self.form.ball_joint(angle)).any():
            return ARM
        return TIE_ROD if float(self.form.upper_spare(angle)) > 0.0 else self.suspension.upper_lock

    def ends(self, inputs: Inputs, driven: str) -> list[tuple[float, str]]:
        """The ends of an input, upper and lower, as far as it has them."""
        found = (self.end(inputs, driven, ahead) for ahead in (True, False))
        return [end for end in found if end is not None]

    def way_is_open(self, home: Inputs, inputs: Inputs) -> bool:
        """Whether there is room all along the straight way of ball joint height and rack."""
        s = np.linspace(0.0, 1.0, PATH)
        rise = (1.0 - s) * math.cos(home["arm_angle"]) + s * math.cos(inputs["arm_angle"])
        rack = (1.0 - s) * home["rack"] + s * inputs["rack"]
        return bool((self.spare(np.arccos(rise), rack)[:-1] > 1e-3 * (1.0 - s[:-1])).all())


def _narrowed(spare: Callable[[Array], Array], inside: float, outside: float) -> tuple[float, float]:
    for _ in range(ROUNDS):
        values = np.linspace(inside, outside, PARTS + 1)
        shut = ~(spare(values[1:]) > 0.0)
        first = int(np.argmax(shut)) if shut.any() else PARTS - 1
        inside, outside = float(values[first]), float(values[first + 1])
    return inside, outside
