"""What stands in the way where a motion ends: the links at their dead point, and the input that meets it."""

import numpy as np

from absolute.mechanism import Mechanism
from absolute.solution import Array

# A motion is followed until a fold is about sqrt(eps) away, and a share there is of that order, times
# ratios of lengths: this is ten thousand times as much.
LARGEST_SHARE = 1e-4
# Two branch signs whose shares differ by less than this factor have come to their ends together.
TOGETHER = 10.0


def limits_at(mechanism: Mechanism, world: Array) -> tuple[str, ...]:
    """Links at their dead point, from placed features; empty where no branch sign is near zero."""
    signs = mechanism.branch_signs
    shares = np.abs(signs.shares(world))
    smallest = float(shares.min(initial=1.0))
    if not smallest <= LARGEST_SHARE:
        return ()
    near = np.flatnonzero(shares <= TOGETHER * smallest).tolist()
    return tuple(dict.fromkeys(link for place in near for link in signs.limits[place]))


def limiting_input(mechanism: Mechanism, jacobian: Array, change: Array) -> str:
    """The input whose change, (inputs,) in units of its row, the bodies cannot follow near a singular pose.

    There some y has y J = 0 nearly, so that rows may only change at right angles to y: the input with
    the largest product of its change and its part in y is named.
    """
    left = np.linalg.svd(jacobian)[0]
    blocked = np.abs(left[mechanism.joint_rows :, -1] * change)
    return tuple(mechanism.model.inputs)[int(np.argmax(blocked))]


def limited_by(limits: tuple[str, ...]) -> str:
    """The links of a refusal as part of its message."""
    return f"limited by {', '.join(limits)}; " if limits else ""
