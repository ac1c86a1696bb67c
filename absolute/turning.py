r"""A chassis that turns: what was solved in its frame, as it is seen from the ground.

A turn by the angle t(t) about the unit axis u through the fixed point P, with U v = u x v, takes a place x to

    P + R (x - P),    R = I + sin t U + (1 - cos t) U U        (Rodrigues)

and with w = t' u, a = t'' u any vector s that is solved in the chassis' frame has, seen from the ground,

    (R s)'  = R s' + w x R s
    (R s)'' = R s'' + 2 w x R s' + a x R s + w x (w x R s)

and so on: rate and acceleration of a point with s = x - P (the term with 2 w is Coriolis'), and of a body,
whose rates are s and s', angular velocity w + R s and angular acceleration a + (R s)'. Of several turns the
next one takes what the one before has made. A displacement is added last.
"""

from dataclasses import dataclass, replace
from math import comb

import numpy as np

from absolute.solution import Array
from absolute.vectors import carried


@dataclass(frozen=True)
class Turning:
    """A turn of the chassis at N instants.

    Attributes:
        about: P, (3,), mm. axis: u, (3,). angle: t, t', t'' and so on, (N, orders), rad and s.
        rolls: whether it rolls the car.
    """

    about: Array
    axis: Array
    angle: Array
    rolls: bool

    @property
    def by_roll(self) -> "Turning":
        """The same at unit rate if it rolls the car, and at rest if not."""
        rate = np.full(len(self.angle), float(self.rolls))
        return replace(self, angle=np.stack((self.angle[:, 0], rate), axis=1))

    @property
    def rotation(self) -> Array:
        """R, (N, 3, 3)."""
        t = self.angle[:, 0, None, None]
        # A row v of this product is u x e_i: the transpose of U.
        across = np.cross(self.axis, np.eye(3)).T
        once, twice = np.sin(t) * across, 2.0 * np.sin(0.5 * t) ** 2 * (across @ across)
        return np.asarray(np.eye(3) + once + twice)

    @property
    def rates(self) -> Array:
        """w, a and so on, (orders - 1, N, 3), rad/s, rad/s^2."""
        return np.asarray(self.angle.T[1:, :, None] * self.axis)

    def seen(self, vector: Array) -> Array:
        """R s and as many of its rates as there are of s, (orders, N, 3)."""
        turned: Array = np.matvec(self.rotation, vector)
        seen = turned.copy()
        for order, rate in enumerate(turned):
            # R s^(order) turns with the chassis from then on.
            for more, part in enumerate(carried(rate, list(self.rates), len(turned) - order)[1:], 1):
                seen[order + more] += comb(order + more, order) * part
        return seen

    def seen_point(self, state: Array, base: Array) -> Array:
        """A point and its rates, (orders, N, 3), measured from a place at rest, (3,)."""
        arm, about = state.copy(), self.about - base
        arm[0] -= about
        seen = self.seen(arm)
        seen[0] += about
        return seen
