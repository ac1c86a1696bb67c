"""Forces of loads at the wheels by all three mechanics: statics by hand, and balances of bodies."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import pytest
from changed_scenes import scene_with
from mpmath import cos, mp, mpf, sin, sqrt, workdps
from three_mechanics import DIGITS, assert_exact, by_each, scene_of, solved_by

from validate.comparison.compare import compare
from validate.reference.vectors import Vector, cross, dot, minus, plus, times

# A right double wishbone with a pushrod and a rocker. The contact point of its wheel, with the spin axis
# (36, 48, 25) and the radius 260, is (1060, 780, 60).
WHEEL = {"wheel_axis_inner": (964, 652, 275), "wheel_centre": (1000, 700, 300)}
CONTACT = (1060, 780, 60)
WISHBONES = {
    "lower_arm_front": (900, 250, 160),
    "lower_arm_rear": (1120, 260, 150),
    "upper_arm_front": (930, 300, 410),
    "upper_arm_rear": (1080, 310, 420),
    "lower_ball_joint": (995, 660, 150),
    "upper_ball_joint": (1010, 620, 430),
    "tie_rod_outer": (1130, 650, 240),
    "tie_rod_inner": (1140, 270, 250),
    "pushrod_outer": (1000, 560, 180),
    "pushrod_inner": (1010, 330, 500),
    "rocker_front": (960, 280, 480),
    "rocker_rear": (1060, 290, 490),
    "damper_rocker": (1000, 250, 540),
    "damper_top": (990, 40, 520),
    **WHEEL,
}

FORCE, MOMENT = (300, -700, 4000), (20000, -5000, 90000)
LOAD = {"force": list(FORCE), "moment": list(MOMENT)}
ONES: tuple[Vector, ...] = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
# Forces of up to 10 kN, of which claims are some 1e-13 and which have arms of some 10 to carry them.
WITHIN = 1e-10


@pytest.fixture(autouse=True)
def many_digits() -> Iterator[None]:
    with workdps(DIGITS):
        yield


def solved(columns: Sequence[Sequence[Any]], right: Sequence[Any]) -> list[mpf]:
    """Linear equations by their columns."""
    return [*mp.lu_solve(mp.matrix([[*column] for column in columns]).T, mp.matrix([*right]))]


def wrench(force: Vector, at: Vector) -> tuple[Any, ...]:
    return (*force, *cross(at, force))


def against_load(contact: Vector) -> list[Any]:
    """What balances the load, as a force and a moment about the origin."""
    load = [-x for x in wrench(FORCE, contact)]
    return [*load[:3], *(x - m for x, m in zip(load[3:], MOMENT, strict=True))]


def assert_forces(who: str, mechanism: Mapping[str, Any], exact: Mapping[Any, Any], **laws: Any) -> Any:
    """Forces as drawn, of rods by tension over length, of joints as vectors."""
    solution = solved_by(who, scene_of(mechanism, ["loads"], **laws))
    assert_exact(solution, {name: [value] * 3 for name, value in exact.items()}, WITHIN)
    return solution


def tension(density: mpf, way: Vector) -> mpf:
    return density * sqrt(mpf(dot(way, way)))


def right_wheel(name: str, points: Mapping[str, Vector]) -> dict[str, Any]:
    places = {point: [float(c) for c in place] for point, place in points.items()}
    return {"type": name, "side": "right", "points": places, "wheel_radius": 260.0, "loads": LOAD}


SWING = {
    "bodies": {"chassis": ["a", "b", "top"], "knuckle": ["a", "b", "inner", "centre", "low"]},
    "inputs": {"turn": {"angle": "knuckle", "from": "drawing"}},
    "roles": {"knuckle": "knuckle", "wheel_axis": ["inner", "centre"], "damper": ["low", "top"]},
    "points": {
        "a": (-100.0, 150.0, 420.0),
        "b": (100.0, 150.0, 420.0),
        "inner": (0.0, 660.0, 300.0),
        "centre": (0.0, 760.0, 300.0),
        "low": (0.0, 600.0, 280.0),
        "top": (0.0, 500.0, 700.0),
    },
    "side": "right",
    "wheel_radius": 300.0,
    "loads": LOAD,
}


@by_each
def test_a_damper_beside_a_hinge_carries_the_moment_about_it(who: str) -> None:
    turn = [0.015625, 0.125]
    solution = solved_by(who, scene_of(SWING, ["loads"], turn=turn))
    assert [*solution.numbers["rod_force"]] == ["damper"]
    assert not solution.numbers["joint_force"]  # what holds beside it is a hinge
    exact = []
    for time in (mpf(0), mpf(1) / 2, mpf(1)):
        angle = mpf(turn[0]) + mpf(turn[1]) * time

        def turned(y: int, z: int, angle: mpf = angle) -> tuple[mpf, mpf]:
            return y * cos(angle) - z * sin(angle), y * sin(angle) + z * cos(angle)

        y, z = turned(610, -120)
        contact = (y + 300 * sin(angle), z - 300 * cos(angle))
        low, top = turned(450, -140), (mpf(350), mpf(280))
        line = (top[0] - low[0], top[1] - low[1])
        # About the hinge: the load's moment, and the damper's arm, which pulls `low` towards `top`.
        moment = contact[0] * FORCE[2] - contact[1] * FORCE[1] + MOMENT[0]
        arm = (low[0] * line[1] - low[1] * line[0]) / sqrt(line[0] ** 2 + line[1] ** 2)
        exact.append(-moment / arm)
    assert_exact(solution, {"damper": exact}, WITHIN)
    with pytest.raises(AssertionError):
        assert_exact(solution, {"damper": [force * (1 + mpf("1e-9")) for force in exact]}, WITHIN)


LINKS = {
    "upper_front": ((950, 300, 420), (960, 620, 430)),
    "upper_rear": ((1100, 320, 410), (1040, 610, 440)),
    "lower_front": ((900, 250, 150), (980, 640, 140)),
    "lower_rear": ((1150, 260, 160), (1030, 650, 150)),
    "toe": ((1080, 280, 250), (1090, 630, 230)),
}


@by_each
def test_five_links_and_the_height_of_the_wheel_hold_the_knuckle(who: str) -> None:
    ends = {
        f"{name}_{end}": place
        for name, both in LINKS.items()
        for end, place in zip(("inner", "outer"), both, strict=True)
    }
    columns = [wrench(minus(a, b), b) for a, b in LINKS.values()]  # on the knuckle, per tension over length
    columns.append(wrench((0, 0, 1), WHEEL["wheel_centre"]))
    load = against_load(CONTACT)
    exact = {
        ("rod_force", name): tension(density, minus(a, b))
        for (name, (a, b)), density in zip(LINKS.items(), solved(columns, load), strict=False)
    }
    assert_forces(who, right_wheel("five_link", {**ends, **WHEEL}), exact, wheel_travel=0.0)


@by_each
def test_wishbones_hold_the_knuckle_and_the_damper_holds_them_by_rocker_and_pushrod(who: str) -> None:
    p = WISHBONES
    pushed, pulled = minus(p["pushrod_inner"], p["pushrod_outer"]), minus(p["damper_top"], p["damper_rocker"])
    tie = minus(p["tie_rod_inner"], p["tie_rod_outer"])

    def about(hinge: str, force: Vector, at: str) -> Any:
        """The moment about a hinge."""
        first = p[f"{hinge}_front"]
        return dot(minus(p[f"{hinge}_rear"], first), cross(minus(p[at], first), force))

    # Unknown: the forces on the knuckle in both ball joints, and tension over length of tie rod, pushrod and
    # damper. The knuckle balances, and each arm and the rocker about its hinge.
    lower, upper = "lower_ball_joint", "upper_ball_joint"
    columns = [(*wrench(e, p[lower]), about("lower_arm", e, lower), 0, 0) for e in ONES]
    columns += [(*wrench(e, p[upper]), 0, about("upper_arm", e, upper), 0) for e in ONES]
    columns.append((*wrench(tie, p["tie_rod_outer"]), 0, 0, 0))
    arm, rocker = about("lower_arm", pushed, "pushrod_outer"), about("rocker", pushed, "pushrod_inner")
    columns.append((*[0] * 6, -arm, 0, rocker))
    columns.append((*[0] * 8, -about("rocker", pulled, "damper_rocker")))
    load = [*against_load(CONTACT), 0, 0, 0]
    want = solved(columns, load)
    ways = {"tie_rod": tie, "pushrod": pushed, "damper": pulled}
    push = times(pushed, want[7])
    # What is left of each body's balance are the forces at its hinge.
    hinged: dict[str, list[tuple[Vector, str]]] = {
        "lower_arm": [(times(want[:3], -1), lower), (push, "pushrod_outer")],
        "upper_arm": [(times(want[3:6], -1), upper)],
        "rocker": [(times(push, -1), "pushrod_inner"), (times(pulled, want[8]), "damper_rocker")],
    }
    exact: dict[Any, Any] = {
        name: tension(density, way) for (name, way), density in zip(ways.items(), want[6:], strict=True)
    }
    joints = {lower: want[:3], upper: want[3:6]}
    joints["tie_rod_inner"] = times(tie, want[6])  # what the rack does
    for body, forces in hinged.items():
        first, second = f"{body}_front", f"{body}_rear"
        line = minus(p[second], p[first])
        force, moment = (0, 0, 0), (0, 0, 0)
        for acting, at in forces:
            force, moment = minus(force, acting), minus(moment, cross(minus(p[at], p[first]), acting))
        at_second = times(cross(moment, line), mpf(1) / dot(line, line))
        along = times(line, mpf(dot(force, line)) / dot(line, line))
        joints |= {second: at_second, first: minus(minus(force, along), at_second)}
        exact["hinge_thrust", first] = dot(force, line) / sqrt(mpf(dot(line, line)))
    exact |= {("joint_force", name): force for name, force in joints.items()}
    mechanism = right_wheel("double_wishbone_pushrod", p)
    solution = assert_forces(who, mechanism, exact, wheel_travel=0.0, rack=0.0)
    assert {*solution.numbers["joint_force"]} == {*joints}


STRUT = {
    "lower_arm_front": (-300, -330, -80),
    "lower_arm_rear": (30, -350, -90),
    "lower_ball_joint": (-20, -640, -110),
    "strut_lower": (-5, -560, 150),
    "strut_rod_end": (4, -540, 330),
    "strut_top": (13, -520, 510),
    "tie_rod_outer": (120, -610, -40),
    "tie_rod_inner": (130, -290, -20),
    "wheel_axis_inner": (-36, -622, -5),
    "wheel_centre": (0, -670, 20),
}
"""A left strut whose three points are in line; the spin axis is (36, -48, 25)."""


@by_each
def test_a_strut_holds_the_knuckle_along_its_axis_by_the_damper_and_across_it_by_its_top(who: str) -> None:
    p = STRUT
    arm, lower, top = p["lower_arm_front"], p["lower_ball_joint"], p["strut_top"]
    tie, strut = minus(p["tie_rod_inner"], p["tie_rod_outer"]), minus(top, p["strut_lower"])
    hinge = minus(p["lower_arm_rear"], arm)
    # Unknown: the ball joint's force, tension over length of tie rod and damper, and what its top holds
    # across the axis. The arm hangs on the ball joint alone: its force has no moment about the hinge.
    columns = [(*wrench(e, lower), dot(hinge, cross(minus(lower, arm), e))) for e in ONES]
    columns += [(*wrench(tie, p["tie_rod_outer"]), 0), (*wrench(strut, p["strut_lower"]), 0)]
    across = [cross(strut, e) for e in ONES[:2]]
    columns += [(*wrench(way, top), 0) for way in across]
    load = [*against_load(plus(p["wheel_centre"], (60, -80, -240))), 0]
    want = solved(columns, load)
    side = plus(*(times(way, share) for way, share in zip(across, want[5:], strict=True)))
    mechanism = right_wheel("macpherson", p) | {"side": "left"}
    exact = {
        ("joint_force", "lower_ball_joint"): want[:3],
        "tie_rod": tension(want[3], tie),
        "damper": tension(want[4], strut),
        ("joint_force", "strut_top"): side,
    }
    assert_forces(who, mechanism, exact, wheel_travel=0.0, rack=0.0)


def test_forces_of_one_pose_in_which_nothing_moves_are_compared() -> None:
    still = {"inputs": {name: {"constant": 0.0} for name in ("wheel_travel", "rack")}, "effects": ["loads"]}
    time = {"start": 0.0, "stop": 0.0, "samples": 1}
    outcome = compare(scene_with("pushrod", {"loads": LOAD}, **still, time=time), "pointcoord", "absolute")
    verdicts = [row.verdict for row in outcome.rows if row.unit == "N"]
    assert len(verdicts) >= 10
    assert set(verdicts) == {"agrees"}
