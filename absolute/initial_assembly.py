"""Putting the drawn bodies together on the branch of the drawing, or saying why not."""

from collections.abc import Iterator

import numpy as np

from absolute.backend import eigenpy
from absolute.continuation import BlockedError, follow
from absolute.errors import AssemblyError, BranchError, SingularError
from absolute.limits import limited_by, limits_at
from absolute.mechanism import Mechanism
from absolute.newton import SMALLEST_RCOND, Pose, inverse, pose_at, seek
from absolute.solution import Array

# Other starts than the drawing, each body turned and moved at random by up to these amounts (rad
# and units of size, as standard deviations): near the drawing and anywhere, by turns.
TURNS = (0.2, 0.4, 0.6, 1.0)
STARTS_PER_TURN = 40


def assemble(mechanism: Mechanism) -> tuple[Pose, int]:
    """The assembled pose on the branch of the drawing, at the inputs of the drawing.

    First the rows keep a shrinking share of the violation they have in the drawing: rows(q) =
    (1 - share) rows(drawn) + share * target. A drawing far from assembled may end on another
    branch, or lock; then Newton starts from the drawing with its bodies turned. Whatever the way,
    the pose has the branch signs of the drawing. Without any in the model only the first way is tried.

    Returns:
        The pose and the Newton corrections of the way that led to it.
    Raises:
        SingularError: the drawing itself is singular.
        BranchError: a branch sign of the drawing is zero, or only poses with others are found.
        AssemblyError: no pose is found.
    """
    drawn = _drawn_pose(mechanism)
    _check_branch_signs(mechanism)
    inputs = mechanism.drawn_inputs.tolist()
    zeros = [0.0] * len(inputs)
    target = mechanism.targets(inputs, zeros, zeros)[0]
    gap = target - drawn.placed.values

    def closing(share: float) -> Array:
        return np.array([drawn.placed.values + share * gap, gap, np.zeros_like(gap)])

    wrong: Pose | None = None
    blocked: BlockedError | None = None
    try:
        pose, spent = follow(mechanism, drawn, closing)
    except BlockedError as block:
        blocked = block
    else:
        if mechanism.branch_signs.kept(pose.placed.world):
            return pose, spent
        wrong = pose
    if mechanism.branch_signs.told:
        for start in _starts(mechanism, drawn):
            found = seek(mechanism, start, target)
            if found is None:
                continue
            if mechanism.branch_signs.kept(found.placed.world):
                return found, 0
            wrong = wrong or found
    if wrong is not None:
        raise branch_error(mechanism, None, inputs, wrong.placed.world) from blocked
    size, largest = mechanism.drawing.size, float(np.abs(gap).max())
    reached = blocked or BlockedError(1.0, drawn, 0)
    left = largest * (1 - reached.share) * size
    owner = mechanism.stack.owners[int(np.abs(gap).argmax())]
    limits = limits_at(mechanism, reached.pose.placed.world)
    raise AssemblyError(
        f"the drawing cannot be assembled: rows are violated by up to {largest * size:.3g} mm "
        f"(most at {owner!r}) and closing them locks the mechanism with {left:.3g} mm left; "
        f"{limited_by(limits)}"
        "draw the points closer to an assembled pose",
        None,
        mechanism.named(inputs),
        {},
        left,
        inverse(reached.pose.rcond),
        limits,
    ) from blocked


def branch_error(mechanism: Mechanism, instant: int | None, inputs: list[float], world: Array) -> BranchError:
    """The refusal of a pose that is not on the branch of the drawing."""
    signs = mechanism.branch_signs
    place = signs.lost(world)
    drawn, found = float(signs.drawn[place]), float(signs.shares(world)[place])
    if instant is None:
        where = "the drawing can be assembled, but not on its own branch"
        cure = "draw the points closer to an assembled pose"
    else:
        where = f"instant {instant}: the pose found is not on the branch of the drawing"
        cure = "lead up to these inputs by closer instants, or stay away from the limit of the motion"
    return BranchError(
        f"{where}: the branch sign {signs.names[place]!r} is {drawn:.3g} in the drawing and {found:.3g} "
        f"there (its product divided by the lengths of its vectors, from -1 to 1); the sign must stay: "
        f"{limited_by(signs.limits[place])}{cure}",
        instant,
        mechanism.named(inputs),
        signs.names[place],
        drawn,
        found,
        signs.limits[place],
    )


def _drawn_pose(mechanism: Mechanism) -> Pose:
    poses = mechanism.poses(mechanism.drawn)
    placed = mechanism.stack.place(*poses)
    factors = eigenpy.PartialPivLU(mechanism.stack.jacobian(placed))
    drawn = pose_at(mechanism, mechanism.drawn, poses, placed, placed.values, factors)
    if not drawn.rcond >= SMALLEST_RCOND:
        limits = limits_at(mechanism, placed.world)
        raise SingularError(
            f"the drawing is singular: condition number about {inverse(drawn.rcond):.3g}, "
            f"at most {1 / SMALLEST_RCOND:.3g} can be solved; a body can move although all inputs are held. "
            "Look for points on one line that should not be (a steering arm on the strut axis, "
            "an arm along its own axis) or an input at its dead point; "
            f"{limited_by(limits)}move a point off it",
            None,
            mechanism.named(mechanism.drawn_inputs.tolist()),
            {},
            float("nan"),
            inverse(drawn.rcond),
            limits,
        )
    return drawn


def _check_branch_signs(mechanism: Mechanism) -> None:
    """Refuse a drawing that stands where its branches meet."""
    signs = mechanism.branch_signs
    for name, wanted, drawn, limits in zip(signs.names, signs.wanted, signs.drawn, signs.limits, strict=True):
        if wanted == 0:
            raise BranchError(
                f"the drawing has no branch: the branch sign {name!r} is {drawn:.3g} there, zero within "
                "rounding (its product divided by the lengths of its vectors, from -1 to 1): two assemblies "
                f"are equally near; {limited_by(limits)}move a point off that limit, to the side "
                "that is meant",
                None,
                mechanism.named(mechanism.drawn_inputs.tolist()),
                name,
                float(drawn),
                limits=limits,
            )


def _starts(mechanism: Mechanism, drawn: Pose) -> Iterator[Array]:
    # Seeded: the same drawing gives the same answer, to the last digit.
    random = np.random.default_rng(0)
    for _ in range(STARTS_PER_TURN):
        for turn in TURNS:
            step = random.normal(scale=turn, size=mechanism.stack.count)
            yield mechanism.moved(drawn.q, drawn.poses.rotation, step)
