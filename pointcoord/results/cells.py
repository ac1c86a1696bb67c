r"""Many instants close together: the rows of a table as polynomials in cells, by one matrix product.

A cell is a set of consecutive instants inside one series, so short that every number is a polynomial of
degree `DEGREE` in the cell, to rounding. The numbers are computed by the plain formulas (series, effects) at
DEGREE + 1 Chebyshev points. All instants of the cell then follow from one product,

    rows = coefficients [s^n .. s^0],

which is written directly into the table. So an angle or another number computed from states costs no more
than a coordinate: all effects are read some 20 times as fast as by the formulas. The motion of the chassis is
added at the instants themselves. Numbers are analytic in a cell: if the second half of their coefficients is
below `HALFWAY`, the truncated terms are below the square of `HALFWAY`. A cell that is too long for that, or
in which a rate grows from zero, is halved. If a cell of few instants still fails, the plain formulas are
used. The error bound of a number is proven from the number itself (see `bounds`), however it was computed.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from pointcoord.errors import InputOutOfRange, SingularConfiguration
from pointcoord.numerics.arrays import Array, Flags, Indices
from pointcoord.numerics.chebyshev import interpolation
from pointcoord.numerics.rounding import EPS
from pointcoord.results.readout import Readout
from pointcoord.results.solved_scene import SolvedScene
from pointcoord.solve.dense_output import narrow_product

# Degree of the polynomials; three products make all powers up to 8.
DEGREE = 8
# Fewest instants of one series for which cells pay.
ENOUGH = 1024
# Most instants of a cell, so that the powers stay in a second-level cache; and fewest instants for which the
# Chebyshev points pay.
MOST, FEWEST = 4096, 128
# A number below this share of the largest number of its kind counts as zero: rates that are solved for
# together share that much of each other's rounding error.
SHARED = 8.0 * EPS
# At the start of a series the error of a number is a share of its size there, and the number may be zero. So
# a cell nearer to the start than NEAR times half its length is good only if every number has, at the first
# instant of the cell, BEGUN times its largest size in the cell.
NEAR, BEGUN = 16.0, 0.5
# Largest rounding of an instant, as a share of half a cell (see `Interpolation.chebyshev`).
ROUNDED = 2.0**-24
# Limit of the coefficients of the second half, relative to the size of the number.
HALFWAY = 2.0**-30


def fill_cells(solved: SolvedScene, starts: Array, times: Array, rows: Array) -> Flags:
    """Fill the columns of a table in cells, where cells pay; returns which are filled, (N,).

    They pay for many instants of one car whose chassis does not rotate.

    Args:
        starts: first instant of each series, s.
        times: instants that do not decrease, (N,), s.
        rows: the table, shape (..., height, N).
    """
    readout, filled = solved.readout, np.zeros(len(times), dtype=bool)
    if len(times) < ENOUGH or readout.mechanism.drawn.ndim > 1 or readout.chassis.turning:
        return filled
    if not (times[0] >= solved.start and times[-1] <= solved.stop):
        return filled
    edges = [0, *np.searchsorted(times, starts[1:]).tolist(), len(times)]
    cells = [
        (low, min(low + MOST, last))
        for first, last in pairwise(edges)
        if last - first >= ENOUGH
        for low in range(first, last, MOST)
    ]
    try:
        while cells:
            coefficients, still, fits = _fitted(solved, starts, np.array(cells), times)
            halves = []
            for (low, high), matrix, constants, fit in zip(cells, coefficients, still, fits, strict=True):
                if fit:
                    here, block = times[low:high], rows[:, low:high]
                    _sum(matrix, here, block)
                    block[len(matrix) :] = constants
                    readout.add(readout.laws(here), block)
                    filled[low:high] = True
                elif high - low >= 2 * FEWEST:
                    halves += [(low, (low + high) // 2), ((low + high) // 2, high)]
            cells = halves
    except (InputOutOfRange, SingularConfiguration):
        # A Chebyshev point failed, which may be no requested instant: the plain formulas decide.
        filled[:] = False
    return filled


def _fitted(solved: SolvedScene, starts: Array, cells: Indices, times: Array) -> tuple[Array, Array, Flags]:
    """Polynomials of the rows in cells, and whether they fit.

    The highest power is first and the largest coefficient, the constant, last. So the partial sums are
    rounded by the size of the smaller terms.

    Args:
        cells: number of the first instant and of the one after the last, (cells, 2).
    Returns:
        Coefficients of the rows that are solved for or computed, (cells, rows, DEGREE + 1); the constant rows
        of the points of the chassis, (cells, rows, 1); and whether all rows fit, (cells,).
    """
    own, table = interpolation(DEGREE), solved.readout.table
    first, last = times[cells[:, :1]], times[cells[:, 1:] - 1]
    middle, half = _middle_and_half(first, last)
    apart = ((half > 0.0) & (EPS * np.abs(middle) <= ROUNDED * half))[:, 0]
    near = middle - starts[np.searchsorted(starts, first, side="right") - 1] < NEAR * half
    points = np.clip(middle + half * own.points, first, last)
    whole = np.empty((table.height, points.size))
    solved.fill_plainly(points.ravel(), whole, add=False)
    whole = whole.reshape(-1, *points.shape)
    values, still = whole[: table.first_still], whole[table.first_still :, :, :1]
    with np.errstate(divide="ignore", invalid="ignore"):
        found = own.chebyshev(values, (points - middle) / half - own.points)
    rows, least, kinds = _numbers(solved.readout)
    largest, begun, later = (
        np.maximum.reduceat(np.abs(each).max(axis=-1), rows)
        for each in (values, values[..., :1], found[..., DEGREE // 2 + 1 :])
    )
    of_kind = np.zeros((kinds.max() + 1, len(cells)))
    np.maximum.at(of_kind, kinds, largest)
    size, none = np.maximum(largest, least[:, None]), SHARED * of_kind[kinds]
    fits = apart & (later <= HALFWAY * size + none).all(axis=0)
    grown = (np.maximum(begun, least[:, None]) < BEGUN * size - none).any(axis=0)
    powers = np.moveaxis(found @ own.powers, 1, 0)[..., ::-1]
    return np.ascontiguousarray(powers), np.moveaxis(still, 1, 0), fits & ~(grown & near[:, 0])


def _sum(matrix: Array, times: Array, rows: Array) -> None:
    """Fill the columns of a cell from its coefficients."""
    basis = np.ones((DEGREE + 1, len(times)))
    power = basis[::-1]
    middle, half = _middle_and_half(times[0], times[-1])
    np.divide(times - middle, half, out=power[1])
    for known in (1, 2, 4):
        np.multiply(power[1 : known + 1], power[known], out=power[known + 1 : 2 * known + 1])
    narrow_product(matrix, basis, rows[: len(matrix)])


def _middle_and_half(first: Array, last: Array) -> tuple[Array, Array]:
    """Middle and half length of cells from their first and last instants, s."""
    middle = first + 0.5 * (last - first)
    return middle, np.maximum(middle - first, last - middle)


def _numbers(readout: Readout) -> tuple[Indices, Array, Indices]:
    """The first row of each number, the smallest size with which it is compared, and its kind, from 0.

    The size of a vector is the size of its largest component, and that of an angle is at least 1 rad.
    States of the same derivative are of one kind; every other number is a kind of its own.
    """
    table, kind = readout.table, readout.plan.derivative
    found = {row: (0.0, order) for (order, _), row in table.states.items() if row < table.first_still}
    for effect in table.computed:
        for quantity in effect.quantities:
            size = 1.0 if quantity.unit == "rad" else 0.0
            for place in table.places[quantity.name].values():
                found[place.start] = size, (kind := kind + 1)
    first = sorted(found)
    least, kinds = zip(*(found[row] for row in first), strict=True)
    return np.array(first, dtype=np.intp), np.array(least), np.array(kinds, dtype=np.intp)
