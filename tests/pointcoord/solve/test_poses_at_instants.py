"""Poses at instants, however they are solved: how far one is proven, what is left of it, what it costs."""

from functools import partial

import numpy as np
import pytest

from pointcoord.errors import AssemblyError
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.linear import factorise
from pointcoord.numerics.quadratic import Product, quadratic_map
from pointcoord.solve import pointwise
from pointcoord.solve.assembly import Pose, assemble
from pointcoord.solve.pointwise import InstantSolver, solve_from_drawing, solve_instants
from pointcoord.solve.proven_step import ROOM
from pointcoord.time_functions import Polynomial, Sine, TimeFunction

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
