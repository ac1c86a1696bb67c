"""Poses at instants, however they are solved: how far one is proven, what is left of it, what it costs."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from numpy.typing import NDArray

from pointcoord.errors import AssemblyError
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics import newton
from pointcoord.numerics.counters import Work
from pointcoord.numerics.linear import Factors, factorise
from pointcoord.numerics.quadratic import Product, QuadraticMap, quadratic_map
from pointcoord.solve import assembly, follower, pointwise, proven_path, standing_still
from pointcoord.solve.assembly import Pose, assemble
from pointcoord.solve.pointwise import InstantSolver, Solved, solve_from_drawing, solve_instants
from pointcoord.solve.proven_step import ROOM
from pointcoord.time_functions import Polynomial, Sine, TimeFunction

Array = NDArray[np.float64]
solve_by_chord = partial(solve_instants, chord=True)
WAYS = {"newton": solve_instants, "chord": solve_by_chord, "newton-cold": solve_from_drawing}
by_way = pytest.mark.parametrize("way", WAYS.values(), ids=WAYS.keys())
SWING: dict[str, TimeFunction] = {"arm_angle": Sine(0.2, 2.0, 0.0, 1.5), "rack": Sine(10.0, 3.0)}
# Past the last angle, 152.013 degrees, at t = 1.153 s.
PAST: dict[str, TimeFunction] = {"arm_angle": Polynomial((1.5, 1.0)), "rack": Polynomial((0.0,))}

# u^2 = w in y = (u, w, 0, 1), at u = w = 1.
PARABOLA = quadratic_map([(Product(1.0, (0, 2), (0, 2)), Product(-1.0, (1, 2), (3, 2)))], unknowns=1, size=4)
AT_ONE = np.array([1.0, 1.0, 0.0, 1.0])


def start_of(mechanism: Mechanism, functions: dict[str, TimeFunction]) -> Pose:
    return assemble(mechanism, {name: f.series(0.0, 0)[..., 0] for name, f in functions.items()})


@pytest.mark.parametrize(
    ("way", "proven"), [(-1.1, 0), (-0.91, 0), (-0.89, 1), (0.89, 1), (0.91, 0), (1.1, 0)]
)
def test_the_next_pose_is_proven_as_far_as_the_condition_holds(way: float, proven: int) -> None:
    # Along w = 1 + s dw: z = |dw| / 2, eta = dw^2 / 8 and omega = 1, so z + sqrt(2 omega eta) is |dw|.
    assert ROOM == 0.9
    factors = factorise(PARABOLA.jacobian(AT_ONE))
    found = pointwise._proven_ahead(PARABOLA, AT_ONE, factors, np.array([[1.0 + way, 0.0, 1.0]]), 0.0)
    assert len(found.left) == proven


def test_a_guess_is_the_series_of_the_root_to_its_third_term() -> None:
    way = np.array([-0.5, 0.1, 0.7])
    targets = np.stack([1.0 + way, 0.0 * way, 1.0 + 0.0 * way], axis=-1)
    inverse = factorise(PARABOLA.jacobian(AT_ONE)).preconditioner
    guess = pointwise._guessed(PARABOLA, inverse, AT_ONE, targets)
    np.testing.assert_allclose(guess[:, 0], 1.0 + way / 2.0 - way**2 / 8.0 + way**3 / 16.0, rtol=1e-14)
    np.testing.assert_array_equal(guess[:, 1:], targets)


@pytest.mark.parametrize("way", [solve_instants, solve_by_chord, solve_from_drawing])
def test_poses_are_solved_to_rounding_unless_a_tolerance_allows_more(
    strut: Mechanism, way: Callable[..., Solved]
) -> None:
    times = np.linspace(0.0, 1.0, 12)
    found = way(strut, SWING, start_of(strut, SWING), times, 0)
    exact = assemble(strut, {name: f.series(times, 0)[..., 0] for name, f in SWING.items()})
    assert (found.left == 0.0).all()
    # Each of the two ends with a Newton step that has shrunk to rounding, of coordinates up to 2.
    off = np.abs(found.states[0] - exact.y).max(axis=-1)
    assert (off <= 8.0 * np.finfo(float).eps * exact.condition).all()


@by_way
def test_a_motion_is_told_to_end_at_the_first_instant_that_has_no_pose(
    strut: Mechanism, way: InstantSolver
) -> None:
    times = np.linspace(0.0, 1.5, 31)
    solved = way(strut, PAST, start_of(strut, PAST), times, 0, pointwise.square_velocity_term, 1e-12)
    error = solved.status.error()
    assert isinstance(error, AssemblyError)
    assert (solved.times < 1.1532).all()
    assert len(solved.times) == 24
    assert error.instant == times[24]
    assert error.wanted["arm_angle"] == pytest.approx(1.5 + times[24])


def test_one_factorisation_serves_many_instants_by_chord(strut: Mechanism) -> None:
    times = np.linspace(0.0, 1.0, 400)
    solved = solve_by_chord(strut, SWING, start_of(strut, SWING), times, 0)
    assert len(solved.times) == 400
    assert solved.work.factorisations < 40


@by_way
@pytest.mark.parametrize("derivative", [0, 1, 2])
def test_factorisations_and_rates_are_counted_as_they_are_made(
    strut: Mechanism, monkeypatch: pytest.MonkeyPatch, way: InstantSolver, derivative: int
) -> None:
    pose, times, seen = start_of(strut, SWING), np.linspace(0.0, 1.0, 30), []

    def counted(matrix: Array) -> Factors:
        seen.append(int(np.prod(matrix.shape[:-2])))
        return factorise(matrix)

    for module in (newton, assembly, follower, proven_path, pointwise, standing_still):
        monkeypatch.setattr(module, "factorise", counted)
    if way is solve_from_drawing:
        # It closes the drawing as well, which has factors of its own.
        monkeypatch.setattr(pointwise, "close_drawing", lambda *_: replace(closed, work=Work()))
        closed = assembly.close_drawing(strut)
        seen.clear()
    work = way(strut, SWING, pose, times, derivative, pointwise.square_velocity_term, 1e-10).work
    assert work.factorisations == sum(seen)
    assert work.rate_solves == derivative * 30
    assert work.unknowns_solved == derivative * 30 * strut.map.unknowns


def test_residuals_by_chord_are_counted_one_by_one(strut: Mechanism, monkeypatch: pytest.MonkeyPatch) -> None:
    pose, whole, seen = start_of(strut, SWING), QuadraticMap.residual, []

    def counted(system: QuadraticMap, y: Array) -> Array:
        seen.append(1)
        return whole(system, y)

    targets = strut.known_series({name: f.series(np.array([0.01, 0.02]), 0) for name, f in SWING.items()})
    monkeypatch.setattr(QuadraticMap, "residual", counted)
    for tolerance in (0.0, 1e-9):
        seen.clear()
        reached = pointwise._by_chord(strut.map, pose.y, pose.factors, targets[:, 0], tolerance)
        assert len(reached.left) == 2
        assert reached.work.residuals == len(seen)
