"""Forces of loads at the wheels, by all three mechanics: every body of every shipped suspension balances."""

from __future__ import annotations

from collections import defaultdict
from itertools import combinations

import numpy as np
import pytest
from changed_scenes import scene_with
from three_mechanics import by_each, solved_by

from pointcoord import Scene
from pointcoord.numerics.arrays import Array
from validate.comparison.compare import compare
from validate.formulations.protocol import Solution

RADIUS = 310.0
FORCE, MOMENT = [300.0, -700.0, 4000.0], [20000.0, -5000.0, 90000.0]
LOAD = {"force": FORCE, "moment": MOMENT}
# One of each suspension; where no damper holds the wheel, an input of its height does.
CARS = (
    *("bmw-e90-strut", "hmmwv-front", "pushrod", "pushrod-by-damper", "five-link"),
    *("semi-trailing-arm", "axle-steer"),
)
UP = np.array([0.0, 0.0, 1.0])
QUANTITIES = ("rod_force", "joint_force", "hinge_thrust")


def loaded(name: str) -> Scene:
    """A shipped car with loads at its wheels, at two instants."""
    roles = Scene.load(name).mechanism.topology.roles
    wheels = [role.removesuffix("wheel_axis") for role in roles if role.endswith("wheel_axis")]
    loads = {wheel.removesuffix("."): LOAD for wheel in wheels}
    return scene_with(name, {"wheel_radius": RADIUS, "loads": loads}, samples=2, effects=["loads"])


class Balance:
    """The sum of forces and moments on every body at one instant; a point of no body is one by itself."""

    def __init__(self, scene: Scene, solution: Solution, instant: int) -> None:
        self.plain = scene.mechanism.plain(tuple(scene.inputs))
        self.places = {name: place[instant] for name, place in solution.position.items()}
        self.sums: dict[str, Array] = defaultdict(lambda: np.zeros(6))

    def bodies_of(self, point: str) -> list[str]:
        return [body for body, points in self.plain["bodies"].items() if point in points] or [point]

    def add(self, body: str, point: str, force: Array) -> None:
        """A force on a body at a point."""
        self.sums[body] += [*force, *np.cross(self.places[point], force)]

    def pull(self, ends: list[str], tension: float) -> None:
        """What stretches between two points."""
        a, b = (self.places[end] for end in ends)
        way = (b - a) / np.linalg.norm(b - a)
        for end, sign in zip(ends, (1.0, -1.0), strict=True):
            (body,) = self.bodies_of(end)
            self.add(body, end, sign * tension * way)

    def press(self, wheel: str) -> Array:
        """The load of a wheel; returns the wrench of a force upwards at its centre."""
        roles = self.plain["roles"]
        inner, centre = (self.places[name] for name in roles[f"{wheel}wheel_axis"])
        axis = (centre - inner) / np.linalg.norm(centre - inner)
        down = axis * (axis @ UP) - UP
        contact = centre + RADIUS * down / np.linalg.norm(down)
        self.sums[roles[f"{wheel}knuckle"]] += [*FORCE, *(np.cross(contact, FORCE) + MOMENT)]
        return np.array([*UP, *np.cross(centre, UP)])


@by_each
@pytest.mark.parametrize("name", CARS)
def test_every_body_of_a_loaded_car_balances(who: str, name: str) -> None:
    """The reported forces of rods, dampers, joints, hinges and slides leave nothing over."""
    scene = loaded(name)
    solution = solved_by(who, scene)
    rods, joints, thrusts = (solution.numbers[quantity] for quantity in QUANTITIES)
    claims = [claim for quantity in QUANTITIES for claim in solution.accuracy.claims[quantity].values()]
    assert max(map(np.max, claims)) <= 1e-6
    for k in range(2):
        sums = Balance(scene, solution, k)
        plain, used = sums.plain, set[str]()
        wheels = [role.removesuffix("knuckle") for role in plain["roles"] if role.endswith("knuckle")]
        for rod, ends in plain["rods"].items():
            sums.pull(ends, rods[rod][k])
        # The body on which a joint's force is reported comes first: the knuckle, or the one named first.
        knuckles = [plain["roles"][f"{wheel}knuckle"] for wheel in wheels]
        moving = [*knuckles, *(body for body in plain["bodies"] if body not in (*knuckles, "chassis"))]
        for on, by in combinations([*moving, "chassis"], 2):
            shared = [point for point in plain["bodies"][on] if point in plain["bodies"][by]]
            for point in shared:
                force = joints[point][k].copy()
                if len(shared) == 2 and point == shared[0]:
                    line = sums.places[shared[1]] - sums.places[point]
                    force += thrusts[point][k] * line / np.linalg.norm(line)
                sums.add(on, point, force)
                sums.add(by, point, -force)
            used |= {*shared}
        for slide in plain["slides"].values():
            for point in {*(slide.get("points") or [slide["point"]])} & {*joints}:
                (own,) = sums.bodies_of(point)
                on, by = (slide["body"], own) if own == "chassis" else (own, slide["body"])
                sums.add(on, point, joints[point][k])
                sums.add(by, point, -joints[point][k])
                used.add(point)
        for wheel in wheels:
            upwards, ends = sums.press(wheel), plain["roles"].get(f"{wheel}damper")
            if ends:
                sums.pull(ends, rods[f"{wheel}damper"][k])
            else:  # the input holds the wheel's centre at its height
                left = sums.sums[plain["roles"][f"{wheel}knuckle"]]
                left -= upwards * left[2]
        assert used == {*joints}
        del sums.sums["chassis"]
        for body, left in sums.sums.items():
            # Forces of some 10 kN, rounded some ten times, at coordinates of up to 3 m.
            assert np.abs(left[:3]).max() <= 1e-8, (body, left)
            assert np.abs(left[3:]).max() <= 1e-5, (body, left)


def test_forces_of_one_pose_in_which_nothing_moves_are_compared() -> None:
    held = {name: {"constant": 0.0} for name in ("wheel_travel", "rack")}
    time = {"start": 0.0, "stop": 0.0, "samples": 1}
    scene = scene_with("pushrod", {"loads": {"": LOAD}}, inputs=held, effects=["loads"], time=time)
    outcome = compare(scene, "pointcoord", "absolute")
    verdicts = [row.verdict for row in outcome.rows if row.unit == "N"]
    assert len(verdicts) >= 10
    assert set(verdicts) == {"agrees"}
