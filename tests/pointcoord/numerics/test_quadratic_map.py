"""The quadratic map against its definition, in exact arithmetic, and parts of it.

Where the numbers are small integers every operation of the map is exact, so equalities need no tolerance.
"""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from pointcoord.numerics.linear import factorise
from pointcoord.numerics.multi_index import powers
from pointcoord.numerics.partial_map import moving_part
from pointcoord.numerics.power_series import expand
from pointcoord.numerics.quadratic import Product, QuadraticMap, quadratic_map

Array = NDArray[np.float64]
U = np.finfo(float).eps / 2
SIZE, UNKNOWNS = 9, 5
seeds = st.integers(0, 2**32 - 1)
plain = settings(deadline=None)


def random_map(rng: np.random.Generator, most_terms: int = 5) -> QuadraticMap:
    rows = []
    for _ in range(UNKNOWNS):
        ends = rng.integers(0, SIZE, size=(rng.integers(1, most_terms + 1), 4)).tolist()
        rows.append(
            tuple(
                Product(float(rng.choice([-2.0, -1.0, 0.5, 1.0, 4.0])), (a, b), (c, d)) for a, b, c, d in ends
            )
        )
    return quadratic_map(rows, UNKNOWNS, SIZE)


def integers(rng: np.random.Generator, *shape: int) -> Array:
    return rng.integers(-1000, 1000, size=(*shape, SIZE)).astype(float)


def exact_rows(system: QuadraticMap, y: list[Fraction]) -> list[Fraction]:
    """sum c (y_a - y_b)(y_c - y_d) from the definition."""
    return [
        sum(
            (
                Fraction(p.coefficient) * (y[p.left[0]] - y[p.left[1]]) * (y[p.right[0]] - y[p.right[1]])
                for p in row
            ),
            Fraction(0),
        )
        for row in system.rows
    ]


@plain
@given(seed=seeds)
def test_residual_is_the_definition_and_the_diagonal_of_the_polar_form(seed: int) -> None:
    rng = np.random.default_rng(seed)
    system, y = random_map(rng), integers(rng)
    exact = [float(value) for value in exact_rows(system, [Fraction(v) for v in y])]
    assert system.residual(y).tolist() == exact
    assert system.polar(y, y).tolist() == exact


@plain
@given(seed=seeds)
def test_jacobian_applied_to_a_step_is_twice_the_polar_form(seed: int) -> None:
    rng = np.random.default_rng(seed)
    system, (y, h) = random_map(rng), integers(rng, 2)
    h[UNKNOWNS:] = 0.0
    assert np.array_equal(system.jacobian(y) @ h[:UNKNOWNS], 2.0 * system.polar(y, h))
    # and the polar form is what is left of C(y + h) when C(y) and C(h) are taken away
    assert np.array_equal(
        2.0 * system.polar(y, h), system.residual(y + h) - system.residual(y) - system.residual(h)
    )


@plain
@given(seed=seeds, batch=st.lists(st.integers(1, 3), max_size=3).map(tuple))
def test_batches_of_any_shape_give_the_numbers_of_their_members(seed: int, batch: tuple[int, ...]) -> None:
    rng = np.random.default_rng(seed)
    system, y, h = random_map(rng), integers(rng, *batch), integers(rng, *batch)
    weights, inverse = np.abs(h[..., :UNKNOWNS]) + 1.0, integers(rng, *batch, UNKNOWNS)[..., :UNKNOWNS]
    whole = (
        system.residual(y),
        system.polar(y, h),
        system.jacobian(y),
        system.uncertainty(y, np.abs(h)),
        system.lipschitz(inverse, weights),
    )
    for member in np.ndindex(*batch):
        one = (
            system.residual(y[member]),
            system.polar(y[member], h[member]),
            system.jacobian(y[member]),
            system.uncertainty(y[member], np.abs(h[member])),
            system.lipschitz(inverse[member], weights[member]),
        )
        for number, (all_of_them, alone) in enumerate(zip(whole, one, strict=True)):
            # Integers are exact; the rounding in the uncertainty (3) and the division by the weights in
            # the Lipschitz constant (4) may differ by the order of a sum: 32 terms at most.
            rounding = 32 * U if number in (3, 4) else 0.0
            assert np.allclose(all_of_them[member], alone, rtol=rounding, atol=0.0)


@plain
@given(seed=seeds, doubt=st.sampled_from([0.0, 2.0**-60, 2.0**-45, 2.0**-10]))
def test_uncertainty_bounds_the_error_of_the_residual_against_exact_arithmetic(
    seed: int, doubt: float
) -> None:
    rng = np.random.default_rng(seed)
    system = random_map(rng)
    # Close pairs far from zero, where differences cancel, and numbers of very different size.
    y = np.where(rng.random(SIZE) < 0.5, 1.0 + rng.normal(size=SIZE) * 1e-8, rng.normal(size=SIZE) * 100.0)
    data = doubt * rng.integers(0, 3, size=SIZE)
    for share in (rng.choice([-1.0, 1.0], size=SIZE), rng.integers(-4, 5, size=SIZE) / 4.0):
        true = [Fraction(v) + Fraction(d) * Fraction(s) for v, d, s in zip(y, data, share, strict=True)]
        computed, bound = system.residual(y), system.uncertainty(y, data)
        for value, limit, exact in zip(computed, bound, exact_rows(system, true), strict=True):
            # The bound itself is evaluated in fewer than 16 roundings.
            assert abs(Fraction(value) - exact) <= Fraction(limit) * (1 + Fraction(16 * U))


@plain
@given(seed=seeds)
def test_the_jacobian_moves_by_its_uncertainty_at_most_and_at_a_corner(seed: int) -> None:
    rng = np.random.default_rng(seed)
    system, y, data = random_map(rng), integers(rng, 4), np.abs(integers(rng, 4))
    bound = system.jacobian_uncertainty(data)
    for _ in range(5):
        moved = y + data * rng.integers(-1, 2, y.shape)
        assert (np.abs(system.jacobian(moved) - system.jacobian(y)) <= bound).all()
    # Of one product of four coordinates both differences move by two coordinates' worth.
    a, b, c, d = rng.permutation(SIZE)[:4].tolist()
    one = quadratic_map([(Product(-4.0, (a, b), (c, d)),)], UNKNOWNS, SIZE)
    corner = y.copy()
    corner[:, [a, c]] += data[:, [a, c]]
    corner[:, [b, d]] -= data[:, [b, d]]
    change = np.abs(one.jacobian(corner) - one.jacobian(y))
    assert np.array_equal(change, one.jacobian_uncertainty(data))


def test_row_without_terms_and_unknown_coordinate_are_refused() -> None:
    good = (Product(1.0, (0, 1), (2, 3)),)
    with pytest.raises(ValueError, match="row 1 has no terms"):
        quadratic_map([good, ()], 2, 4)
    for bad in ((0, 4), (-1, 0)):
        with pytest.raises(ValueError, match=r"row 0.*outside 0\.\.3"):
            quadratic_map([(Product(1.0, bad, (2, 3)),)], 2, 4)
    for coefficient in (3.0, 0.0, -0.75, float("nan")):
        with pytest.raises(ValueError, match=r"row 0.*no power of two"):
            quadratic_map([(Product(coefficient, (0, 1), (2, 3)),)], 2, 4)


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
