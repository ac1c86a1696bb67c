"""What each kind of constraint reads off a drawing, in numbers known by hand."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from numpy.typing import NDArray

from pointcoord.errors import MechanismError
from pointcoord.linkage.constraints.constraint import Constraint
from pointcoord.linkage.constraints.link import Link
from pointcoord.linkage.constraints.on_line import FARTHEST, OnLine
from pointcoord.linkage.drawing import Drawing

Array = NDArray[np.float64]
U = 2.0**-53
LINE = OnLine("c", "a", "line a - b", "b", "ratio", between=True)


def drawing(**points: tuple[float, float, float]) -> Drawing:
    return Drawing({name: np.array(place) for name, place in points.items()}, np.array(1.0))


def both_and(car: Drawing, other: Drawing) -> Drawing:
    """Both cars, and then the first again, in one drawing."""
    vectors = {name: np.stack([place, other.vectors[name], place]) for name, place in car.vectors.items()}
    return Drawing(vectors, np.stack([car.unit, other.unit, car.unit]))


def value(kind: Constraint, car: Drawing) -> Array:
    """What a kind with one coordinate of its own reads off."""
    ((_, placed),) = kind.placed(car).items()
    return np.asarray(placed.values)


def test_a_point_on_a_line_stands_at_its_foot() -> None:
    one = drawing(a=(1.0, 2.0, 3.0), b=(3.0, 3.0, 5.0), c=(1.0 + 3.0, 2.0, 3.0 + 6.0))
    other = drawing(a=(0.0, 1.0, 0.0), b=(4.0, 1.0, 0.0), c=(-6.0, 9.0, 7.0))
    # (3, 0, 6) . (2, 1, 2) = 18 over 9, and -24 over 16
    assert value(LINE, one) == 2.0
    assert value(LINE, other) == -1.5
    assert value(LINE, both_and(one, other)).tolist() == [2.0, -1.5, 2.0]
    with pytest.raises(MechanismError, match="a - b has no length"):
        LINE.placed(both_and(one, drawing(a=(0.0, 1.0, 0.0), b=(0.0, 1.0, 0.0), c=(1.0, 1.0, 1.0))))


def test_a_line_is_left_at_235_of_its_lengths() -> None:
    # A turn by 1 rad takes 0.036 R^2 proven steps, and a path may have 2000.
    assert 0.036 * FARTHEST**2 <= 2000.0 < 0.036 * (FARTHEST + 1.0) ** 2
    near = {"a": (0.0, 0.0, 0.0), "b": (2.0, 0.0, 0.0)}
    for sign in (1.0, -1.0):
        LINE.placed(drawing(**near, c=(2.0 * sign * FARTHEST, 5.0, 0.0)))
        far, fine = (
            replace(drawing(**near, c=end), unit=np.array(100.0))
            for end in ((sign * 500.0, 5.0, 0.0), (1.0, 1.0, 1.0))
        )
        for car in (far, both_and(fine, far)):
            with pytest.raises(MechanismError) as caught:
                LINE.placed(car)
            # Times 100 mm: 2 apart, 500 along, and 500 / 235 = 2.13
            for words in ("200 mm apart", "5e+04 mm along", "250 times as far", "most 235 times", "2.1e+02"):
                assert words in str(caught.value)


def test_links_know_the_squares_of_their_lengths_to_their_doubt() -> None:
    rng = np.random.default_rng(3)
    # Of very different sizes, so that the differences are rounded too.
    cars = {name: rng.uniform(-1.0, 1.0, (20, 3)) * 10.0 ** rng.uniform(-4.0, 0.0, (20, 3)) for name in "abc"}
    for link in (Link("a", "b"), Link("b", "c")):
        ((_, (values, lacks, doubt)),) = link.placed(Drawing(cars, np.ones(20))).items()
        for i in range(20):
            parts = zip(cars[link.start][i].tolist(), cars[link.end][i].tolist(), strict=True)
            exact = sum((Fraction(p) - Fraction(q)) ** 2 for p, q in parts)
            found = Fraction(float(values[i])) + Fraction(float(lacks[i]))
            assert abs(found - exact) <= Fraction(float(doubt[i]))
            assert abs(lacks[i]) <= 5 * U * exact
            assert doubt[i] <= 1e3 * U**2 * exact
