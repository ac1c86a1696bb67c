"""Groups of bodies, and the signs of their determinants."""

import numpy as np
import pytest
from numpy.typing import NDArray

import absolute
from absolute.groups import groups_of
from absolute.mechanism import Mechanism

Array = NDArray[np.float64]


def jacobians(mechanism: Mechanism, turns: Array, seed: int) -> Array:
    """At random poses, each body moved and turned from the drawing by about so much one way."""
    ways = np.outer(turns, np.random.default_rng(seed).normal(size=mechanism.stack.count))
    drawn = mechanism.poses(mechanism.drawn).rotation
    q = np.array([mechanism.moved(mechanism.drawn, drawn, way) for way in ways])
    return mechanism.stack.jacobian(mechanism.stack.place(*mechanism.poses(q)))


@pytest.mark.parametrize("seed", range(3))
def test_the_signs_of_groups_multiply_to_that_of_the_whole_on_both_sides_of_a_fold(
    model: absolute.Model, seed: int
) -> None:
    mechanism = Mechanism(model)
    many = jacobians(mechanism, np.linspace(-2.0, 2.0, 400), seed)
    signs = mechanism.signs(many)
    assert any((sign > 0).any() and (sign < 0).any() for sign in signs.T)
    # Both orders of rows and columns change the sign of the whole determinant alike everywhere.
    whole = signs.prod(axis=1) * np.sign(np.linalg.det(many))
    assert (whole == whole[0]).all()


def test_a_driven_link_is_a_group_of_its_own(model: absolute.Model) -> None:
    # The lower arm and its angle, the end of the rod in the rack, and what hangs between these.
    assert Mechanism(model).groups.ends in ((6, 12, 18, 24), (6, 12, 24), (6, 18, 24))


def test_bodies_that_no_smaller_number_fixes_are_one_group() -> None:
    # Six rows between body 1 and body 2, six between body 2 and the chassis and body 1: no body alone.
    first, second = np.array([0] * 3 + [1] * 6 + [0] * 3), np.array([1] * 3 + [2] * 6 + [2] * 3)
    assert groups_of(first, second, 3).ends == (12,)
