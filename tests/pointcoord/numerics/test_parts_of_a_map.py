"""What moves when some known coordinates do, as a map of its own, against the whole."""

import numpy as np
import pytest

from pointcoord.numerics.linear import factorise
from pointcoord.numerics.multi_index import powers
from pointcoord.numerics.partial_map import moving_part
from pointcoord.numerics.power_series import expand
from pointcoord.numerics.quadratic import Product, QuadraticMap, quadratic_map

# y = (three unknowns, two inputs, 0, 1). The first unknown is driven by the first input, the second by the
# second input, and the third by the two other unknowns.
FIRST, SECOND, ZERO, ONE = 3, 4, 5, 6
SYSTEM: QuadraticMap = quadratic_map(
    [
        (
            Product(1.0, (2, 0), (2, 1)),
            Product(4.0, (2, ZERO), (ONE, ZERO)),
            Product(-2.0, (1, ZERO), (0, 1)),
        ),
        (Product(1.0, (0, ZERO), (0, ONE)), Product(-1.0, (FIRST, ZERO), (ONE, ZERO))),
        (Product(2.0, (1, ZERO), (1, FIRST)), Product(-1.0, (SECOND, ZERO), (ONE, ZERO))),
    ],
    unknowns=3,
    size=7,
)


def poses(batch: tuple[int, ...]) -> np.ndarray:
    """Whole numbers, the unknowns so far apart that no row loses its own."""
    y = np.random.default_rng(1).integers(2, 9, (*batch, 7)).astype(float)
    y += [0.0, 10.0, 30.0, 0.0, 0.0, 0.0, 0.0]
    y[..., [ZERO, ONE]] = 0.0, 1.0
    return y


@pytest.mark.parametrize(
    ("driven", "rows", "unknowns"), [({SECOND}, [0, 2], [1, 2]), ({FIRST}, [0, 1, 2], [0, 1, 2])]
)
@pytest.mark.parametrize("batch", [(), (4,), (2, 3)])
def test_a_part_has_the_rows_of_what_moves_and_their_jacobian(
    driven: set[int], rows: list[int], unknowns: list[int], batch: tuple[int, ...]
) -> None:
    part, y = moving_part(SYSTEM, frozenset(driven)), poses(batch)
    assert part.is_whole == (len(rows) == 3)
    own = part.taken(y)
    assert np.array_equal(part.system.residual(own), SYSTEM.residual(y)[..., rows])
    jacobian = SYSTEM.jacobian(y)[..., rows, :][..., unknowns]
    assert np.array_equal(part.system.jacobian(own), jacobian)
    assert np.array_equal(part.back(own), y)


@pytest.mark.parametrize("batch", [(), (4,), (2, 3)])
@pytest.mark.parametrize("alike", [False, True])
def test_the_series_of_a_part_is_that_of_the_whole(batch: tuple[int, ...], alike: bool) -> None:
    """With laws for each pose, or one law for all of them."""
    order, y, rng = 6, poses(batch), np.random.default_rng(2)
    part = moving_part(SYSTEM, frozenset({SECOND}))
    known = np.zeros((order + 1, 4) if alike else (*batch, order + 1, 4))
    known[..., 1:, SECOND - 3] = rng.integers(-3, 4, known[..., 1:, 0].shape)
    whole = expand(SYSTEM, factorise(SYSTEM.jacobian(y)), y, known)
    own = part.taken(y)
    series = part.known(own, known)
    assert series.shape == (*batch, order + 1, 5)
    found = part.back(expand(part.system, factorise(part.system.jacobian(own)), own, series))
    size = np.abs(whole).max(axis=-1, keepdims=True)
    # Some operations an order, of condition numbers below 1e3.
    assert (np.abs(found - whole) <= 1e-12 * size).all()


@pytest.mark.parametrize("batch", [(), (3,)])
@pytest.mark.parametrize("driven", [((0,), (1,)), ((1,), (0,)), ((0, 1), (1,)), ((0, 1), (0, 1))])
def test_series_in_two_inputs_are_those_in_one_along_every_line(
    batch: tuple[int, ...], driven: tuple[tuple[int, ...], ...]
) -> None:
    """Along s = (a t, b t) the powers of degree d sum to the d-th coefficient in t, by whatever stages."""
    order, y, rng = 5, poses(batch), np.random.default_rng(5)
    every = powers(2, order)
    known = np.zeros((*batch, every.count, 4))
    known[..., 0, :] = y[..., 3:]
    for column, inputs in zip((FIRST - 3, SECOND - 3), driven, strict=True):
        others = [i for i in (0, 1) if i not in inputs]
        own = np.flatnonzero(~every.exponents[:, others].any(axis=-1))[1:]
        known[..., own, column] = rng.integers(-3, 4, (*batch, len(own)))
    factors = factorise(SYSTEM.jacobian(y))
    found = expand(SYSTEM, factors, y, known, inputs=2)
    # Carried on from any whole degree, to the same.
    begun = found[..., : every.first_of(3), :]
    again = expand(SYSTEM, factors, y, known, begun, inputs=2)
    assert (np.abs(again - found) <= 1e-12 * np.abs(found).max(axis=-1, keepdims=True)).all()
    for a, b in ((1.0, 0.0), (0.0, 1.0), (1.0, -2.0), (0.5, 1.5)):
        weights = (np.array([a, b]) ** every.exponents).prod(axis=-1)
        degree = every.exponents.sum(axis=-1) == np.arange(order + 1)[:, None]
        line = (weights * degree) @ known
        whole = expand(SYSTEM, factors, y, line)
        summed = (weights * degree) @ found
        # Some operations a power, of condition numbers below 1e3; what is summed may cancel.
        size = (np.abs(weights) * degree) @ np.abs(found)
        assert (np.abs(summed - whole) <= 1e-11 * size.max(axis=-1, keepdims=True)).all()
