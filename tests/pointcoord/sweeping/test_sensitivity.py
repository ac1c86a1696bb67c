"""Derivatives by hardpoints: laws that hold of any car, and another model's differences."""

from collections.abc import Mapping
from fractions import Fraction

import numpy as np
import pytest
from numpy.typing import NDArray

from pointcoord import Scene, SweepError, UnknownName, sensitivity
from pointcoord.scene.scene_file import LoadPart
from validate.formulations.reference_solution import inputs_at
from validate.formulations.registry import formulation
from validate.reference import solve_reference

Array = NDArray[np.float64]

TIME = {"start": 0.0, "stop": 0.4, "samples": 3}
ANGLES = ("camber", "toe")
CARS = ("off-axis-strut", "pushrod")


def car(name: str, *effects: str) -> Scene:
    return Scene.load(name).model_copy(update={"time": TIME, "effects": effects or ("wheel_angles", "toe")})


@pytest.mark.parametrize("name", CARS)
def test_moved_as_a_whole_a_car_changes_no_angle(name: str) -> None:
    """The derivatives by one axis of all points add up to that of the whole car."""
    found = sensitivity(car(name, "camber", "toe"))
    assert not found.failures
    for number, derivatives in found.derivatives.items():
        for axis in "xyz":
            ours = [i for i, one in enumerate(found.coordinates) if one.endswith(f".{axis}")]
            # An angle is rounded to some 1e-15, twice over steps of half a millimetre, for each point.
            left = np.abs(derivatives[ours].sum(axis=0)).max()
            assert left <= len(ours) * (2e-14 + 0.1 * found.doubts[number].max()), (number, axis)


def test_scaled_about_the_origin_a_car_changes_no_angle_where_its_inputs_are_angles() -> None:
    """Of x . df/dx over all coordinates: the rack stands still, and the arm's angle is no length."""
    held = {"arm_angle": {"constant": 1.45}, "rack": {"constant": 0.0}}
    scene = car("double-wishbone").model_copy(update={"inputs": held})
    found = sensitivity(scene)
    places = np.array(
        [scene.mechanism.points[n.rpartition(".")[0]]["xyz".index(n[-1])] for n in found.coordinates]
    )
    for number, derivatives in found.derivatives.items():
        room = np.abs(places) @ (2e-14 + 0.1 * found.doubts[number])
        assert (np.abs(places @ derivatives) <= room).all(), number


@pytest.mark.parametrize(
    ("name", "coordinate"),
    [
        ("double-wishbone", "upper_ball_joint.y"),
        ("five-link", "lower_front_outer.z"),
    ],
)
def test_derivatives_are_those_of_the_many_digit_reference(name: str, coordinate: str) -> None:
    scene = car(name, "camber", "toe")
    found = sensitivity(scene, coordinates=[coordinate])
    point, _, axis = coordinate.rpartition(".")
    plain, step = scene.mechanism.plain(tuple(scene.inputs)), Fraction(1, 10**8)

    def angles(instant: float, move: Fraction) -> Mapping[str, Fraction]:
        place = [Fraction(x) for x in plain["points"][point]]
        place["xyz".index(axis)] += move
        points = {**plain["points"], point: place}
        return solve_reference({**plain, "points": points}, inputs_at(scene, instant), effects=ANGLES).effects

    for number in ANGLES:
        for i, instant in enumerate(found.times.tolist()):
            middle = (angles(instant, step)[number] - angles(instant, -step)[number]) / (2 * step)
            # An angle is rounded to some 1e-15, and twice that over steps of half a millimetre.
            room = 2e-14 + 0.1 * found.doubts[number][0, i]
            assert abs(float(middle) - found.derivatives[number][0, i]) <= room
        assert np.abs(found.derivatives[number]).max() > 1e-6


@pytest.mark.parametrize(
    ("effect", "numbers", "size", "least"),
    [
        ("toe_by_travel", ["angle_gradient.toe_by_travel"], 1.0 / 60.0, 6e-4),
        ("loads", ["rod_force.tie_rod", "joint_force.lower_ball_joint.y"], 4000.0, 1e-4),
        ("velocity", ["velocity.wheel_centre.x"], 300.0, 1e-4),
    ],
)
def test_every_number_has_the_derivatives_that_another_model_of_the_moved_cars_has(
    effect: str, numbers: list[str], size: float, least: float
) -> None:
    scene = Scene.load("wheel-travel")
    load = LoadPart(force=(-310.0, 1870.0, 3105.0), moment=(0.0, 0.0, 0.0))
    part = scene.mechanism.model_copy(update={"loads": {"": load}})
    time = scene.time.model_copy(update={"samples": 5})
    scene = scene.model_copy(update={"effects": (effect,), "mechanism": part, "time": time})
    found = sensitivity(scene, numbers, ["tie_rod_outer.z"])
    step, solved = 0.05, []
    for sign in (1.0, -1.0):
        points = dict(scene.mechanism.points)
        x, y, z = points["tie_rod_outer"]
        points["tie_rod_outer"] = (x, y, z + sign * step)
        moved = scene.model_copy(update={"mechanism": scene.mechanism.model_copy(update={"points": points})})
        solved.append(formulation("absolute").solve(moved).numbers)
    for number in numbers:
        quantity, name, *axis = number.split(".")
        middle = (solved[0][quantity][name] - solved[1][quantity][name]) / (2.0 * step)
        middle = middle[:, "xyz".index(axis[0])] if axis else middle
        # A central difference leaves out f''' h^2 / 6, of a number that changes by its size with 60 mm and
        # more.
        off = np.abs(found.derivatives[number][0] - middle).max()
        assert off <= size * (step**2 / 60.0**3 + 6e-11)
        assert np.abs(middle).max() > least * size


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
