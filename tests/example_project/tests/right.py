import pytest
from wishbone_solver import solve


@pytest.mark.suspension_scenes(hard=True, suspension="double_wishbone")
def test_the_solver_is_right(scene, plain_scene, assert_agrees):
    assert_agrees(solve(plain_scene(scene)), scene, accuracy=1e-6)


@pytest.mark.impossible_scenes(suspension="double_wishbone")
def test_the_solver_refuses_what_cannot_be(scene, assert_refuses):
    assert_refuses(solve, scene)
