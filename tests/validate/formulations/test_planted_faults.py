"""A comparison is worth what it catches: each single fault, planted in one formulation, must be seen.

tests/validate/comparison/test_tolerance.py shows that a number beyond its tolerance is seen, and
tests/mechanisms/test_formulations.py how narrow tolerances are, of every way to solve.
"""

from collections.abc import Callable
from dataclasses import replace
from importlib import import_module
from itertools import cycle
from typing import Any

import numpy as np
import pytest
from changed_scenes import scene_with
from sample_cars import CARS

import absolute
import validate.formulations.modelled
from pointcoord import Scene
from pointcoord.linkage.mechanism import Mechanism
from validate.comparison.compare import compare
from validate.paper.scenes import PAPER_SCENES
from validate.peers.in_pinocchio import InPinocchio

# The module; the package's attribute of this name is the function.
solver = import_module("pointcoord.simulation")

Plant = Callable[[pytest.MonkeyPatch], None]


def _link_too_long(patch: pytest.MonkeyPatch) -> None:
    """The tie rod 1e-7 mm longer than drawn."""
    build = solver.build_mechanism

    def wrong(*parts: Any) -> Mechanism:
        mechanism = build(*parts)
        place = mechanism.layout.scalar("squared length of link tie_rod_inner - tie_rod_outer")
        drawn = mechanism.drawn.copy()
        drawn[place] = (np.sqrt(drawn[place]) + 1e-7 / mechanism.unit) ** 2
        return replace(mechanism, drawn=drawn)

    patch.setattr(solver, "build_mechanism", wrong)


def _theta_at_rest(patch: pytest.MonkeyPatch) -> None:
    """Inputs without accelerations, to a model that states its accuracy: pointcoord has laws of its own."""
    laws_of = validate.formulations.modelled.laws_of

    def wrong(scene: Scene, times: np.ndarray) -> dict[str, np.ndarray]:
        return {name: law * (np.arange(law.shape[-1]) != 2) for name, law in laws_of(scene, times).items()}

    patch.setattr(validate.formulations.modelled, "laws_of", wrong)


def _chassis_at_rest(patch: pytest.MonkeyPatch) -> None:
    """The heaving chassis moves the absolute model, but its velocity and acceleration are forgotten."""
    solve = absolute.Assembled.solve

    def wrong(car: absolute.Assembled, inputs: dict, **options: bool) -> absolute.Solution:
        forgotten = {name: inputs[name] * (np.arange(inputs[name].shape[1]) == 0) for name in car.model.moves}
        return solve(car, inputs | forgotten, **options)

    patch.setattr(absolute.Assembled, "solve", wrong)


def _loops_at_rest(patch: pytest.MonkeyPatch) -> None:
    """What the loops' sides accelerate apart by is left out: no Coriolis terms."""
    patch.setattr(InPinocchio, "apart", lambda program, *_: np.zeros(3 * len(program.tree.loops)))


# The fault, one of the paper's scenes that shows it, the quantity that it spoils, and who is compared.
FAULTS: dict[str, tuple[Plant, str, str, str]] = {
    "a link 1e-7 mm too long": (_link_too_long, "bounce", "position", "absolute"),
    "theta'' forgotten": (_theta_at_rest, "bounce", "acceleration", "absolute"),
    "the chassis' rates forgotten": (_chassis_at_rest, "bounce-on-a-heaving-chassis", "velocity", "absolute"),
    "no Coriolis terms, in the tree": (_loops_at_rest, "bounce-and-steer", "acceleration", "relative"),
}


# On a chassis that moves up and down, so that they show every fault.
HEAVE = {"heave": {"sine": {"amplitude": 20.0, "angular_frequency": 5.0}}}
OTHER_CARS = [name for name in CARS if name not in PAPER_SCENES]
ON_CARS = [*zip(FAULTS, cycle(("paper", *OTHER_CARS)), strict=False)]


@pytest.mark.parametrize(("name", "car"), ON_CARS)
def test_a_single_fault_makes_a_comparison_fail_that_agrees_without_it(
    name: str, car: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    plant, shown, spoils, second = FAULTS[name]
    scene = scene_with(car, laws=HEAVE) if car in OTHER_CARS else Scene.load(shown)
    assert compare(scene, "pointcoord", second).agreed
    plant(monkeypatch)
    assert spoils in {row.quantity for row in compare(scene, "pointcoord", second).disagreements}
