"""Slopes of a file's numbers by hardpoints: cars drawn anew, whatever the rows of the file are taken by."""

from collections.abc import Sequence

import numpy as np
import pytest
from curve_files import measured
from drawn_anew import PLACES, STEP, hold_to_designs, size_of
from every_number import load, one_of_each

from pointcoord import Scene
from pointcoord.effects.registry import EFFECTS
from pointcoord.numerics.arrays import Array
from pointcoord.sweeping.designs import coordinates_of
from validate.measured.poses import Driven

# How far rows are from the drawing, rad and parts of the car's size.
AWAY = np.array([-0.5, 0.0, 1.0])
FAR = {"rad": 0.04, "mm": 0.01}
RADIUS = 300.0  # mm
TRAVELLING = ("wheel_centre", "contact")
RATES = ("velocity", "acceleration", "angular_velocity", "camber_by_time")


def asking(name: str, effects: Sequence[str]) -> Scene:
    """A shipped scene of a car with a wheel's radius, that asks for what it has of some effects."""
    content = load(name).model_dump(exclude_none=True, exclude={"points"}) | {"tolerance": 1e-12}
    content["mechanism"] = {"wheel_radius": RADIUS, **content["mechanism"]}
    scene = Scene.from_mapping(content | {"effects": ()}, name)
    had = [effect for effect in effects if effect in scene.mechanism.effects]
    return scene.model_copy(update={"effects": tuple(had)})


def of_a_pose(along_ways: bool = True) -> list[str]:
    """Effects that are made of places, and of their derivatives by an input."""
    some = (name for name, effect in EFFECTS.items() if effect.derivative == 0 and name != "loads")
    return [name for name in some if along_ways or not EFFECTS[name].way]


def driven_by(scene: Scene, *columns: str, **content: object) -> Driven:
    """A car by the columns of a file, which has a number of it beside, and by what its map says."""
    point = scene.mechanism.topology.moving[0]
    text = f"{','.join(columns)},position.{point}.x [mm]\n{'0,' * len(columns)}0\n"
    return Driven.of(scene, measured(text, scene, rolling_radius=RADIUS, **content))


def hold_to_cars_drawn_anew(driven: Driven, values: Sequence[Array]) -> None:
    """Slopes along a direction in which all coordinates move, but those that lock the mechanism."""
    scene = driven.scene
    coordinates, size = coordinates_of(scene), size_of(scene)
    found = driven.at(values, 1e-12, bounded=False)
    assert found.reached.all(), found.reasons
    slopes = driven.slopes(found, coordinates)
    kept = np.isfinite([*slopes["position"].values()]).all(axis=(0, 2, 3))
    assert kept.any()
    along = kept * np.random.default_rng(2).uniform(-1.0, 1.0, len(coordinates))
    ours = {
        quantity: {name: np.tensordot(along[kept], slope[kept], 1) for name, slope in of.items()}
        for quantity, of in slopes.items()
    }
    offsets = (dict(zip(coordinates, size * STEP * at * along, strict=True)) for at in PLACES)
    designs = [driven.redrawn(offset).at(values, 1e-12, bounded=False).numbers for offset in offsets]
    numbers = {
        quantity: {name: found.numbers[quantity][name] for name in of} for quantity, of in ours.items()
    }
    others = {
        quantity: {name: np.stack([one[quantity][name] for one in designs]) for name in of}
        for quantity, of in ours.items()
    }
    hold_to_designs(numbers, ours, others, size)


def rows_from(driven: Driven) -> list[Array]:
    """Values of the columns about the drawing."""
    units, size = driven.scene.mechanism.topology.input_units, size_of(driven.scene)
    values = []
    for i, name in enumerate(driven.columns):
        far = FAR[units[name]] * (size if units[name] == "mm" else 1.0)
        values.append(driven.drawn.get(name, 0.0) - driven.level(name) + far * np.roll(AWAY, i))
    return values


def headings(name: str) -> list[list[str]]:
    """All inputs of a scene, and its first and last alone: the others are as drawn, or as the scene says."""
    scene = load(name)
    every = [f"input.{one} [{scene.mechanism.topology.input_units[one]}]" for one in scene.inputs]
    return [every, *([one] for one in dict.fromkeys((every[0], every[-1])) if len(every) > 1)]


@pytest.mark.parametrize("name", one_of_each(inputs=True))
def test_slopes_of_poses_over_inputs_are_those_of_cars_drawn_anew(name: str) -> None:
    scene = asking(name, of_a_pose())
    for columns in headings(name):
        driven = driven_by(scene, *columns)
        hold_to_cars_drawn_anew(driven, rows_from(driven))


TRAVELS = [
    *((name, p) for name in one_of_each() if load(name).mechanism.topology.wheel_axis for p in TRAVELLING),
    ("axle-steer", "left.wheel_centre"),
    ("axle-roll", "right.wheel_centre"),
]


@pytest.mark.parametrize(("name", "point"), TRAVELS)
def test_slopes_over_a_travel_are_those_of_cars_whose_travel_counts_from_their_own_drawing(
    name: str, point: str
) -> None:
    """The paper's strut is drawn off the line that closing puts it on, so that the level changes too."""
    driven = driven_by(asking(name, of_a_pose(along_ways=False)), f"travel.{point} [mm]")
    hold_to_cars_drawn_anew(driven, rows_from(driven))


def test_a_travel_that_is_held_counts_from_each_car_s_own_drawing_too() -> None:
    scene = asking("steer", of_a_pose(along_ways=False))
    driven = driven_by(scene, "input.rack [mm]", held={"travel.wheel_centre": 3.0})
    hold_to_cars_drawn_anew(driven, rows_from(driven))


# Motions of every mechanism are in tests/pointcoord/sweeping/test_sensitivity.py.
@pytest.mark.parametrize("name", one_of_each(inputs=True)[::3])
def test_slopes_of_rates_are_those_of_motions_of_cars_drawn_anew(name: str) -> None:
    driven = driven_by(asking(name, RATES), "time [s]")
    time = driven.scene.time
    hold_to_cars_drawn_anew(driven, [time.start + (time.stop - time.start) * np.array([0.6, 0.1])])
