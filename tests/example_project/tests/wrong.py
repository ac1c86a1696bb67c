import pytest
from wishbone_solver import wrong


@pytest.mark.suspension_scenes("double-wishbone")
def test_the_wrong_solver_is_right(scene, plain_scene, assert_agrees):
    assert_agrees(wrong(plain_scene(scene)), scene, accuracy=1e-6)
