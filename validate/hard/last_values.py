"""The last values that inputs can reach, to sixteen digits, from the reference alone.

A pose either is proven to exist or proven not to. Between two values of an input, one of each kind, the
interval is halved in fractions until it is shorter than 1e-16 of the input's range.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache

import numpy as np

from validate.cars.car import RIGHT, UP, Car, any_rotation, as_tuple, mirrored, turned
from validate.cars.input_limits import Linkage
from validate.cars.macpherson import BESIDE
from validate.hard.cars import BESIDE_CAR, PAPER_CAR, WIDE_CAR
from validate.reference import InfeasibleError, SingularPoseError, solve_reference

DIGITS = 15  # of the reference: only whether there is a pose counts, which is proven anyhow
NEAR = 1e-6  # of the range: what the rough end, good to rounding, is off by at most
HALVED = Fraction(1, 10**16)  # of the range


@dataclass(frozen=True)
class LastValue:
    """One end of an input, the others held.

    Attributes:
        value: rad or mm; poses exist up to here.
        reach: distance from this end to the opposite one, rad or mm.
        ahead: whether it is the upper end.
        lock: what locks there, `arm`, `strut` or `tie_rod`.
    """

    value: Fraction
    reach: float
    ahead: bool
    lock: str

    def beyond(self, share: float) -> float:
        """An input beyond this end by a share of the reach, rad or mm."""
        return float(self.value + (1 if self.ahead else -1) * Fraction(share) * Fraction(self.reach))


def car_called(name: str) -> Car:
    """The paper's car; `beside` and `wide`, whose struts pass beside the ball joint; or `turned`.

    That is `beside` mirrored, turned about three axes and 4e6 mm from the origin.
    """
    known = {"paper": PAPER_CAR, "beside": BESIDE_CAR, "wide": WIDE_CAR}
    if name in known:
        return known[name]
    turn, shift = any_rotation(9), np.array([3e6, -2e6, 2e6])
    there = turned(Car(mirrored(BESIDE), "right", UP, RIGHT), turn)
    return replace(there, points={n: as_tuple(np.array(p) + shift) for n, p in there.points.items()})


def home(car: str, level: bool = True) -> dict[str, float]:
    """Inputs amid their ranges, from which each is driven: the arm level or as drawn, the rack as drawn."""
    drawn = Linkage.of(car_called(car)).drawn_angle
    return {"arm_angle": 0.5 * np.pi if level else drawn, "rack": 0.0}


@cache
def last_value(car: str, driven: str, ahead: bool, level: bool = True) -> LastValue:
    """The end of an input, the other one at home.

    Args:
        car: a name that `car_called` knows.
        driven: `arm_angle` or `rack`.
        ahead: whether the upper end is wanted.
        level: see `home`.
    Raises:
        ValueError: no end is near the place where plain floating point sees it.
    """
    held = home(car, level)
    linkage = Linkage.of(car_called(car))
    this, opposite = (linkage.end(held, driven, way) for way in (ahead, not ahead))
    if this is None or opposite is None:
        raise ValueError(f"{driven} of the car {car!r} has no end on one of its sides")
    reach = abs(this[0] - opposite[0])
    outward = 1 if ahead else -1
    inside = Fraction(this[0]) - outward * Fraction(NEAR * reach)
    outside = Fraction(this[0]) + outward * Fraction(NEAR * reach)
    if not reachable(car, held | {driven: inside}) or reachable(car, held | {driven: outside}):
        raise ValueError(f"{driven} of the car {car!r} has no end near {this[0]!r}")
    while abs(outside - inside) > HALVED * Fraction(reach):
        middle = (inside + outside) / 2
        if reachable(car, held | {driven: middle}):
            inside = middle
        else:
            outside = middle
    return LastValue(inside, reach, ahead, this[1])


def reachable(car: str, values: Mapping[str, Fraction | float]) -> bool:
    """Whether a pose exists at these values of the inputs, which is proven.

    A pose that is singular to 400 digits counts as existing: it is the end itself.
    """
    hardpoints = car_called(car)
    inputs = {name: (value, 0, 0) for name, value in values.items()}
    try:
        solve_reference(
            hardpoints.points,
            inputs,
            up=hardpoints.up,
            right=hardpoints.right,
            side=hardpoints.side,
            closure=hardpoints.closure,
            digits=DIGITS,
        )
    except InfeasibleError:
        return False
    except SingularPoseError:
        return True
    return True
