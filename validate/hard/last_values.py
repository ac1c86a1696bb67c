"""The last values that inputs can reach, to sixteen digits, from the reference alone.

A pose either is proven to exist or proven not to. Between two values of an input, one of each kind, the
interval is halved in fractions until it is shorter than 1e-16 of the input's range.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cache

import numpy as np

from validate.cars.input_limits import Linkage
from validate.hard.cars import CARS
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
        lock: what locks there: `arm`, `tie_rod` or the suspension's `upper_lock`.
    """

    value: Fraction
    reach: float
    ahead: bool
    lock: str

    def beyond(self, share: float) -> float:
        """An input beyond this end by a share of the reach, rad or mm."""
        return float(self.value + (1 if self.ahead else -1) * Fraction(share) * Fraction(self.reach))


def home(car: str, level: bool = True) -> dict[str, float]:
    """Inputs amid their ranges, from which each is driven: the arm level or as drawn, the rack as drawn."""
    drawn = Linkage.of(CARS[car]).drawn_angle
    return {"arm_angle": 0.5 * np.pi if level else drawn, "rack": 0.0}


@cache
def last_value(car: str, driven: str, ahead: bool, level: bool = True) -> LastValue:
    """The end of an input, the other one at home.

    Args:
        car: the name of one in `CARS`.
        driven: `arm_angle` or `rack`.
        ahead: whether the upper end is wanted.
        level: see `home`.
    Raises:
        ValueError: no end is near the place where plain floating point sees it.
    """
    held = home(car, level)
    linkage = Linkage.of(CARS[car])
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
    there = CARS[car]
    inputs = {name: (value, 0, 0) for name, value in values.items()}
    try:
        solve_reference(
            there.points,
            inputs,
            up=there.up,
            right=there.right,
            side=there.side,
            closure=there.closure,
            suspension=there.suspension,
            digits=DIGITS,
        )
    except InfeasibleError:
        return False
    except SingularPoseError:
        return True
    return True
