"""Derivatives by hardpoints are what cars that are drawn anew change by, however a motion was solved."""

from collections.abc import Mapping

import numpy as np
import pytest
from drawn_anew import PLACES, STEP, hold_to_designs, size_of
from every_number import asked, one_of_each
from random_mechanisms import random_mechanism

from pointcoord import Scene, SweepError, UnknownName, sensitivity, simulate, sweep
from pointcoord.numerics.arrays import Array
from pointcoord.results.samples import Channel
from pointcoord.sweeping.designs import coordinates_of
from pointcoord.sweeping.hardpoint_slopes import slopes_of_motion

TIME = {"start": 0.0, "stop": 0.4, "samples": 3}
# Of the largest derivative, how far one may be off as a solved rate is, some ten times.
SOLVED = 1e-13


def car(name: str, *effects: str) -> Scene:
    return Scene.load(name).model_copy(update={"time": TIME, "effects": effects or ("wheel_angles", "toe")})


def at_two_instants(name: str) -> Scene:
    """A scene with every number that its car can have, at two instants."""
    scene = asked(name)
    # Designs by themselves share no series, and truncate it by what a tolerance allows.
    return scene.model_copy(update={"time": scene.time.model_copy(update={"samples": 2}), "tolerance": 1e-12})


def every_number(channels: Mapping[str, Channel]) -> list[str]:
    """Their names as `sensitivity` takes them."""
    return [
        f"{quantity}.{name}{axis}"
        for quantity, channel in channels.items()
        for name in channel
        for axis in (("",) if channel.quantity.of == "car" else (".x", ".y", ".z"))
    ]


def hold_to_differences(scene: Scene, *coordinates: str) -> None:
    """Derivatives along a direction in which all coordinates move against those of cars that are drawn there.

    Args:
        coordinates: all unless given.
    """
    drawn = sweep(scene)
    found = sensitivity(scene, every_number(drawn.numbers), coordinates)
    size = size_of(scene)
    kept = np.array([name not in found.failures for name in found.coordinates])
    assert kept.any()
    along = kept * np.random.default_rng(1).uniform(-1.0, 1.0, len(found.coordinates))
    offsets = {name: STEP * size * PLACES * a for name, a in zip(found.coordinates, along, strict=True)}
    designs = sweep(scene, offsets=offsets)
    assert not designs.failures
    numbers, ours = ({q: dict[str, Array]() for q in drawn.numbers} for _ in range(2))
    for quantity, channel in drawn.numbers.items():
        for name, values in channel.items():
            one, axes = f"{quantity}.{name}", "" if channel.quantity.of == "car" else "xyz"
            parts = [found.derivatives[f"{one}.{axis}"] for axis in axes] or [found.derivatives[one]]
            derivatives = [along[kept] @ part[kept] for part in parts]
            numbers[quantity][name] = values[0]
            ours[quantity][name] = np.stack(derivatives, axis=-1) if axes else derivatives[0]
            assert (np.isfinite(ours[quantity][name]) == np.isfinite(values[0])).all(), one
    hold_to_designs(numbers, ours, designs.numbers, size)


@pytest.mark.parametrize("name", one_of_each(inputs=True))
def test_every_number_of_every_mechanism_changes_as_that_of_cars_drawn_anew(name: str) -> None:
    hold_to_differences(at_two_instants(name))


@pytest.mark.parametrize("number", [16, 28, 29, 35, 43, 50])
def test_so_they_do_in_mechanisms_at_random_that_have_what_no_shipped_one_has(number: int) -> None:
    """Bodies that may not turn on lines that they are drawn off, travels along these, turns on bodies."""
    content = random_mechanism(number)
    effects = Scene.from_mapping(content).mechanism.effects
    hold_to_differences(Scene.from_mapping(content | {"effects": effects}))


def test_so_they_do_where_a_steering_wheel_turns_and_a_rack_that_is_drawn_at_the_tie_rod_moves_alone() -> (
    None
):
    scene = Scene.load("pushrod")
    part = scene.mechanism.model_copy(update={"rack_per_turn": 52.0})
    inputs = {"wheel_travel": scene.inputs["wheel_travel"], "steering_wheel": {"constant": 0.7}}
    effects = ("toe", "toe_by_rack", "screw_axis", "velocity")
    scene = scene.model_copy(update={"mechanism": part, "inputs": inputs, "effects": effects})
    hold_to_differences(scene)
    hold_to_differences(scene, "rack_centre", "tie_rod_outer.z")


@pytest.mark.parametrize("method", ["map", "newton"])
def test_however_a_motion_was_solved_its_derivatives_are_the_same(method: str) -> None:
    scene = car("off-axis-strut", "camber", "acceleration", "toe_by_travel")
    one, other = (
        slopes_of_motion(scene, simulate(scene, way).solved, scene.instants, coordinates_of(scene)).numbers
        for way in ("series", method)
    )
    for quantity, numbers in one.items():
        for name, slopes in numbers.items():
            assert np.abs(slopes - other[quantity][name]).max() <= SOLVED * np.abs(slopes).max()


def test_instants_and_coordinates_that_are_asked_for_beside_change_nothing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    scene = at_two_instants("wheel-travel")
    scene = scene.model_copy(update={"time": TIME, "effects": ("loads", "velocity")})
    numbers = ["rod_force.tie_rod", "velocity.wheel_centre.z"]
    every = sensitivity(scene, numbers)
    monkeypatch.setattr("pointcoord.sweeping.hardpoint_slopes.ROOM", 1.0)
    alone = sensitivity(scene, numbers, ["tie_rod_outer.z"])
    place = every.coordinates.index("tie_rod_outer.z")
    for number in numbers:
        size = np.abs(every.derivatives[number]).max()
        assert np.abs(alone.derivatives[number][0] - every.derivatives[number][place]).max() <= SOLVED * size
    # Without the loads the pushrod and what it moves are not solved for.
    few = sensitivity(
        scene.model_copy(update={"effects": ("velocity",), "points": ("wheel_centre",)}), numbers[1:]
    )
    size = np.abs(every.derivatives[numbers[1]]).max()
    assert np.abs(few.derivatives[numbers[1]] - every.derivatives[numbers[1]]).max() <= SOLVED * size


def test_a_coordinate_whose_change_locks_the_mechanism_has_no_derivative_and_says_which_row_locks() -> None:
    """Bricard's linkage moves by its symmetry alone: of a plane, and with its corners in line."""
    found = sensitivity(car("bricard", "velocity"), ["velocity.P4.x", "position.P4.y"])
    assert 0 < len(found.failures) < len(found.coordinates)
    for i, name in enumerate(found.coordinates):
        assert np.isfinite(found.derivatives["velocity.P4.x"][i]).all() == (name not in found.failures)
    assert all(
        "the mechanism locks" in why and "normal of the link_" in why for why in found.failures.values()
    )


def test_what_stops_the_drawn_car_leaves_no_derivative_and_is_said_of_each_coordinate() -> None:
    far = {"arm_angle": {"polynomial": [1.5, 3.0]}, "rack": {"constant": 0.0}}
    found = sensitivity(car("double-wishbone").model_copy(update={"inputs": far}), ["camber"])
    assert set(found.failures) == {*found.coordinates}
    assert np.isnan(found.derivatives["camber"]).all()
    assert np.isnan(found.largest("camber")).all()
    assert all("cannot pass a singular pose" in why for why in found.failures.values())


def test_spreads_are_what_independent_coordinates_and_the_worst_of_them_make() -> None:
    found = sensitivity(car("double-wishbone"), ["camber"])
    sizes = np.abs(found.derivatives["camber"])
    deviation, worst = found.spread("camber", 0.5)
    assert deviation == pytest.approx(0.5 * np.linalg.norm(sizes, axis=0).max(), rel=1e-14)
    assert worst == pytest.approx(0.5 * sizes.sum(axis=0).max(), rel=1e-14)
    assert deviation < worst


def test_a_rack_that_goes_along_has_no_coordinates_unless_they_are_asked_for() -> None:
    scene = car("double-wishbone")
    assert not [name for name in sensitivity(scene).coordinates if name.startswith("rack_centre")]
    assert sensitivity(scene, coordinates=["rack_centre.z"]).coordinates == ("rack_centre.z",)


def test_what_is_not_there_is_refused_by_name() -> None:
    with pytest.raises(UnknownName, match="cambr"):
        sensitivity(car("double-wishbone"), ["cambr"])
    with pytest.raises(UnknownName, match="uper_ball_joint"):
        sensitivity(car("double-wishbone"), coordinates=["uper_ball_joint"])
    with pytest.raises(SweepError, match="give no number of the car"):
        sensitivity(car("double-wishbone", "velocity"))
