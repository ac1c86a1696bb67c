"""An arm on two pivots of the chassis with a ball joint at its end, as suspensions share it."""

import math

from absolute.description import Axis, BranchSign, Input, Joint, plain
from absolute.suspensions.suspension import Drawn


def arm_pivot(front: str, rear: str, body: str) -> Joint:
    """The arm turns about the line from its front to its rear pivot."""
    axis = Axis(front, rear)
    return Joint("revolute", "chassis", body, axis, axis)


def arm_angle(drawn: Drawn, front: str, ball: str, body: str) -> Input:
    """(ball - front) . up = d cos(angle), d their drawn distance (eq. 12)."""
    drawn.line(front, ball)
    # Without the squares of a norm, which are zero for the smallest numbers.
    length = math.hypot(*(drawn.place[ball] - drawn.place[front]).tolist())
    return Input("chassis", Axis(front, plain(drawn.up)), body, ball, "cosine", length)


def beside_arm_axis(drawn: Drawn, front: str, rear: str, ball: str) -> BranchSign:
    """On which side of the upright plane through its pivots the ball joint is: its angle does not tell."""
    return BranchSign(((front, ball), (front, rear), plain(drawn.up)), arm_links(front, rear, ball))


def arm_links(front: str, rear: str, ball: str) -> tuple[str, ...]:
    """The two distances that the arm keeps, for messages."""
    return (f"link {ball} - {front}", f"link {ball} - {rear}")
