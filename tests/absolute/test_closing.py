"""Closing a drawing is solving it at its own inputs."""

import math

import numpy as np
import pytest
from kinds import KINDS, Kind, with_rack

import absolute

EPS = float(np.finfo(float).eps)


@pytest.mark.parametrize("kind", [KINDS["strut"], KINDS["double wishbone"]])
@pytest.mark.parametrize("raised", [0.0, 3.0])
def test_a_drawing_is_closed_where_it_is_solved_at_its_own_inputs(kind: Kind, raised: float) -> None:
    car = with_rack(kind.random_car(2, True))
    car["rack_centre"] = car["rack_centre"] + np.array([0.0, 0.0, raised])
    closed = absolute.close_drawing(kind.build(car))
    inputs = {name: np.array([[value, 0.3, 0.2]]) for name, value in closed.inputs.items()}
    motion = absolute.solve(kind.build(car), inputs)
    for name, place in closed.position.items():
        assert place.shape == (3,)
        assert np.abs(place - motion.position[name][0]).max() <= 64 * EPS * 500.0
        moved = math.dist(place, car[name])
        assert closed.movement[name] == pytest.approx(moved, rel=1e-12, abs=1e-300)
        assert raised or moved < 1e-9


@pytest.mark.parametrize("kind", KINDS.values(), ids=KINDS)
def test_a_rack_drawn_at_its_centre_is_at_nothing_and_not_at_minus_nothing(kind: Kind) -> None:
    inputs = absolute.close_drawing(kind.build(kind.car)).inputs
    assert (inputs["rack"], math.copysign(1.0, inputs["rack"])) == (0.0, 1.0)
