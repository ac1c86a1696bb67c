"""What an effect is: one number of a pose."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass

import validate.reference.car_data as given
from validate.reference.effects.car import DAMPER, KNUCKLE, STEERING, WHEEL
from validate.reference.vectors import Scalar

TRAVEL, RACK, ROLL, TIME = "by_travel", "by_rack", "by_roll", "by_time"
PAIR = "pair"

NEEDS = {
    WHEEL: "the role wheel_axis",
    STEERING: "the role steering_axis",
    DAMPER: "the role damper",
    KNUCKLE: "the role knuckle, a body that moves",
    given.RADIUS: "a wheel_radius, mm",
    TRAVEL: "exactly one driven input that is not the travel of a slide and steers none",
    RACK: "exactly one driven input that is the travel of a slide or steers one",
    ROLL: "exactly one driven input that turns the chassis about a line along the car",
    PAIR: "two parts on opposite sides of the car",
    given.AXLE: "the car's axle, 'front' or 'rear'",
    given.WHEELBASE: "the car's wheelbase, mm",
    given.HEIGHT: "the car's centre_of_gravity_height, mm",
    given.BRAKE_SHARE: "the car's brake_share, 0 to 1",
    given.DRIVE_SHARE: "the car's drive_share, 0 to 1",
    given.SPRING_RATE: "the car's spring_rate, N/mm",
    given.FREE_LENGTH: "the car's spring_free_length, mm",
}


@dataclass(frozen=True)
class Effect:
    """A number of a pose.

    Attributes:
        name: what results call it, behind the prefix of its part if there are parts.
        unit: of the number, a unit or a quotient of two.
        needs: what the car must have, of `NEEDS`; with `PAIR` each of the two parts.
        evaluate: the number of a `Car`, or with `PAIR` of the left and the right one, in their kind of scalar
            and their lengths; not a finite ball where it is undefined.
        along: None, or `TRAVEL`, `RACK`, `ROLL` or `TIME`: the numbers of the car are duals, whose slopes are
            by the one driven input that is not the travel of a slide, in any unit, by the one that is, in the
            car's own lengths, or by the one that rolls the chassis, rad, while the others rest; or by time,
            as all of them move.
    """

    name: str
    unit: str
    needs: tuple[str, ...]
    evaluate: Callable[..., Scalar]
    along: str | None = None

    @property
    def power(self) -> int:
        """Of a unit of length, which the number in the car's own lengths is multiplied by."""
        # A force is the rate of a spring, N/mm, times a length.
        above, below = (int(part in ("mm", "N")) for part in f"{self.unit}/".split("/")[:2])
        return above - below

    def lacks(self, has: Collection[str]) -> str:
        """What it needs and a car does not have, in words; empty if it can be had."""
        return " and ".join(NEEDS[one] for one in self.needs if one not in has)
