"""What a projected angle claims of its error, held to lines that are moved about by hand."""

import itertools
from dataclasses import dataclass

import numpy as np
import pytest
from numpy.typing import NDArray

from absolute.description import Corner, Vector
from absolute.effects.effect import Effect
from absolute.effects.projected_angle import projected_angle

Array = NDArray[np.float64]
EPS = float(np.finfo(float).eps)


def angle_between(run: Vector, rise: Vector) -> Effect:
    return projected_angle(
        name="angle",
        gives="",
        sign="",
        role="wheel_axis",
        rise=lambda corner: rise,
        run=lambda corner: run,
    )


ANGLE = angle_between((1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
TURNED = angle_between((0.6, 0.8, 0.0), (-0.8, 0.6, 0.0))


@dataclass(frozen=True)
class ByHand:
    """Lines, (N, 3), and how far each component may be off."""

    corner: Corner
    along: Array
    off: Array

    def line(self, ends: tuple[str, str]) -> Array:
        return self.along

    def error(self, ends: tuple[str, str]) -> Array:
        return self.off


def by_hand(along: object, off: object) -> ByHand:
    """Of a car whose axes are not asked for."""
    corner = Corner((0, 0, 1), (0, 1, 0), (0, 1, 0), ("inner", "outer"), ("low", "high"))
    return ByHand(corner, np.atleast_2d(np.asarray(along, float)), np.atleast_2d(np.asarray(off, float)))


@pytest.mark.parametrize("effect", [ANGLE, TURNED])
@pytest.mark.parametrize("scale", [2.0**-12, 1.0, 2.0**12])
def test_a_claim_is_what_the_worst_corner_of_a_lines_box_turns_it_by(effect: Effect, scale: float) -> None:
    random = np.random.default_rng(1)
    along = random.normal(size=(40, 3))
    off = 1e-6 * random.uniform(size=(40, 3))
    claim = effect.error(by_hand(scale * along, scale * off))
    angles = effect.value(by_hand(scale * along, scale * off))
    worst = np.zeros(40)
    for signs in itertools.product((-1.0, 1.0), repeat=3):
        moved = effect.value(by_hand(scale * (along + signs * off), scale * off))
        worst = np.maximum(worst, np.abs(np.remainder(moved - angles + np.pi, 2.0 * np.pi) - np.pi))
    # Of second order is what the claim gives away: the line may be shorter by its error.
    short = 1.0 - 2.0 * np.sum(off, axis=1) / np.hypot(along[:, 0], along[:, 1])
    assert (claim >= worst - 4.0 * EPS).all()
    assert (claim * short <= worst + 20.0 * EPS).all()


def test_of_an_exact_line_the_claim_is_its_roundings() -> None:
    # The products' roundings move 600 along the run by 3 eps 600 at most, and 800 along the rise by
    # 3 eps 800: across the line that is (800 600 + 600 800) 3 eps / 1000 of a length of 1000. The arc tangent
    # rounds by 2 eps of itself.
    claim = float(ANGLE.error(by_hand([600.0, 800.0, 0.0], np.zeros(3)))[0])
    expected = 2.0 * 480_000.0 * 3.0 / 1e6 + 2.0 * np.arctan2(800.0, 600.0)
    assert claim / EPS == pytest.approx(expected, rel=1e-9)


def test_a_line_that_may_have_no_direction_may_have_any() -> None:
    # Along neither direction; shorter than its error; as short, with the roundings of 4 mm.
    just = 4.0 - 12.0 * EPS
    along = [[0.0, 0.0, 5.0], [1.0, 0.0, 0.0], [4.0, 0.0, 0.0]]
    off = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [just, 0.0, 0.0]]
    assert ANGLE.error(by_hand(along, off)).tolist() == [np.pi] * 3
    nearly = by_hand([4.0, 0.0, 0.0], [just - 1e-9, 0.0, 0.0])
    assert ANGLE.error(nearly)[0] < 1e-5
