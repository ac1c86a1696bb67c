"""The proven and the expected error of an angle, held to lines whose errors are known by hand."""

from fractions import Fraction

import numpy as np
import pytest

from pointcoord.numerics.enclosure import Enclosed, angle_error

EPS = 2.0**-52
UNIT = EPS / 2.0
PROVEN, EXPECTED = 0, 1


def errors(
    sine: float, cosine: float, found: float, boxes: tuple[float, ...] = (0.0,) * 4
) -> tuple[float, float]:
    """Of a line; `boxes` are the proven radii of sine and cosine, then the expected ones."""
    s, c = (Enclosed.of(np.array([x]), 0.0, boxes[i], boxes[i + 2]) for i, x in enumerate((sine, cosine)))
    proven, expected = angle_error(s, c, np.array([found]))[:, 0]
    return float(proven), float(expected)


@pytest.mark.parametrize("length", [2.0**-9, 1.0, 2.0**9])
def test_a_proven_error_is_what_the_worst_line_in_its_box_is_off(length: float) -> None:
    random = np.random.default_rng(3)
    for angle in random.uniform(-np.pi, np.pi, 30):
        sine, cosine = length * np.sin(angle), length * np.cos(angle)
        r = length * 1e-6 * random.uniform(0.2, 1.0, 2)
        worst = 0.0
        for up in (-r[0], r[0]):
            for along in (-r[1], r[1]):
                off = np.arctan2(sine + up, cosine + along) - angle
                worst = max(worst, abs(np.remainder(off + np.pi, 2.0 * np.pi) - np.pi))
        proven, expected = errors(sine, cosine, angle, (*r, 0.0, 0.0))
        # Of second order is what a line that is shorter by its box gives away.
        assert worst - 4.0 * EPS <= proven <= worst * (1.0 + 4e-6) + 8.0 * EPS
        assert expected < 8.0 * EPS


@pytest.mark.parametrize("off", [-0.4, -0.01, 0.3])
@pytest.mark.parametrize("line", [(3.0, 4.0), (5.0, 1.0), (5.0, -1.0), (1.0, -5.0)])
def test_a_wrong_angle_is_proven_wrong_by_as_much(off: float, line: tuple[float, float]) -> None:
    proven, expected = errors(*line, float(np.arctan2(*line)) + off)
    # The arc of a sine x is taken as x + x^3, of which a sixth is needed.
    assert abs(off) < proven <= abs(off) * (1.0 + off**2)
    assert expected < 8.0 * EPS


@pytest.mark.parametrize("off", [np.pi, np.pi - 0.1, 3.4, 1.0, -1.0])
@pytest.mark.parametrize("length", [0.125, 1.0])
def test_of_an_angle_that_points_elsewhere_nothing_is_proven(off: float, length: float) -> None:
    proven, expected = errors(3.0 * length, 4.0 * length, float(np.arctan2(3.0, 4.0)) + off)
    assert proven == np.pi
    # What a plain evaluation loses does not depend on what was found.
    assert expected < 8.0 * EPS


@pytest.mark.parametrize("box", [(0.5, 0.0), (0.0, 0.5), (0.7, 0.7)])
def test_a_line_that_may_have_no_length_may_have_any_angle(box: tuple[float, float]) -> None:
    assert errors(0.0, 1.0, 0.0, (*box, 0.0, 0.0))[PROVEN] == np.pi


def test_a_line_is_no_shorter_than_by_twice_its_larger_radius() -> None:
    # Along the cosine the sine's radius 0.1 turns it; of the length 1 at least 1 - 2 0.2 is left.
    turn = 0.1 / (1.0 - 2.0 * 0.2)
    assert errors(0.0, 1.0, 0.0, (0.1, 0.2, 0.01, 0.01))[PROVEN] == pytest.approx(turn * (1.0 + turn**2))
    turn = 0.2 / (1.0 - 2.0 * 0.2)
    assert errors(0.0, 1.0, 0.0, (0.2, 0.1, 0.01, 0.01))[PROVEN] == pytest.approx(turn * (1.0 + turn**2))


def test_what_is_expected_is_the_lines_own_error_over_its_length_and_a_few_roundings() -> None:
    # Along the sine, 2 long: only the error of the cosine turns it.
    found = float(np.arctan2(2.0, 0.0))
    assert errors(2.0, 0.0, found, (0.0, 0.0, 1e-9, 4e-9))[EXPECTED] == pytest.approx(2e-9, rel=1e-5)
    # Of an exact line at 45 degrees: to each of both products come 2 u of its function and u of itself, which
    # is sqrt(1/2), over the length sqrt 2; and 4 eps are of the angle that was found.
    found = float(np.arctan2(1.0, 1.0))
    units = 2.0 * (2.0 + 0.5**0.5) / 2.0**0.5
    assert errors(1.0, 1.0, found)[EXPECTED] / EPS == pytest.approx(4.0 + units / 2.0, rel=1e-6)


def test_of_an_exact_line_the_functions_rounding_is_proven_twice() -> None:
    # numpy's cosine and sine are within a unit in the last place, 2 u; what they leave of the exact product
    # is known in fractions.
    found = float(np.arctan2(1.0, 1.0)) + 1e-16
    left = abs(float(Fraction(float(np.cos(found))) - Fraction(float(np.sin(found)))))
    wanted = (left + 2.0 * 2.0 * UNIT) / np.sqrt(2.0)
    assert errors(1.0, 1.0, found)[PROVEN] / EPS == pytest.approx(wanted / EPS, rel=1e-6)
