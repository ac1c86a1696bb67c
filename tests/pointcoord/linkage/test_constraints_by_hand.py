"""What each kind of constraint reads off a drawing, in numbers known by hand."""

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from numpy.typing import NDArray

from pointcoord.errors import MechanismError
from pointcoord.linkage.constraints.constraint import Constraint
from pointcoord.linkage.constraints.in_body import AxisInBody, Normal
from pointcoord.linkage.constraints.link import Link
from pointcoord.linkage.constraints.on_line import FARTHEST, HeldOnAxis, OnChassisLine, OnLine
from pointcoord.linkage.drawing import Drawing
from pointcoord.linkage.layout import Layout
from pointcoord.numerics.quadratic import quadratic_map

Array = NDArray[np.float64]
U = 2.0**-53
BODY = Normal("n", "a", "b", "c")
AXIS = AxisInBody("axis", "a", "b", BODY)
HELD = HeldOnAxis("c", "b", AXIS, "held")
LINE = OnLine("c", "a", "b", "ratio")
RACK = OnChassisLine("a", "o", "rack", "", "e", "travel", True)
LAYOUT = Layout(
    moving=("a", "b", "c"),
    ratios=("place", "ratio"),
    chassis=("o",),
    directions=("e",),
    driven=("travel",),
    squared_lengths=(("a", "b"), ("b", "c")),
    vectors=("n", "axis"),
    constants=(*AXIS.constants, *HELD.constants),
)


def drawing(**points: tuple[float, float, float]) -> Drawing:
    return Drawing({name: np.array(place) for name, place in points.items()}, np.array(1.0))


def both_and(car: Drawing, other: Drawing) -> Drawing:
    """Both cars, and then the first again, in one drawing."""
    vectors = {name: np.stack([place, other.vectors[name], place]) for name, place in car.vectors.items()}
    return Drawing(vectors, np.stack([car.unit, other.unit, car.unit]))


def value(kind: Constraint, car: Drawing) -> Array:
    """What a kind with one coordinate of its own reads off."""
    (placed,) = kind.placed(LAYOUT, car)
    assert len(placed.places) == placed.values.shape[-1] == 1
    return np.asarray(placed.values[..., 0])


def test_a_point_on_a_line_stands_at_its_foot() -> None:
    one = drawing(a=(1.0, 2.0, 3.0), b=(3.0, 3.0, 5.0), c=(1.0 + 3.0, 2.0, 3.0 + 6.0))
    other = drawing(a=(0.0, 1.0, 0.0), b=(4.0, 1.0, 0.0), c=(-6.0, 9.0, 7.0))
    # (3, 0, 6) . (2, 1, 2) = 18 over 9, and -24 over 16
    assert value(LINE, one) == 2.0
    assert value(LINE, other) == -1.5
    assert value(LINE, both_and(one, other)).tolist() == [2.0, -1.5, 2.0]
    with pytest.raises(MechanismError, match="a - b has no length"):
        LINE.placed(LAYOUT, both_and(one, drawing(a=(0.0, 1.0, 0.0), b=(0.0, 1.0, 0.0), c=(1.0, 1.0, 1.0))))


def test_a_line_is_left_at_235_of_its_lengths() -> None:
    # A turn by 1 rad takes 0.036 R^2 proven steps, and a path may have 2000.
    assert 0.036 * FARTHEST**2 <= 2000.0 < 0.036 * (FARTHEST + 1.0) ** 2
    near = {"a": (0.0, 0.0, 0.0), "b": (2.0, 0.0, 0.0)}
    for sign in (1.0, -1.0):
        LINE.placed(LAYOUT, drawing(**near, c=(2.0 * sign * FARTHEST, 5.0, 0.0)))
        far, fine = (
            replace(drawing(**near, c=end), unit=np.array(100.0))
            for end in ((sign * 500.0, 5.0, 0.0), (1.0, 1.0, 1.0))
        )
        for car in (far, both_and(fine, far)):
            with pytest.raises(MechanismError) as caught:
                LINE.placed(LAYOUT, car)
            # Times 100 mm: 2 apart, 500 along, and 500 / 235 = 2.13
            for words in ("200 mm apart", "5e+04 mm along", "250 times as far", "most 235 times", "2.1e+02"):
                assert words in str(caught.value)


def test_links_know_the_squares_of_their_lengths_to_their_doubt() -> None:
    rng = np.random.default_rng(3)
    # Of very different sizes, so that the differences are rounded too.
    cars = {name: rng.uniform(-1.0, 1.0, (20, 3)) * 10.0 ** rng.uniform(-4.0, 0.0, (20, 3)) for name in "abc"}
    links = (Link("a", "b"), Link("b", "c"))
    (placed,) = Link.placed_together(links, LAYOUT, Drawing(cars, np.ones(20)))
    assert placed.places == (LAYOUT.squared_length("a", "b"), LAYOUT.squared_length("b", "c"))
    lacks, doubt = np.asarray(placed.lacks), np.asarray(placed.doubt)
    for i in range(20):
        for j, (start, end) in enumerate((("a", "b"), ("b", "c"))):
            parts = zip(cars[start][i].tolist(), cars[end][i].tolist(), strict=True)
            exact = sum((Fraction(p) - Fraction(q)) ** 2 for p, q in parts)
            found = Fraction(float(placed.values[i, j])) + Fraction(float(lacks[i, j]))
            assert abs(found - exact) <= Fraction(float(doubt[i, j]))
            assert abs(lacks[i, j]) <= 5 * U * exact
            assert doubt[i, j] <= 1e3 * U**2 * exact


LENGTHS: Mapping[Constraint, Array] = {kind: np.array([2.0, -3.0, 6.0]) for kind in (RACK, LINE, HELD)}


@pytest.mark.parametrize("kind", LENGTHS, ids=lambda kind: type(kind).__name__)
def test_the_rows_of_a_distance_are_that_distance(kind: Constraint) -> None:
    """Where a kind says that its rows are a distance, a point moved off by 7 mm misses by 7 mm."""
    assert kind.is_length
    y = np.random.default_rng(4).normal(size=LAYOUT.size)
    y[LAYOUT.zero], y[LAYOUT.one] = 0.0, 1.0
    moved = y.copy()
    moved[list(LAYOUT.vector("a" if kind is RACK else "c"))] += LENGTHS[kind]
    system = quadratic_map(kind.rows(LAYOUT), LAYOUT.unknowns, LAYOUT.size)
    assert np.linalg.norm(system.residual(moved) - system.residual(y)) == pytest.approx(7.0, rel=1e-13)
