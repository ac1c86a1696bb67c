"""Wheels of an axle: each as if it were alone, and what both make together."""

from typing import Any

import numpy as np
import pytest
from mechanism_files import plain_scene
from shipped import EPS, Array, Motion, off

import absolute

RADIUS, WHEELBASE = 300.0, 2600.0
# Points are rounded at 1000 mm; lines that meet within 3 m are fixed by points 400 mm apart.
OFF = 64 * EPS * 1000.0 * (3000.0 / 400.0) ** 2
# Hinges along x in the front view, and wheels of different heights.
HINGES = {"left": (-150.0, 220.0), "right": (180.0, 160.0)}
CENTRES = {"left": (-750.0, 300.0), "right": (760.0, 310.0)}
ROLL_CENTRE = ["axle_roll_centre_offset", "axle_roll_centre_height"]


def swing_axle(upright: bool = False, **changed: Any) -> dict[str, Any]:
    """Two wheels on a hinge each: along x, or upright through the wheel centre, about which they steer."""
    points: dict[str, Any] = {}
    for part, (y, z) in CENTRES.items():
        out = np.sign(y)
        hinge = (0.0, y, z) if upright else (0.0, *HINGES[part])
        end = np.add(hinge, (0.0, 0.0, 100.0) if upright else (100.0, 0.0, 0.0))
        ends = {"pivot": hinge, "pivot_end": end, "inner": (0.0, y - 100.0 * out, z), "centre": (0.0, y, z)}
        points |= {f"{part}.{name}": place for name, place in ends.items()}
    parts = tuple(CENTRES)
    return {
        "name": "swing axle",
        "bodies": {"chassis": [f"{part}.{end}" for part in parts for end in ("pivot", "pivot_end")]}
        | {
            f"{p}.knuckle": [
                f"{p}.{n}" for n in ("pivot", "pivot_end", "inner", "centre") if f"{p}.{n}" in points
            ]
            for p in parts
        },
        "inputs": {
            f"{part}.turn": {"angle": f"{part}.knuckle", "from": "drawing", "on": "chassis"} for part in parts
        }
        | {"roll": {"turns": "chassis", "about": "left.pivot", "along": "forward"}},
        "roles": {f"{part}.wheel_axis": [f"{part}.inner", f"{part}.centre"] for part in parts}
        | {f"{part}.knuckle": f"{part}.knuckle" for part in parts},
        "points": points,
        "up": (0, 0, 1),
        "right": (0, 1, 0),
        "sides": {part: part for part in parts},
        "wheel_radius": RADIUS,
        "car": {"wheelbase": WHEELBASE},
        **changed,
    }


def solved(described: dict[str, Any], names: Any, **values: float) -> dict[str, float]:
    inputs = {name: np.array([[value, 0.0, 0.0]]) for name, value in values.items()}
    found = Motion(described, inputs).solve(rates=False, effects=names).effects
    return {name: float(number[0]) for name, number in found.items()}


def turns(left: float, right: float, **more: float) -> dict[str, float]:
    return {"left.turn": left, "right.turn": right, **more}


def alone(described: dict[str, Any], part: str) -> dict[str, Any]:
    """A part of a mechanism by itself."""

    def own(entry: Any) -> Any:
        if isinstance(entry, dict):
            return {own(name): own(of) for name, of in entry.items() if f"{part}." in name or "." not in name}
        if isinstance(entry, list | tuple):
            return [own(of) for of in entry if not isinstance(of, str) or f"{part}." in of]
        return entry.removeprefix(f"{part}.") if isinstance(entry, str) else entry

    of = {
        key: own(described.get(key, {})) for key in ("bodies", "rods", "slides", "inputs", "roles", "points")
    }
    return {**described, **of, "sides": {}, "side": described["sides"][part]}


@pytest.mark.parametrize("part", ["left", "right"])
def test_every_number_of_a_wheel_is_that_of_its_part_alone(part: str) -> None:
    car = {
        "axle": "front",
        "wheelbase": WHEELBASE,
        "centre_of_gravity_height": 500.0,
        "brake_share": 0.6,
        "drive_share": 0.4,
    }
    described = plain_scene("axle-steer") | {"sides": {"left": "left", "right": "right"}, "car": car}
    described["wheel_radius"] = RADIUS
    values = {"left.wheel_travel": 20.0, "right.wheel_travel": -10.0, "rack": 12.0}
    single = alone(described, part)
    of_springs = ("spring_force", "wheel_force", "wheel_rate")
    names = [name for name in absolute.EFFECTS if "damper" not in name and name not in of_springs]
    here = solved(described, [f"{part}.{name}" for name in names], **values)
    there = solved(single, names, wheel_travel=values[f"{part}.wheel_travel"], rack=values["rack"])
    for name in names:
        # Instant centres are up to 10 m away, and their distances as far off as its square.
        times = 1e4 if "_view_" in name or "anti" in name else 1.0
        assert abs(here[f"{part}.{name}"] - there[name]) <= times * OFF, name


@pytest.mark.parametrize(("left", "right"), [(0.0, 0.0), (0.1, 0.0), (-0.05, 0.12)])
def test_the_roll_centre_is_where_the_lines_from_contact_points_to_hinges_meet(
    left: float, right: float
) -> None:
    found = solved(swing_axle(), [*ROLL_CENTRE, "track"], **turns(left, right))
    # About x the turn leads from y to z; a disc hangs along the wheel plane.
    contacts, hinges = [], []
    for part, turn in (("left", left), ("right", right)):
        hinge, centre = np.array(HINGES[part]), np.array(CENTRES[part])
        turned = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
        contacts.append(hinge + turned @ (centre - [0.0, RADIUS] - hinge))
        hinges.append(hinge)
    ways = np.array([h - c for h, c in zip(hinges, contacts, strict=True)])
    shares = np.linalg.solve(np.array([ways[0], -ways[1]]).T, contacts[1] - contacts[0])
    y, z = contacts[0] + shares[0] * ways[0]
    ground = np.interp(y, *np.transpose(contacts)) if contacts[0][0] < y < contacts[1][0] else np.nan
    assert abs(found["axle_roll_centre_offset"] - y) <= OFF
    assert abs(found["axle_roll_centre_height"] - (z - ground)) <= OFF
    assert abs(found["track"] - (contacts[1] - contacts[0])[0]) <= OFF


def test_a_car_that_rolls_has_its_roll_centre_where_the_turned_lines_meet() -> None:
    # The whole picture turns about the pivot, but discs hang along the car's up and not along their plane.
    thin = {"wheel_radius": 1e-6}
    still, rolled = (
        solved(swing_axle(**thin), ROLL_CENTRE, **turns(0.1, -0.1, roll=roll)) for roll in (0.0, 0.05)
    )
    pivot, (y, above) = np.array(HINGES["left"]), still.values()
    centres = {}
    for part, turn in (("left", 0.1), ("right", -0.1)):
        arm = np.subtract(CENTRES[part], HINGES[part])
        c, s = np.cos(turn), np.sin(turn)
        centres[part] = np.add(HINGES[part], [c * arm[0] - s * arm[1], s * arm[0] + c * arm[1]])

    def height(y: float, places: dict[str, Array]) -> float:
        left, right = places["left"], places["right"]
        return float(left[1] + (y - left[0]) * (right[1] - left[1]) / (right[0] - left[0]))

    # Forward is minus x, about which z turns to y.
    c, s = np.cos(0.05), np.sin(0.05)

    def turned(place: Any) -> Array:
        a, b = np.subtract(place, pivot)
        return np.add(pivot, [c * a + s * b, c * b - s * a])

    p = turned((y, above + height(y, centres)))
    wanted = p[1] - height(p[0], {part: turned(place) for part, place in centres.items()})
    # A disc of 1e-6 mm moves its lowest point by as much, which is seen 30 times as far.
    assert abs(rolled["axle_roll_centre_offset"] - p[0]) <= OFF + 3e-5
    assert abs(rolled["axle_roll_centre_height"] - wanted) <= OFF + 3e-5


def test_parallel_lines_and_a_wheel_that_stands_have_no_roll_centre() -> None:
    # A hinge as high as the contact point makes its line level; one in the contact point makes no line.
    points = swing_axle()["points"]
    for heights in ({"left": 0.0, "right": 10.0}, {}):
        moved = dict(points)
        for part, height in heights.items():
            for end in ("pivot", "pivot_end"):
                moved[f"{part}.{end}"] = (*np.array(points[f"{part}.{end}"])[:2], height)
        if not heights:
            moved["left.pivot"], moved["left.pivot_end"] = (0.0, -750.0, 0.0), (100.0, -750.0, 0.0)
        found = solved(swing_axle(points=moved), [*ROLL_CENTRE, "track"], **turns(0.0, 0.0))
        assert np.isnan([found[name] for name in ROLL_CENTRE]).all()
        assert found["track"] == 1510.0


@pytest.mark.parametrize(("left", "right"), [(0.3, 0.25), (0.2, 0.2), (-0.4, -0.5), (1.2, 0.6)])
def test_steering_numbers_are_those_of_angles_that_are_driven(left: float, right: float) -> None:
    """Up is the line of the hinges, about which forward turns to the left."""
    names = ["left.steer_angle", "right.steer_angle", "turning_radius", "ackermann", "ackermann_error"]
    found = solved(swing_axle(upright=True), names, **turns(left, right))
    # To the left the left wheel is the inner one.
    track, (inner, outer) = 1510.0, (left, right) if left > 0.0 else (-right, -left)
    radius = WHEELBASE * (1 / np.tan(inner) + 1 / np.tan(outer)) / 2
    ideal = np.arctan(WHEELBASE / (radius - track / 2)) - np.arctan(WHEELBASE / (radius + track / 2))
    error = outer - (np.pi / 2 - np.arctan(1 / np.tan(inner) + track / WHEELBASE))
    wanted = [left, right, radius, 100 * (inner - outer) / ideal, error]
    for name, value in zip(names, wanted, strict=True):
        # Radii of 20 m of angles of 0.2.
        assert abs(found[name] - value) <= 64 * EPS * 20e3, name


def test_wheels_on_circles_about_one_point_have_an_ackermann_of_a_hundred() -> None:
    # The middle of the turn is 5 m to the left of the middle of the rear axle.
    inner, outer = np.arctan(WHEELBASE / (5000.0 - 755.0)), np.arctan(WHEELBASE / (5000.0 + 755.0))
    names = ["turning_radius", "ackermann", "ackermann_error"]
    for one, other in ((inner, outer), (-outer, -inner)):
        found = solved(swing_axle(upright=True), names, **turns(one, other))
        assert found["turning_radius"] == pytest.approx(5000.0, abs=1e-9)
        assert found["ackermann"] == pytest.approx(100.0, abs=1e-9)
        assert found["ackermann_error"] == pytest.approx(0.0, abs=1e-13)
    for one, other in ((0.1, -0.1), (0.0, 0.2), (0.0, 0.0)):
        assert np.isnan(list(solved(swing_axle(upright=True), names, **turns(one, other)).values())).all()


def test_names_are_those_of_the_parts_and_others_are_refused() -> None:
    names = absolute.effect_names(absolute.compile(swing_axle()))
    parts = {f"{part}.{name}" for part in CENTRES for name in absolute.EFFECTS}
    assert set(names) == parts | set(absolute.AXLE_EFFECTS)
    single = alone(swing_axle(), "left")
    assert absolute.effect_names(absolute.compile(single)) == tuple(absolute.EFFECTS)
    with pytest.raises(absolute.InputError, match=r"no effect 'camber'.*'left.camber'"):
        solved(swing_axle(), ["camber"], **turns(0.0, 0.0))
    with pytest.raises(absolute.DescriptionError, match=r"'track' needs .* exactly two parts.* has none"):
        solved(single, ["track"], turn=0.0)
    both = swing_axle(sides={"left": "left", "right": "left"})
    with pytest.raises(
        absolute.DescriptionError, match=r"'track' needs .* on opposite sides.* 'right': 'left'"
    ):
        solved(both, ["track"], **turns(0.0, 0.0))
    with pytest.raises(absolute.DescriptionError, match="'ackermann' needs wheelbase"):
        solved(swing_axle(car={}), ["ackermann"], **turns(0.0, 0.0))
    with pytest.raises(
        absolute.DescriptionError, match=r"'left.toe_by_rack' needs exactly one.* are 0: \[\] of"
    ):
        solved(swing_axle(), ["left.toe_by_rack"], **turns(0.0, 0.0))


def test_of_two_parts_on_one_slide_each_has_its_derivatives() -> None:
    described = plain_scene("axle-steer") | {"sides": {"left": "left", "right": "right"}}
    names = ["left.steer_angle_by_rack", "right.steer_angle_by_rack", "right.toe_by_travel"]
    inputs = {name: np.zeros((1, 3)) for name in ("left.wheel_travel", "right.wheel_travel", "rack")}
    solution = Motion(described, inputs).solve(conditions=True, effects=names)
    left, right, _ = (float(solution.effects[name][0]) for name in names)
    # The drawing is symmetrical: so are the wheels' turns to the left.
    assert abs(left - right) <= off(solution)[0] / 10.0
    assert abs(left) > 1e-3


@pytest.mark.parametrize(
    ("upright", "angles", "names"),
    [
        (False, turns(0.11, 0.07), ["track", "axle_roll_centre_height"]),
        (True, turns(0.3, 0.25), ["ackermann"]),
    ],
)
def test_what_both_wheels_make_costs_no_digit_far_from_the_origin(
    upright: bool, angles: dict[str, float], names: list[str]
) -> None:
    """Drawn 2^30 mm out to the right, where a place is rounded by 2^-23 mm; integers are not."""
    points = swing_axle(upright)["points"]
    far = {name: np.add(place, (0.0, 2.0**30, 0.0)) for name, place in points.items()}
    near, there = (solved(swing_axle(upright, points=drawn), names, **angles) for drawn in (points, far))
    for name in names:
        assert abs(near[name] - there[name]) < OFF, name
