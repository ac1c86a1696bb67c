"""Mechanisms from plain data: what each primitive means, on a crank and a rod, and redundant hinges."""

from typing import Any

import numpy as np
import pytest
from many_digits import DIGITS, unit, vector
from mechanism_files import plain_scene
from mpmath import acos, mp
from shipped import EPS, Array, Motion, error, exact, off

import absolute

TURN: dict[str, Any] = {"turn": {"angle": "crank", "from": "drawing", "on": "chassis"}}


def at(values: Any, rate: float = 0.0, second: float = 0.0) -> Array:
    """Value, rate and acceleration at N instants."""
    values = np.asarray(values, dtype=float)
    return np.stack([values, np.full_like(values, rate), np.full_like(values, second)], axis=-1)


def plain(
    bodies: dict[str, Any], points: dict[str, Any], inputs: dict[str, Any], **more: Any
) -> dict[str, Any]:
    """A mechanism that is no car."""
    axes = {"up": (0.0, 0.0, 1.0), "right": (0.0, 1.0, 0.0), "side": "left"}
    return {"name": "mechanism", "bodies": bodies, "points": points, "inputs": inputs, **axes, **more}


def crank(inputs: dict[str, Any]) -> dict[str, Any]:
    """A crank of 300 mm about x, and beside it a rod of 700 mm to a point that slides to the right."""
    points = {"a": (0, 0, 0), "b": (100, 0, 0), "end": (0, 180, 240)}
    points["slide"] = (0, 180 + np.sqrt(700**2 - 240**2), 0)
    bore = {"points": ["slide"], "body": "chassis", "through": "a", "along": "right", "turns": True}
    more = {"rods": {"rod": ["end", "slide"]}, "slides": {"bore": bore}}
    return plain({"chassis": ["a", "b"], "crank": ["a", "b", "end"]}, points, inputs, **more)


def test_a_hinge_turns_from_the_drawing_by_any_number_of_turns() -> None:
    turn = np.array([0.0, 1.0, 3.0, 7.0, 20.0, -50.0, -1.0])
    motion = Motion(crank(TURN), {"turn": at(turn, 2.0, -3.0)}).solve(conditions=True)
    angle = np.arctan2(240, 180) + turn
    y, z = 300 * np.cos(angle), 300 * np.sin(angle)
    root = np.sqrt(700**2 - z**2)
    # y + sqrt(l^2 - z^2), with y' = -z w, z' = y w, w = 2, w' = -3.
    y1, z1 = -2 * z, 2 * y
    y2, z2 = 3 * z - 4 * y, -3 * y - 4 * z
    root1 = -z * z1 / root
    root2 = (-(z1**2) - z * z2 - root1**2) / root
    for found, expected, fast in (
        (motion.position, y + root, 1.0),
        (motion.velocity, y1 + root1, 2.0),
        (motion.acceleration, y2 + root2, 7.0),
    ):
        # The turns asked for are rounded, and so is this form.
        rounding = 16 * EPS * (1.0 + np.abs(turn)) * np.abs(expected).max()
        assert (np.abs(found["slide"][:, 1] - expected) <= fast * off(motion) + rounding).all()
    assert np.allclose(motion.angular_velocity["crank"], [2.0, 0.0, 0.0], rtol=0, atol=1e-14)
    assert set(motion.angular_velocity) == {"crank"}


@pytest.mark.parametrize(
    "given",
    [
        {"travel": ["bore"]},
        {"distance": ["a", "slide"]},
        {"height": "slide", "along": "right"},
        {"height": "end"},
        {"angle": "crank", "of": "end", "about": "a", "from": "up"},
    ],
    ids=["travel", "distance", "height along", "height", "angle"],
)
def test_every_input_leads_to_the_pose_that_the_turn_leads_to(given: dict[str, Any]) -> None:
    turned = Motion(crank(TURN), {"turn": at([0.3], 0.5, -0.25)}).solve()
    states = (turned.position, turned.velocity, turned.acceleration)
    point, axis, drawn = ("end", 2, 240.0) if given.get("height") == "end" else ("slide", 1, 0.0)
    if given.get("height") == "slide":
        drawn = 180 + np.sqrt(700**2 - 240**2)
    law = [of[point][0, axis] for of in states] - np.array([drawn, 0.0, 0.0])
    if "angle" in given:
        law = np.array([np.arctan2(180, 240) - 0.3, -0.5, 0.25])
    motion = Motion(crank({"in": given}), {"in": law[None]}).solve(conditions=True)
    for of, wanted in zip((motion.position, motion.velocity, motion.acceleration), states, strict=True):
        for name in ("end", "slide"):
            assert np.abs(of[name] - wanted[name]).max() <= 64 * off(motion)[0], name


def four_bar(tilt: float = 0.0, **more: Any) -> dict[str, Any]:
    """Hinges along x at (0, 0), (40, 30), (160, 60), (150, 0) in y and z; the last one tilted."""
    places = [(0, 0), (40, 30), (160, 60), (150, 0)]
    points = {f"p{i}": (0, y, z) for i, (y, z) in enumerate(places)}
    points |= {f"q{i}": (100, y + (100 * tilt if i == 3 else 0), z) for i, (y, z) in enumerate(places)}
    bodies = {
        "chassis": ["p0", "q0", "p3", "q3"],
        "crank": ["p0", "q0", "p1", "q1"],
        "coupler": ["p1", "q1", "p2", "q2"],
        "rocker": ["p2", "q2", "p3", "q3"],
    }
    return plain(bodies, points, TURN, **more)


def test_a_four_bar_of_hinges_follows_its_circles() -> None:
    turn = np.linspace(-0.4, 0.9, 27)
    motion = Motion(four_bar(), {"turn": at(turn, 1.0)}).solve(conditions=True)
    pin = 50.0 * np.exp(1j * (np.arctan2(30, 40) + turn))
    # The joint is where circles about the pin and about the other pivot meet, on the drawn side.
    across = 150.0 - pin
    coupler, rocker = np.hypot(120, 30), np.hypot(10, 60)
    along = (coupler**2 - rocker**2 + np.abs(across) ** 2) / (2 * np.abs(across))
    joint = pin + across / np.abs(across) * (along + 1j * np.sqrt(coupler**2 - along**2))
    found = motion.position["p2"]
    error = np.abs(found[:, 1] + 1j * found[:, 2] - joint)
    assert (error <= off(motion) + 32 * EPS * 200.0).all()
    assert np.abs(found[:, 0]).max() < 1e-12


@pytest.mark.parametrize(
    ("tilt", "turn", "rate", "effects", "kind", "words"),
    [
        (1e-2, [0.0], 0.0, [], absolute.DescriptionError, "hinge of.*held more than once"),
        (1e-9, [0.0, 0.5], 0.0, [], absolute.PoseError, "hinge of"),
        (1e-10, [0.0], 1.0, [], absolute.AssemblyError, r"hinge of.*locked"),
        (1e-10, [0.0], 0.0, ["toe_by_travel"], absolute.AssemblyError, r"hinge of.*locked"),
    ],
)
def test_a_four_bar_whose_hinges_are_not_parallel_is_locked(
    tilt: float, turn: list[float], rate: float, effects: list[str], kind: type[Exception], words: str
) -> None:
    bars = four_bar(tilt, roles={"wheel_axis": ["q1", "q2"]})
    with pytest.raises(kind, match=words):
        Motion(bars, {"turn": at(turn, rate)}).solve(effects=effects)
    if tilt == 1e-10:
        assert Motion(bars, {"turn": at([0.0])}).solve(effects=["toe"]).effects


def test_a_slide_of_two_points_of_one_body_may_turn_or_not() -> None:
    points = {"a": (0, 0, 0), "b": (0, 100, 0), "c": (0, 300, 0), "d": (30, 350, 40), "e": (200, 300, 0)}
    slide = {"points": ["b", "c"], "body": "chassis", "through": "a", "along": "right"}
    bodies = {"chassis": ["a", "e"], "ram": ["b", "c", "d"]}
    travel = {"out": {"travel": ["bore"]}}
    fixed = plain(bodies, points, travel, slides={"bore": {**slide, "turns": False}})
    motion = Motion(fixed, {"out": at([130.0])}).solve()
    assert motion.position["d"][0] == pytest.approx([30.0, 380.0, 40.0], abs=1e-12)
    free = plain(
        bodies, points, travel | {"lift": {"height": "d"}}, slides={"bore": {**slide, "turns": True}}
    )
    motion = Motion(free, {"out": at([130.0]), "lift": at([-10.0])}).solve()
    assert motion.position["d"][0] == pytest.approx([40.0, 380.0, 30.0], abs=1e-11)
    # Drawn askew, the ram is laid into its bore by the smallest turn, in which its other points do not roll.
    askew = fixed | {"points": points | {"c": (0, 300, 20)}}
    closed = absolute.close_drawing(absolute.compile(askew)).position
    assert closed["c"][[0, 2]] == pytest.approx([0.0, 0.0], abs=1e-12)
    assert closed["d"][0] == pytest.approx(30.0, abs=1e-12)


# Pairs of one body of the paper's strut.
PAIRS = [
    ("lower_arm_front", "lower_arm_rear"),
    ("lower_ball_joint", "strut_lower"),
    ("strut_lower", "lower_ball_joint"),
    ("strut_top", "strut_rod_end"),
    ("lower_ball_joint", "lower_arm_front"),
    ("tie_rod_outer", "wheel_centre"),
]


@pytest.mark.parametrize(("fixed", "moved"), PAIRS)
def test_points_drawn_near_each_other_keep_the_digits_of_the_coordinates_given(
    fixed: str, moved: str
) -> None:
    """However short a line between two points of a body is, it is drawn as accurately as they are."""
    share, scene, random = 1e-3, plain_scene("steer", ["arm_angle", "rack"]), np.random.default_rng(3)
    car = {name: np.array(point) + random.uniform(-30, 30, 3) for name, point in scene["points"].items()}
    ball, top = car["lower_ball_joint"], car["strut_top"]
    for name, along in (("strut_lower", 0.12), ("strut_rod_end", 0.5)):
        car[name] = ball + along * (top - ball) + random.uniform(-2, 2, 3)
    car[moved] = car[fixed] + share * (car[moved] - car[fixed])
    model = absolute.compile(scene | {"points": car})
    drawing, drawn = model.drawing, absolute.close_drawing(model).inputs
    for body in model.moving:
        if {fixed, moved} <= set(model.bodies[body]):
            number = drawing.bodies[body]
            line = np.linalg.norm(drawing.arm(number, moved) - drawing.arm(number, fixed)) * drawing.size
            assert abs(line / np.linalg.norm(car[moved] - car[fixed]) - 1) <= 4 * EPS
    with mp.workdps(DIGITS):
        angle = acos(unit(vector(car["lower_ball_joint"]) - vector(car["lower_arm_front"]))[2])
    # The arc cosine of a ratio with three roundings, at an angle whose sine is above a half.
    assert abs(drawn["arm_angle"] - float(angle)) <= 4 * EPS
    goal = {"arm_angle": at([drawn["arm_angle"] + 0.05]), "rack": at([drawn["rack"] + 5.0])}
    motion = Motion(scene | {"points": car}, goal)
    solution, (wanted, *_) = motion.solve(rates=False, conditions=True), exact(motion)[0]
    for name, place in solution.position.items():
        assert error(place[0], wanted[name]) <= off(solution)[0], name
