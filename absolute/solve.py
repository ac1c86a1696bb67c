"""Solve a motion: assemble the drawing, go to the first instant, then from instant to instant."""

from collections.abc import Mapping, Sequence

import eigenpy
import numpy as np

from absolute.assembly import Mechanism
from absolute.continuation import BlockedError, Path, follow
from absolute.description import Model
from absolute.errors import AbsoluteError, AssemblyError, InputError, SingularError, UnreachableError
from absolute.motion import Record
from absolute.newton import SMALLEST_RCOND, Pose, accelerations, pose_at
from absolute.series import chassis_series, input_series
from absolute.solution import Array, Solution


def solve(
    model: Model,
    inputs: Mapping[str, Array],
    chassis: Array | None = None,
    rates: bool = True,
    conditions: bool = False,
) -> Solution:
    """Positions, velocities and accelerations of a linkage at N instants.

    Args:
        model: the linkage.
        inputs: name -> (N, 3) value, rate and acceleration of every input (rad or mm, per s).
        chassis: (N, 3, 3) translation, velocity, acceleration of the chassis in the frame of the
            points, mm, mm/s, mm/s^2; None for a chassis at rest as drawn.
        rates: False for positions only.
        conditions: also the condition number of the scaled Jacobian at each instant.
    Returns:
        Solution with one row per instant.
    Raises:
        DescriptionError: an axis of the model has no length or its lines point apart.
        InputError: names, shapes or values of inputs or chassis.
        AssemblyError: the bodies as drawn do not fit together.
        UnreachableError: the mechanism locks before the inputs of an instant.
        SingularError: the inputs of an instant do not fix the pose.
        Every error raised at an instant carries the motion before it as `partial`.
    """
    series = input_series(tuple(model.inputs), inputs)
    count = len(series)
    carried = chassis_series(chassis, count)
    mechanism = Mechanism(model)
    record = Record(mechanism, count, rates, conditions)
    if count == 0:
        return record.solution(0, carried)
    try:
        # Absurd inputs may overflow on the way; what is not finite is refused where it arises.
        with np.errstate(over="ignore", invalid="ignore"):
            _march(mechanism, series, rates, record)
    except AbsoluteError as error:
        done = record.written
        error.partial = record.solution(done, carried) if done else None
        raise
    return record.solution(count, carried)


def _march(mechanism: Mechanism, series: Array, rates: bool, record: Record) -> None:
    pose, spent = assemble(mechanism)
    at = mechanism.drawn_inputs.tolist()
    for instant, (values, speeds, seconds) in enumerate(series.tolist()):
        pose, corrections = travel(mechanism, pose, at, values, instant)
        motion = None
        if rates:
            _, first, second = mechanism.targets(values, speeds, seconds)
            motion = accelerations(mechanism, pose, first, second)
            if not np.isfinite(motion[1]).all():
                raise InputError(
                    f"instant {instant}: rates {speeds} and accelerations {seconds} of the inputs "
                    f"{list(mechanism.model.inputs)} overflow; give smaller ones",
                    next(iter(mechanism.model.inputs)),
                    instant,
                    (speeds, seconds),
                )
        record.write(instant, pose, motion, corrections + spent)
        at, spent = values, 0


def assemble(mechanism: Mechanism) -> tuple[Pose, int]:
    """The assembled pose nearest in continuation to the drawing, at the inputs of the drawing.

    The rows keep a shrinking share of the violation they have in the drawing: rows(q) =
    (1 - share) rows(drawn) + share * target. So the branch is that of the drawing.
    """
    poses = mechanism.poses(mechanism.drawn)
    placed = mechanism.stack.place(*poses)
    factors = eigenpy.PartialPivLU(mechanism.stack.jacobian(placed))
    drawn = pose_at(mechanism, mechanism.drawn, poses, placed, placed.values, factors)
    size = mechanism.drawing.size
    names = tuple(mechanism.model.inputs)
    inputs = dict(zip(names, mechanism.drawn_inputs.tolist(), strict=True))
    zeros = [0.0] * len(names)
    target = mechanism.targets(mechanism.drawn_inputs.tolist(), zeros, zeros)[0]
    gap = target - placed.values
    worst = int(np.abs(gap).argmax())
    owner = mechanism.stack.owners[worst]
    if not drawn.rcond >= SMALLEST_RCOND:
        raise SingularError(
            f"the drawing is singular: condition number about {_inverse(drawn.rcond):.3g}, "
            f"at most {1 / SMALLEST_RCOND:.3g} can be solved; a body can move although all inputs are held. "
            "Look for points on one line that should not be (a steering arm on the strut axis, "
            "an arm along its own axis) or an input at its dead point",
            None,
            inputs,
            {},
            float("nan"),
            _inverse(drawn.rcond),
        )

    def path(share: float) -> tuple[Array, Array, Array]:
        return placed.values + share * gap, gap, np.zeros_like(gap)

    try:
        pose, spent = follow(mechanism, drawn, path)
    except BlockedError as blocked:
        left = float(np.abs(gap).max()) * (1 - blocked.share) * size
        raise AssemblyError(
            f"the drawing cannot be assembled: rows are violated by up to {np.abs(gap).max() * size:.3g} mm "
            f"(most at {owner!r}) and closing them locks the mechanism with {left:.3g} mm left; "
            "draw the points closer to an assembled pose",
            None,
            inputs,
            {},
            left,
            _inverse(blocked.pose.rcond),
        ) from blocked

    senses = mechanism.stack.senses(pose.poses.rotation)
    if (senses <= 0).any():
        reversed_joint = mechanism.stack.sense_owners[int(senses.argmin())]
        raise AssemblyError(
            f"joint {reversed_joint!r} is reversed in the assembled pose; "
            "draw its two lines in the same sense",
            None,
            inputs,
            {},
            pose.residual * size,
            _inverse(pose.rcond),
        )
    return pose, spent


def travel(
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
    zeros = [0.0] * len(change)

    def path(share: float) -> tuple[Array, Array, Array]:
        # The end is exact, so that an instant does not depend on where it was reached from.
        values = list(end) if share == 1.0 else [a + share * c for a, c in zip(begin, change, strict=True)]
        return mechanism.targets(values, change, zeros)

    return path


def _refusal(
    mechanism: Mechanism, blocked: BlockedError, start: Sequence[float], goal: Sequence[float], instant: int
) -> AbsoluteError:
    names = tuple(mechanism.model.inputs)
    wanted = dict(zip(names, goal, strict=True))
    reached = {name: a + blocked.share * (b - a) for name, a, b in zip(names, start, goal, strict=True)}
    residual = blocked.pose.residual * mechanism.drawing.size
    condition = _inverse(blocked.pose.rcond)
    asked = ", ".join(f"{name} = {value:.12g}" for name, value in wanted.items())
    where = ", ".join(f"{name} = {value:.12g}" for name, value in reached.items())
    if blocked.share == 1.0 or np.allclose(list(reached.values()), goal, rtol=SMALLEST_RCOND, atol=0):
        return SingularError(
            f"instant {instant}: {asked} is a singular pose (condition number about {condition:.3g}, "
            f"at most {1 / SMALLEST_RCOND:.3g} can be solved): rates and branch are undetermined there; "
            "stay away from the limit of the motion",
            instant,
            wanted,
            reached,
            residual,
            condition,
        )
    return UnreachableError(
        f"instant {instant}: {asked} cannot be reached; going there the mechanism locks at {where} "
        f"(condition number about {condition:.3g}, rows still closed to {residual:.3g} mm). "
        "Keep the inputs inside that limit, or reach them by another sequence of instants",
        instant,
        wanted,
        reached,
        residual,
        condition,
    )


def _inverse(rcond: float) -> float:
    return 1.0 / rcond if rcond > 0 else float("inf")
