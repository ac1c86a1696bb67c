"""Products of small matrices with many columns, by parts."""

import numpy as np
import pytest
from threadpoolctl import threadpool_limits

from pointcoord.numerics import narrow_product as module
from pointcoord.numerics.narrow_product import FEWEST, narrow_product


@pytest.mark.parametrize("batch", [(), (2,)])
@pytest.mark.parametrize("columns", [0, 1, 5000])
def test_a_product_by_parts_is_the_product_in_its_place(batch: tuple[int, ...], columns: int) -> None:
    rng = np.random.default_rng(1)
    matrix, right = rng.uniform(-1.0, 1.0, (*batch, 60, 10)), rng.uniform(-1.0, 1.0, (10, columns))
    room = np.full((*batch, 60, columns + 6), np.nan)
    with threadpool_limits(limits=1):
        narrow_product(matrix, right, room[..., 3 : 3 + columns])
    # Ten products of numbers below 1, summed in any order.
    assert (np.abs(room[..., 3 : 3 + columns] - matrix @ right) <= 10 * np.finfo(float).eps).all()
    assert np.isnan(room[..., :3]).all()
    assert np.isnan(room[..., 3 + columns :]).all()


def test_no_part_is_larger_than_what_one_thread_takes(monkeypatch: pytest.MonkeyPatch) -> None:
    sizes, product = [], np.matmul

    def counted(left: np.ndarray, right: np.ndarray, out: np.ndarray) -> None:
        sizes.append(left.shape[-2] * left.shape[-1] * right.shape[-1])
        product(left, right, out=out)

    monkeypatch.setattr(module.np, "matmul", counted)
    rng = np.random.default_rng(2)
    for rows, inner in ((1, 10), (60, 10), (500, 10), (10, 600)):
        sizes.clear()
        narrow_product(rng.random((rows, inner)), rng.random((inner, 9000)), np.empty((rows, 9000)))
        # OpenBLAS shares out none of 2^19 multiplications. Half of that is no smaller than it has to be.
        assert min(2**18, rows * inner * 9000) <= max(sizes) <= 2**19
    # But a part is never so narrow that calling costs more than computing.
    sizes.clear()
    narrow_product(rng.random((3000, 40)), rng.random((40, 100)), np.empty((3000, 100)))
    assert sizes == [3000 * 40 * FEWEST, 3000 * 40 * (100 - FEWEST)]
