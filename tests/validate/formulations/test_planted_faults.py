"""A comparison is worth what it catches: each single fault, planted in one formulation, must be seen."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from importlib import import_module
from itertools import cycle

import numpy as np
import pytest
from changed_scenes import scene_with
from sample_cars import CARS

import absolute
import absolute.rows
import pointcoord.patches.evaluation
import pointcoord.patches.patches
import pointcoord.results.readout
import pointcoord.solve.dense_output
import pointcoord.solve.taylor
import validate.formulations.modelled
from pointcoord import Scene
from pointcoord.effects.point_states import STATES
from pointcoord.effects.registry import QUANTITIES
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.method import NEWTON
from validate.comparison.compare import compare, compare_solutions
from validate.formulations.asked_numbers import per_second
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


def _in_powers_of_inputs(change: Callable[[list[np.ndarray], list[np.ndarray]], list[np.ndarray]]) -> Plant:
    """In the powers that a map's series are summed with: those of the rates alone are handed over too."""
    right = pointcoord.patches.evaluation.monomials

    def wrong(states: list[np.ndarray], order: int, room: np.ndarray | None = None) -> list[np.ndarray]:
        without_push = [*states[:2], *(np.zeros_like(state) for state in states[2:])]
        return change(right(states, order), right(without_push, order))

    return lambda patch: patch.setattr(pointcoord.patches.evaluation, "monomials", wrong)


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


@dataclass(frozen=True)
class Fault:
    """Where a fault goes, one of the paper's scenes that shows it, and the quantity that it spoils."""

    plant: Plant
    scene: str
    spoils: str
    first: str = "pointcoord"
    second: str = "absolute"


FAULTS = {
    "a link 1e-7 mm too long": Fault(_in_mechanism(_link_too_long), "bounce", "position"),
    "the factor 2 of eq. (23) dropped": Fault(
        _half_square_term, "bounce", "acceleration", "pointcoord-newton"
    ),
    "the curvature of the map counted half": Fault(
        _in_powers_of_inputs(
            lambda p, r: [*p[:2], *(a - 0.5 * b for a, b in zip(p[2:], r[2:], strict=True))]
        ),
        "bounce-and-steer",
        "acceleration",
        "pointcoord-map",
    ),
    "theta'' forgotten": Fault(_in_inputs(_without(2)), "bounce", "acceleration"),
    "inputs late by 1e-10 s": Fault(_in_inputs(_without(), 1e-10), "bounce", "position"),
    "the chassis' rates forgotten": Fault(_chassis_at_rest, "bounce-on-a-heaving-chassis", "velocity"),
    "no Coriolis terms, in the tree": Fault(
        _loops_at_rest, "bounce-and-steer", "acceleration", second="relative"
    ),
}


OWN_SCENES = {name: Scene.load(name) for name in PAPER_SCENES}
# On a chassis that moves up and down, so that they show every fault.
HEAVE = {"heave": {"sine": {"amplitude": 20.0, "angular_frequency": 5.0}}}
OTHER_CARS = {name: scene_with(name, laws=HEAVE) for name in CARS if name not in PAPER_SCENES}


def shown(name: str, car: str) -> Scene:
    """A scene of a car that shows a fault."""
    return OTHER_CARS[car] if car in OTHER_CARS else OWN_SCENES[FAULTS[name].scene]


ON_CARS = [*zip(FAULTS, cycle(("paper", *OTHER_CARS)), strict=False)]


@pytest.mark.parametrize("car", ["paper", *OTHER_CARS])
def test_without_a_fault_these_comparisons_agree(car: str) -> None:
    faults = {name: FAULTS[name] for name, on in ON_CARS if on == car}
    pairs = {(shown(name, car).title, fault.first, fault.second): name for name, fault in faults.items()}
    for name in pairs.values():
        assert compare(shown(name, car), FAULTS[name].first, FAULTS[name].second).agreed


@pytest.mark.parametrize(("name", "car"), ON_CARS)
def test_a_single_fault_makes_the_comparison_fail(
    name: str, car: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    fault, scene = FAULTS[name], shown(name, car)
    fault.plant(monkeypatch)
    outcome = compare(scene, fault.first, fault.second)
    assert fault.spoils in {row.quantity for row in outcome.disagreements}


NEAR = 1e-11  # relative: a hundred thousand roundings, which a tolerance for a whole motion let pass
FURTHER = 1e-9  # of derivatives from the fourth on, whose errors are sums of many terms
# Of the derivatives that follow on the jerk, one, which has no name.
LAST = "derivative_9"
RATES = [
    name
    for name, q in QUANTITIES.items()
    if per_second(name) and q.of != "car" and name not in {*STATES[4:]} - {LAST}
]


def _scaled(quantity: str, arrays: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    near = FURTHER if quantity in STATES[4:] else NEAR
    return {name: array * (1.0 + near) for name, array in arrays.items()}


@pytest.mark.parametrize(("name", "other"), [("off-axis-strut", "absolute"), ("double-wishbone", "relative")])
def test_rates_a_little_off_are_seen_and_so_is_one_number_at_one_instant(name: str, other: str) -> None:
    """Of every point, body and angle: off by a ten millionth of the largest number of its quantity."""
    scene = scene_with(name, samples=11)
    if other != "relative":
        scene = scene.model_copy(update={"effects": (*scene.effects, *STATES[3 : STATES.index(LAST) + 1])})
    ours, theirs = (formulation(who).solve(scene) for who in ("pointcoord", other))

    def disagree(quantity: str, arrays: Mapping[str, np.ndarray]) -> list[tuple[str, str]]:
        faulty = theirs.with_numbers({quantity: arrays})
        outcome = compare_solutions(scene, ours, faulty, name)
        return [(row.quantity, row.name) for row in outcome.disagreements]

    for quantity, arrays in theirs.numbers.items():
        if quantity in RATES:
            assert {q for q, _ in disagree(quantity, _scaled(quantity, arrays))} == {quantity}
        largest = max(float(np.abs(array).max()) for array in arrays.values())
        for part, array in arrays.items():
            wrong = array.copy()
            wrong[len(wrong) // 2] += 1e-7 * largest
            assert disagree(quantity, {**arrays, part: wrong}) == [(quantity, part)]
