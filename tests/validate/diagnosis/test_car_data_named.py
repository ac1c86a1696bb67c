"""Numbers of a car that were made with other data than the scene's: named with what was taken."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from pointcoord import Scene, simulate
from validate import check

Numbers = dict[str, dict[str, NDArray[np.float64]]]

FORCES = ("rod_force", "joint_force", "hinge_thrust")
EFFECTS = ("camber", "wheel_travel", "steering_axis", "anti_features", "spring")
CAR = {
    "axle": "front",
    "wheelbase": 2500.0,
    "centre_of_gravity_height": 500.0,
    "brake_share": 0.6,
    "drive_share": 0.0,
    "spring_rate": 30.0,
    "spring_free_length": 300.0,
}


@dataclass(frozen=True)
class Given:
    """A solver that has these numbers."""

    numbers: Numbers

    def solve(self, given: Any) -> Numbers:
        return self.numbers


def car(force: tuple[float, ...] = (100.0, -3000.0, 4000.0), loaded: bool = True, **other: float) -> Scene:
    """A wheel with pushrod and spring over its travel; of one car, or of one that is otherwise."""
    effects = [*EFFECTS, *(["loads"] if loaded else [])]
    content = Scene.load("wheel-travel").model_dump(exclude_none=True) | {"effects": effects}
    content["time"]["samples"] = 5
    content["mechanism"]["wheel_radius"] = other.pop("wheel_radius", 270.0)
    content["mechanism"]["car"] = CAR | other
    content["mechanism"]["loads"] = {"force": list(force)}
    return Scene.from_mapping(content, "car")


def numbers_of(scene: Scene) -> Numbers:
    return {quantity: dict(part) for quantity, part in simulate(scene).numbers.items()}


def named(numbers: Numbers) -> list[str]:
    """What explains numbers beside those of the car."""
    outcome = check(Given(numbers), car(loaded=FORCES[0] in numbers), accuracy=1e-6)
    assert outcome.disagreements
    return [one.words for one in outcome.explanations]


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("wheel_radius", 282.5, "wheel_radius is 282.5 mm, not 270"),
        ("spring_rate", 28.0, "spring_force, wheel_force, wheel_rate: spring_rate is 28 N/mm, not 30"),
        ("centre_of_gravity_height", 520.0, "anti_brake: centre_of_gravity_height is 520 mm, not 500"),
    ],
)
def test_another_number_of_the_car_is_named_and_nothing_else(name: str, value: float, said: str) -> None:
    (words,) = named(numbers_of(car(loaded=name == "wheel_radius", **{name: value})))
    assert said in words


def test_what_two_numbers_explain_as_well_is_said_of_both() -> None:
    # Of the braking force and the wheelbase only their product is in it.
    first, second = named(numbers_of(car(loaded=False, brake_share=0.66)))
    assert first == "anti_brake: wheelbase is 2750 mm, not 2500"
    assert second == "anti_brake: brake_share is 0.66, not 0.6"


def test_the_wheel_centre_taken_for_the_contact_point_is_said() -> None:
    numbers = numbers_of(car())
    for forces in FORCES:
        numbers[forces] = numbers_of(car(wheel_radius=1e-9))[forces]
    sideways = numbers["position"]["wheel_centre"][:, 1] - car().mechanism.points["wheel_centre"][1]
    dimensions = numbers["dimension"]
    dimensions |= {"contact_travel": dimensions["travel"], "half_track_change": sideways}
    (words,) = named(numbers)
    assert {"contact_travel", "half_track_change", "tie_rod", "damper"} <= {*words.split(", ")}
    assert words.endswith(": the wheel centre is taken for the contact point")


def test_another_load_is_named_by_all_forces() -> None:
    said, force = "force.y of the load is -2500 N, not -3000", (100.0, -2500.0, 4000.0)
    numbers = numbers_of(car()) | {q: numbers_of(car(force))[q] for q in FORCES}
    (words,) = named(numbers)
    assert words.endswith(said)
    assert {"tie_rod", "damper", "force at the joint"} <= {*words.partition(":")[0].split(", ")}


def test_a_force_that_is_off_by_itself_is_no_other_load() -> None:
    # A moment about some axis makes nearly such an offset, and of the joints' forces something else.
    numbers = numbers_of(car())
    numbers["rod_force"] |= {
        name: numbers["rod_force"][name] + 0.5 for name in ("tie_rod", "pushrod", "damper")
    }
    assert not [words for words in named(numbers) if "load" in words]


def test_forces_in_another_unit_are_told() -> None:
    numbers = numbers_of(car())
    numbers["rod_force"] = {name: force / 4.4482216152605 for name, force in numbers["rod_force"].items()}
    assert named(numbers) == ["tie_rod, pushrod, damper: pounds for N"]
