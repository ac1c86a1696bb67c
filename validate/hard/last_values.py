"""The last values that inputs can reach, to sixteen digits, from the truth alone.

A pose either is proven to exist or proven not to. Between two values of an input, one of each kind, the
interval is halved in fractions until it is shorter than 1e-16 of the input's range.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cache

import numpy as np

from validate.input_ends import Car, Linkage
from validate.paper_car import PAPER
from validate.truth import InfeasibleError, SingularPoseError, solve_truth

DIGITS = 15  # of the truth: only whether there is a pose counts, which is proven anyhow
NEAR = 1e-6  # of the range: what the rough end, good to rounding, is off by at most
HALVED = Fraction(1, 10**16)  # of the range


@dataclass(frozen=True)
class LastValue:
    """One end of an input, the others held.

    Attributes:
        value: rad or mm; poses exist up to here.
        reach: distance from this end to the opposite one, rad or mm.
        ahead: whether it is the upper end.
        closure: what locks there, `arm` or `tie_rod`.
    """

    value: Fraction
    reach: float
    ahead: bool
    closure: str

    def beyond(self, share: float) -> float:
        """An input beyond this end by a share of the reach, rad or mm."""
        return float(self.value + (1 if self.ahead else -1) * Fraction(share) * Fraction(self.reach))


def car_called(name: str) -> Car:
    """The paper's car, or `turned`: mirrored, turned about three axes and 4e6 mm from the origin."""
    if name == "paper":
        return Car(dict(PAPER), "left", (0.0, 0.0, 1.0), (0.0, 1.0, 0.0))
    turn = np.linalg.qr(np.random.default_rng(9).normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    shift = np.array([3e6, -2e6, 2e6])
    moved = {name: turn @ (np.array(place) * (1.0, -1.0, 1.0)) + shift for name, place in PAPER.items()}
    points = {name: (float(x), float(y), float(z)) for name, (x, y, z) in moved.items()}
    up, right = ((float(x), float(y), float(z)) for x, y, z in (turn[:, 2], turn[:, 1]))
    return Car(points, "right", up, right)


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
        solve_truth(
            hardpoints.points,
            inputs,
            up=hardpoints.up,
            right=hardpoints.right,
            side=hardpoints.side,
            digits=DIGITS,
        )
    except InfeasibleError:
        return False
    except SingularPoseError:
        return True
    return True
