"""What stands in the way where a motion ends: joints that hold each other, and the input that meets it."""

import numpy as np

from absolute.mechanism import Mechanism
from absolute.newton import Configurations
from absolute.vectors import Array

# A motion is followed until a fold is about sqrt(eps) away, and the smallest singular value there is of that
# order, times ratios of lengths: this is ten thousand times as much.
LARGEST_SHARE = 1e-4
# Joints with less of the largest force than this carry what the others hold each other with.
SMALLEST_FORCE = 0.1


def limits_at(mechanism: Mechanism, pose: Configurations) -> tuple[str, ...]:
    """Joints that hold each other near a singular pose, the strongest first; empty where none is near.

    There some forces y in the rows are in equilibrium, y J = 0 nearly, without any load: in the group of
    bodies whose block is nearest to singular.
    """
    numbers, jacobian = np.arange(mechanism.stack.count)[pose.choice.kept], pose.kept[0]
    groups = pose.choice.groups
    blocks = [(numbers[rows], np.linalg.svd(jacobian[rows[:, None], columns])) for rows, columns in groups]
    rows, (left, strengths, _) = min(blocks, key=lambda found: float(found[1][1][-1] / found[1][1][0]))
    if not strengths[-1] <= LARGEST_SHARE * strengths[0]:
        return ()
    forces: dict[str, float] = {}
    for row, force in zip(rows.tolist(), left[:, -1].tolist(), strict=True):
        if row < mechanism.joint_rows:
            owner = mechanism.stack.owners[row]
            forces[owner] = forces.get(owner, 0.0) + force * force
    least = SMALLEST_FORCE**2 * max(forces.values(), default=0.0)
    return tuple(
        sorted((owner for owner in forces if forces[owner] >= least), key=lambda owner: -forces[owner])
    )


def limiting_input(mechanism: Mechanism, pose: Configurations, change: Array) -> str:
    """The input whose change, (inputs,) in units of its row, the bodies cannot follow near a singular pose.

    There some y has y J = 0 nearly, so that rows may only change at right angles to y: the input with
    the largest product of its change and its part in y is named.
    """
    left = np.linalg.svd(pose.kept[0])[0]
    # The rows of the inputs come last and are all kept.
    blocked = np.abs(left[-len(change) :, -1] * change)
    return mechanism.model.inputs[int(np.argmax(blocked))].value


def limited_by(limits: tuple[str, ...]) -> str:
    """The links of a refusal as part of its message."""
    return f"limited by {', '.join(limits)}; " if limits else ""
