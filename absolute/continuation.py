"""From one pose to another along a path of targets, without leaving the branch."""

import math
from collections.abc import Callable

from absolute.mechanism import Mechanism
from absolute.newton import Pose, accelerations, correct, held_at
from absolute.precision import EPS
from absolute.solution import Array
from absolute.vectors import cross

# A path: share of the way in [0, 1] -> (3, rows) target of the rows, its first and second derivative.
Path = Callable[[float], Array]

# All bodies together turn and move by half (2-norm, rad and units of size) in one step at most:
# over that distance the second-order prediction holds for any linkage that is not near a fold.
LONGEST_STEP = 0.5
# The curved part of a step must be small against its straight part, and Newton's first correction against
# the step. Where x is the distance from a fold, so that the other branch is 2 x away, a step s has a curved
# part of s / 2 x: it ends within half the way to the fold and a quarter of that to the other branch.
LARGEST_CURVE = 0.25
LARGEST_CORRECTION = 0.1
# A step below sqrt(eps) that still bends this much means a fold within eps of the target.
SHORTEST_STEP = math.sqrt(EPS)
# Thousands of the longest steps would be many turns around. A guard against endless work.
MOST_STEPS = 2000


class BlockedError(Exception):
    """The path cannot be followed to its end; carries how far it was and the last good pose."""

    def __init__(self, share: float, pose: Pose, corrections: int) -> None:
        super().__init__(f"blocked at {share:.17g} of the way")
        self.share = share
        self.pose = pose
        self.corrections = corrections


def follow(mechanism: Mechanism, start: Pose, path: Path) -> tuple[Pose, int]:
    """The pose at the end of a path, and the Newton corrections it took.

    Each step is predicted to second order by the factors of the last pose and corrected by Newton.
    It is refused and halved when it is long, bends much, needs a large correction, does not converge, leaves
    rows that were left out, or changes the sign of the determinant of a group: assemblies meet where one is
    zero.

    Raises:
        BlockedError: steps have become too short to go on: the mechanism locks there.
    """
    pose, share, length, spent = start, 0.0, 1.0, 0
    for _ in range(MOST_STEPS):
        length = min(length, 1.0 - share)
        _, slope, bend = path(share)
        straight, curve = accelerations(mechanism, pose, slope * length, bend * length**2)
        size = math.sqrt(straight @ straight)
        # A step turns with the body, so its curve is o'' - w x o'.
        twist = straight.reshape(-1, 2, 3)
        curve.reshape(-1, 2, 3)[:, 0] -= cross(twist[:, 1], twist[:, 0])
        curved = 0.5 * math.sqrt(curve @ curve)
        arrived = None
        if size <= LONGEST_STEP and curved <= LARGEST_CURVE * size + pose.floor:
            end = share + length if length < 1.0 - share else 1.0
            step = straight + 0.5 * curve
            outcome = correct(
                mechanism, mechanism.moved(pose.q, pose.poses.rotation, step), path(end)[0], pose.rcond
            )
            spent += outcome.corrections
            small = outcome.first <= LARGEST_CORRECTION * size + pose.floor
            there = outcome.pose
            if (
                there is not None
                and small
                and (there.signs == pose.signs).all()
                and held_at(mechanism, there)
            ):
                arrived = there
        if arrived is not None:
            pose, share, length = arrived, end, 2.0 * length
            if share >= 1.0:
                return pose, spent
        else:
            # Straight to the longest step allowed where the length alone was too large.
            shrink = LONGEST_STEP / size if LONGEST_STEP < size < math.inf else 1.0
            length *= min(0.5, shrink)
            if size <= SHORTEST_STEP or share + length == share:
                break
    raise BlockedError(share, pose, spent)
