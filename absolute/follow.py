"""Follows the poses of a motion from instant to instant without leaving the branch.

From a known pose, many instants are predicted at once, to second order, and corrected together by Newton's
method. The last one that is near enough becomes the next known pose. If there is none, a pose between is
solved first.
"""

import math
from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

from absolute.errors import PoseError
from absolute.mechanism import Mechanism
from absolute.newton import (
    SMALLEST_RCOND,
    Configurations,
    configurations_at,
    leading,
    lengths,
    newton,
    rates,
    rounding_of,
)
from absolute.rows import WHOLE_TURN
from absolute.vectors import EPS, Array, cross

# Inputs (..., inputs) and rates of them -> (1 + rates, ..., rows): targets of the rows, and their rates.
Targets = Callable[..., Array]

# Largest change of all bodies together in one step (2-norm, rad and units of size): up to this distance the
# second-order prediction is good for any linkage that is not near a fold.
LONGEST_STEP = 0.5
# Limits of the curved part of a step relative to its straight part, and of Newton's first correction relative
# to the step. At a distance x from a fold the other branch is 2 x away, and a step s has a curved part of s /
# 2 x: so a step ends within half the way to the fold, and within a quarter of the way to the other branch.
LARGEST_CURVE = 0.25
LARGEST_CORRECTION = 0.1
# A step below sqrt(eps) that still curves too much means a fold within eps of the target.
SHORTEST_STEP = math.sqrt(EPS)
# Against endless work: thousands of the longest steps to one instant would be many turns.
MOST_STEPS = 2000
# Instants per step: enough to share the cost of a call, few enough to stay in fast memory.
MOST_INSTANTS = 64
# A fold is near if the ratio of the smallest to the largest singular value is below this. A motion is
# followed until a fold is about sqrt(eps) away, where the ratio is of that order times ratios of lengths.
LARGEST_SHARE = 1e-4
# Joints with less than this share of the largest force do not block.
SMALLEST_FORCE = 0.1


class BlockedError(Exception):
    """The path is blocked: the inputs where it ends, and the last good pose."""

    def __init__(self, reached: Array, pose: Configurations) -> None:
        super().__init__(f"blocked at {reached.tolist()}")
        self.reached, self.pose = reached, pose


def follow(
    mechanism: Mechanism, start: Configurations, at: Array, goals: Array, targets: Targets
) -> Iterator[Configurations]:
    """The poses at goals, in consecutive runs, each reached on the straight path from a pose before it.

    A pose is accepted if it is near, the path to it curves little, its first correction is small, it closes,
    rows left out hold, and its determinants have the signs of the start: assemblies meet where one is zero.
    If other rows should be left out, the rows are chosen anew.

    Args:
        start: one pose, at inputs `at`, (inputs,). goals: (N, inputs).
        targets: function of the inputs that gives the targets of the rows.
    Raises:
        BlockedError: steps became too short: the mechanism locks there.
    """
    pose, longest, done, steps = start, LONGEST_STEP, 0, 0
    while done < len(goals):
        ends = goals[done : done + MOST_INSTANTS]
        ways = ends - at
        # Unit vectors, since squares of long paths overflow.
        whole = np.abs(ways).max(axis=1, initial=0.0)
        units = ways / np.where(whole > 0.0, whole, 1.0)[:, None]
        straight, curve, furthest = _predicted(mechanism, pose, partial(targets, at), units, longest)
        count = leading(whole <= furthest)
        share = 1.0
        if not count:
            share = float(furthest[0] / whole[0])
            count, ends = 1, (at + share * ways[0])[None]
        length = share * whole[:count, None, None, None]
        straight, curve = length * straight[:count], length**2 * curve[:count]
        size, floor = lengths(straight), float(rounding_of(pose.condition[0]))
        # A path of zero length may end at its start; any other must make progress.
        short = share < 1.0 and (size[0] <= SHORTEST_STEP or (ends[0] == at).all())
        there = newton(
            mechanism,
            pose,
            mechanism.moved(np.repeat(pose.q, count, axis=0), pose.placed.rotation, straight + curve),
            targets(ends[:count])[0],
            LARGEST_CORRECTION * size + floor,
        )
        same = (there.signs == pose.signs).all(axis=1)
        count, steps = leading(there.closed & there.held & same), steps + 1
        if short or steps > MOST_STEPS or not (count or size[0] > SHORTEST_STEP):
            raise BlockedError(at, pose)
        if not count:
            longest = 0.5 * float(size[0])
            continue
        there = there.part(slice(count))
        pose, at, longest = there.part(slice(-1, None)), ends[count - 1], LONGEST_STEP
        choice = mechanism.choice_at(pose.placed, pose.choice)
        if choice is not pose.choice:
            pose = configurations_at(mechanism, choice, pose.q, targets(at)[:1])
        if share == 1.0:
            done, steps = done + count, 0
            yield there


def _predicted(
    mechanism: Mechanism, pose: Configurations, targets: Targets, units: Array, longest: float
) -> tuple[Array, Array, Array]:
    """Along units (N, inputs): the straight part s and the curve c, (N, bodies, 2, 3), of a step l s + l^2 c,
    and the largest l within the limits of a step's length and curve.
    """
    ways, of = np.unique(units, axis=0, return_inverse=True)
    straight, second = (each[of] for each in rates(mechanism, pose, *targets(ways, 0.0 * ways)[1:]))
    # A step turns with the body, so its curve is o'' - w x o'.
    second[:, :, 0] -= cross(straight[:, :, 1], straight[:, :, 0])
    curve = 0.5 * second
    size, bent = lengths(straight), lengths(curve)
    # Solves l^2 bent = LARGEST_CURVE l size + rounding.
    half = 0.5 * LARGEST_CURVE * size
    with np.errstate(divide="ignore", invalid="ignore"):
        bending = (half + np.sqrt(half**2 + bent * rounding_of(pose.condition))) / bent
        furthest = np.fmin(longest / size, bending)
    return straight, curve, np.where(size + bent > 0.0, furthest, np.inf)


def through(mechanism: Mechanism, drawn: Configurations, goals: Array) -> Iterator[Configurations]:
    """The poses at inputs (N, inputs) at N instants: on straight paths, else one input after another.

    Raises:
        PoseError: an instant has no pose; the poses before it have been yielded.
    """
    pose, at, done = drawn, mechanism.drawn_inputs.copy(), 0
    # After whole turns the car stands as drawn.
    turns = [drive.turns for drive in mechanism.model.inputs]
    turned = np.round((goals[:1] - at).sum(axis=0) / WHOLE_TURN)[: len(turns)]
    at[: len(turns)] += WHOLE_TURN * np.where(turns, turned, 0.0)
    while done < len(goals):
        try:
            for found in follow(mechanism, pose, at, goals[done:], mechanism.targets):
                done += len(found.q)
                pose, at = found.part(slice(-1, None)), goals[done - 1]
                yield found
        except BlockedError as blocked:
            around = _around(mechanism, pose, at, goals[done])
            if around is None:
                raise _refusal(mechanism, blocked, at, goals[done], done) from blocked
            pose, at, done = around, goals[done], done + 1
            yield pose


def _around(mechanism: Mechanism, pose: Configurations, at: Array, goal: Array) -> Configurations | None:
    """The pose at a goal by changing one input after another; None if these paths are blocked too."""
    changed = np.flatnonzero(at != goal)
    for order in (changed, changed[::-1]) if len(changed) > 1 else ():
        corners = np.tile(at, (len(order), 1))
        for place, index in enumerate(order):
            corners[place:, index] = goal[index]
        try:
            *_, last = follow(mechanism, pose, at, corners, mechanism.targets)
        except BlockedError:
            continue
        return last.part(slice(-1, None))
    return None


def _refusal(
    mechanism: Mechanism, blocked: BlockedError, start: Array, goal: Array, instant: int
) -> PoseError:
    pose, wanted, reached = blocked.pose, *map(mechanism.named, (goal.tolist(), blocked.reached.tolist()))
    asked, where = (
        ", ".join(f"{name} = {value:.12g}" for name, value in values.items()) for values in (wanted, reached)
    )
    # Far from singular, only the rows that were left out block the path.
    limits = limits_at(mechanism, pose) or mechanism.stack.owners_of(pose.choice.left_out)
    # Change of the targets at the end of the straight path.
    change = mechanism.targets(blocked.reached, goal - start)[1]
    limit = limiting_input(mechanism, pose, change[mechanism.joint_rows :])
    condition = float(pose.condition[0])
    near = f"{limited_by(limits)}condition number about {condition:.3g}"
    if np.allclose(blocked.reached, goal, rtol=SMALLEST_RCOND, atol=0):
        message = (
            f"{asked} is a singular pose ({near}, at most {1 / SMALLEST_RCOND:.3g} can be solved): rates and "
            "branch are not determined there; stay away from the limit of the motion"
        )
    else:
        residual = float(pose.residual[0]) * mechanism.model.size
        message = (
            f"{asked} cannot be reached; going there the mechanism locks at {where} ({near}, rows still "
            f"closed to {residual:.3g} mm). Keep the inputs inside that limit ({limit!r} meets it), or reach "
            "them by another sequence of instants"
        )
    return PoseError(f"instant {instant}: {message}", instant, wanted, reached, condition, limits, limit)


def limits_at(mechanism: Mechanism, pose: Configurations) -> tuple[str, ...]:
    """Joints that block each other near a singular pose, the strongest first; empty far from one.

    Near such a pose some forces y in the rows are in equilibrium without a load, y J = 0 nearly. They are
    those of the group of bodies whose block is nearest to singular.
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

    With y J = 0 nearly, the rows can only change normal to y. The input has the largest product of its change
    and its component of y.
    """
    left = np.linalg.svd(pose.kept[0])[0]
    # The rows of the inputs come last and are all kept.
    blocked = np.abs(left[-len(change) :, -1] * change)
    return mechanism.model.inputs[int(np.argmax(blocked))].value


def limited_by(limits: tuple[str, ...]) -> str:
    """The limits as part of a message."""
    return f"limited by {', '.join(limits)}; " if limits else ""
