"""Statics: tensions of rods and forces in joints under loads at the wheels, without mass and friction.

Bodies are in equilibrium if the loads do no work in any motion that the rows allow. With J the rows'
Jacobian, and w the loads as forces and moments on the velocities of the bodies,

    J^T f = w,

and f of a row is the work of the loads per mm that the row grows while all others are held. So f of a rod is
its tension. The rows of a ball joint, the position of its point in the second body relative to the first,
push the second body by -f. A hinge has the rows of one of its points and two right angles; each of these
applies a moment to the second body, -f times the derivative of its rate by that body's angular velocity. With
d from the first hinge point P to the second, Q, a force F and a moment M about P become F_Q = M x d / (d . d)
at Q and the rest of F at P; a hinge has no moment about d. Along d only the sum of both forces is determined.
A point on a slide has forces across the line, and along the line if an input drives its travel.

Chassis and inputs hold the mechanism. In a corner with a damper, however, the damper's length is held, and
the input that moves the wheel is free.
"""

from dataclasses import replace

import numpy as np

from absolute.effects import ground
from absolute.errors import DescriptionError
from absolute.mechanism import Mechanism
from absolute.model import Model, Row
from absolute.newton import SMALLEST_RCOND, solved
from absolute.results import Motion
from absolute.rows import RowStack
from absolute.vectors import Array, cross


def forces(mechanism: Mechanism, motion: Motion) -> dict[str, dict[str, Array]]:
    """`rod_force`, `joint_force` and `hinge_thrust` of `Solution`; NaN if the pose is singular with dampers
    held.

    Raises:
        DescriptionError: there is no load, a role is missing, or redundant rows leave forces undetermined.
    """
    model = motion.model
    _require_determined(mechanism)
    rows = _loaded_rows(model)
    stack = RowStack(rows, len(model.bodies), mechanism.columns)
    placed = stack.place(motion.rotation, motion.origin)
    along, _, second_arm = (placed.vectors[:, kind] for kind in range(3))
    jacobian = stack.jacobian(placed)
    acting = _work_of_loads(motion)[..., mechanism.columns, None]
    with np.errstate(all="ignore"):
        found = solved(jacobian.swapaxes(1, 2), acting)[..., 0]
        found[~(np.linalg.cond(jacobian, 1) * SMALLEST_RCOND <= 1.0)] = np.nan

    def place(point: str) -> Array:
        body = model.holders[point]
        return np.asarray(placed.origin[:, body] + np.matvec(placed.rotation[:, body], model.arms[point]))

    joints, thrusts = {}, {}
    for points, (owner, body) in model.reported_joints.items():
        own = [number for number, row in enumerate(rows) if row.owner == owner]
        second = rows[own[0]].second
        if len(own) == 2:  # a point on a slide
            own += _travels_of(model, rows[own[0]])
        pushed = found[:, own, None] * (-1.0 if second == model.numbers[body] else 1.0)
        force = (pushed[:, :3] * along[:, own[:3]]).sum(axis=1)
        if len(points) == 1:
            joints[points[0]] = force
            continue
        start, end = map(place, points)
        line = (end - start) / np.sqrt(np.vecdot(end - start, end - start))[:, None]
        meeting = placed.origin[:, second] + second_arm[:, own[0]]
        moment = (pushed[:, 3:] * cross(second_arm[:, own[3:]], along[:, own[3:]])).sum(axis=1)
        moment += cross(meeting - start, force)
        at_end = cross(moment, line) / np.vecdot(line, end - start)[:, None]
        thrusts[points[0]] = np.vecdot(line, force)
        across = force - thrusts[points[0]][:, None] * line
        joints |= {points[0]: across - at_end, points[1]: at_end}
    rods = {row.owner[4:]: found[:, n] for n, row in enumerate(rows) if row.owner.startswith("rod ")}
    return {"rod_force": rods, "joint_force": joints, "hinge_thrust": thrusts}


def _loaded_rows(model: Model) -> list[Row]:
    """All rows; a damper's length takes the place of the input that moves its wheel."""
    driven, values = [drive.row for drive in model.inputs], [drive.value for drive in model.inputs]
    for part, damper in model.dampers.items():
        moving = model.input_of(part, "travel", f"{damper.owner!r}, which carries a load,")
        driven[values.index(moving)] = damper
    return [*model.joints, *driven]


def _travels_of(model: Model, slide: Row) -> list[int]:
    """Numbers of the inputs' rows that are the travel of the same point on the same line as a slide's row."""

    def points(row: Row) -> list[float]:
        return [row.first, row.second, *row.first_arm, *row.second_arm]

    return [
        number
        for number, drive in enumerate(model.inputs, len(model.joints))
        if drive.steers and points(drive.row) == points(slide)
    ]


def _require_determined(mechanism: Mechanism) -> None:
    if not mechanism.model.loads:
        raise DescriptionError(
            "there are no loads: write [mechanism.loads], for example, force = [0.0, 0.0, 4000.0], in N, or "
            "do not ask for loads",
            "loads",
        )
    if names := mechanism.stack.owners_of(mechanism.choice.left_out):
        raise DescriptionError(
            f"loads need a mechanism without redundant joints; {', '.join(names)} follow from the others, so "
            "that forces are not determined: free a joint, or do not ask for loads",
            names[0],
            names,
        )


def _work_of_loads(motion: Motion) -> Array:
    """(N, 6 * bodies) forces, N, and moments about the origins of the bodies, N times size, of all loads."""
    model, origin = motion.model, motion.origin
    work = np.zeros((*origin.shape[:2], 2, 3))
    for part, (force, moment) in model.loads.items():
        wheel = replace(motion, part=part)
        try:
            knuckle, at = wheel.corner.need("knuckle"), ground(wheel).value.T / model.size
        except DescriptionError as error:
            raise DescriptionError(f"the load of the wheel {error}", error.name) from None
        body = model.numbers[knuckle]
        work[:, body, 0] += force
        work[:, body, 1] += moment / model.size + cross(at - origin[:, body], force)
    return work.reshape(len(work), 6 * len(model.bodies))
