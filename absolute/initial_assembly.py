"""Assembles the drawn bodies on the branch of the drawing, or reports why they cannot be assembled."""

import numpy as np

from absolute.errors import PoseError
from absolute.follow import BlockedError, follow, limited_by, limits_at
from absolute.mechanism import Mechanism
from absolute.newton import SMALLEST_RCOND, Configurations, configurations_at, signs_of
from absolute.vectors import Array

# In sizes of the mechanism, which is about the distance between two assemblies. Among 300 struts with every
# point up to 200 mm off, two closed to another assembly than the drawn one, with movements of 0.82 and 1.11
# sizes.
FURTHEST = 0.8


def assemble(mechanism: Mechanism) -> Configurations:
    """The assembled pose on the branch of the drawing, at the inputs of the drawing.

    The violation of the rows in the drawing shrinks, rows(q) = (1 - share) rows(drawn) + share * target,
    without meeting a singular pose.

    Raises:
        PoseError: the drawing itself is singular or could mean two assemblies, or closing it locks the
            mechanism.
        DescriptionError: there are more rows than unknowns, and the rows are not redundant.
    """
    target = mechanism.targets(mechanism.drawn_inputs[None])[0]
    pose = drawn = configurations_at(mechanism, mechanism.choice, mechanism.drawn[None], target)
    if not SMALLEST_RCOND * drawn.condition[0] <= 1.0:
        limits = limits_at(mechanism, drawn)
        message = (
            f"the drawing is singular: condition number about {drawn.condition[0]:.3g}, at most "
            f"{1 / SMALLEST_RCOND:.3g} can be solved; a body can move although all inputs are held. "
            "Look for points on one line that should not be (a steering arm on the strut axis, "
            "an arm along its own axis) or an input at its dead point; "
            f"{limited_by(limits)}move a point off it"
        )
        raise _refused(mechanism, drawn, message, limits)
    if not drawn.closed[0]:
        pose = _closed(mechanism, drawn, mechanism.stack.gap(drawn.placed, target)[0])
    if len(pose.choice.left_out):
        mechanism.redundancies(pose.placed, SMALLEST_RCOND)
        if not pose.held.all():
            raise locked(mechanism, None, pose, mechanism.drawn_inputs.tolist())
    return pose


def _closed(mechanism: Mechanism, drawn: Configurations, gap: Array) -> Configurations:
    """The closed pose of a drawing with gaps, (rows,)."""

    def closing(share: Array, *rates: Array) -> Array:
        values = drawn.placed.values[0] + share * gap
        return np.array(np.broadcast_arrays(values, *(rate * gap for rate in rates)))

    _require_clear(mechanism, drawn, gap)
    try:
        (pose,) = follow(mechanism, drawn, np.zeros(1), np.ones((1, 1)), closing)
    except BlockedError as blocked:
        largest = float(np.abs(gap).max()) * mechanism.model.size
        limits = limits_at(mechanism, blocked.pose)
        message = (
            f"the drawing cannot be assembled: rows are violated by up to {largest:.3g} mm (most at "
            f"{mechanism.stack.owners[int(np.abs(gap).argmax())]!r}) and closing them locks the mechanism "
            f"with {largest * float(1.0 - blocked.reached[0]):.3g} mm left; {limited_by(limits)}"
            "draw the points closer to an assembled pose"
        )
        raise _refused(mechanism, blocked.pose, message, limits) from blocked
    _require_near(mechanism, pose)
    return pose


def _refused(
    mechanism: Mechanism, pose: Configurations, message: str, limits: tuple[str, ...] = ()
) -> PoseError:
    """The error for a drawing, at the pose where closing it ends."""
    inputs = mechanism.named(mechanism.drawn_inputs.tolist())
    return PoseError(message, inputs=inputs, condition=float(pose.condition[0]), limits=limits)


def _require_near(mechanism: Mechanism, pose: Configurations) -> None:
    """Refuse a closed drawing so far from the drawing that another assembly may be meant."""
    model, (body, arms) = mechanism.model, mechanism.model.held()
    there = pose.placed.origin[0, body] + np.matvec(pose.placed.rotation[0, body], arms)
    distances = np.linalg.norm(there - model.origins[body] - arms, axis=1)
    if distances.max() > FURTHEST:
        furthest, far = list(model.holders)[int(distances.argmax())], float(distances.max())
        message = (
            f"closing the drawing moves {furthest!r} by {far * model.size:.3g} mm; beyond "
            f"{FURTHEST * model.size:.3g} mm, a part of the mechanism's size, another assembly may be "
            "meant: draw the points closer to an assembled pose"
        )
        raise _refused(mechanism, pose, message)


def _require_clear(mechanism: Mechanism, drawn: Configurations, gap: Array) -> None:
    """Refuse a drawing whose open joints could close to assemblies on different sides of a singular pose.

    The sign of a determinant tells in which of two assemblies a group of bodies is, and the path to the
    closed pose keeps it. The Jacobian of an open joint can be taken at either of its two halves, which
    coincide when the joint is closed (see `RowStack.read_at_foot`). If the two differ in a sign, paths that
    keep one or the other lead to different assemblies.
    """
    stack, of = mechanism.stack, np.array(mechanism.stack.owners)

    def other_side(gaps: Array) -> bool:
        read = stack.jacobian(stack.read_at_foot(drawn.placed, gaps))
        return bool((signs_of(drawn.choice, read) != drawn.signs).any())

    if not other_side(gap):
        return
    alone = [owner for owner in dict.fromkeys(stack.owners) if other_side(np.where(of == owner, gap, 0.0))]
    open_joints = tuple(alone) or (stack.owners[int(np.abs(gap).argmax())],)
    largest = float(np.abs(gap[np.isin(of, open_joints)]).max()) * mechanism.model.size
    message = (
        f"the drawing could mean two assemblies: {', '.join(map(repr, open_joints))} is drawn {largest:.3g} "
        "mm from closed, and a singular pose between the two assemblies lies in the way, so the assembly "
        "depends on which of the joint's two halves is moved; draw the points closer to an assembled pose"
    )
    raise _refused(mechanism, drawn, message, open_joints)


def locked(mechanism: Mechanism, instant: int | None, pose: Configurations, inputs: list[float]) -> PoseError:
    """The error for a pose that violates rows that were left out."""
    stack, left_out = mechanism.stack, pose.choice.left_out
    off = np.abs(stack.gap(pose.placed, stack.drawn))[0, left_out]
    names = stack.owners_of(left_out[np.argsort(-off)])
    where = "the closed drawing" if instant is None else f"instant {instant}"
    return PoseError(
        f"{where}: {', '.join(names)} cannot be kept together with the other joints, by "
        f"{float(off.max()) * mechanism.model.size:.3g} mm: their rows follow from the others in the "
        "drawing, but not here, so the mechanism is locked: draw axes that should be parallel or meet "
        "exactly so, or free a joint",
        instant,
        mechanism.named(inputs),
        limits=names,
    )
