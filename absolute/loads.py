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

from absolute.effects import contact
from absolute.errors import DescriptionError
from absolute.mechanism import Mechanism
from absolute.newton import SMALLEST_RCOND, solved
from absolute.results import Motion
from absolute.rows import RowStack
from absolute.vectors import Array, cross


def forces(motion: Motion) -> dict[str, dict[str, Array]]:
    """`rod_force`, `joint_force` and `hinge_thrust` of `Solution`; NaN if the pose is singular with dampers
    held.

    Raises:
        DescriptionError: there is no load, a role is missing, or redundant rows leave forces undetermined.
    """
    mechanism, model = motion.mechanism, motion.mechanism.model
    _require_determined(mechanism)
    stack, bodies, size = mechanism.stack, mechanism.drawing.bodies, mechanism.drawing.size
    placed = stack.place(motion.instants.rotation, motion.instants.origin)
    along, _, second_arm = (placed.vectors[:, kind] for kind in range(3))
    jacobian, owners = stack.jacobian(placed), list(stack.owners)
    for part, damper in model.dampers.items():
        moving = model.input_of(part, "travel", f"{damper.owner!r}, which carries a load,")
        row = mechanism.joint_rows + [drive.value for drive in model.inputs].index(moving)
        held = RowStack([damper], len(bodies), mechanism.columns)
        jacobian[:, row] = held.jacobian(held.place(placed.rotation, placed.origin))[:, 0]
        owners[row] = damper.owner
    work = np.zeros((len(jacobian), len(bodies), 2, 3))
    for part in model.loads:
        try:
            work[:, bodies[model.corners[part].carrier]] += _on_knuckle(replace(motion, part=part))
        except DescriptionError as error:
            raise DescriptionError(f"the load of the wheel {error}", error.name) from None
    acting = work.reshape(len(work), 6 * len(bodies)).take(mechanism.columns, 1)[..., None]
    with np.errstate(all="ignore"):
        found = solved(jacobian.swapaxes(1, 2), acting)[..., 0]
        found[~(np.linalg.cond(jacobian, 1) * SMALLEST_RCOND <= 1.0)] = np.nan
    joints, thrusts = {}, {}
    travels = {mechanism.joint_rows + i for i, drive in enumerate(model.inputs) if drive.steers}
    for points, (owner, body) in model.reported_joints.items():
        rows = [row for row, name in enumerate(owners) if name == owner]
        if len(rows) == 2:  # a point on a slide
            rows += [row for row in stack.of_one_point(rows[0]) if row in travels]
        second = stack.second[rows[0]]
        pushed = found[:, rows, None] * (-1.0 if second == bodies[body] else 1.0)
        force = (pushed[:, :3] * along[:, rows[:3]]).sum(axis=1)
        if len(points) == 1:
            joints[points[0]] = force
            continue
        start, end = (motion.place(point).value.T / size for point in points)
        line = (end - start) / np.sqrt(np.vecdot(end - start, end - start))[:, None]
        meeting = placed.origin[:, second] + second_arm[:, rows[0]]
        moment = (pushed[:, 3:] * cross(second_arm[:, rows[3:]], along[:, rows[3:]])).sum(axis=1)
        moment += cross(meeting - start, force)
        at_end = cross(moment, line) / np.vecdot(line, end - start)[:, None]
        thrusts[points[0]] = np.vecdot(line, force)
        across = force - thrusts[points[0]][:, None] * line
        joints |= {points[0]: across - at_end, points[1]: at_end}
    rods = {name[4:]: found[:, row] for row, name in enumerate(owners) if name.startswith("rod ")}
    return {"rod_force": rods, "joint_force": joints, "hinge_thrust": thrusts}


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


def _on_knuckle(motion: Motion) -> Array:
    """(N, 2, 3) force, N, and moment about the knuckle's origin, N times size, of a part's load."""
    mechanism, corner = motion.mechanism, motion.corner
    load, size = mechanism.model.loads[motion.part], mechanism.drawing.size
    origin = motion.instants.origin[:, mechanism.drawing.bodies[corner.carrier]]
    ground = motion.place(corner.ends("wheel_axis")[1]) + contact(motion)
    arm = ground.value.T / size - origin
    force, moment = np.broadcast_arrays(load.force, load.moment / size + cross(arm, load.force))
    return np.stack([force, moment], axis=1)
