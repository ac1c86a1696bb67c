"""Mechanisms that nobody drew, and slides that do not turn drawn off their lines, by every formulation."""

from typing import Any

import numpy as np
import pytest
from hypothesis import Phase, assume, example, given, note, settings
from hypothesis import strategies as st
from random_mechanisms import random_mechanism
from scipy.spatial.transform import Rotation
from three_mechanics import scene_of, solved_by

from pointcoord import Scene, SceneError, simulate
from pointcoord.numerics.arrays import Array
from validate.comparison.compare import compare_solutions
from validate.formulations.protocol import FormulationError
from validate.formulations.reference_solution import reference_solution, told_by
from validate.formulations.refusals import why_refused
from validate.formulations.registry import formulation
from validate.reference import NoReferenceError

FORMULATIONS = ("pointcoord", "pointcoord-newton", "absolute", "relative")
# Others than those that are named are searched for by the long profile alone: each takes seconds. Without
# shrinking: it changes the seed, and so the whole mechanism.
EXAMPLES = settings.default.max_examples if settings.default else 100
PHASES = (Phase.explicit, Phase.generate) if EXAMPLES > 100 else (Phase.explicit,)


@settings(phases=PHASES)
@given(st.integers(0, 2**32 - 1))
@example(65)  # a knuckle hinged to an arm, the arm after it in the file
@example(254)  # another before it, on a car that rolls over the ground
@example(260)  # a knuckle that slides along a line of an arm
def test_a_mechanism_at_random_moves_as_the_reference_says_by_every_formulation(number: int) -> None:
    content = random_mechanism(number)
    if number % 2:
        content["mechanism"]["bodies"] = dict(reversed(content["mechanism"]["bodies"].items()))
    note(repr(content))
    try:
        effects = Scene.from_mapping(content).mechanism.effects
        scene = Scene.from_mapping(content | {"effects": effects})
        first = formulation(FORMULATIONS[1]).solve(scene)
        reference = reference_solution(scene)
    except (SceneError, NoReferenceError):
        assume(False)
        raise
    except FormulationError as error:
        assume(not why_refused(error))
        raise
    told = told_by(reference, scene)
    for name in FORMULATIONS[1:]:
        solution = first if name == FORMULATIONS[1] else formulation(name).solve(scene)
        outcome = compare_solutions(scene, solution, reference, "random", told)
        # A tree of joints gives angles, lengths and rates of points, and not all that is made of these.
        assert name == "relative" or all(row.verdict != "not given" for row in outcome.rows)
        # What is expected of usual cars; of one that only slides a component may be lost in the others.
        for row in outcome.rows:
            assert row.verdict == "not given" or row.share <= (4.0 if row.quantity == "position" else 100.0)
    motion = simulate(scene)
    proven = motion.proof(rates=True).proven
    for quantity, names in told.items():
        for part in names:
            off = np.abs(motion.numbers[quantity][part] - reference.numbers[quantity][part])
            assert (off <= proven[quantity][part] + reference.accuracy.claims[quantity][part]).all()


LINE = np.array([1.0, 2.0, 2.0]) / 3.0
SIZE = 300.0


def carriage(off: float, **more: Any) -> tuple[dict[str, Array], dict[str, Any]]:
    """A body on a rail that it does not turn about, one of its two points there drawn so far off, mm."""
    through = np.array([40.0, -30.0, 20.0])
    points: dict[str, Array] = {
        "through": through,
        "front": through + 0.4 * SIZE * LINE + off * np.array([0.6, -1.0, 0.3]),
        "rear": through + SIZE * LINE,
        "above": through + np.array([70.0, 20.0, 190.0]),
        "beside": through + np.array([-60.0, 210.0, 130.0]),
    }
    rail = {"points": ["front", "rear"], "through": "through", "along": "rear", "turns": False}
    return points, {
        "points": {point: place.tolist() for point, place in points.items()},
        "bodies": {"chassis": ["through"], "carriage": ["front", "rear", "above", "beside"], **more},
        "slides": {"rail": rail},
        "inputs": {"travel": {"travel": "rail"}},
    }


@pytest.mark.parametrize("off", [1e-13, 1e-3, 1.0])
@pytest.mark.parametrize("name", [*FORMULATIONS, "mujoco", "exudyn", "reference"])
def test_what_is_drawn_off_a_slide_that_does_not_turn_is_turned_onto_it_the_least(
    name: str, off: float
) -> None:
    points, mechanism = carriage(off)
    through = points["through"]
    solution = solved_by(name, scene_of(mechanism, [], travel=[120.0, 25.0]))
    own = points["rear"] - points["front"]
    own /= np.linalg.norm(own)
    axis = np.cross(own, LINE)
    sine = float(np.linalg.norm(axis))
    turn = Rotation.from_rotvec(axis * (np.arctan2(sine, own @ LINE) / sine))
    for k, travel in enumerate((120.0, 132.5, 145.0)):
        for point in ("front", "rear", "above", "beside"):
            there = through + travel * LINE + turn.apply(points[point] - points["front"])
            found = solution.position[point][k]
            # The closed form rounds some ten times at 400 mm, and a tilt of 1e-15 by a part of itself.
            assert np.abs(found - there).max() <= 1e-12 + solution.accuracy.claims["position"][point][k].max()


def test_a_slide_whose_points_are_those_of_a_hinge_does_not_say_which_body_is_kept_from_turning() -> None:
    points, mechanism = carriage(0.0, arm=["front", "rear", "tip"])
    mechanism["points"]["tip"] = (points["above"] + 50.0).tolist()
    with pytest.raises(SceneError, match="to carriage and arm, so the body kept from turning"):
        scene_of(mechanism, [], travel=120.0)


@pytest.mark.parametrize("name", [*FORMULATIONS, "reference"])
def test_an_angle_about_a_point_that_moves_is_measured_in_the_axes_of_the_car(name: str) -> None:
    arm = {"angle": "fore", "of": "tip", "about": "elbow", "from": "up"}
    points = {"hip": [0, 0, 0], "hip2": [90, 0, 0], "elbow": [0, 400, 0], "elbow2": [90, 400, 0]}
    bodies = {
        "chassis": ["hip", "hip2"],
        "upper": ["hip", "hip2", "elbow", "elbow2"],
        "fore": ["elbow", "elbow2", "tip"],
    }
    inputs = {"shoulder": {"angle": "upper", "from": "drawing"}, "fore": arm}
    mechanism = {"points": points | {"tip": [0, 600, 150]}, "bodies": bodies, "inputs": inputs}
    scene = scene_of(mechanism, [], shoulder=[0.0, 0.5], fore=[0.75, 0.25])
    places = solved_by(name, scene).position
    angles = (0.0, 0.25, 0.5), (0.75, 0.875, 1.0)
    for shoulder, fore, elbow, tip in zip(*angles, places["elbow"], places["tip"], strict=True):
        upper = [0.0, 400.0 * np.cos(shoulder), 400.0 * np.sin(shoulder)]
        assert elbow == pytest.approx(upper, abs=1e-12)
        assert tip - elbow == pytest.approx([0.0, 250.0 * np.sin(fore), 250.0 * np.cos(fore)], abs=1e-11)
