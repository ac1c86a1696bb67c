"""What a map is asked for, and what it is cut into: orders, ranges, limits, seams, and where it starts."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from numpy.typing import NDArray
from sample_cars import GENERAL_STRUT, PAPER_STRUT

from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.multi_index import powers
from pointcoord.patches.domain import Domain, widened
from pointcoord.patches.flood import Limits, _seams, flood
from pointcoord.patches.jet import Jet
from pointcoord.patches.patches import ProvenPatches
from pointcoord.patches.way_map import HALVINGS
from pointcoord.solve.assembly import assemble

Array = NDArray[np.float64]
RANGES = {"arm_angle": (0.9, 1.1), "rack": (-10.0, 10.0)}
START = {"arm_angle": np.array(1.0), "rack": np.array(0.0)}


@pytest.mark.parametrize(
    ("tolerance", "derivative", "inputs", "order"),
    [
        (1e-6, 0, 1, 9),  # a digit each of 1e-6 mm in a car of 1000 mm
        (1e-6, 1, 2, 11),
        (1e-6, 2, 1, 13),
        (1e-6, 0, 3, 9),
        (1.0, 0, 2, 6),  # no fewer
        (1e-20, 0, 1, 16),  # a double has no more digits
        (1e-20, 1, 1, 18),
        (1e-20, 2, 2, 20),
        (1e-12, 2, 1, 19),
        (1e-20, 0, 3, 12),  # of three inputs 12 are 455 powers
    ],
)
def test_series_have_an_order_for_each_digit_and_two_for_each_derivative(
    tolerance: float, derivative: int, inputs: int, order: int
) -> None:
    names = ["arm_angle", "rack", "wheel"][:inputs]
    mechanism = SimpleNamespace(unit=1e3, topology=SimpleNamespace(required_inputs=names))
    domain = Domain(cast(Mechanism, mechanism), dict.fromkeys(names, (0.0, 1.0)), 0)
    assert domain.order_for(tolerance, derivative) == order


def test_the_smallest_boxes_of_a_way_are_some_hundred_thousand() -> None:
    for inputs, halvings in HALVINGS.items():
        assert 2**16 <= 2 ** (inputs * halvings) <= 2**18
    assert sorted(HALVINGS) == [1, 2, 3]


@pytest.mark.parametrize(("low", "high"), [(3.0, 3.0), (-4e3, -4e3), (1.0, 1.0 + 2.0**-22), (0.25, 0.25)])
def test_a_range_too_narrow_iswidened_alike_on_both_sides(low: float, high: float) -> None:
    first, last = widened(low, high)
    width = 2.0**-20 * max(abs(low), abs(high), 1.0)
    assert last - first == pytest.approx(width, rel=1e-6)
    assert low - first == pytest.approx(last - high, rel=1e-6)
    assert first < low


def test_a_range_that_is_wide_enough_stays_as_it_is() -> None:
    assert widened(1.0, 1.0 + 2.0**-19) == (1.0, 1.0 + 2.0**-19)
    assert widened(-1e-6, 1e-6) == (-1e-6, 1e-6)


@pytest.mark.parametrize(("derivative", "used"), [(0, [0.5, 4.0]), (1, [3.0, 4.0]), (2, [3.0, 10.0])])
def test_a_patch_uses_the_largest_part_of_what_is_allowed_of_any_derivative(
    derivative: int, used: list[float]
) -> None:
    # Two patches of two inputs with one point; L = 100 mm, so that a part of 1e-2 is a tolerance of 1 mm.
    coefficients = np.zeros((2, 6, 3))
    coefficients[:, 1, 0], coefficients[:, 2, 1] = -20.0, 40.0  # S_1 = 20 mm, S_2 = 40 mm
    coefficients[:, 1, 2] = 3.0  # less than that of another coordinate
    off = Jet(np.zeros((2, 3)), np.zeros((2, 2, 3)), np.zeros((2, 2, 2, 3)))
    off.value[0, 1], off.value[1, 2] = 0.5, 4.0  # of 1 mm
    off.first[0, 1, 2] = 3.0 * 1e-2 * 40.0
    off.first[1, 0, 0] = 2.0 * 1e-2 * 20.0
    off.second[0, 1, 1, 0] = 2.0 * 1e-2 * 40.0 * 40.0 / 100.0
    off.second[1, 0, 1, 1] = off.second[1, 1, 0, 1] = 10.0 * 1e-2 * 20.0 * 40.0 / 100.0
    found = Limits(1.0, derivative).used(coefficients, off, 100.0)
    np.testing.assert_allclose(found, used, rtol=1e-12)


def test_known_coordinates_are_those_of_one_place_and_of_a_grid_of_places() -> None:
    mechanism = GENERAL_STRUT.mechanism()
    domain = Domain(mechanism, {"arm_angle": (1.4, 1.8), "rack": (2.0, 2.0)}, 2)
    angles = np.linspace(1.4, 1.8, 6).reshape(2, 3)
    grid = domain.known_at(angles[..., None])
    assert grid.shape == (2, 3, mechanism.map.size - mechanism.map.unknowns)
    for place, angle in np.ndenumerate(angles):
        one = domain.known_at(np.array([angle]))
        wanted = mechanism.known_series({"arm_angle": np.array([angle]), "rack": np.array([2.0])})[0]
        assert np.array_equal(one, wanted)
        assert np.array_equal(grid[place], wanted)


@pytest.mark.parametrize("which", [0, 1])
def test_a_driven_coordinate_and_its_two_derivatives_are_as_near_as_a_box_says(which: int) -> None:
    """Against many more terms; the fifth, which is left out, is by the sine of angles near a right one."""
    mechanism = GENERAL_STRUT.mechanism()
    domain = Domain(mechanism, {"arm_angle": (1.1, 2.1), "rack": (-30.0, 40.0)}, 1)
    low, high = np.array([[which, 0]]), np.array([[which + 1, 2]])
    middle, half = domain.middle_and_half(low, high)
    np.testing.assert_allclose(middle, [[1.35 + 0.5 * which, 5.0]], rtol=1e-15)
    np.testing.assert_allclose(half, [[0.25, 35.0]], rtol=1e-14)
    short, _, doubt = domain.known_over(middle, half, 4)
    long, _, _ = domain.known_over(middle, half, 14)
    s = np.linspace(-1.0, 1.0, 81)
    first = mechanism.layout.unknowns
    for variable, name in enumerate(domain.free):
        drive = next(drive for drive in mechanism.topology.drives if drive.input == name)
        place = mechanism.layout.scalar(drive.coordinate)
        rows = [
            np.array(
                [known[0, powers(2, order).power_of(variable, k), place - first] for k in range(order + 1)]
            )
            for known, order in ((short, 4), (long, 14))
        ]
        bounds = [
            doubt.value[0, place],
            doubt.first[0, variable, place],
            doubt.second[0, variable, variable, place],
        ]
        for derivative, bound in enumerate(bounds):
            one, other = (np.polynomial.Polynomial(row).deriv(derivative)(s) for row in rows)
            off = np.abs(one - other).max()
            assert off <= bound + 1e-15
            assert bound <= 2.0 * off + 1e-15
        # Nothing depends on the other input, and the other coordinates are known as they are.
        other_input = 1 - variable
        assert doubt.first[0, other_input, place] == 0.0
        assert not doubt.second[0, other_input, :, place].any()
        doubt.first[0, variable, place] = doubt.second[0, variable, variable, place] = 0.0
    assert not doubt.first.any()
    assert not doubt.second.any()


def paper_patches() -> tuple[ProvenPatches, Array]:
    mechanism = PAPER_STRUT.mechanism()
    domain = Domain(mechanism, RANGES, 6)
    start = assemble(mechanism, START)
    cover = flood(domain, 8, Limits(1e-9), (np.array([64, 64]), start.y), 4096)
    return cover.patches, start.y


def test_neighbours_are_the_same_assembly_if_either_is_alone_around_the_other() -> None:
    patches, _ = paper_patches()
    assert not _seams(patches).any()
    touching = _seams(replace(patches, unique_within=0.0 * patches.unique_within))
    assert touching.any()
    for place in (0, -1):
        alone = patches.unique_within.copy()
        alone[place] = 0.0
        assert not _seams(replace(patches, unique_within=alone)).any()


@pytest.mark.parametrize("coordinate", [0, 7])
def test_neighbours_that_differ_in_one_coordinate_are_another_assembly(coordinate: int) -> None:
    patches, _ = paper_patches()
    series = patches.series.copy()
    series[-1, 0, coordinate] += 2.0 * patches.unique_within.max()
    dropped = _seams(replace(patches, series=series))
    assert np.flatnonzero(dropped).tolist() == [len(dropped) - 1]


def test_a_start_where_no_patch_is_is_nowhere() -> None:
    patches, y = paper_patches()
    assert patches.holds(np.array([1.0, 0.0]), y)
    assert not ProvenPatches.none(patches.domain, 8).holds(np.array([1.0, 0.0]), y)
