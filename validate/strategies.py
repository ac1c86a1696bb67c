"""Random cars, motions and near-singular poses for property-based tests; the extra `strategies` brings them.

from hypothesis import given
from validate.solvers.plain import given_to_solver
from validate.strategies import scenes

@given(scenes(solvable=True))
def test_my_solver_is_right(scene):
    assert_agrees(solve(given_to_solver(scene)), scene, accuracy=1e-6)
"""

from validate.cars.strategies import cars, inputs, mechanisms, near_singular, scenes

__all__ = ["cars", "inputs", "mechanisms", "near_singular", "scenes"]
