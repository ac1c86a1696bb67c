"""Wheels of an axle: each as if it were alone, and what both need."""

from typing import Any

import numpy as np
import pytest
from mechanism_files import plain_scene
from shipped import EPS, Motion, off

import absolute

RADIUS, WHEELBASE = 300.0, 2600.0
# Points are rounded at 1000 mm; lines that meet within 3 m are fixed by points 400 mm apart.
OFF = 64 * EPS * 1000.0 * (3000.0 / 400.0) ** 2
# Hinges along x in the front view, and wheels of different heights.
HINGES = {"left": (-150.0, 220.0), "right": (180.0, 160.0)}
CENTRES = {"left": (-750.0, 300.0), "right": (760.0, 310.0)}


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
