"""Forces of rods and ball joints: by virtual work, by equilibrium of the knuckle, and by hand."""

from typing import Any

import numpy as np
import pytest
from mechanism_files import plain_scene, renamed
from shipped import EPS, Array, Motion
from test_mechanisms import four_bar

import absolute

FORCE, MOMENT = np.array([300.0, -900.0, 4000.0]), np.array([2e4, -5e4, 1e4])
LOAD = {"force": FORCE.tolist(), "moment": MOMENT.tolist()}
UNITS = np.eye(3)
# Poses are off by some 40 roundings of 800 mm (see test_effects), and forces of up to 20 kN change by no more
# over 50 mm; each is known to as many roundings of its own.
OFF = 40 * EPS * 2e4 * (1.0 + 800.0 / 50.0)
# Scene, other inputs than its own, values of the inputs; the damper stands upright, lies, or is driven.
CARS: dict[str, tuple[str, list[str] | None, dict[str, float]]] = {
    "double wishbone": ("double-wishbone", ["wheel_travel", "rack"], {"wheel_travel": 20.0, "rack": 8.0}),
    "strut": ("off-axis-strut", ["wheel_travel", "rack"], {"wheel_travel": -15.0, "rack": 5.0}),
    "five link": ("five-link", None, {"wheel_travel": 25.0}),
    "pushrod": ("pushrod", None, {}),
    "pushrod by damper": ("pushrod-by-damper", None, {}),
}


def car(name: str, **changed: Any) -> tuple[dict[str, Any], dict[str, float]]:
    """A car, drawn in a pose of its motion, whose wheel is loaded; and its inputs there."""
    scene, driven, values = CARS[name]
    described = plain_scene(scene, driven) | {"wheel_radius": 300.0, "loads": {"": LOAD}} | changed
    values = absolute.close_drawing(absolute.compile(described)).inputs | values
    posed = solve(described, values).position
    described["points"] = {point: place[0] for point, place in posed.items()}
    return described, absolute.close_drawing(absolute.compile(described)).inputs


def solve(described: dict[str, Any], values: dict[str, float], moving: str = "", **options: Any) -> Any:
    """At values of the inputs, one of which may move by 1 in a second."""
    inputs = {name: np.array([[value, float(name == moving), 0.0]]) for name, value in values.items()}
    return Motion(described, inputs).solve(**options)


def contact(points: dict[str, Array], roles: dict[str, Any], radius: float, prefix: str = "") -> Array:
    inner, centre = (np.asarray(points[point]) for point in roles[f"{prefix}wheel_axis"])
    axis = (centre - inner) / np.linalg.norm(centre - inner)
    down = axis * axis[2] - [0.0, 0.0, 1.0]
    return np.asarray(centre + radius * down / np.linalg.norm(down))


def work_of(described: dict[str, Any], inputs: dict[str, Any], bodies: Any = None) -> float:
    """Work of the load for each mm that the distance `apart`, an input, grows; others are held."""
    changed = described | {"inputs": inputs} | (bodies or {})
    ends = inputs["apart"]["distance"]
    values = absolute.close_drawing(absolute.compile(changed)).inputs
    assert values["apart"] == pytest.approx(
        np.linalg.norm(np.subtract(*(changed["points"][e] for e in ends)))
    )
    moving = solve(changed, values, "apart")
    knuckle, centre = described["roles"]["knuckle"], described["roles"]["wheel_axis"][1]
    spin, speed = moving.angular_velocity[knuckle][0], moving.velocity[centre][0]
    points = {name: place[0] for name, place in moving.position.items()}
    speed = speed + np.cross(spin, contact(points, described["roles"], 300.0) - points[centre])
    return float(FORCE @ speed + MOMENT @ spin)


def holding(described: dict[str, Any]) -> dict[str, Any]:
    """Its inputs, with the length of a damper in place of the one that moves the wheel."""
    inputs = {name: drive for name, drive in described["inputs"].items() if "moves" not in drive}
    if "damper" in described["roles"]:
        inputs = {name: drive for name, drive in inputs.items() if "travel" in drive}
        inputs["damper"] = {"distance": described["roles"]["damper"]}
    return inputs


@pytest.mark.parametrize("name", CARS)
def test_the_tension_of_a_rod_is_the_work_of_the_load_as_it_is_lengthened(name: str) -> None:
    described, values = car(name)
    forces = solve(described, values, loads=True).rod_force
    damper = {"damper": described["roles"]["damper"]} if "damper" in described["roles"] else {}
    assert set(forces) == set(described["rods"]) | set(damper)
    held = holding(described)
    for rod, ends in (described["rods"] | damper).items():
        rods = {other: of for other, of in described["rods"].items() if other != rod}
        if set(ends) & {point for slide in described["slides"].values() for point in slide["points"]} and (
            rod == "strut_rod"
        ):
            # It only keeps the free end of the strut in its place.
            assert abs(forces[rod][0]) <= OFF
            continue
        inputs = {other: drive for other, drive in held.items() if other != rod}
        work = work_of(described | {"rods": rods}, inputs | {"apart": {"distance": ends}})
        assert abs(forces[rod][0] - work) <= OFF, rod


@pytest.mark.parametrize("name", [name for name in CARS if name != "five link"])
def test_the_force_of_a_ball_joint_is_the_work_of_the_load_as_its_halves_part(name: str) -> None:
    described, values = car(name)
    forces, knuckle = solve(described, values, loads=True).joint_force, described["roles"]["knuckle"]
    joints = {point for point in described["points"] if "ball_joint" in point}
    assert set(forces) >= joints
    for point in joints:
        force = forces[point]
        arm = next(b for b, ps in described["bodies"].items() if point in ps and b != knuckle)
        points, bodies, rods = dict(described["points"]), dict(described["bodies"]), dict(described["rods"])
        # The arm's half has a point of its own, and the knuckle's stands off three of the arm's, 1 m away.
        bodies[arm] = [("half" if p == point else p) for p in bodies[arm]] + ["out x", "out y", "out z"]
        points["half"] = points[point]
        for axis, way in zip("xyz", UNITS, strict=True):
            points[f"out {axis}"] = np.asarray(points[point]) + 1000.0 * way
        for axis, way in zip("xyz", UNITS, strict=True):
            others = {f"out {o}": [f"out {o}", point] for o in "xyz" if o != axis}
            apart = holding(described) | {"apart": {"distance": [f"out {axis}", point]}}
            named = by_own_half(apart, "half", point, arm)
            work = work_of(described | {"rods": rods | others, "points": points, "bodies": bodies}, named)
            # The distance grows as the knuckle goes against the direction.
            assert abs(force[0] @ way - work) <= 4 * OFF, (point, axis)


@pytest.mark.parametrize("name", [name for name in CARS if name != "five link"])
def test_rods_ball_joints_and_its_hinge_hold_every_arm_in_balance(name: str) -> None:
    described, values = car(name)
    found = solve(described, values, loads=True)
    at, bodies = {n: place[0] for n, place in found.position.items()}, described["bodies"]
    rods = dict(described["rods"])
    if "damper" in described["roles"]:
        rods["damper"] = described["roles"]["damper"]
    arms = [body for body, points in bodies.items() if body != "chassis" and points[0] in found.hinge_thrust]
    assert len(arms) >= (2 if "wishbone" in name or "pushrod" in name else 1)
    for arm in arms:
        first, second = (point for point in bodies[arm] if point in bodies["chassis"])
        line = (at[second] - at[first]) / np.linalg.norm(at[second] - at[first])
        held = found.joint_force[first][0] + found.hinge_thrust[first][0] * line
        acting = [(held, at[first]), (found.joint_force[second][0], at[second])]
        acting += [(-found.joint_force[n][0], at[n]) for n in bodies[arm] if "ball_joint" in n]
        for rod, ends in rods.items():
            for here, there in (ends, ends[::-1]):
                if here in bodies[arm]:
                    way = (at[there] - at[here]) / np.linalg.norm(at[there] - at[here])
                    acting.append((found.rod_force[rod][0] * way, at[here]))
        assert np.abs(sum(force for force, _ in acting)).max() <= 4 * OFF, arm
        turning = sum(np.cross(place - at[first], force) for force, place in acting)
        assert np.abs(turning).max() <= 500.0 * 4 * OFF, arm


def by_own_half(inputs: dict[str, Any], half: str, point: str, arm: str) -> dict[str, Any]:
    """Inputs that measure an arm by its own half of the joint."""
    return {
        name: {
            key: half if (key, value) == ("of", point) and drive.get("angle") == arm else value
            for key, value in drive.items()
        }
        for name, drive in inputs.items()
    }


@pytest.mark.parametrize("roll", [0.0, 0.2])
@pytest.mark.parametrize("side", ["left", "right"])
def test_the_knuckles_of_an_axle_are_in_equilibrium_each_with_its_load(side: str, roll: float) -> None:
    described = plain_scene("axle-steer") | {"sides": {"left": "left", "right": "right"}}
    described |= {"wheel_radius": 300.0, "loads": {side: {"force": LOAD["force"]}}}
    described["inputs"]["roll"] = {"turns": "chassis", "about": "left.rack_centre", "along": "forward"}
    values = {"left.wheel_travel": 20.0, "right.wheel_travel": -10.0, "rack": 12.0, "roll": roll}
    solution = solve(described, values, loads=True)
    at = {name: place[0] for name, place in solution.position.items()}
    for part in ("left", "right"):
        inner, outer = (at[f"{part}.tie_rod_{end}"] for end in ("inner", "outer"))
        pull = solution.rod_force[f"{part}.tie_rod"][0] * (inner - outer) / np.linalg.norm(inner - outer)
        wheel = FORCE if part == side else np.zeros(3)
        acting = [(pull, outer), (wheel, contact(at, described["roles"], 300.0, f"{part}."))]
        acting += [
            (solution.joint_force[f"{part}.{n}_ball_joint"][0], at[f"{part}.{n}_ball_joint"])
            for n in ("lower", "upper")
        ]
        # What drives the wheel's height acts on its centre along the car's up, before it rolls.
        centre = at[f"{part}.wheel_centre"]
        up = np.array([0.0, np.sin(roll), np.cos(roll)])
        missing = -sum(force for force, _ in acting)
        assert np.linalg.norm(np.cross(missing, up)) <= OFF
        moment = sum(np.cross(place - centre, force) for force, place in acting)
        assert np.abs(moment).max() <= 500.0 * OFF
        assert (abs(missing[2]) > 1.0) == (part == side)


def trailing_link(**changed: Any) -> dict[str, Any]:
    """A link of 400 mm, hinged ahead of the wheel, with a damper straight above its middle."""
    points = {
        "pivot": (-400.0, -700.0, 300.0),
        "pivot_end": (-400.0, -500.0, 300.0),
        "inner": (0.0, -600.0, 300.0),
        "centre": (0.0, -700.0, 300.0),
        "foot": (-200.0, -700.0, 300.0),
        "top": (-200.0, -700.0, 600.0),
    }
    return {
        "name": "trailing link",
        "bodies": {
            "chassis": ["pivot", "pivot_end", "top"],
            "link": ["pivot", "pivot_end", "inner", "centre", "foot"],
        },
        "inputs": {"turn": {"angle": "link", "from": "drawing", "on": "chassis"}},
        "roles": {"wheel_axis": ["inner", "centre"], "damper": ["top", "foot"], "knuckle": "link"},
        "points": points,
        "up": (0, 0, 1),
        "right": (0, 1, 0),
        "side": "left",
        "wheel_radius": 300.0,
        "loads": {"": {"force": [0.0, 0.0, 1000.0]}},
        **changed,
    }


@pytest.mark.parametrize(
    ("load", "tension"),
    [
        # Up at twice the damper's arm; rearward 300 mm below the pivot, which pulls the wheel up from below:
        # 300 N m about the pivot on an arm of 200 mm.
        ({"force": [0.0, 0.0, 1000.0]}, -2000.0),
        ({"force": [1000.0, 0.0, 0.0]}, -1500.0),
        ({"force": [0.0, 800.0, 0.0]}, 0.0),
        # About the line to the right what is behind goes down: it lengthens the damper.
        ({"force": [0.0, 0.0, 0.0], "moment": [0.0, 2e5, 0.0]}, 1000.0),
    ],
)
def test_a_damper_above_a_link_carries_what_the_lever_says(load: dict[str, Any], tension: float) -> None:
    found = solve(trailing_link(loads={"": load}), {"turn": 0.0}, loads=True)
    assert abs(found.rod_force["damper"][0] - tension) <= OFF
    assert found.joint_force == {}
    # As a part of a mechanism.
    words = {"chassis", "drawing", "angle", "from", "on", *trailing_link()["roles"]}

    def put(name: str) -> str:
        return name if name in words else f"left.{name}"

    tables = {key: renamed(trailing_link()[key], put) for key in ("bodies", "inputs", "roles", "points")}
    tables = {
        key: {("" if n == "chassis" else "left.") + n: v for n, v in of.items()} for key, of in tables.items()
    }
    part = trailing_link(**tables, sides={"left": "left"}, loads={"left": load})
    assert solve(part, {"left.turn": 0.0}, loads=True).rod_force == {"left.damper": found.rod_force["damper"]}


def test_forces_are_in_proportion_to_the_load_and_do_not_depend_on_the_unit_of_length() -> None:
    described, values = car("pushrod")
    once, twice, large = (
        solve(
            described
            | {
                "points": {name: scale * np.asarray(place) for name, place in described["points"].items()},
                "wheel_radius": scale * 300.0,
                "loads": {"": {"force": times * FORCE, "moment": scale * times * MOMENT}},
            },
            {n: v * (1.0 if "angle" in described["inputs"][n] else scale) for n, v in values.items()},
            loads=True,
        )
        for times, scale in ((1.0, 1.0), (2.0, 1.0), (1.0, 8.0))
    )
    for kind in ("rod_force", "joint_force", "hinge_thrust"):
        for name, force in getattr(once, kind).items():
            assert np.abs(getattr(twice, kind)[name] - 2.0 * force).max() <= 2 * OFF, name
            assert np.abs(getattr(large, kind)[name] - force).max() <= 2 * OFF, name


def test_a_damper_at_its_dead_point_has_no_force() -> None:
    # Its line goes through the hinge of the link.
    dead = trailing_link()
    dead["points"]["top"] = (-800.0, -700.0, 300.0)
    found = solve(dead, {"turn": 0.0}, loads=True)
    assert np.isnan(found.rod_force["damper"]).all()
    assert np.isfinite(found.position["centre"]).all()


def test_forces_are_given_only_where_they_are_asked_for() -> None:
    assert not solve(trailing_link(), {"turn": 0.0}).rod_force
    described, values = car("double wishbone")
    forces = solve(described, values, loads=True)
    with pytest.raises(ValueError, match="read-only"):
        forces.rod_force["tie_rod"][0] = 0.0


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"loads": {}}, r"^there are no loads: write \[mechanism.loads\]"),
        ({"loads": {"left": LOAD}}, "^the part of a load is 'left'"),
        ({"loads": {"": {}}}, "^force of load '' is None; three finite numbers"),
        ({"loads": {"": {"force": [0.0, 1.0, np.nan]}}}, "^force of load '' is .*three finite numbers"),
        ({"loads": {"": LOAD | {"moment": 5.0}}}, "^moment of load '' is .*three finite numbers"),
        ({"wheel_radius": None}, "^the load of the wheel needs wheel_radius"),
        ({"roles": {"damper": ["top", "foot"]}}, "^the load of the wheel needs the role 'knuckle'"),
        ({"roles": trailing_link()["roles"] | {"damper": ["centre", "foot"]}}, "keep their distance in"),
    ],
)
def test_what_a_load_lacks_is_said_in_one_line(changed: dict[str, Any], words: str) -> None:
    with pytest.raises(absolute.DescriptionError, match=words) as refused:
        solve(trailing_link(**changed), {"turn": 0.0}, loads=True)
    assert "\n" not in str(refused.value)


def test_rows_that_follow_from_each_other_are_named() -> None:
    bars = four_bar(roles={"wheel_axis": ["q1", "q2"], "knuckle": "coupler"}, wheel_radius=300.0)
    with pytest.raises(absolute.AbsoluteError, match=r"hold each body once; hinge of") as refused:
        solve(bars | {"loads": {"": LOAD}}, {"turn": 0.0}, loads=True)
    assert solve(bars, {"turn": 0.0}).position
    assert "\n" not in str(refused.value)
