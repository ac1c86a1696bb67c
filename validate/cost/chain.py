r"""A chain of linkages of any length, with a closed form: rockers in a row, each driven by the one before.

Rocker j turns about an axis along x in a lane of its own, x = 40 j. A rod joins its tip to the next one's.
The first rocker is driven by its arm angle theta from the upward vertical,

    p_j = a_j + r_j (0, sin theta_j, cos theta_j),

with a_j = (40 j, 0, 0) and r_j = 100 mm for even j, (40 j, 0, 150) and 80 mm for odd j. Tips stay in their
lanes, so two neighbours and their rod are a planar four-bar. The pivots lie in turns on two lines, so that
every second four-bar is the first one backwards: all even rockers turn as the driven one does, all odd ones
as its follower, and a swing neither dies nor grows along the chain, however long it is. So the closed form is
one intersection of two circles. Every drawn number is an integer: nothing of the drawing is rounded.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene
from pointcoord.time_functions import Sine
from validate.extras import MissingPackage

try:
    from mpmath import mp, mpf
except ModuleNotFoundError as error:
    raise MissingPackage("validate.cost.chain", error) from None

Array = NDArray[np.float64]

LANE = 40.0  # mm
AXIS = 60.0  # mm, between the two points of a rocker's axis
RISE = 150.0  # mm, from the lower line of pivots to the upper one
ROCKERS = (100.0, 80.0)  # mm, of even and of odd number
SWING = Sine(amplitude=0.35, angular_frequency=2.0 * np.pi, phase=0.0, offset=0.5 * np.pi)
"""The driven angle, rad: about the horizontal, where it is drawn; there the height tells it best."""
STOP = 0.25  # s: a quarter of the swing
TOLERANCE = 1e-9  # mm
DIGITS = 40


@dataclass(frozen=True)
class FourBarChain:
    """A chain of `rockers` rockers, which has three unknown coordinates for each: those of its tip."""

    rockers: int

    @classmethod
    def with_unknowns(cls, unknowns: int) -> FourBarChain:
        """The chain of so many unknowns, a multiple of three.

        Raises:
            ValueError: it is none.
        """
        if unknowns < 3 or unknowns % 3:
            raise ValueError(f"a chain of {unknowns} unknowns; allowed: 3, 6, 9, ...")
        return cls(unknowns // 3)

    @property
    def tips(self) -> tuple[str, ...]:
        """Names of the rockers' tips, in order."""
        return tuple(f"tip_{j}" for j in range(self.rockers))

    @property
    def points(self) -> dict[str, Array]:
        """Where every point is drawn, mm: all rockers level."""
        found = {}
        for j in range(self.rockers):
            pivot = np.array([LANE * j, 0.0, RISE * (j % 2)])
            found[f"pivot_{j}"] = pivot
            found[f"axis_{j}"] = pivot + np.array([AXIS, 0.0, 0.0])
            found[f"tip_{j}"] = pivot + np.array([0.0, ROCKERS[j % 2], 0.0])
        return found

    @property
    def rods(self) -> dict[str, tuple[str, str]]:
        """From each tip to the next."""
        return {f"rod_{j}": (f"tip_{j - 1}", f"tip_{j}") for j in range(1, self.rockers)}

    def scene(self) -> Scene:
        """The chain over a quarter of the swing, for its positions alone."""
        axes = {j: (f"pivot_{j}", f"axis_{j}") for j in range(self.rockers)}
        rockers = {f"rocker_{j}": [*axis, f"tip_{j}"] for j, axis in axes.items()}
        mechanism = {
            "bodies": {"chassis": [name for axis in axes.values() for name in axis], **rockers},
            "rods": {name: list(ends) for name, ends in self.rods.items()},
            "inputs": {"arm_angle": {"angle": "rocker_0", "of": "tip_0", "about": "pivot_0", "from": "up"}},
            "side": "right",
            "points": {name: place.tolist() for name, place in self.points.items()},
        }
        content = {
            "title": f"chain of {self.rockers} rockers",
            "tolerance": TOLERANCE,
            "mechanism": mechanism,
            "inputs": {"arm_angle": {"sine": asdict(SWING)}},
            "time": {"start": 0.0, "stop": STOP, "samples": 6},
        }
        return Scene.from_mapping(content, "chain of four-bars")

    def closed_form(self, instants: Array) -> Array:
        """Tips at instants of shape (N,) in many digits, each rounded once: (N, rockers, 3), mm."""
        found = np.empty((len(instants), self.rockers, 3))
        found[..., 0] = LANE * np.arange(self.rockers)
        for place, t in zip(found, instants.tolist(), strict=True):
            for parity, tip in enumerate(_two_tips(t)):
                place[parity::2, 1:] = tip
        return found


def _two_tips(t: float) -> tuple[tuple[float, float], tuple[float, float]]:
    """(y, z) of an even tip and of an odd one at an instant.

    With d the vector from the even tip to the odd pivot, the odd tip is the intersection of the circles of
    radius c (the rod's drawn length in the plane) and r_1 about its ends, on the side where it is drawn.
    """
    even, odd = (mpf(length) for length in ROCKERS)
    with mp.workdps(DIGITS):
        law = SWING
        angle = mpf(law.offset) + mpf(law.amplitude) * mp.sin(
            mpf(law.angular_frequency) * mpf(t) + mpf(law.phase)
        )
        y, z = even * mp.sin(angle), even * mp.cos(angle)
        dy, dz = -y, mpf(RISE) - z
        square = dy * dy + dz * dz
        rod = (even - odd) ** 2 + mpf(RISE) ** 2
        # Share of d from the even tip to the foot of the odd one, and the height over d in parts of d.
        share = (square + rod - odd * odd) / (2 * square)
        height = mp.sqrt(rod / square - share * share)
        return (float(y), float(z)), (
            float(y + share * dy + height * dz),
            float(z + share * dz - height * dy),
        )
