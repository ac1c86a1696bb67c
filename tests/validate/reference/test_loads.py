"""Forces in rods and joints against statics by hand: balances of bodies, solved in fractions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

import mpmath
import pytest
from exact_vectors import number, rational_turn, size, turned
from mechanism_drawings import described, joined
from mpmath import mpf
from plain_mechanisms import plain_mechanism
from reference_cars import OFF_AXIS

from validate.reference import BadInputError, Design, Instant, closed_drawing, solve_reference
from validate.reference.vectors import Vector, cross, dot, minus, plus, times

WITHIN = mpf("1e-50")
FORCE, MOMENT = (300, -700, 4000), (20000, -5000, 90000)
LOAD = {"force": FORCE, "moment": MOMENT}
ONES: tuple[Vector, ...] = ((1, 0, 0), (0, 1, 0), (0, 0, 1))

# The right wheel's contact point of the spin axis (36, 48, 25) and the radius 260 is (1060, 780, 60).
WHEEL = {"wheel_axis_inner": (964, 652, 275), "wheel_centre": (1000, 700, 300)}
CONTACT = (1060, 780, 60)
AXIS = {"wheel_axis": ["wheel_axis_inner", "wheel_centre"], "knuckle": "knuckle"}
WHEELED = {"side": "right", "wheel_radius": 260, "loads": {"": LOAD}}

Balance = Sequence[tuple[Vector, Vector]]  # a force of size 1 and where it acts


def solved(rows: Sequence[Sequence[Fraction]]) -> list[Fraction]:
    """Linear equations, the right-hand side last, by elimination."""
    left = [[Fraction(x) for x in row] for row in rows]
    for i in range(len(left)):
        pivot = next(k for k in range(i, len(left)) if left[k][i])
        left[i], left[pivot] = left[pivot], left[i]
        left[i] = [x / left[i][i] for x in left[i]]
        for k in range(len(left)):
            if k != i:
                left[k] = [x - left[k][i] * y for x, y in zip(left[k], left[i], strict=True)]
    return [row[-1] for row in left]


def wrench(force: Vector, at: Vector) -> tuple[Any, ...]:
    return (*force, *cross(at, force))


def drawn(plain: Mapping[str, Any]) -> Instant:
    return closed_drawing(Design.from_plain(plain)).instant


def near(found: Vector, want: Vector) -> bool:
    return all(abs(a - number(Fraction(b))) < WITHIN for a, b in zip(found, want, strict=True))


def test_a_damper_holds_its_arm_about_the_hinge() -> None:
    points = {**WHEEL, "pivot": (600, 400, 300), "end": (600, 500, 300), "low": (1014, 421, 558)}
    top = (1000, 400, 600)  # 49 from its lower end
    plain = described(
        {**points, "top": top},
        {"chassis": ["pivot", "end", "top"], "knuckle": list(points)},
        {"swing": {"angle": "knuckle", "from": "drawing"}},
        roles={**AXIS, "damper": ["top", "low"]},
        **WHEELED,
    )
    about = points["pivot"]
    pull = cross(minus(points["low"], about), minus(top, points["low"]))[1]
    load = cross(minus(CONTACT, about), FORCE)[1] + MOMENT[1]
    found = drawn(plain)
    assert abs(found.rod_force["damper"] - number(Fraction(-load * 49, pull))) < WITHIN
    assert not found.joint_force
    # Without a damper the input holds the arm, and there is no rod.
    bare = drawn({**plain, "roles": AXIS})
    assert (bare.rod_force, bare.joint_force) == ({}, {})


LINKS = {
    "upper_front": ((950, 300, 420), (960, 620, 430)),
    "upper_rear": ((1100, 320, 410), (1040, 610, 440)),
    "lower_front": ((900, 250, 150), (980, 640, 140)),
    "lower_rear": ((1150, 260, 160), (1030, 650, 150)),
    "toe": ((1080, 280, 250), (1090, 630, 230)),
}


def five_links(**others: Any) -> dict[str, Any]:
    ends = {
        f"{name}_{end}": p
        for name, both in LINKS.items()
        for end, p in zip(("inner", "outer"), both, strict=True)
    }
    plain = plain_mechanism("five_link", {**ends, **WHEEL}, ["wheel_travel"], side="right", wheel_radius=260)
    return {**plain, "loads": {"": LOAD}, **others}


def test_five_links_and_the_height_of_the_wheel_hold_the_knuckle() -> None:
    columns = [wrench(minus(a, b), b) for a, b in LINKS.values()]  # on the knuckle, per tension over length
    columns.append(wrench((0, 0, 1), WHEEL["wheel_centre"]))
    load = [-x for x in wrench(FORCE, CONTACT)]
    load[3:] = [x - m for x, m in zip(load[3:], MOMENT, strict=True)]
    densities = solved([[column[i] for column in columns] + [load[i]] for i in range(6)])
    found = drawn(five_links())
    for (name, (a, b)), density in zip(LINKS.items(), densities, strict=False):
        assert abs(found.rod_force[name] - number(density) * size(minus(a, b))) < WITHIN, name


def test_forces_turn_with_the_car_and_its_load() -> None:
    turn = rational_turn((3, 1, -2, 5))
    here = drawn(five_links())
    points = {name: turned(turn, p) for name, p in five_links()["points"].items()}
    frame = {"up": turned(turn, (0, 0, 1)), "right": turned(turn, (0, 1, 0))}
    load = {"force": turned(turn, FORCE), "moment": turned(turn, MOMENT)}
    there = drawn(five_links(points=points, **frame, loads={"": load}))
    assert all(abs(there.rod_force[name] - force) < WITHIN for name, force in here.rod_force.items())


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


def wishbones(driven: str = "wheel_travel", changed: Mapping[str, Any] | None = None, **others: Any) -> Any:
    points = {**WISHBONES, **(changed or {})}
    inputs = [driven, "rack"]
    plain = plain_mechanism("double_wishbone_pushrod", points, inputs, side="right", wheel_radius=260)
    return {**plain, "loads": {"": LOAD}, **others}


def test_wishbones_hold_the_knuckle_and_the_damper_holds_them_by_rocker_and_pushrod() -> None:
    p = WISHBONES
    pushed, pulled = minus(p["pushrod_inner"], p["pushrod_outer"]), minus(p["damper_top"], p["damper_rocker"])
    tie = minus(p["tie_rod_inner"], p["tie_rod_outer"])

    def about(hinge: str, force: Vector, at: str) -> Fraction:
        """The moment about a hinge."""
        first = p[f"{hinge}_front"]
        return Fraction(dot(minus(p[f"{hinge}_rear"], first), cross(minus(p[at], first), force)))

    # Unknown: the forces on the knuckle in both ball joints, and tension over length of tie rod, pushrod and
    # damper. The knuckle balances, and each arm and the rocker about its hinge.
    lower, upper = "lower_ball_joint", "upper_ball_joint"
    columns = [(*wrench(e, p[lower]), about("lower_arm", e, lower), 0, 0) for e in ONES]
    columns += [(*wrench(e, p[upper]), 0, about("upper_arm", e, upper), 0) for e in ONES]
    columns.append((*wrench(tie, p["tie_rod_outer"]), 0, 0, 0))
    arm, rocker = about("lower_arm", pushed, "pushrod_outer"), about("rocker", pushed, "pushrod_inner")
    columns.append((*[0] * 6, -arm, 0, rocker))
    columns.append((*[0] * 8, -about("rocker", pulled, "damper_rocker")))
    load = [*(-x for x in wrench(FORCE, CONTACT)), 0, 0, 0]
    load[3:6] = [x - m for x, m in zip(load[3:6], MOMENT, strict=True)]
    want = solved([[column[i] for column in columns] + [load[i]] for i in range(9)])
    found = drawn(wishbones())
    assert near(found.joint_force[lower], tuple(want[:3]))
    assert near(found.joint_force[upper], tuple(want[3:6]))
    # What is left of each body's balance are the forces at its hinge.
    push = times(pushed, want[7])
    hinged: dict[str, list[tuple[Vector, str]]] = {
        "lower_arm": [(times(want[:3], -1), lower), (push, "pushrod_outer")],
        "upper_arm": [(times(want[3:6], -1), upper)],
        "rocker": [(times(push, -1), "pushrod_inner"), (times(pulled, want[8]), "damper_rocker")],
    }
    ends = {f"{body}_{name}" for body in hinged for name in ("front", "rear")}
    assert set(found.joint_force) == {lower, upper, "tie_rod_inner", *ends}
    assert near(found.joint_force["tie_rod_inner"], times(tie, want[6]))  # what the rack does
    for body, forces in hinged.items():
        first, second = f"{body}_front", f"{body}_rear"
        line = minus(p[second], p[first])
        force, moment = (0, 0, 0), (0, 0, 0)
        for acting, at in forces:
            force, moment = minus(force, acting), minus(moment, cross(minus(p[at], p[first]), acting))
        at_second = times(cross(moment, line), Fraction(1, dot(line, line)))
        along = times(line, Fraction(dot(force, line), dot(line, line)))
        assert near(found.joint_force[second], at_second)
        assert near(found.joint_force[first], minus(minus(force, along), at_second))
        assert abs(found.hinge_thrust[first] - number(dot(force, line)) / size(line)) < WITHIN
    ways = {"tie_rod": tie, "pushrod": pushed, "damper": pulled}
    for (name, way), density in zip(ways.items(), want[6:], strict=True):
        assert abs(found.rod_force[name] - number(density) * size(way)) < WITHIN, name
    assert found.error_bound["rod_force"] < mpf("1e-50")
    # Whichever input moves the wheel, the damper holds it.
    same = drawn(wishbones("arm_angle"))
    assert all(abs(same.rod_force[name] - force) < WITHIN for name, force in found.rod_force.items())


def test_a_strut_holds_the_knuckle_along_its_axis_by_the_damper_and_across_it_by_its_top() -> None:
    centre = (450, -420, 20)
    inner = minus(centre, (36, -48, 25))
    p = {**OFF_AXIS, "wheel_centre": centre, "wheel_axis_inner": inner}
    plain = plain_mechanism("macpherson", p, ["arm_angle", "rack"], wheel_radius=260)
    found = drawn({**plain, "loads": {"": LOAD}})
    arm, lower, top = p["lower_arm_front"], p["lower_ball_joint"], p["strut_top"]
    tie, strut = minus(p["tie_rod_inner"], p["tie_rod_outer"]), minus(top, p["strut_lower"])
    hinge = minus(p["lower_arm_rear"], arm)
    # Unknown: the ball joint's force, tension over length of tie rod and damper, and what its top holds.
    columns = [(*wrench(e, lower), dot(hinge, cross(minus(lower, arm), e))) for e in ONES]
    columns += [(*wrench(tie, p["tie_rod_outer"]), 0), (*wrench(strut, p["strut_lower"]), 0)]
    columns += [(*wrench(cross(strut, e), top), 0) for e in ONES[:2]]
    load = [-x for x in wrench(FORCE, plus(centre, (60, -80, -240)))] + [0]
    load[3:6] = [x - m for x, m in zip(load[3:6], MOMENT, strict=True)]
    want = solved([[column[i] for column in columns] + [load[i]] for i in range(7)])
    # The arm hangs on the ball joint alone: its force has no moment about the hinge.
    assert near(found.joint_force["lower_ball_joint"], tuple(want[:3]))
    assert abs(found.rod_force["tie_rod"] - number(want[3]) * size(tie)) < WITHIN
    assert abs(found.rod_force["damper"] - number(want[4]) * size(strut)) < WITHIN
    assert abs(found.rod_force["strut_rod"]) < WITHIN


def test_on_a_chassis_that_rolls_with_its_load_the_forces_roll_along() -> None:
    roll = {"roll": {"turns": "chassis", "about": "rocker_front", "along": "rearward"}}
    plain = wishbones()
    angle = mpf("0.4")
    sine, cosine = mpmath.sin(angle), mpmath.cos(angle)

    def rolled(v: Vector) -> Vector:
        return v[0], cosine * v[1] - sine * v[2], sine * v[1] + cosine * v[2]

    # The disc's lowest point moves in it: the force is taken there in the turned car as a moment besides.
    inputs = {"wheel_travel": (5, 0, 0), "rack": (3, 0, 0)}
    still = solve_reference(plain, inputs)
    turning = {**plain, "inputs": {**plain["inputs"], **roll}}
    moved = solve_reference(turning, {**inputs, "roll": (angle, 0, 0)})

    def contact(found: Instant) -> Vector:
        axis = minus(*(found.position[name] for name in ("wheel_centre", "wheel_axis_inner")))
        down = minus(times(axis, axis[2]), times((0, 0, 1), dot(axis, axis)))
        return plus(found.position["wheel_centre"], times(down, 260 / size(down)))

    pivot = WISHBONES["rocker_front"]
    there = plus(pivot, rolled(minus(contact(still), pivot)))
    force = rolled(FORCE)
    moment = plus(rolled(MOMENT), cross(minus(there, contact(moved)), force))
    load = {"": {"force": force, "moment": moment}}
    found = solve_reference({**turning, "loads": load}, {**inputs, "roll": (angle, 0, 0)})
    for name, tension in still.rod_force.items():
        assert abs(found.rod_force[name] - tension) < WITHIN, name
    for name, pull in still.joint_force.items():
        assert max(abs(x) for x in minus(found.joint_force[name], rolled(pull))) < WITHIN, name


def test_the_load_of_one_wheel_of_an_axle_is_held_on_its_side() -> None:
    mirrored = {name: (x, -y, z) for name, (x, y, z) in WISHBONES.items()}
    parts = {"left": wishbones(changed=mirrored, side="left"), "right": wishbones()}
    found = drawn({**joined(parts), "loads": {"right": LOAD}})
    alone = drawn(wishbones())
    for name, force in alone.rod_force.items():
        assert abs(found.rod_force[f"right.{name}"] - force) < WITHIN
        assert abs(found.rod_force[f"left.{name}"]) < WITHIN
    for name, pull in alone.joint_force.items():
        assert max(abs(x) for x in minus(found.joint_force[f"right.{name}"], pull)) < WITHIN


def test_what_forces_lack_is_said() -> None:
    assert "rod_force" not in drawn({**wishbones(), "loads": {}}).left_out
    radius = drawn({**wishbones(), "wheel_radius": None}).left_out
    assert radius["rod_force"] == radius["joint_force"] == "needs a wheel_radius, mm"
    twice = {**wishbones(), "rods": {**wishbones()["rods"], "again": ["tie_rod_inner", "tie_rod_outer"]}}
    assert drawn(twice).left_out["rod_force"].endswith(("as these do: again", "as these do: tie_rod"))
    # The line of the damper meets the hinge of the rocker.
    crossing = times(plus(WISHBONES["rocker_front"], WISHBONES["rocker_rear"]), Fraction(1, 2))
    dead = {"damper_top": minus(times(crossing, 2), WISHBONES["damper_rocker"])}
    assert "does not hold it" in drawn(wishbones(changed=dead)).left_out["rod_force"]
    with pytest.raises(BadInputError, match=r"loads\['left'\]"):
        Design.from_plain({**wishbones(), "loads": {"left": LOAD}})
    with pytest.raises(BadInputError, match=r"loads\[''\].force"):
        Design.from_plain({**wishbones(), "loads": {"": {"force": (1, 2)}}})
