"""Random cars, motions and near-singular poses for property-based tests; the extra `strategies` brings them.

    from hypothesis import given, settings
    from my_solver import solve
    from validate.strategies import scenes

    @settings(deadline=None)  # the comparison itself takes some tenths of a second
    @given(scene=scenes(suspension="double_wishbone"))
    def test_my_solver_is_right(scene, plain_scene, assert_agrees):
        assert_agrees(solve(plain_scene(scene)), scene, accuracy=1e-6)

| strategy | what is drawn |
|---|---|
| `mechanisms()` | a car, as the `mechanism` of a scene's content |
| `inputs(mechanism)` | laws of its inputs that it can follow, as the `inputs` of a scene's content |
| `scenes()` | a scene of a car with such inputs |
| `near_singular()` | one instant of a car close to where it locks |

`suspension`, `closure` and `turns` say which cars a solver can be asked. pointcoord solves every example,
none is drawn and thrown away, and the least example is a car in whole millimetres at its drawing.
"""

from validate.cars.accepted import inputs, mechanisms, near_singular, scenes

__all__ = ["inputs", "mechanisms", "near_singular", "scenes"]
