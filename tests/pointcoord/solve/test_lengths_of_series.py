"""How long a series may be, and of which order, is told from its terms as it is said."""

from math import perm

import numpy as np
import pytest
from numpy.typing import NDArray

from pointcoord.errors import InputOutOfRange
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.solve import taylor
from pointcoord.solve.assembly import assemble
from pointcoord.solve.taylor import (
    SAFE,
    Chain,
    Settings,
    build_chain,
    lengths_by_sizes,
    power_of_two,
)
from pointcoord.time_functions import Polynomial, Sine, TimeFunction

Array = NDArray[np.float64]
BOUNCE: dict[str, TimeFunction] = {"arm_angle": Polynomial((1.2, 0.25, 0.0625)), "rack": Polynomial((0.0,))}


@pytest.mark.parametrize("radius", [0.3, 1.0, 5.0])
@pytest.mark.parametrize("derivative", [0, 1, 2])
def test_a_series_ends_where_its_last_two_terms_are_half_the_tolerance_of_a_derivative(
    radius: float, derivative: int
) -> None:
    tolerance, k = 1e-8, np.arange(15)
    # The first term stands for the mechanism's size, 1, whatever it is.
    sizes = radius ** -k.astype(float) / np.maximum(k, 1) ** 2
    sizes[0] = 7.0
    with np.errstate(divide="ignore"):
        length = float(lengths_by_sizes(np.log(sizes)[None], Settings(tolerance, derivative))[0])

    def largest_part(s: float) -> float:
        """Of the last two terms in half the tolerance times the size, over the derivatives."""
        found = []
        for d in range(derivative + 1):
            terms = [perm(j, d) * sizes[j] * s ** (j - d) if j >= d else 0.0 for j in range(15)]
            # The second last term is at least what it takes for the last to follow it.
            size = 1.0 if d == 0 else max(terms)
            found += [term / (0.5 * tolerance * size) for term in terms[-2:]]
        return max(found)

    # Terms fall a little slower than they fell since the window before: at most by the quotient of squares.
    assert largest_part(0.8 * length) < 1.0 < largest_part(1.3 * length)


@pytest.mark.parametrize("length", [1e-12, 0.3, 0.5, 0.75, 1.0, 3.0, 1e9])
def test_a_unit_of_time_is_the_next_power_of_two(length: float) -> None:
    unit = power_of_two(length)
    assert length <= unit <= 2.0 * length
    assert np.frexp(unit)[0] == 0.5


def chain_of(mechanism: Mechanism, functions: dict[str, TimeFunction], start: float, stop: float) -> Chain:
    pose = assemble(mechanism, {name: f.series(start, 0)[..., 0] for name, f in functions.items()})
    return build_chain(mechanism, functions, pose, start, stop, Settings(1e-10, derivative=2))


def swing(since: float) -> dict[str, TimeFunction]:
    return {"arm_angle": Sine(0.3, 2.0, -2.0 * since, 1.4), "rack": Sine(20.0, 3.0, -3.0 * since)}


def test_a_motion_is_cut_the_same_way_whenever_it_begins(strut: Mechanism) -> None:
    at_once, later = (chain_of(strut, swing(since), since, since + 3.0) for since in (0.0, 1024.0))
    assert [s.order for s in later.segments] == [s.order for s in at_once.segments]
    for one, other in zip(at_once.segments, later.segments, strict=True):
        # The phases are rounded, by some 1e-13.
        assert other.stop - 1024.0 == pytest.approx(one.stop, abs=1e-6)


def test_the_unit_of_a_slow_motion_is_no_longer_than_the_motion(strut: Mechanism) -> None:
    slow: dict[str, TimeFunction] = {"arm_angle": Polynomial((1.4, 1e-3)), "rack": Polynomial((0.0, 1e-3))}
    assert all(segment.scale <= 1.0 for segment in chain_of(strut, slow, 0.0, 0.9).segments)


class UpTo24(Polynomial):
    """A law whose rates of higher orders are no numbers."""

    def series(self, t: Array | float, order: int) -> Array:
        if order > 24:
            raise InputOutOfRange("arm_angle", np.inf, "rates that are numbers")
        return super().series(t, order)


def test_a_series_falls_back_to_an_order_whose_rates_are_numbers(strut: Mechanism) -> None:
    functions: dict[str, TimeFunction] = {**BOUNCE, "arm_angle": UpTo24((1.2, 0.25, 0.0625))}
    pose = assemble(strut, {"arm_angle": np.array(1.2), "rack": np.array(0.0)})
    part = strut.moving_part(functions)
    course = taylor._Course(strut, functions, 0.0, 2.0, Settings(1e-10, 2), part)
    place = taylor.starting_place(part, pose)
    joint = taylor._Joint(0.0, place.y, place.factors, place.left, 1.0)
    found = course.series_about(joint, 30)
    assert found.order == SAFE
    np.testing.assert_array_equal(found.coefficients, course.series_about(joint, SAFE).coefficients)
