"""Statics: tensions of rods and forces of joints under loads at the wheels, without mass and friction.

Bodies are in equilibrium where the loads do no work in any motion that the rows allow. With J the rows'
Jacobian, and w the loads by the velocities on which they work,

    J^T f = w,

and f of a row is the work of the loads for each mm that the row grows while all others are held. So f of a
rod is its tension, and the rows of a ball joint, which say where its point of the second body is from that of
the first, push the second body by -f. Those of a hinge are of one of its points and of two right angles, of
which each turns the second body by -f as its rate goes with that body's angular velocity. With d from the
first of its points P, Q to the second, a force F and a moment M about P are F_Q = M x d / (d . d) at Q, the
rest of F at P, and a moment about d, which a hinge has none of. Along d only both forces together are known.
Those of a point on a slide are across its line, and along it one of an input where its travel is driven.

Chassis and inputs hold the mechanism; but in a corner with a damper its length is held, and the input that
moves the wheel is free.
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
    """What links carry.

    Returns:
        rod_force: name of a rod, or `damper` with its part in front where one holds -> (N,) tension, N.
        joint_force: point of a ball joint or slide -> (N, 3) force, N, on the body that
            `Model.reported_joints` names, as the ground sees it; of a hinge both points, and there what is
            across its line; of a slide along the line what an input pushes that drives it.
        hinge_thrust: first point of a hinge -> (N,) force at both along the line to the second, N.
        Not numbers where the pose is singular while dampers are held.
    Raises:
        DescriptionError: there is no load, or a role that one needs; rows follow from each other, so that
            forces are not determined.
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
            f"loads need joints that hold each body once; {', '.join(names)} follow from the others, so "
            "that forces are not determined: free a joint, or do not ask for loads",
            names[0],
            names,
        )


def _on_knuckle(motion: Motion) -> Array:
    """(N, 2, 3) force, N, and moment about the knuckle's origin, N times size, of the load of a part."""
    mechanism, corner = motion.mechanism, motion.corner
    load, size = mechanism.model.loads[motion.part], mechanism.drawing.size
    origin = motion.instants.origin[:, mechanism.drawing.bodies[corner.carrier]]
    ground = motion.place(corner.ends("wheel_axis")[1]) + contact(motion)
    arm = ground.value.T / size - origin
    force, moment = np.broadcast_arrays(load.force, load.moment / size + cross(arm, load.force))
    return np.stack([force, moment], axis=1)
