"""Groups of bodies give the inverse of the whole Jacobian."""

import numpy as np
import pytest
from numpy.typing import NDArray

import absolute
from absolute.groups import SERVES, groups_of, inverses, times
from absolute.mechanism import Mechanism

Array = NDArray[np.float64]


def jacobians(mechanism: Mechanism, turns: Array, seed: int = 4) -> Array:
    """At random poses, each body moved and turned from the drawing by about so much one way."""
    ways = np.outer(turns, np.random.default_rng(seed).normal(size=mechanism.stack.count))
    drawn = mechanism.poses(mechanism.drawn).rotation
    q = np.array([mechanism.moved(mechanism.drawn, drawn, way) for way in ways])
    return mechanism.stack.jacobian(mechanism.stack.place(*mechanism.poses(q)))


@pytest.mark.parametrize("furthest", [0.0, 1e-3, 0.1, 1.0])
@pytest.mark.parametrize("count", [1, 3, 33, 100])
def test_shared_inverses_are_those_of_each_whole_jacobian(
    model: absolute.Model, furthest: float, count: int
) -> None:
    mechanism = Mechanism(model)
    many = jacobians(mechanism, np.linspace(0.0, furthest, count))
    right_hand = np.random.default_rng(5).normal(size=(count, mechanism.stack.count))
    inverse, signs = inverses(mechanism.groups, many)
    found, expected = (
        times(mechanism.groups, inverse, right_hand),
        np.linalg.solve(many, right_hand[..., None]),
    )
    # Off by SERVES in each block, and by that once more for what one block hands on to the next.
    off = np.abs(found - expected[..., 0]).max(axis=1) / np.linalg.norm(np.linalg.inv(many), axis=(1, 2))
    assert off.max() <= 10.0 * SERVES * np.linalg.norm(right_hand, axis=1).max()
    assert np.array_equal(signs, mechanism.signs(many))
    # Both orders of rows and columns change the sign of the whole determinant alike everywhere.
    whole = signs.prod(axis=1) * np.sign(np.linalg.det(many))
    assert (whole == whole[0]).all()


def test_instants_on_both_sides_of_a_fold_have_their_own_signs(model: absolute.Model) -> None:
    mechanism = Mechanism(model)
    signs = [
        inverses(mechanism.groups, jacobians(mechanism, np.linspace(-2.0, 2.0, 400), seed))
        for seed in range(3)
    ]
    plain = [mechanism.signs(jacobians(mechanism, np.linspace(-2.0, 2.0, 400), seed)) for seed in range(3)]
    assert all(np.array_equal(sign, each) for (_, sign), each in zip(signs, plain, strict=True))
    assert any((sign > 0).any() and (sign < 0).any() for each in plain for sign in each.T)


def test_a_driven_link_is_a_group_of_its_own(model: absolute.Model) -> None:
    # The lower arm and its angle, the end of the rod in the rack, and what hangs between these.
    assert Mechanism(model).groups.ends in ((6, 12, 18, 24), (6, 12, 24), (6, 18, 24))


def test_bodies_that_no_smaller_number_fixes_are_one_group() -> None:
    # Six rows between body 1 and body 2, six between body 2 and the chassis and body 1: no body alone.
    first, second = np.array([0] * 3 + [1] * 6 + [0] * 3), np.array([1] * 3 + [2] * 6 + [2] * 3)
    assert groups_of(first, second, 3).ends == (12,)


def test_a_singular_block_spoils_no_other_instant(model: absolute.Model) -> None:
    mechanism = Mechanism(model)
    many = jacobians(mechanism, np.linspace(0.0, 1.0, 5))
    plain, _ = inverses(mechanism.groups, many.copy())
    flat = many.swapaxes(-1, -2).copy()
    flat[2] = 0.0
    found, signs = inverses(mechanism.groups, flat.swapaxes(-1, -2))
    assert np.isnan(found[2]).any()
    assert (signs[2] == 0.0).all()
    others = [0, 1, 3, 4]
    assert np.allclose(found[others], plain[others], rtol=10.0 * SERVES, atol=10.0 * SERVES)
    assert (signs[others] != 0.0).all()
