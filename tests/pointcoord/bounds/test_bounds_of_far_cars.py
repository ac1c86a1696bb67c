"""A car that is drawn far away is bounded at every instant, by its rounding there and no more."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from sample_cars import SampleCar, by_car

from pointcoord import Scene, simulate
from pointcoord.numerics.rounding import UNIT_ROUNDOFF as U

SINE = {"sine": {"amplitude": 0.1, "angular_frequency": 2.3, "phase": 0.4, "offset": 1.5}}
# Whole numbers of mm: what is drawn in parts of 2^-20 mm and more is moved without rounding.
FAR = (2.0**20, -(2.0**21), 2.0**19)


@by_car
@pytest.mark.parametrize("rates", [False, True])
def test_a_far_car_is_as_well_proven_but_for_the_rounding_of_its_places(
    make_scene: Callable[..., Scene], car: SampleCar, rates: bool
) -> None:
    drawn = {name: tuple(round(c * 2**20) / 2**20 for c in place) for name, place in car.points.items()}
    moved = {name: tuple(np.add(place, FAR).tolist()) for name, place in drawn.items()}
    motions = [
        simulate(make_scene(SINE, [0.0, 3.0], car=car, points=points, samples=60, stop=1.0))
        for points in (drawn, moved)
    ]
    near, far = (motion.proof(rates=rates) for motion in motions)
    one, other = (motion.position for motion in motions)
    assert len(near.bound) == 60
    for name in one:
        apart = np.abs((other[name] - FAR) - one[name]).max(axis=-1)
        solved = name not in car.topology.carried
        allowed = near.bound + far.bound if solved else near.carried_bound + far.carried_bound
        # The difference is exact: numbers near 2^21 on both sides of it.
        assert (apart <= allowed + 2.0 * U * np.abs(one[name]).max()).all()
    # A few hundred roundings of a car of some 1000 mm, and one or two of its places.
    for bound in (near.pose_bound, near.bound, near.carried_bound, far.pose_bound):
        assert bound.min() > 0.0
        assert bound.max() <= 1000.0 * 1000.0 * U
    for bound, beside in ((far.bound, near.bound), (far.carried_bound, near.carried_bound)):
        assert (bound <= 1.5 * beside + 3.0 * U * 2.0**21).all()
        assert bound.max() >= 0.5 * U * 2.0**20
