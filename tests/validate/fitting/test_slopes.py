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
RATES = ("velocity", "acceleration", "angular_velocity", "camber_by_time")
# Of a pose: made of places, and of their derivatives by an input where a row has all inputs.
PLACED = [name for name, effect in EFFECTS.items() if effect.derivative == 0 and name != "loads"]
STILL = [name for name in PLACED if not EFFECTS[name].way]


def asking(name: str, effects: Sequence[str]) -> Scene:
    """A shipped scene of a car with a wheel's radius, that asks for what it has of some effects."""
    content = load(name).model_dump(exclude_none=True, exclude={"points"}) | {"tolerance": 1e-12}
    content["mechanism"] = {"wheel_radius": RADIUS, **content["mechanism"]}
    scene = Scene.from_mapping(content | {"effects": ()}, name)
    had = [effect for effect in effects if effect in scene.mechanism.effects]
    return scene.model_copy(update={"effects": tuple(had)})


def driven_by(scene: Scene, *columns: str, **content: object) -> Driven:
    """A car by the columns of a file, which has a number of it beside, and by what its map says."""
    point = scene.mechanism.topology.moving[0]
    text = f"{','.join(columns)},position.{point}.x [mm]\n{'0,' * len(columns)}0\n"
    return Driven.of(scene, measured(text, scene, rolling_radius=RADIUS, **content))


def hold_to_cars_drawn_anew(driven: Driven, values: Sequence[Array]) -> None:
    """Slopes along a direction in which all coordinates move, but those that lock the mechanism."""
    scene = driven.scene
    coordinates, size = coordinates_of(scene), size_of(scene)
    found = driven.at(values, 1e-12)
    assert not found.reasons, found.reasons
    slopes = driven.slopes(found, coordinates)
    kept = np.isfinite([*slopes["position"].values()]).all(axis=(0, 2, 3))
    assert kept.any()
    along = kept * np.random.default_rng(2).uniform(-1.0, 1.0, len(coordinates))
    offsets = (dict(zip(coordinates, size * STEP * at * along, strict=True)) for at in PLACES)
    designs = [driven.redrawn(offset).at(values, 1e-12).numbers for offset in offsets]
    numbers, ours, others = ({quantity: dict[str, Array]() for quantity in slopes} for _ in range(3))
    for quantity, of in slopes.items():
        for name, slope in of.items():
            numbers[quantity][name] = found.numbers[quantity][name]
            ours[quantity][name] = np.tensordot(along[kept], slope[kept], 1)
            others[quantity][name] = np.stack([one[quantity][name] for one in designs])
    hold_to_designs(numbers, ours, others, size)


def rows_from(driven: Driven) -> list[Array]:
    """Values of the columns about the drawing, or instants of the motion."""
    units, size, time = driven.scene.mechanism.topology.input_units, size_of(driven.scene), driven.scene.time
    if "time" in driven.columns:
        return [time.start + (time.stop - time.start) * np.array([0.6, 0.1])]
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


WHEELS = [name for name in one_of_each() if load(name).mechanism.topology.wheel_axis]
# A scene, the effects that it asks for, the columns of the file, and what its map says.
CASES: list[tuple[str, list[str], list[str], dict[str, object]]] = [
    *((name, PLACED, columns, {}) for name in one_of_each(inputs=True) for columns in headings(name)),
    # The paper's strut is drawn off the line that closing puts it on: a travel counts from another level.
    *(
        (name, STILL, [f"travel.{point} [mm]"], {})
        for name in WHEELS
        for point in ("wheel_centre", "contact")
    ),
    ("axle-steer", STILL, ["travel.left.wheel_centre [mm]"], {}),
    ("axle-roll", STILL, ["travel.right.wheel_centre [mm]"], {}),
    ("steer", STILL, ["input.rack [mm]"], {"held": {"travel.wheel_centre": 3.0}}),
    # Motions of every mechanism are in tests/pointcoord/sweeping/test_sensitivity.py.
    *((name, [*RATES], ["time [s]"], {}) for name in one_of_each(inputs=True)[::3]),
]


@pytest.mark.parametrize(("name", "effects", "columns", "content"), CASES)
def test_slopes_of_a_file_s_numbers_are_those_of_cars_drawn_anew(
    name: str, effects: list[str], columns: list[str], content: dict[str, object]
) -> None:
    driven = driven_by(asking(name, effects), *columns, **content)
    hold_to_cars_drawn_anew(driven, rows_from(driven))
