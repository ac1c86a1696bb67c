"""Whether pieces of a line turn over against each other between the drawing and a pose."""

import numpy as np
import pytest
from sample_cars import SampleCar, by_car

from pointcoord.linkage.drawing_orientation import turned_over
from pointcoord.linkage.mechanism import Mechanism


def flips(mechanism: Mechanism, y: np.ndarray) -> list[bool]:
    """Pair by pair, whether the pieces lie less than a right angle apart in the drawing or in y only."""
    found = []
    for pair in mechanism.topology.paired_pieces[0]:
        along = []
        for numbers in (mechanism.drawn, y):
            (a, b), (c, d) = (tuple(numbers[mechanism.layout.span(end)] for end in piece) for piece in pair)
            along.append(float(np.dot(b - a, d - c)) > 0.0)
        found.append(along[0] != along[1])
    return found


@by_car
@pytest.mark.parametrize("seed", range(3))
def test_pieces_that_turn_over_are_found_in_each_car_and_the_first_such_pair_is_named(
    car: SampleCar, seed: int
) -> None:
    mechanism = car.mechanism()
    pairs, _ = mechanism.topology.paired_pieces
    rng = np.random.default_rng(seed)
    poses = mechanism.drawn + rng.normal(size=(40, len(mechanism.drawn))) * rng.choice(
        [0.0, 1e-3, 0.5], (40, 1)
    )
    expected = np.array([flips(mechanism, y) for y in poses]).reshape(40, len(pairs))
    bad, pair = turned_over(mechanism, poses)
    assert bad.tolist() == expected.any(axis=1).tolist()
    assert pair == (pairs[int(np.flatnonzero(expected.any(axis=0))[0])] if expected.any() else None)
    for y, turned in zip(poses, expected, strict=True):
        alone, its_pair = turned_over(mechanism, y)
        assert alone.shape == ()
        assert bool(alone) == any(turned)
        assert its_pair == (pairs[list(turned).index(True)] if any(turned) else None)
