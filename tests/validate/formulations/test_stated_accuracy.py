"""What a stated accuracy makes of every number: wide enough for who keeps it, and for nobody else."""

import numpy as np
import pytest
from cars_in_closed_form import VARIANTS
from mechanism_files import scene_file
from plain_solvers import closed_form, less_exact

from pointcoord import Scene
from pointcoord.effects.registry import QUANTITIES
from validate.cars.car import content_of
from validate.cars.input_ends import drawn_inputs, end
from validate.comparison.compare import Outcome, compare
from validate.formulations.modelled import Problem, asked_of
from validate.formulations.protocol import NOTHING
from validate.formulations.stated_accuracy import accuracy_for
from validate.formulations.trees import closed_in
from validate.hard.subjects import ASKED, scene_content
from validate.peers.in_pinocchio import InPinocchio
from validate.peers.motion import numbers
from validate.solvers.plain import PlainSolver, Solve
from validate.studies.claims import scene_rows
from validate.studies.study import Task

# Every closure of each: the closed form has a collinear strut's axis through the ball joint.
CARS = [variant.base for variant in VARIANTS]
by_car = pytest.mark.parametrize("car", CARS, ids=lambda car: f"{car.suspension}-{car.closure}")
MOVING = {"arm_angle": (1.6, 0.12, -0.3), "rack": (4.0, -25.0, 40.0), "heave": (0.0, 30.0, -20.0)}


def moving(car) -> Scene:
    return Scene.from_mapping(
        content_of(car, MOVING, effects=ASKED, start=-0.5, stop=0.5, samples=5), "moving"
    )


def compared(solver: Solve, scene: Scene, accuracy: float) -> Outcome:
    return compare(scene, PlainSolver("mine", solver, accuracy), "pointcoord")


def by_quantity(outcome: Outcome) -> dict[str, float]:
    """The largest share of its tolerance that a quantity uses up; of each angle by itself."""
    shares: dict[str, float] = {}
    for row in outcome.rows:
        key = row.name if QUANTITIES[row.quantity].of == "car" else row.quantity
        shares[key] = max(shares.get(key, 0.0), row.share)
    return shares


@by_car
def test_a_right_solver_agrees_in_everything_down_to_nearly_rounding(car) -> None:
    for accuracy in (1e-3, 1e-6, 1e-10):
        outcome = compared(closed_form, moving(car), accuracy)
        assert {row.verdict for row in outcome.rows} == {"agrees"}, by_quantity(outcome)


@by_car
def test_a_solver_is_held_to_what_it_states(car) -> None:
    scene, solver = moving(car), less_exact(1e-3, seed=1)
    kept = compared(solver, scene, 1e-3)
    assert kept.passed, by_quantity(kept)
    broken = compared(solver, scene, 1e-9)
    assert not broken.passed
    assert all(share > 1.0 for share in by_quantity(broken).values())
    # The tolerance is that of this accuracy and of no far larger one: every quantity uses up a part of it.
    # The kingpin of a collinear strut is the line to strut_lower, and a shorter one turns by more: that is
    # allowed, but a car whose points are in line does not do it.
    shorter = 1.0
    if car.closure == "collinear":
        ball, lower, top = (np.array(car.points[n]) for n in ("lower_ball_joint", "strut_lower", "strut_top"))
        shorter = float(np.linalg.norm(lower - ball) / np.linalg.norm(top - ball))
    least = {"kingpin": 2e-3 * shorter, "caster": 2e-3 * shorter}
    shares = by_quantity(kept)
    assert all(share > least.get(name, 2e-3) for name, share in shares.items()), (shorter, shares)


def near_the_end(car, distance: float) -> Scene:
    """Instants at a distance from the last reachable rack travel, in parts of the way there; at rest."""
    home = drawn_inputs(car)
    last = end(car, home, "rack", True)
    assert last is not None
    rack = last.value + distance * (home["rack"] - last.value)
    return Scene.from_mapping(scene_content(car, home["arm_angle"], (rack, 1.0)), "near")


@by_car
def test_near_a_fold_the_tolerance_grows_as_the_pose_does(car) -> None:
    wide = {}
    for distance in (1e-3, 1e-5, 1e-7):
        scene = near_the_end(car, distance)
        claims = accuracy_for(scene, 1e-10).claims
        wide[distance] = [claims[q]["wheel_centre"].max() for q in ("position", "velocity", "acceleration")]
        assert compared(closed_form, scene, 1e-10).passed, distance
    # At a distance d of a fold position, velocity and acceleration change with d^-1/2, d^-3/2 and d^-5/2.
    for near, far in ((1e-5, 1e-3), (1e-7, 1e-5)):
        grown = np.log10(np.array(wide[near]) / np.array(wide[far])) / 2.0
        np.testing.assert_allclose(grown, [0.5, 1.5, 2.5], atol=0.2)


def test_of_a_number_that_does_not_exist_at_an_instant_nothing_is_said_there() -> None:
    content = scene_file("semi-trailing-arm")
    # Of the three instants at the second the pivot is right above the wheel centre, which goes along the car.
    pivots = {"pivot_inner": [1350, -420, 420], "pivot_outer": [1350, -620, 420]}
    content["mechanism"]["points"] |= pivots
    content |= {
        "effects": ["camber", "toe_by_travel", "roll_centre"],
        "inputs": {"arm_turn": {"polynomial": [-0.125, 0.125]}},
        "time": {"start": 0.0, "stop": 2.0, "samples": 3},
    }
    claims = accuracy_for(Scene.from_mapping(content, "arm"), 1e-9).claims
    assert claims["wheel"]["camber"].max() < 1e-10
    for claim in (claims["dimension"]["roll_centre_height"], claims["angle_gradient"]["toe_by_travel"]):
        assert claim[1] == NOTHING
        assert claim[[0, 2]].max() < 1e-5


MODELS = ("pointcoord", "absolute", "relative", "mujoco", "exudyn")
# Numbers of random cars, among them such that are driven up to a fold.
CARS_AT_RANDOM = (0, 18, 39, 51)


@pytest.mark.parametrize("name", MODELS)
def test_what_a_model_states_of_itself_covers_its_errors_and_is_near_to_them(name: str) -> None:
    rows = [
        row
        for number in CARS_AT_RANDOM
        for row in scene_rows(Task("scenes", number), name)
        if row.get("quantity") is not None
    ]
    error, claim = np.array([(row["error"], row["claim"]) for row in rows]).T
    assert (error <= claim).all()
    # Rates of the two programs, whose joints form the longest chains, are held most widely.
    off = error > 0.0
    assert np.median(claim[off] / error[off]) < 600.0


def test_it_covers_what_an_early_end_of_newtons_method_leaves() -> None:
    scene = Scene.load("double-wishbone")
    problem, (program, home) = Problem.of(scene), closed_in(InPinocchio, scene, 1e-10)
    tree, series = program.tree, program.tree.series(problem.laws)
    best, coarse = (program.motion(series, tolerance, home) for tolerance in (1e-10, 1e-2))
    exact, found = (numbers(tree, problem.laws, motion) for motion in (best, coarse))
    solution = problem.solution("relative", found, tree.accuracy(coarse.last_step))
    asked = asked_of(exact, scene)
    for quantity, arrays in solution.numbers.items():
        for point, array in arrays.items():
            gap = np.abs(array - asked[quantity][point])
            assert (gap <= solution.accuracy.claims[quantity][point]).all(), (quantity, point)
    assert max(np.abs(found["position"][n] - exact["position"][n]).max() for n in found["position"]) > 1e-9


def test_tolerances_of_slow_rates_are_in_proportion_to_them() -> None:
    """Squares of such rates underflow."""

    def tolerances(rate: float) -> np.ndarray:
        scene = Scene.from_mapping(scene_content(CARS[0], [1.57, rate], [0.0], samples=1), "slow")
        return accuracy_for(scene, 1e-6).claims["velocity"]["lower_ball_joint"]

    assert tolerances(1e-175) == pytest.approx(1e-150 * tolerances(1e-25), rel=1e-9, abs=0.0)
