"""A comparison is worth what it catches: each single fault, planted in one formulation, must be seen.

tests/validate/comparison/test_tolerance.py shows that a number beyond its tolerance is seen, and
tests/mechanisms/test_formulations.py how narrow tolerances are.
"""

from collections.abc import Callable
from dataclasses import replace
from importlib import import_module
from itertools import cycle

import numpy as np
import pytest
from changed_scenes import scene_with
from sample_cars import CARS

import absolute
import pointcoord.patches.evaluation
import validate.formulations.modelled
from pointcoord import Scene
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.method import NEWTON
from validate.comparison.compare import compare
from validate.formulations.point_coordinates import PointCoordinates
from validate.formulations.registry import formulation
from validate.paper.scenes import PAPER_SCENES
from validate.peers.in_pinocchio import InPinocchio

# The module; the package's attribute of this name is the function.
solver = import_module("pointcoord.simulation")

Plant = Callable[[pytest.MonkeyPatch], None]


def _in_mechanism(change: Callable[[Mechanism], Mechanism]) -> Plant:
    build = solver.build_mechanism

    def plant(patch: pytest.MonkeyPatch) -> None:
        patch.setattr(solver, "build_mechanism", lambda *a: change(build(*a)))

    return plant


def _link_too_long(mechanism: Mechanism) -> Mechanism:
    """The tie rod 1e-7 mm longer than drawn."""
    place = mechanism.layout.scalar("squared length of link tie_rod_inner - tie_rod_outer")
    drawn = mechanism.drawn.copy()
    drawn[place] = (np.sqrt(drawn[place]) + 1e-7 / mechanism.unit) ** 2
    return replace(mechanism, drawn=drawn)


def _half_square_term(patch: pytest.MonkeyPatch) -> None:
    """The factor 2 of eq. (23) dropped in every row."""
    wrong = replace(NEWTON, square_velocity_term=lambda s, v: 0.5 * NEWTON.square_velocity_term(s, v))
    faulty = PointCoordinates("pointcoord-newton", wrong)
    patch.setattr(
        "validate.comparison.compare.formulation",
        lambda name: faulty if name == faulty.name else formulation(name),
    )


def _half_curvature(patch: pytest.MonkeyPatch) -> None:
    """In the powers that a map's series are summed with."""
    right = pointcoord.patches.evaluation.monomials

    def wrong(states: list[np.ndarray], order: int, room: np.ndarray | None = None) -> list[np.ndarray]:
        powers = right(states, order)
        of_rates = right([*states[:2], *(np.zeros_like(state) for state in states[2:])], order)
        return [*powers[:2], *(a - 0.5 * b for a, b in zip(powers[2:], of_rates[2:], strict=True))]

    patch.setattr(pointcoord.patches.evaluation, "monomials", wrong)


def _in_inputs(change: Callable[[np.ndarray], np.ndarray], late: float = 0.0) -> Plant:
    """What a model that states its accuracy gets of its inputs: pointcoord has laws of its own."""
    laws_of = validate.formulations.modelled.laws_of

    def wrong(scene: Scene, times: np.ndarray) -> dict[str, np.ndarray]:
        return {name: change(law) for name, law in laws_of(scene, times - late).items()}

    def plant(patch: pytest.MonkeyPatch) -> None:
        patch.setattr(validate.formulations.modelled, "laws_of", wrong)

    return plant


def _without(*orders: int) -> Callable[[np.ndarray], np.ndarray]:
    return lambda rates: rates * [0.0 if order in orders else 1.0 for order in range(rates.shape[-1])]


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


PAIR = ("pointcoord", "absolute")
# The fault, one of the paper's scenes that shows it, the quantity that it spoils, and who are compared.
FAULTS: dict[str, tuple[Plant, str, str, tuple[str, str]]] = {
    "a link 1e-7 mm too long": (_in_mechanism(_link_too_long), "bounce", "position", PAIR),
    "the factor 2 of eq. (23) dropped": (
        *(_half_square_term, "bounce", "acceleration"),
        ("pointcoord-newton", "absolute"),
    ),
    "the curvature of the map counted half": (
        *(_half_curvature, "bounce-and-steer", "acceleration"),
        ("pointcoord-map", "absolute"),
    ),
    "theta'' forgotten": (_in_inputs(_without(2)), "bounce", "acceleration", PAIR),
    "inputs late by 1e-10 s": (_in_inputs(_without(), 1e-10), "bounce", "position", PAIR),
    "the chassis' rates forgotten": (_chassis_at_rest, "bounce-on-a-heaving-chassis", "velocity", PAIR),
    "no Coriolis terms, in the tree": (
        *(_loops_at_rest, "bounce-and-steer", "acceleration"),
        ("pointcoord", "relative"),
    ),
}


# On a chassis that moves up and down, so that they show every fault.
HEAVE = {"heave": {"sine": {"amplitude": 20.0, "angular_frequency": 5.0}}}
OTHER_CARS = [name for name in CARS if name not in PAPER_SCENES]
ON_CARS = [*zip(FAULTS, cycle(("paper", *OTHER_CARS)), strict=False)]


@pytest.mark.parametrize(("name", "car"), ON_CARS)
def test_a_single_fault_makes_a_comparison_fail_that_agrees_without_it(
    name: str, car: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    plant, shown, spoils, (first, second) = FAULTS[name]
    scene = scene_with(car, laws=HEAVE) if car in OTHER_CARS else Scene.load(shown)
    assert compare(scene, first, second).agreed
    plant(monkeypatch)
    assert spoils in {row.quantity for row in compare(scene, first, second).disagreements}
