"""Every shipped mechanism moves as closed forms and other people's printed tables say, by the reference.

A check asks the reference for poses at some inputs and returns how far their points are from where they
should be. It does not read the tables of a mechanism file, so it finds a fault in them.

One file describes a mechanism to all models, so one wrong file would be wrong for all of them: faults planted
in the tables of a file must be found. A faulty mechanism is refused, or its poses are far from right.
"""

from __future__ import annotations

import csv
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pytest
from changed_scenes import change
from many_digits import DIGITS, Array, Points, number, unit, vector
from mechanism_closed_forms import closed_form
from mechanism_files import (
    MECHANISMS,
    SCENES,
    Plain,
    Tables,
    exact_states,
    mechanism_file,
    plain,
    plain_scene,
    scene_file,
)
from mpmath import atan2, mp, mpf

from pointcoord import Scene
from pointcoord.mechanism.faults import TableFault
from validate.formulations.reference_solution import inputs_at
from validate.published.tables import FOLDER
from validate.reference import NoReferenceError

LINES = Path(__file__).with_name("faults.txt").read_text(encoding="utf-8").splitlines()
FAULTS = [line.split(" | ") for line in LINES if line[0] != "#"]
MIRROR = vector([1, -1, 1])
# Of a pose in 45 digits, mm: what a few hundred operations on lengths of a metre may lose is below 1e-40.
EXACT = 1e-35

Inputs = Mapping[str, Any]


@dataclass(frozen=True)
class Check:
    """Poses and what they should be.

    Attributes:
        scene: the shipped scene whose drawing it is.
        path: inputs of the poses, in the order in which they are reached.
        deviations: by quantity, how far the points of the poses are off; mm and rad.
        limits: by quantity, how far they may be, because of what the other side rounds.
    """

    scene: str
    path: Sequence[Inputs]
    deviations: Callable[[Sequence[Points]], Mapping[str, float]]
    limits: Mapping[str, float]

    def plain(self, change: Callable[[Tables, Tables], object] | None = None) -> Plain:
        """The mechanism; `change` may plant a fault in its tables or in the drawing."""
        part = scene_file(self.scene)["mechanism"]
        tables = mechanism_file(part["type"])
        if change:
            change(tables, part)
        return plain(tables, part, self.path[0])

    def deviations_of(self, mechanism: Plain) -> Mapping[str, float]:
        """Of the poses that the reference says it has."""
        states = exact_states(mechanism, [{n: (v, 0, 0) for n, v in one.items()} for one in self.path])
        return self.deviations([position for position, *_ in states])


def scene_inputs(scene: str, count: int) -> list[Inputs]:
    """What a scene drives at some of its samples, the first and the last among them, in many digits."""
    asked = Scene.load(scene)
    places = np.linspace(0, len(asked.instants) - 1, count).round().astype(int)
    with mp.workdps(DIGITS):
        return [
            {name: number(law[0]) for name, law in inputs_at(asked, asked.instants[k]).items()}
            for k in places
        ]


def right_form(scene: str, path: Sequence[Inputs]) -> list[Points]:
    """The poses of a scene's mechanism by its closed form, as the ground sees them."""
    part = scene_file(scene)["mechanism"]
    type = f"{part['type']} collinear" if part.get("closure") == "collinear" else part["type"]
    if any("." in name for name in path[0]):
        found = _axle(part, path)
    else:
        found = closed_form(type, part["points"], path, part.get("wheel_radius"))
    with mp.workdps(DIGITS):
        return [
            {name: _on_the_ground(part, place, inputs) for name, place in points.items()}
            for points, inputs in zip(found, path, strict=True)
        ]


def _on_the_ground(part: Tables, place: Array, inputs: Inputs) -> Array:
    """A place in the chassis where the shipped cars' chassis is rolled about forward, -x, and then lifted."""
    if "roll" in inputs:
        axis = vector(part["points"]["roll_axis"])
        c, s = mpmath.cos(inputs["roll"]), mpmath.sin(inputs["roll"])
        x, y, z = place - axis
        place = axis + np.array([x, c * y + s * z, c * z - s * y])
    return place + vector([0, 0, inputs.get("heave", 0)])


def _axle(part: Tables, path: Sequence[Inputs]) -> list[Points]:
    """Each corner alone; the left one is the right one's mirror image, and so are rack and roll."""
    corners = {}
    for corner, way in (("left", -1), ("right", 1)):
        with mp.workdps(DIGITS):
            own = [{n.removeprefix(f"{corner}."): v for n, v in i.items()} for i in path]
            inputs = [
                {n: way * v if n in ("rack", "roll") else v for n, v in one.items() if "." not in n}
                for one in own
            ]
        corners[corner] = closed_form("double_wishbone", part["points"], inputs, part.get("wheel_radius"))
    with mp.workdps(DIGITS):
        return [
            {f"left.{name}": place * MIRROR for name, place in left.items()}
            | {f"right.{name}": place for name, place in right.items()}
            for left, right in zip(corners["left"], corners["right"], strict=True)
        ]


def farthest(found: Sequence[Points], right: Sequence[Points]) -> float:
    """The largest component of a difference of points, mm."""
    with mp.workdps(DIGITS):
        return max(
            float(np.max(np.abs(a[name] - b[name])))
            for a, b in zip(found, right, strict=True)
            for name in b
            if name in a
        )


@cache
def check_of(scene: str) -> Check:
    """Five links have no closed form."""
    if scene_file(scene)["mechanism"]["type"] == "five_link":
        return five_link_table(scene)
    path = scene_inputs(scene, 3)
    right = right_form(scene, path)
    return Check(scene, path, lambda found: {"position": farthest(found, right)}, {"position": EXACT})


def five_link_table(scene: str) -> Check:
    """VDSim's table: its axes are ours after half a turn about z, and its solver ends below 1e-12 m."""
    with (FOLDER / "vdsim-five-link.csv").open(newline="") as file:
        rows = [[mpf(cell) for cell in row] for row in list(csv.reader(file))[1:]]
    # From the drawing down, and from there up.
    rows = [row for row in rows if row[0] <= 0][::-1] + [row for row in rows if row[0] > 0]
    static = scene_file(scene)["mechanism"]["points"]["wheel_centre"]
    limits = {"camber": 1e-14, "toe": 1e-14, "track": 1e-12}

    def deviations(found: Sequence[Points]) -> Mapping[str, float]:
        off = []
        for points, (_, camber, toe, track) in zip(found, rows, strict=True):
            n, centre = unit(points["wheel_centre"] - points["wheel_axis_inner"]), points["wheel_centre"]
            here = (atan2(-n[2], -n[1]), atan2(-n[0], -n[1]), -(centre[1] - static[1]))
            off.append([abs(float(a - b)) for a, b in zip(here, (camber, toe, track * 1000), strict=True)])
        return dict(zip(limits, np.max(off, axis=0), strict=True))

    with mp.workdps(DIGITS):
        return Check(scene, [{"wheel_travel": row[0] * 1000} for row in rows], deviations, limits)


def type_of(scene: str) -> str:
    return str(scene_file(scene)["mechanism"]["type"])


def test_every_mechanism_has_a_scene_and_planted_faults() -> None:
    assert {*map(type_of, SCENES)} == {mechanism for mechanism, *_ in FAULTS} == {*MECHANISMS}


@pytest.mark.parametrize("scene", SCENES)
def test_a_scene_is_read_as_its_tables_say(scene: str) -> None:
    """What is compared with closed forms below is what a scene's models are given."""
    asked = Scene.load(scene)
    read, tables = asked.mechanism.plain(tuple(asked.inputs)), plain_scene(scene)
    assert {name: [*map(float, place)] for name, place in tables.pop("points").items()} == read.pop("points")
    assert {**read, "name": ""} == {**tables, "name": ""}


@pytest.mark.parametrize("scene", SCENES)
def test_the_poses_of_a_scene_are_those_of_its_closed_form_or_printed_table(scene: str) -> None:
    check = check_of(scene)
    found = check.deviations_of(check.plain())
    assert all(found[name] <= limit for name, limit in check.limits.items()), found


@pytest.mark.parametrize(("mechanism", "what", "changes", "scene", "notice"), FAULTS)
def test_a_fault_in_a_mechanism_file_is_found(
    mechanism: str, what: str, changes: str, scene: str, notice: str
) -> None:
    check = check_of(scene)
    assert type_of(scene) == mechanism

    def plant(tables: Tables, drawing: Tables) -> None:
        change({**tables, "drawing": drawing}, changes)

    quantity, _, least = notice.rpartition(" ")
    if quantity in check.limits:
        found = check.deviations_of(check.plain(plant))
        assert found[quantity] > max(float(least), 10 * check.limits[quantity])
    else:
        with pytest.raises((TableFault, NoReferenceError), match=notice):
            check.deviations_of(check.plain(plant))


def test_a_rod_that_is_written_twice_changes_nothing() -> None:
    check = check_of("hmmwv-front")
    twice = check.plain(lambda tables, _: tables["rods"].update(twice=tables["rods"]["tie_rod"][:]))
    assert check.deviations_of(twice)["position"] <= check.limits["position"]


def andrews_angles(inputs: Sequence[Any], order: int) -> Array:
    """The seven angles of the benchmark, or their first or second derivatives; the second ones at rest."""
    (states,) = exact_states(plain_scene("andrews-squeezer"), [{"crank": inputs}])
    p, moved = states[0], states[order]

    def turning(first: str, second: str) -> Any:
        arm, pull = p[second] - p[first], moved[second] - moved[first]
        return np.cross(arm, pull)[2] / (arm @ arm) if order else atan2(arm[1], arm[0])

    beta, gamma, delta, epsilon = (turning(*ends) for ends in ("OF", "BE", "AG", "AH"))
    theta, phi, omega = (turning(*ends) for ends in ("EF", "GE", "HE"))
    found = np.array([beta, theta - beta, gamma, phi - delta, delta, omega - epsilon, epsilon])
    # Three of them are counted from a line across.
    return found if order else found + mp.pi / 2 * np.array([0, 0, 1, 1, 0, -1, 1])


@pytest.mark.parametrize(
    ("name", "order", "within"),
    [
        # The drawing is rounded to doubles, and the end is printed to 16 digits of 15.8 rad.
        ("q0", 0, 1e-15),
        ("q_t003", 0, 1e-14),
        # 1e-16 of the rates, a hundred times amplified at most.
        ("a0", 2, 1e-14 * 14222),
        # The printed velocities meet their own constraints to 2e-8 of the largest and no better.
        ("v_t003", 1, 2e-8 * 1139),
    ],
)
def test_andrews_squeezer_starts_and_ends_as_printed(name: str, order: int, within: float) -> None:
    data = json.loads(Path(__file__).with_name("andrews_squeezer.json").read_text(encoding="utf-8"))
    with mp.workdps(DIGITS):
        printed, way = vector(data[name]), mpf(data["q_t003"][0]) - mpf(data["q0"][0])
        inputs = (0 if name.endswith("0") else way, printed[0] if order == 1 else 0, printed[0])
        off = andrews_angles(inputs, order) - printed
        if not order:
            off = [a - 2 * mp.pi * mpmath.nint(a / (2 * mp.pi)) for a in off]
    assert max(abs(float(a)) for a in off) <= within


def test_parallel_cranks_stay_parallel_a_thousandth_of_a_radian_before_they_lie_in_line() -> None:
    path = [{"crank": mpf(angle)} for angle in ("-0.8", "-1.5697")]
    states = exact_states(plain_scene("n-four-bar"), [{"crank": (one["crank"], 0, 0)} for one in path])
    assert farthest([position for position, *_ in states], right_form("n-four-bar", path)) <= EXACT
