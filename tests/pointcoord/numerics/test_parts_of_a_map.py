"""What moves when some known coordinates do, as a map of its own, against the whole."""

import numpy as np
import pytest

from pointcoord.numerics.linear import factorise
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
            Product(3.0, (2, ZERO), (ONE, ZERO)),
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


def test_where_nothing_moves_the_part_is_the_whole() -> None:
    assert moving_part(SYSTEM, frozenset()).is_whole


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
