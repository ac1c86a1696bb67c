"""The strut's pose by circles and spheres alone, on the branch that the drawing's signs name."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
UP, RIGHT = np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0])


def random_car(table: dict[str, tuple[float, float, float]], seed: int) -> dict[str, Array]:
    """Each point up to 200 mm from the table; the strut's points nearly on the line 4-5."""
    random = np.random.default_rng(seed)
    p = {name: np.array(point) + random.uniform(-200, 200, 3) for name, point in table.items()}
    top, ball = p["strut_top"], p["lower_ball_joint"]
    for name, low, high in (("strut_lower", 0.55, 0.95), ("strut_rod_end", 0.2, 0.5)):
        share, off = random.uniform(low, high), random.normal(size=3)
        length = random.uniform(0.0, 0.1) * min(share, 1 - share) * np.linalg.norm(ball - top)
        p[name] = top + share * (ball - top) + length * off / np.linalg.norm(off)
    return p


def drawn_inputs(p: dict[str, Array]) -> tuple[float, float]:
    arm = p["lower_ball_joint"] - p["lower_arm_front"]
    return (
        float(np.arccos(arm @ UP / np.linalg.norm(arm))),
        float(-(p["tie_rod_inner"] - p["rack_centre"]) @ RIGHT),
    )


def closed_form(p: dict[str, Array], angle: float, rack: float) -> tuple[dict[str, Array], float] | None:
    """Moving points and how far from a limit the pose is (0 to 1), or None beyond the limits."""
    front, top, ball, outer = (
        p[n] for n in ("lower_arm_front", "strut_top", "lower_ball_joint", "tie_rod_outer")
    )
    # The ball joint moves on a circle about the arm axis; at one height it has two places.
    axis = unit(p["lower_arm_rear"] - front)
    arm = ball - front
    sideways = unit(np.cross(axis, UP))
    upward = np.cross(sideways, axis)
    radius = np.linalg.norm(np.cross(axis, arm))
    rise = (np.linalg.norm(arm) * np.cos(angle) - (axis @ arm) * (axis @ UP)) / (radius * (upward @ UP))
    if abs(rise) >= 1:
        return None
    beside = np.sign(arm @ sideways) * np.sqrt(1 - rise**2)
    new_ball = front + (axis @ arm) * axis + radius * (rise * upward + beside * sideways)
    # Knuckle and strut rod lie along the kingpin, in the sense in which they are drawn.
    line = unit(p["strut_lower"] - ball)
    new_line = np.sign(line @ (top - ball)) * unit(top - new_ball)
    if (line @ (top - ball)) * ((top - p["strut_rod_end"]) @ (top - ball)) <= 0:
        return None
    # The tie rod's outer end moves on a circle about the kingpin and meets a sphere about its inner end.
    inner = p["rack_centre"] - rack * RIGHT
    height, reach = (outer - ball) @ line, float(np.linalg.norm(np.cross(outer - ball, line)))
    across = inner - new_ball - ((inner - new_ball) @ new_line) * new_line
    far, lift = float(np.linalg.norm(across)), (inner - new_ball) @ new_line
    rod = np.linalg.norm(outer - p["tie_rod_inner"])
    cosine = (reach**2 + far**2 + (height - lift) ** 2 - rod**2) / (2 * reach * far)
    if abs(cosine) >= 1:
        return None
    side = np.sign((outer - ball) @ np.cross(line, p["tie_rod_inner"] - ball))
    toward = across / far
    turned = cosine * toward + side * np.sqrt(1 - cosine**2) * np.cross(new_line, toward)
    new_outer = new_ball + height * new_line + reach * turned
    # The knuckle carries the wheel centre.
    drawn_frame, frame = axes(line, outer - ball), axes(new_line, new_outer - new_ball)
    return {
        "lower_ball_joint": new_ball,
        "tie_rod_outer": new_outer,
        "tie_rod_inner": inner,
        "strut_lower": new_ball + np.linalg.norm(p["strut_lower"] - ball) * new_line,
        "strut_rod_end": top - np.linalg.norm(top - p["strut_rod_end"]) * new_line,
        "wheel_centre": new_ball + frame.T @ (drawn_frame @ (p["wheel_centre"] - ball)),
    }, float(min(1 - abs(rise), 1 - abs(cosine)))


def unit(vector: Array) -> Array:
    return np.asarray(vector / np.linalg.norm(vector))


def axes(line: Array, other: Array) -> Array:
    x = unit(other - (other @ line) * line)
    return np.array([x, np.cross(line, x), line])
