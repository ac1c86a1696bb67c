"""What a map says of how far each of its numbers is off holds against the many-digit reference."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from changed_scenes import content_of
from every_effect import asking_for_all
from numpy.typing import NDArray

from pointcoord import KinematicMap, Scene, kinematic_map
from pointcoord.effects.point_states import STATES
from pointcoord.mapping.kinematic_map import MappedPoses
from pointcoord.patches.jet import Jet
from validate.formulations.reference_solution import as_solution, reference_instant

Array = NDArray[np.float64]
POSES = 8
RANGES = {"arm_angle": (1.45, 1.65), "rack": (-15.0, 15.0)}


def with_all_effects(name: str) -> Scene:
    """As many instants as poses are compared with the reference; a map does not look at them.

    What moves the chassis is an input of the scene, as the reference drives nothing else. A map has no jerks.
    """
    content = content_of(name)
    content["inputs"].setdefault("heave", {"constant": 0.0})
    scene = Scene.from_mapping(content)
    time = scene.time.model_copy(update={"samples": POSES})
    effects = tuple(name for name in asking_for_all(scene).effects if name not in STATES[3:])
    return scene.model_copy(update={"time": time, "effects": effects})


def shares(found: MappedPoses, truth: Mapping[str, Mapping[str, Array]]) -> dict[str, float]:
    """The largest error of each quantity in parts of its bound; the rounding of the truth apart."""
    largest = {}
    for quantity, bounds in found.bounds.items():
        right, numbers = truth[quantity], found.numbers[quantity]
        parts = [
            (np.abs(numbers[n] - right[n]) - 2.0**-53 * np.abs(right[n])) / bounds[n]
            for n in bounds
            if bounds[n].all()
        ]
        largest[quantity] = float(np.max([part.max() for part in parts]))
    return largest


def test_a_map_is_off_by_no_more_than_it_says_and_one_that_is_is_found_out() -> None:
    """Planted: errors of its sums, of their first or second derivatives, said to be a millionth as large."""
    scene, rng = with_all_effects("double-wishbone"), np.random.default_rng(23)
    values = {n: rng.uniform(*RANGES.get(n, (-50.0, 50.0)), POSES) for n in scene.inputs}
    rates = {n: (3.0 if n == "arm_angle" else 200.0) * rng.normal(size=POSES) for n in values}
    states = values, rates, {n: 10.0 * rate[::-1] for n, rate in rates.items()}
    # At the inputs as they are, rounded to doubles.
    instants = [
        reference_instant(scene, {n: tuple(float(of[n][i]) for of in states) for n in values})
        for i in range(POSES)
    ]
    truth = as_solution(scene, instants).numbers
    map = kinematic_map(scene, RANGES, tolerance=1e-3)  # its errors are seen beside rounding
    right = shares(map(*states, bounds=True), truth)
    assert max(right.values()) <= 1.0, right
    for derivative, seen in enumerate(STATES[:3]):
        # Nor are bounds far above the errors.
        assert right[seen] > 0.05
        parts = [part * (1e-6 if d == derivative else 1.0) for d, part in enumerate(map.series.off.parts)]
        wrong = KinematicMap(scene, map.tolerance, replace(map.series, off=Jet(*parts)), map.gaps)
        assert shares(wrong(*states, bounds=True), truth)[seen] > 1.0


def test_bounds_have_the_shape_of_the_numbers_and_are_none_unless_asked_for() -> None:
    map = kinematic_map(with_all_effects("bounce"), {"arm_angle": (1.5, 1.9), "rack": (0.0, 0.0)})
    angles = np.linspace(1.5, 1.9, 6).reshape(2, 3)
    plain = map({"arm_angle": angles, "rack": 0.0})
    assert not plain.bounds
    found = map({"arm_angle": angles, "rack": 0.0}, bounds=True)
    assert found.bounds["position"]["wheel_centre"].shape == (2, 3, 3)
    assert found.bounds["wheel"]["camber"].shape == (2, 3)
    assert "velocity" not in found.bounds
    one = map({"arm_angle": 1.6, "rack": 0.0}, {"arm_angle": 2.0}, {"arm_angle": 1.0}, bounds=True)
    assert one.bounds["angular_velocity"]["knuckle"].shape == (3,)
    none = map({"arm_angle": np.empty((0, 2)), "rack": 0.0}, bounds=True)
    assert none.bounds["wheel"]["camber"].shape == (0, 2)


def test_what_moves_the_chassis_and_a_far_origin_are_in_the_bounds() -> None:
    """A heave of 1e9 mm rounds every position to 1e-7 mm, which is no error of the pose's angles."""
    scene = with_all_effects("bounce")
    map = kinematic_map(scene, {"arm_angle": (1.5, 1.9), "rack": (-5.0, 5.0)})
    found = map({"arm_angle": 1.6, "rack": 1.0, "heave": 1e9 / 3.0}, bounds=True)
    up = found.bounds["position"]["wheel_centre"][2]
    assert 1e-9 < up < 1e-7
    assert found.bounds["position"]["wheel_centre"][0] < 1e-9
    assert found.bounds["wheel"]["camber"] < 1e-10
