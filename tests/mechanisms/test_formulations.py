"""Every formulation is right within what it claims, by the reference.

On a scene of every mechanism and closure, and on the cars beside this file: one rolls, pitches and heaves,
one is steered by its steering wheel, and one drives over a kerb. Two formulations give every number.
"""

from __future__ import annotations

import numpy as np
import pytest
from every_number import FAR, OF_A_TURN, TURNED, asked, exact, one_of_each
from mechanism_files import scene_file

from pointcoord import Scene
from pointcoord.effects.point_states import NAMED
from pointcoord.effects.registry import EFFECTS, NUMBERS_OF_THE_CAR
from validate.comparison.compare import Outcome, compare_solutions
from validate.formulations.protocol import FormulationError
from validate.formulations.reference_solution import told_by
from validate.formulations.registry import OUTSIDE, formulation

OF_EVERY_NUMBER = ("pointcoord", "absolute")
OTHERS = ("pointcoord-newton", "pointcoord-map", "relative", *OUTSIDE)
# Redundant everywhere: claims of its numbers hold, and are too wide to test the reference.
REDUNDANT = "bricard"
EVERY = (*one_of_each(), TURNED, TURNED + FAR)
# Trees of joints give no gradients and nothing of an axle, which these ask for.
OWN = ("kerb", "steering-wheel")
TREES = ("relative", *OUTSIDE)
ASKED = [(name, who) for name in (*one_of_each(), TURNED) for who in TREES]
# No way of pointcoord asks which mechanism it solves; tests/pointcoord/test_every_way.py tries others.
ASKED += [(name, who) for name in one_of_each()[::3] for who in OTHERS if who not in TREES]
ASKED += [(name, who) for name in OWN for who in (*OF_EVERY_NUMBER, *OTHERS)]
# A map has at most three inputs that move.
ASKED.remove(("kerb", "pointcoord-map"))
# Motions that meet a singular pose after some instants: the scene, and its input from the drawing on.
BEYOND = {
    "branches cross": ("n-four-bar", "crank", [0.0, -1.7]),
    "the input has an end": ("bricard", "turn", [0.0, -0.6]),
    "the piston has a dead centre": ("slider-crank", "stroke", [15.0, 100.0]),
}


def compared(name: str, who: str, every: bool) -> Outcome:
    scene, reference = asked(name, every), exact(name, name in EVERY)
    found = formulation(who).solve(scene)
    outcome = compare_solutions(scene, found, reference, name, told_by(reference, scene))
    assert not outcome.disagreements, outcome.disagreements
    return outcome


def of_the_car(scene: Scene) -> set[str]:
    """The numbers of its car that a scene asks for."""
    topology = scene.mechanism.topology
    return {name for effect in scene.effects for name in EFFECTS[effect].names(topology)}


def test_every_number_is_one_of_some_car() -> None:
    found = set().union(*(of_the_car(asked(name, True)) for name in one_of_each()))
    # No shipped mechanism that rolls has a damper.
    every = NUMBERS_OF_THE_CAR.keys() - {"damper_length_by_roll"}
    assert {name.rpartition(".")[2] for name in found} >= every
    assert any("loads" in asked(name, True).effects for name in one_of_each())


@pytest.mark.parametrize("name", EVERY)
@pytest.mark.parametrize("who", OF_EVERY_NUMBER)
def test_every_number_of_a_car_is_right_within_what_is_claimed(name: str, who: str) -> None:
    outcome = compared(name, who, True)
    # What is off by no more than is claimed: the reference's own part of that is nothing.
    within = [row for row in outcome.rows if row.verdict != "not given" and row.share <= 1.0]
    assert set(NAMED) <= {row.quantity for row in within}
    lacking = of_the_car(asked(name, True)) - {row.name for row in within}
    assert lacking <= OF_A_TURN
    assert not lacking or name != "axle-steer"


@pytest.mark.parametrize(("name", "who"), ASKED)
def test_what_a_scene_asks_for_is_right_within_what_is_claimed(name: str, who: str) -> None:
    outcome = compared(name, who, False)
    found = outcome.solutions[0]
    assert not outcome.missing or (name in OWN and who in TREES)
    if name == REDUNDANT:
        return
    # A model that claims much tests little. These cars raise 32 u by some ten in a place, by another ten in
    # what is twice differentiated, and by as much as coordinates are larger than the car is. An angle is
    # as far off as a radian's share, however small it is.
    places = np.concatenate([*found.numbers["position"].values()])
    far = max(1.0, float(np.abs(places).max() / np.ptp(places, axis=0).max()))
    for row in (row for row in outcome.rows if row.verdict != "not given"):
        assert row.share <= 1.0, row
        if row.name not in OF_A_TURN:  # quotients by a steer angle
            size = max(float(np.abs(array).max()) for array in found.numbers[row.quantity].values())
            assert row.tolerance < 1e-12 * far * (max(size, 1.0) if row.unit == "rad" else size), row


@pytest.mark.parametrize("beyond", BEYOND)
@pytest.mark.parametrize("who", [*OF_EVERY_NUMBER, *OTHERS])
def test_a_formulation_refuses_to_pass_a_singular_pose(who: str, beyond: str) -> None:
    scene, driven, polynomial = BEYOND[beyond]
    inputs = {driven: {"polynomial": polynomial}}
    time = {"start": 0.0, "stop": 1.0, "samples": 31}
    with pytest.raises(FormulationError, match=driven):
        formulation(who).solve(Scene.from_mapping({**scene_file(scene), "inputs": inputs, "time": time}))
