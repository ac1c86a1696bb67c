"""A mechanism has no place, attitude, size, side or sense of time: its numbers change with these alone.

Every shipped mechanism is tried by all three mechanics, with every number that it has. Coordinates and laws
are multiples of 1/1024, so that no change of them rounds one.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from every_number import with_everything
from mechanism_files import plain_scene
from three_mechanics import MECHANICS, solved_by

from pointcoord import Scene
from pointcoord.drawing_stands import drawn_inputs
from pointcoord.effects.corner import LENGTHS
from pointcoord.effects.registry import QUANTITIES
from pointcoord.numerics.arrays import Array
from validate.formulations.asked_numbers import per_second
from validate.formulations.protocol import Solution

Content = dict[str, Any]

# One of each mechanism and closure; Bricard's depends on exact lengths that only its own drawing has.
SCENES = (
    "bounce",
    "off-axis-strut",
    "pushrod-by-damper",
    "five-link",
    "semi-trailing-arm",
    "axle-roll",
    "spatial-four-bar",
    "slider-crank",
    "n-four-bar",
    "andrews-squeezer",
)
# Two of the three mechanics, in turn.
PAIRS = [(name, who) for i, name in enumerate(SCENES) for k, who in enumerate(MECHANICS) if (i + k) % 3]
# It is its own drawing only where nothing is rounded.
RINGS = [("bricard", who) for who in MECHANICS]
MOTION = ("velocity", "acceleration", "knuckle_rates", "wheel_angles")
SIDES = {"left": "right", "right": "left"}
# The power of a length in a number of such a unit, where loads grow with the square of the size.
POWERS = {"mm": 1, "rad": 0, "rad/mm": -1, "mm/mm": 0, "rad/rad": 0, "mm/rad": 1, "N": 1, "N/mm": 0, "%": 0}
# What counts to the left or the right, or as a screw, is the other way round in a mirror.
ODD = ("steer_angle", "screw_pitch", "axle_roll_centre_offset")


@dataclass(frozen=True)
class Change:
    """What is done to a car.

    Attributes:
        turn, shift: places p become scale (turn p + shift), with the car's own axes turned too.
        mirrored: `turn` is one of a mirror image: left and right are exchanged as well.
        backwards: its inputs run from their end to their start.
    """

    turn: tuple[tuple[int, ...], ...] = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
    shift: tuple[float, float, float] = (0.0, 0.0, 0.0)
    scale: float = 1.0
    mirrored: bool = False
    backwards: bool = False

    @property
    def matrix(self) -> Array:
        """Of vectors, without the scale; its determinant is the sense of turns."""
        return np.array(self.turn, float)

    @property
    def sense(self) -> float:
        return float(round(np.linalg.det(self.matrix)))

    def name(self, name: str) -> str:
        """That of the other side, in a mirror."""
        side, dot, own = name.partition(".")
        return f"{SIDES[side]}.{own}" if self.mirrored and dot and side in SIDES else name

    def number(self, quantity: str, name: str, value: Array) -> Array:
        """What a number of the car becomes, at the same place of the path."""
        of, unit = QUANTITIES[quantity].of, QUANTITIES[quantity].unit
        rates = per_second(quantity)
        sign = (-1.0) ** rates if self.backwards else 1.0
        if self.mirrored:
            own = name.rpartition(".")[2]
            sign *= -1.0 if own.startswith(ODD) else 1.0
            sign *= -1.0 if own.endswith(("_by_rack", "_by_roll")) else 1.0
        factor = self.scale ** POWERS[unit.partition("/s")[0]]
        moved = value[::-1] if self.backwards else value
        if of == "car":
            return np.asarray(sign * factor * moved)
        moved = moved @ self.matrix.T * (self.sense if of == "body" else 1.0)
        place = np.array(self.shift) if quantity == "position" else 0.0
        return np.asarray(factor * (sign * moved + place))

    def content(self, content: Content) -> Content:
        """Of the scene of the changed car."""
        part, matrix, scale = content["mechanism"], self.matrix, self.scale
        changed = {
            self.name(n): (scale * (matrix @ p + self.shift)).tolist() for n, p in part["points"].items()
        }
        right = matrix @ part["right"] * (-1.0 if self.mirrored else 1.0)
        axes = {"up": (matrix @ part["up"]).tolist(), "right": right.tolist()}
        mechanism = {**part, "points": changed, **axes}
        if self.mirrored and "left.wheel_centre" not in changed:  # parts have their own sides
            mechanism["side"] = SIDES[part["side"]]
        if "wheel_radius" in part:
            mechanism["wheel_radius"] = scale * part["wheel_radius"]
        if "car" in part:
            mechanism["car"] = {n: scale * v if n in LENGTHS else v for n, v in part["car"].items()}
        if "rack_per_turn" in part:
            mechanism["rack_per_turn"] = scale * part["rack_per_turn"]
        mechanism["loads"] = {
            SIDES.get(wheel, wheel) if self.mirrored else wheel: {
                "force": (scale * (matrix @ load["force"])).tolist(),
                "moment": (scale**2 * self.sense * (matrix @ load["moment"])).tolist(),
            }
            for wheel, load in part["loads"].items()
        }
        inputs = {
            self.name(name): {"polynomial": self._law(content["kinds"][name], law["polynomial"])}
            for name, law in content["inputs"].items()
        }
        return {**content, "mechanism": mechanism, "inputs": inputs}

    def _law(self, kind: tuple[int, int], law: list[float]) -> list[float]:
        """Coefficients of an input, of which the power of a length and the sign in a mirror are known."""
        power, odd = kind
        factor = self.scale**power * (odd if self.mirrored else 1)
        start, speed, bend = law
        there = [start + speed + bend, -speed - 2.0 * bend, bend] if self.backwards else law
        return [factor * c for c in there]


# Its mirror image, a third of a turn about the space diagonal, a way along the car's middle plane, where the
# origin stays, another size and the other sense of time.
UNCHANGED = Change()
CHANGE = Change(
    ((0, -1, 0), (0, 0, 1), (1, 0, 0)), (0.0, 512.0, -256.0), scale=3.0, mirrored=True, backwards=True
)


def kind_of_input(plain: Content, name: str) -> tuple[int, int]:
    """The power of a length in an input, and its sign in a mirror."""
    drive = plain["inputs"][name]
    if "angle" in drive or "turns" in drive or "steers" in drive:
        sideways = drive.get("along") in ("left", "right")
        turns_round = (
            drive.get("from") == "drawing" or "steers" in drive or ("turns" in drive and not sideways)
        )
        return 0, -1 if turns_round else 1
    along = drive.get("along", "up")
    if "travel" in drive:
        along = plain["slides"][drive["travel"][0]]["along"]
    return 1, -1 if along in ("left", "right") else 1


def rounded(numbers: Any) -> list[float]:
    return (np.round(np.array(numbers, float) * 1024.0) / 1024.0).tolist()


@cache
def content_of(name: str) -> Content:
    """A shipped mechanism on the grid of 1/1024, with all that it can have, near its drawing."""
    scene, plain = Scene.load(name), plain_scene(name)
    content = scene.model_dump(exclude_none=True)
    part = content["mechanism"]
    part["points"] = {n: rounded(place) for n, place in scene.mechanism.points.items()}
    part |= {"up": [0.0, 0.0, 1.0], "right": [0.0, 1.0, 0.0]}
    kinds = {name: kind_of_input(plain, name) for name in scene.inputs}
    drawn = {n: float(v) for n, v in drawn_inputs(Scene.from_mapping(content)).items()}
    steps = {0: (0.0625, -0.03125), 1: (6.5, -2.25)}
    inputs = {
        name: {"polynomial": [*rounded([drawn[name]]), *(c * (1 + 0.25 * k) for c in steps[kinds[name][0]])]}
        for k, name in enumerate(scene.inputs)
    }
    content |= {"inputs": inputs, "time": {"start": 0.0, "stop": 1.0, "samples": 2}}
    return with_everything(content, name) | {"kinds": kinds}


def moving_alone(name: str) -> Content:
    """Without loads and all that is made of motions: squares of these are no numbers at such sizes."""
    content = content_of(name)
    return content | {"effects": [effect for effect in MOTION if effect in content["effects"]]}


def solved(who: str, content: Content) -> Solution:
    return solved_by(who, Scene.from_mapping({key: part for key, part in content.items() if key != "kinds"}))


@cache
def car_by(who: str, name: str, change: Change = UNCHANGED) -> Solution:
    """The numbers of a car, changed or not."""
    return solved(who, change.content(content_of(name)))


def wrong_numbers(found: Solution, plain: Solution, change: Change) -> list[tuple[str, str]]:
    """The numbers of a changed car that are not the changed numbers of the plain one, within both claims."""
    wrong = []
    for quantity, numbers in plain.numbers.items():
        power = POWERS[QUANTITIES[quantity].unit.partition("/s")[0]]
        for name, value in numbers.items():
            there = change.name(name)
            goal = change.number(quantity, name, value)
            claims, own = found.accuracy.claims[quantity][there], plain.accuracy.claims[quantity][name]
            own = own[::-1] if change.backwards else own
            if np.ndim(own) > 1:
                own = own @ np.abs(change.matrix).T
            # Adding the shift rounds the goal, by half a unit in the last place, and the scale by another.
            allowed = claims + change.scale**power * own + 2.0 * np.spacing(np.abs(goal))
            off = np.abs(found.numbers[quantity][there] - goal)
            if not ((off <= allowed) | (np.isnan(goal) & np.isnan(found.numbers[quantity][there]))).all():
                wrong.append((quantity, name))
    return wrong


@pytest.mark.parametrize(("name", "who"), PAIRS)
def test_a_changed_car_has_the_changed_numbers(name: str, who: str) -> None:
    plain, found = car_by(who, name), car_by(who, name, CHANGE)
    assert {q: {*map(CHANGE.name, of)} for q, of in plain.numbers.items()} == {
        q: {*of} for q, of in found.numbers.items()
    }
    assert wrong_numbers(found, plain, CHANGE) == []


@pytest.mark.parametrize(("name", "who"), [("pushrod-by-damper", "pointcoord"), ("axle-roll", "absolute")])
def test_no_number_loses_a_digit_far_from_the_origin(name: str, who: str) -> None:
    """Where a place is rounded by 2^-23 mm, and one of the drawing is not."""
    change = Change(shift=(2.0**30, 0.0, -(2.0**29)))
    plain, found = car_by(who, name), car_by(who, name, change)
    assert wrong_numbers(found, plain, change) == []
    for quantity, numbers in found.numbers.items():
        for own, number in numbers.items() if quantity != "position" else ():
            near, far = (of.accuracy.claims[quantity][own] for of in (plain, found))
            size = np.abs(np.nan_to_num(number)).max(initial=1.0)
            assert (far <= np.maximum(2.0 * near, 1e-10 * size)).all(), (quantity, own)


@pytest.mark.parametrize("power", [-300, 300])
@pytest.mark.parametrize(("name", "who"), [pair for pair in [*PAIRS, *RINGS] if pair[1] != "reference"])
def test_a_car_of_any_size_moves_alike(name: str, who: str, power: int) -> None:
    """A power of two rounds nothing."""
    content, change = moving_alone(name), Change(scale=2.0**power)
    plain, found = solved(who, content), solved(who, change.content(content))
    assert wrong_numbers(found, plain, change) == []
    # Without a unit; of rows that depend on each other another may be left out.
    assert (found.accuracy.condition <= 4.0 * plain.accuracy.condition).all()


@pytest.mark.parametrize("power", [-300, 300])
@pytest.mark.parametrize("name", SCENES)
def test_rates_too_slow_and_too_fast_to_be_squared_are_bounded_as_others_are(name: str, power: int) -> None:
    """Time counts in units of its own, so a motion that takes 2^-300 of the time has the same bounds."""
    power = min(power, 200) if name == "axle-roll" else power  # a car rolls no faster than 1e140 rad/s^2
    content = moving_alone(name) | {"time": {"start": 0.0, "stop": 0.0, "samples": 1}}
    laws = {n: law["polynomial"] for n, law in content["inputs"].items()}
    quick = {n: {"polynomial": [a, 2.0**power * b, 4.0**power * c]} for n, (a, b, c) in laws.items()}
    plain, found = solved("pointcoord", content), solved("pointcoord", content | {"inputs": quick})
    for quantity, numbers in plain.numbers.items():
        for own, number in numbers.items():
            factor, claims = 2.0 ** (power * per_second(quantity)), plain.accuracy.claims[quantity][own]
            scaled = found.accuracy.claims[quantity][own] / factor
            assert scaled == pytest.approx(claims, rel=1e-3, abs=1e-25)
            off = np.abs(found.numbers[quantity][own] / factor - number)
            assert (off <= 2.1 * claims).all(), (quantity, own)


def test_each_part_of_a_change_is_noticed() -> None:
    plain, found = (car_by("absolute", "off-axis-strut", change) for change in (UNCHANGED, CHANGE))
    for part in ("turn", "shift", "scale", "backwards"):
        assert wrong_numbers(found, plain, replace(CHANGE, **{part: getattr(UNCHANGED, part)})), part
