"""Positions and camber of a double wishbone: each joint is where three spheres meet."""

import numpy as np


def solve(given):
    """Every instant by itself, in plain numpy: plain data in, plain data out."""
    drawn = {name: np.array(place) for name, place in given["points"].items()}
    up, right = np.array(given["up"]), np.array(given["right"])
    laws = {name: law["position"] for name, law in given["inputs"].items()}
    rows = [_pose(drawn, up, right, *row) for row in zip(laws["arm_angle"], laws["rack"], strict=True)]
    lifted = np.outer(laws["heave"], up)
    places = {name: np.array([row[name] for row in rows]) + lifted for name in rows[0]}
    spin = places["wheel_centre"] - places["wheel_axis_inner"]
    outboard = -right if given["side"] == "left" else right
    return {"position": places, "camber": np.arctan2(-(spin @ up), spin @ outboard)}


def wrong(given):
    """The same with camber positive where the wheel leans in."""
    found = solve(given)
    return found | {"camber": -found["camber"]}


def _pose(drawn, up, right, angle, rack):
    lower, upper, outer, inner = (
        drawn[n] for n in ("lower_ball_joint", "upper_ball_joint", "tie_rod_outer", "tie_rod_inner")
    )
    front, rear = drawn["lower_arm_front"], drawn["lower_arm_rear"]
    ball = _on_circle(front, rear, lower, up, np.cos(angle) * np.linalg.norm(lower - front))
    rod = drawn.get("rack_centre", inner) - rack * right
    pivots = (drawn["upper_arm_front"], drawn["upper_arm_rear"], lower)
    top = _meeting(upper, pivots, (*pivots[:2], ball))
    end = _meeting(outer, (lower, upper, inner), (ball, top, rod))
    # The knuckle as drawn and as it is now, by the same three points.
    was, now = _frame(lower, upper, outer), _frame(ball, top, end)
    carried = {n: ball + now @ was.T @ (drawn[n] - lower) for n in ("wheel_centre", "wheel_axis_inner")}
    joints = {"lower_ball_joint": ball, "upper_ball_joint": top, "tie_rod_outer": end, "tie_rod_inner": rod}
    return drawn | joints | carried


def _on_circle(front, rear, point, up, rise):
    """Where a point that turns about front and rear is this high over front, on the side as drawn."""
    along = (rear - front) / np.linalg.norm(rear - front)
    foot = front + ((point - front) @ along) * along
    radius = np.linalg.norm(point - foot)
    level = np.cross(along, up) / np.linalg.norm(np.cross(along, up))
    steep = np.cross(level, along)
    share = (rise - (foot - front) @ up) / (radius * (steep @ up))
    side = np.sign((point - foot) @ level)
    return foot + radius * (share * steep + side * np.sqrt(1.0 - share**2) * level)


def _meeting(drawn, from_drawn, centres):
    """Where a point is as far from three centres as it is drawn, on the side of their plane as drawn."""
    first, second, third = centres
    squares = [np.sum((drawn - place) ** 2) for place in from_drawn]
    a, b = second - first, third - first
    normal = np.cross(a, b)
    wanted = [(squares[0] - squares[1] + a @ a) / 2, (squares[0] - squares[2] + b @ b) / 2, 0.0]
    foot = np.linalg.solve([a, b, normal / np.linalg.norm(normal)], wanted)
    height = np.sqrt(squares[0] - foot @ foot)
    side = np.sign(
        (drawn - from_drawn[0]) @ np.cross(from_drawn[1] - from_drawn[0], from_drawn[2] - from_drawn[0])
    )
    return first + foot + side * height * normal / np.linalg.norm(normal)


def _frame(first, second, third):
    a = (second - first) / np.linalg.norm(second - first)
    c = np.cross(a, third - first)
    c /= np.linalg.norm(c)
    return np.column_stack([a, np.cross(c, a), c])
