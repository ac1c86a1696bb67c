"""Members as columns give what the plain form gives them one by one."""

from fractions import Fraction

import numpy as np
import pytest
from numpy.typing import NDArray

from pointcoord import Scene
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.batch_last.block_proof import block_proof, kantorovich_radius
from pointcoord.numerics.batch_last.column_map import ColumnMap, column_map
from pointcoord.numerics.batch_last.elimination import Elimination, eliminate_like
from pointcoord.numerics.batch_last.mixed_series import MixedSeries
from pointcoord.numerics.batch_last.series import ColumnSeries
from pointcoord.numerics.linear import factorise
from pointcoord.numerics.power_series import expand
from pointcoord.numerics.quadratic import Product, QuadraticMap, quadratic_map
from pointcoord.simulation import scene_mechanism
from pointcoord.solve.assembly import close_drawing

Array = NDArray[np.float64]

SCENES = ("bounce", "off-axis-strut", "double-wishbone")
MEMBERS = 7


def case(name: str) -> tuple[Mechanism, ColumnMap, Elimination, Array]:
    """A mechanism as columns, and poses near its drawing, members first."""
    mechanism = scene_mechanism(Scene.load(name))
    system, layout = mechanism.map, mechanism.layout
    drawn = close_drawing(mechanism).y
    columns = column_map(system, ((layout.zero, 0.0), (layout.one, 1.0)))
    plan = eliminate_like(system.jacobian(drawn), columns.entries, system.structure.blocks)
    assert plan is not None
    noise = np.random.default_rng(5).uniform(-1e-2, 1e-2, (MEMBERS, system.size))
    noise[:, [layout.zero, layout.one]] = 0.0
    return mechanism, columns, plan, drawn + noise


def full(entries: tuple[tuple[int, int], ...], values: Array, size: int) -> Array:
    """Matrices, members first, from their entries."""
    matrices = np.zeros((values.shape[-1], size, size))
    for (row, column), value in zip(entries, values, strict=True):
        matrices[:, row, column] = value
    return matrices


@pytest.mark.parametrize("name", SCENES)
def test_rows_and_jacobian_are_those_of_the_plain_form(name: str) -> None:
    mechanism, columns, _, y = case(name)
    system, n = mechanism.map, mechanism.map.unknowns
    d = columns.differences(y.T)
    np.testing.assert_allclose(columns.residual(d).T, system.residual(y), rtol=0, atol=1e-15)
    np.testing.assert_allclose(
        full(columns.entries, columns.jacobian(d), n), system.jacobian(y), rtol=0, atol=0
    )
    step = np.random.default_rng(6).uniform(-1.0, 1.0, y.shape)
    step[:, [mechanism.layout.zero, mechanism.layout.one]] = 0.0
    e = columns.differences(step.T)
    np.testing.assert_allclose(columns.derivative(d, e).T, 2.0 * system.polar(y, step), rtol=0, atol=1e-14)
    np.testing.assert_allclose(columns.bilinear(e).T, system.residual(step), rtol=0, atol=1e-14)
    along = full(columns.entries, columns.jacobian_along(e), n)
    np.testing.assert_allclose(along, system.jacobian(step), rtol=0, atol=1e-15)


def random_map(rng: np.random.Generator) -> QuadraticMap:
    """Five unknowns, two inputs, 0 and 1; squares, differences either way round, constant factors."""
    zero, one = 7, 8

    def pair() -> tuple[int, int]:
        first, second = rng.choice(7, 2, replace=False).tolist()
        return first, second

    rows = []
    for _ in range(5):
        square, other, last = pair(), pair(), pair()
        terms = [
            Product(2.0, square, square),
            Product(-3.0, other, other[::-1]),
            Product(5.0, square, other[::-1]),
            Product(7.0, square[::-1], last),
            Product(-2.0, last[::-1], (one, zero)),
            Product(4.0, (zero, one), pair()),
            Product(3.0, (last[0], zero), (one, last[1])),
        ]
        rows.append(tuple(terms[place] for place in rng.permutation(len(terms))))
    return quadratic_map(rows, 5, 9)


@pytest.mark.parametrize("seed", range(5))
def test_rows_of_any_differences_are_those_of_the_plain_form(seed: int) -> None:
    """In whole numbers, which both hold exactly."""
    rng = np.random.default_rng(seed)
    system = random_map(rng)
    columns = column_map(system, ((7, 0.0), (8, 1.0)))
    y, h = rng.integers(-9, 10, (2, 4, 9)).astype(float)
    y[:, [7, 8]], h[:, [7, 8]] = (0.0, 1.0), 0.0
    d, e = columns.differences(y.T), columns.differences(h.T)
    assert np.array_equal(columns.residual(d).T, system.residual(y))
    assert np.array_equal(columns.bilinear(e).T, system.residual(h))
    assert np.array_equal(columns.derivative(d, e).T, 2.0 * system.polar(y, h))
    for mine, place in ((columns.jacobian(d), y), (columns.jacobian_along(e), h)):
        assert np.array_equal(full(columns.entries, mine, 5), system.jacobian(place))
    left, right = columns.convolution.squares, columns.convolution.left
    factors = np.concatenate([e[left] ** 2, e[right] * e[columns.convolution.right]])
    assert np.array_equal((columns.convolution.sums @ factors).T, system.residual(h))


@pytest.mark.parametrize("name", SCENES)
def test_the_uncertainty_of_rows_is_at_least_that_of_the_plain_form(name: str) -> None:
    mechanism, columns, _, y = case(name)
    data = mechanism.drawn_doubt + np.abs(mechanism.drawn_lacks)
    mine = columns.uncertainty(columns.differences(y.T), data).T
    # A linear term's factor 1 has no rounding, which the plain form counts as a product's.
    plain = mechanism.map.uncertainty(y, np.broadcast_to(data, y.shape))
    assert (mine >= 0.4 * plain).all()
    assert (mine <= 3.0 * plain + 1e-300).all()


@pytest.mark.parametrize("name", SCENES)
def test_elimination_solves_as_lapack_does(name: str) -> None:
    mechanism, columns, plan, y = case(name)
    system, n = mechanism.map, mechanism.map.unknowns
    entries = columns.jacobian(columns.differences(y.T))
    factors = plan.factorise(entries)
    assert factors.sound.all()
    right = np.random.default_rng(7).uniform(-1.0, 1.0, (MEMBERS, n))
    matrices = system.jacobian(y)
    wanted = np.linalg.solve(matrices, right[..., None])[..., 0]
    np.testing.assert_allclose(factors.solve(right.T.copy()).T, wanted, rtol=0, atol=1e-12)
    np.testing.assert_array_equal(factors.orientation, np.linalg.slogdet(matrices)[0])
    # With the signs of a row the other way round it is the opposite.
    entries[[place for place, (row, _) in enumerate(plan.entries) if row == 0]] *= -1.0
    np.testing.assert_array_equal(plan.factorise(entries).orientation, -factors.orientation)


@pytest.mark.parametrize("name", SCENES)
def test_the_inverse_of_a_block_is_that_of_the_blocks_own_matrix(name: str) -> None:
    mechanism, columns, plan, y = case(name)
    system, n = mechanism.map, mechanism.map.unknowns
    factors = plan.factorise(columns.jacobian(columns.differences(y.T)))
    found = full(plan.inverse_program.entries, factors.inverse(), n)
    for block in system.structure.blocks:
        own = system.jacobian(y)[:, list(block.rows)][..., list(block.unknowns)]
        mine = found[:, list(block.unknowns)][..., list(block.rows)]
        np.testing.assert_allclose(mine, np.linalg.inv(own), rtol=0, atol=1e-11)


def test_a_member_whose_pivots_are_bad_is_marked_and_no_other() -> None:
    _, columns, plan, y = case("bounce")
    entries = columns.jacobian(columns.differences(y.T))
    pivot = next(pivot for pivot in plan.pivots if pivot.below)
    entries[plan.places[pivot.row, pivot.column], 3] *= 1e-9
    entries[plan.places[pivot.row, pivot.column], 5] = 0.0
    sound = plan.factorise(entries).sound
    np.testing.assert_array_equal(np.flatnonzero(~sound), [3, 5])


@pytest.mark.parametrize("name", SCENES)
def test_a_series_is_that_of_the_plain_form(name: str) -> None:
    mechanism, columns, plan, _ = case(name)
    system, n, order = mechanism.map, mechanism.map.unknowns, 9
    closed = close_drawing(mechanism).y
    y = np.repeat(closed[None], MEMBERS, axis=0)
    driven = [mechanism.layout.scalar(drive.coordinate) for drive in mechanism.topology.drives]
    laws = np.random.default_rng(8).uniform(-0.3, 0.3, (order + 1, len(driven), MEMBERS))
    known = np.zeros((MEMBERS, order + 1, system.size - n))
    known[..., [place - n for place in driven]] = laws.transpose(2, 0, 1)
    known[:, 0] = closed[n:]
    wanted = expand(system, factorise(system.jacobian(y)), y, known)
    factors = plan.factorise(columns.jacobian(columns.differences(y.T)))
    series = ColumnSeries.begin(columns, factors, np.ascontiguousarray(y.T), driven, order)
    for k in range(1, order + 1):
        series.carry_on(laws[k])
    size = np.abs(wanted).max(axis=(0, 2))
    off = np.abs(series.y.transpose(2, 0, 1) - wanted).max(axis=(0, 2))
    assert (off <= 1e-12 * size).all()
    # The rows of the orders that the series leaves out are those of its own residual.
    s = 0.25
    residual = system.residual(series.at(s).T).T
    sums = sum(series.sums(k) * s**k for k in range(order + 1, 2 * order + 1))
    np.testing.assert_allclose(residual, sums, rtol=0, atol=1e-14)


@pytest.mark.parametrize("name", SCENES)
def test_a_series_in_two_inputs_is_that_along_every_line_through_its_centre(name: str) -> None:
    mechanism, columns, plan, _ = case(name)
    layout, order = mechanism.layout, 7
    y = np.repeat(close_drawing(mechanism).y[:, None], MEMBERS, axis=1)
    factors = plan.factorise(columns.jacobian(columns.differences(y)))
    driven = [layout.scalar(drive.coordinate) for drive in mechanism.topology.drives]
    blocks = mechanism.map.structure.blocks
    moves = []
    for place in driven:
        moved = np.zeros(len(y), dtype=bool)
        moved[place] = True
        moved[[i for number in mechanism.map.structure.moving({place}) for i in blocks[number].unknowns]] = (
            True
        )
        moves.append(moved)

    def along(steps: list[tuple[int, Array]]) -> ColumnSeries:
        series = ColumnSeries.begin(columns, factors, y, [place for place, _ in steps], 2)
        series.longer(order)
        for k in range(1, order + 1):
            series.carry_on(np.array([law[k] for _, law in steps]))
        return series

    spare: tuple[ColumnSeries | None, ColumnSeries | None, MixedSeries | None] = (None, None, None)
    for attempt in range(2):
        laws = np.random.default_rng(attempt).uniform(-0.3, 0.3, (2, order + 1, MEMBERS))
        one, other = (
            ColumnSeries.begin(columns, factors, y, [place], order, room, moved[: columns.unknowns])
            for place, room, moved in zip(driven, spare, moves, strict=False)
        )
        mixed = MixedSeries.begin(columns, factors, one, other, (moves[0], moves[1]), order, spare[2])
        for k in range(1, order + 1):
            one.carry_on(laws[0, k][None])
            other.carry_on(laws[1, k][None])
            if k > 1:
                mixed.carry_on()
        # In the room of a series that is not needed any more the next one is the same.
        spare = (one, other, mixed)
        for a, b in ((1.0, 1.0), (1.0, -0.5), (0.25, 1.0)):
            powers = np.arange(order + 1.0)[:, None]
            wanted = along(list(zip(driven, (laws[0] * a**powers, laws[1] * b**powers), strict=True)))
            for k in range(1, order + 1):
                found = one.y[k] * a**k + other.y[k] * b**k
                if k > 1:
                    shares = a ** np.arange(k - 1.0, 0.0, -1.0) * b ** np.arange(1.0, k)
                    found[mixed.unknowns] += np.einsum("ukm,k->um", mixed.y[k - 2][:-1], shares)
                # Sums of some k^2 products of earlier ones, each solved for, of condition numbers below 1e3.
                size = np.abs(wanted.y[1 : k + 1]).max()
                np.testing.assert_allclose(found, wanted.y[k], rtol=0, atol=1e-11 * size)


@pytest.mark.parametrize("name", SCENES)
def test_omega_of_a_block_bounds_how_far_its_jacobian_turns(name: str) -> None:
    mechanism, columns, plan, y = case(name)
    system, n = mechanism.map, mechanism.map.unknowns
    weights = np.random.default_rng(9).uniform(0.3, 1.0, n)
    proof = block_proof(columns, plan, system.structure, weights)
    factors = plan.factorise(columns.jacobian(columns.differences(y.T)))
    inverse = factors.inverse()
    omega, all_turning = proof.lipschitz(np.abs(inverse)), proof.turning_of_all(np.abs(inverse))
    # 2 B of unknowns, from the polar form of unit vectors, by weights: (k, j, rows).
    units = np.eye(n, system.size) * weights[:, None]
    bends = np.abs([2.0 * system.polar(units, unit) for unit in units])
    for number, block in enumerate(system.structure.blocks):
        own, rows = list(block.unknowns), list(block.rows)
        x = np.abs(np.linalg.inv(system.jacobian(y)[:, rows][..., own])) / weights[own][:, None]
        for found, some in ((omega, own), (all_turning, list(range(n)))):
            wanted = (x @ bends[np.ix_(some, some, rows)].sum(axis=(0, 1))).max(axis=-1)
            np.testing.assert_allclose(found[number], wanted, rtol=1e-9)
        step = np.zeros_like(y)
        step[:, own] = weights[own] * np.random.default_rng(10).choice((-1.0, 1.0), (MEMBERS, len(own)))
        turned = system.jacobian(step)[:, rows][..., own]
        x = np.linalg.inv(system.jacobian(y)[:, rows][..., own])
        norm = (np.abs(x @ turned) * weights[own] / weights[own][:, None]).sum(axis=-1).max(axis=-1)
        assert (norm <= omega[number] * (1.0 + 1e-12)).all()
        along = columns.jacobian_along(columns.differences(step.T))
        np.testing.assert_allclose(proof.turns(inverse, along)[number], norm, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("fault", [0.0, 1e-6])
def test_the_defect_of_inverses_of_blocks_is_bounded_by_what_fractions_say(name: str, fault: float) -> None:
    """Of good inverses it is rounding, of ones that are off it is that."""
    mechanism, columns, plan, y = case(name)
    system, n = mechanism.map, mechanism.map.unknowns
    weights = np.random.default_rng(9).uniform(0.3, 1.0, n)
    proof = block_proof(columns, plan, system.structure, weights)
    d = columns.differences(y.T)
    factors = plan.factorise(columns.jacobian(d))
    inverse = factors.inverse() * (1.0 + fault)
    doubt = columns.jacobian_uncertainty(d, np.zeros(system.size))
    bound = proof.defect(inverse, factors.entries, doubt)
    assert bound.max() < max(1e-11, 100.0 * fault)
    member = 2
    exact = [[Fraction(0)] * n for _ in range(n)]
    for row, products in enumerate(system.rows):
        for p in products:
            for one, other in ((p.left, p.right), (p.right, p.left)):
                size = Fraction(p.coefficient) * (
                    Fraction(y[member, other[0]]) - Fraction(y[member, other[1]])
                )
                for unknown, sign in zip(one, (1, -1), strict=True):
                    if unknown < n:
                        exact[row][unknown] += sign * size
    entries = dict(zip(plan.inverse_program.entries, inverse[:, member], strict=True))
    for number, block in enumerate(system.structure.blocks):
        largest = Fraction(0)
        for i in block.unknowns:
            total = Fraction(0)
            for j in block.unknowns:
                one = sum((Fraction(entries.get((i, r), 0.0)) * exact[r][j] for r in block.rows), Fraction(0))
                total += abs(int(i == j) - one) * Fraction(weights[j]) / Fraction(weights[i])
            largest = max(largest, total)
        assert largest <= bound[number, member]
        assert fault == 0.0 or bound[number, member] <= 2 * largest


def test_the_radius_of_a_block_is_the_smallest_that_the_theorem_holds_for() -> None:
    eta, z, omega = np.meshgrid([1e-9, 0.01, 0.1], [0.0, 0.3, 0.6], [0.1, 1.0, 3.0])
    proven = 2.0 * omega * eta < (1.0 - z) ** 2
    radius = kantorovich_radius(eta, z, omega)
    assert 5 < np.count_nonzero(proven) < proven.size
    assert np.array_equal(np.isfinite(radius), proven)
    eta, z, omega, radius = (each[proven] for each in (eta, z, omega, radius))
    np.testing.assert_allclose(eta + z * radius + 0.5 * omega * radius**2, radius, rtol=1e-12)
    assert (z + omega * radius < 1.0).all()
    assert kantorovich_radius(np.array(1e-9), np.array(1.5), np.array(1.0)) == np.inf


@pytest.mark.parametrize("name", SCENES)
def test_the_assembly_of_each_block_lies_within_its_radius(name: str) -> None:
    mechanism, columns, plan, beside = case(name)
    system, n = mechanism.map, mechanism.map.unknowns
    closed = close_drawing(mechanism).y
    y = np.repeat(closed[None], MEMBERS, axis=0)
    y[:, :n] += 1e-3 * (beside - closed)[:, :n]
    weights = np.random.default_rng(9).uniform(0.3, 1.0, n)
    proof = block_proof(columns, plan, system.structure, weights)
    d = columns.differences(y.T)
    factors = plan.factorise(columns.jacobian(d))
    inverse = factors.inverse()
    missed = np.abs(proof.times(inverse, columns.residual(d)))
    omega = proof.lipschitz(np.abs(inverse))
    nothing = np.zeros_like(omega)
    radii, turned = proof.radii(np.abs(inverse), omega, missed, nothing, np.abs(factors.entries))
    off = proof.largest((closed - y)[:, :n].T)
    # Either is rounded some ten times.
    assert (off <= radii * (1.0 + 1e-14)).all()
    matrices = system.jacobian(y)
    for number, block in enumerate(system.structure.blocks):
        own, rows = list(block.unknowns), list(block.rows)
        earlier = np.array([i for i in block.reads if i < n], dtype=int)
        moved = y.copy()
        moved[:, earlier] = closed[earlier]
        change = (system.jacobian(moved) - matrices)[:, rows][..., own]
        turn = np.linalg.inv(matrices[:, rows][..., own]) @ change
        size = (np.abs(turn) * weights[own] / weights[own][:, None]).sum(axis=-1).max(axis=-1)
        assert (size <= turned[number]).all()
        if not len(earlier):
            assert not turned[number].any()
            # Nothing but its own bend lies between the step and the way to the assembly.
            assert (radii[number] <= 1.05 * off[number]).all()
