"""Going from the inputs of one pose to others, or saying why not."""

from collections.abc import Sequence

import numpy as np

from absolute.continuation import BlockedError, Path, follow
from absolute.errors import AbsoluteError, SingularError, UnreachableError
from absolute.limits import limited_by, limiting_input, limits_at
from absolute.mechanism import Mechanism
from absolute.newton import SMALLEST_RCOND, Pose, inverse
from absolute.solution import Array


def continue_to(
    mechanism: Mechanism, pose: Pose, start: Sequence[float], goal: Sequence[float], instant: int
) -> tuple[Pose, int]:
    """From the pose at inputs `start` to that at `goal`: straight, else one input after the other."""
    blocks: list[BlockedError] = []
    spent = 0
    for legs in _itineraries(start, goal):
        arrived: Pose = pose
        try:
            for begin, end in legs:
                arrived, corrections = follow(mechanism, arrived, _straight(mechanism, begin, end))
                spent += corrections
        except BlockedError as blocked:
            spent += blocked.corrections
            if not blocks:
                blocks.append(blocked)
            continue
        return arrived, spent
    raise _refusal(mechanism, blocks[0], start, goal, instant)


def _itineraries(
    start: Sequence[float], goal: Sequence[float]
) -> list[list[tuple[list[float], list[float]]]]:
    begin, end = list(start), list(goal)
    ways = [[(begin, end)]]
    changed = [index for index, (a, b) in enumerate(zip(begin, end, strict=True)) if a != b]
    if len(changed) > 1:
        for order in (changed, changed[::-1]):
            legs, here = [], begin
            for index in order:
                there = list(here)
                there[index] = end[index]
                legs.append((here, there))
                here = there
            ways.append(legs)
    return ways


def _straight(mechanism: Mechanism, begin: Sequence[float], end: Sequence[float]) -> Path:
    change = [b - a for a, b in zip(begin, end, strict=True)]

    def path(share: float) -> Array:
        # The end is exact, so that an instant does not depend on where it was reached from.
        values = list(end) if share == 1.0 else [a + share * c for a, c in zip(begin, change, strict=True)]
        return mechanism.targets(values, change)

    return path


def _refusal(
    mechanism: Mechanism, blocked: BlockedError, start: Sequence[float], goal: Sequence[float], instant: int
) -> AbsoluteError:
    wanted = mechanism.named(goal)
    reached = mechanism.named([a + blocked.share * (b - a) for a, b in zip(start, goal, strict=True)])
    residual = blocked.pose.residual * mechanism.drawing.size
    condition = inverse(blocked.pose.rcond)
    asked = ", ".join(f"{name} = {value:.12g}" for name, value in wanted.items())
    where = ", ".join(f"{name} = {value:.12g}" for name, value in reached.items())
    jacobian = mechanism.stack.jacobian(blocked.pose.placed)
    limits = limits_at(mechanism, jacobian)
    if not limits and mechanism.redundant is not None:
        # Far from singular: the way leads on, but only without the rows that were left out.
        limits = tuple(dict.fromkeys(mechanism.redundant.owners))
    # What the targets change along the straight way, at its end.
    change = _straight(mechanism, start, goal)(blocked.share)[1][mechanism.joint_rows :]
    limit = limiting_input(mechanism, jacobian, change)
    if blocked.share == 1.0 or np.allclose(
        list(reached.values()), list(wanted.values()), rtol=SMALLEST_RCOND, atol=0
    ):
        return SingularError(
            f"instant {instant}: {asked} is a singular pose ({limited_by(limits)}condition number about "
            f"{condition:.3g}, "
            f"at most {1 / SMALLEST_RCOND:.3g} can be solved): rates and branch are undetermined there; "
            "stay away from the limit of the motion",
            instant,
            wanted,
            reached,
            residual,
            condition,
            limits,
            limit,
        )
    return UnreachableError(
        f"instant {instant}: {asked} cannot be reached; going there the mechanism locks at {where} "
        f"({limited_by(limits)}condition number about {condition:.3g}, rows still closed to "
        f"{residual:.3g} mm). Keep the inputs inside that limit ({limit!r} meets it), or reach them by "
        "another sequence of instants",
        instant,
        wanted,
        reached,
        residual,
        condition,
        limits,
        limit,
    )
