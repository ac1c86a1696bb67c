"""The part of a linkage that a point hangs on is a linkage of its own, with the same numbers and no more."""

import numpy as np
from sample_cars import SampleCar, by_car

from pointcoord.linkage.needed_part import needed_mechanism, needed_topology


@by_car
def test_what_a_point_hangs_on_is_solved_for_as_in_the_whole(car: SampleCar) -> None:
    whole = car.mechanism()
    y = whole.drawn + 0.1 * np.random.default_rng(3).normal(size=whole.drawn.shape)
    y[whole.layout.zero], y[whole.layout.one] = 0.0, 1.0
    rows = dict(zip(whole.topology.labels, whole.map.residual(y), strict=True))
    for point in whole.topology.moving + tuple(whole.topology.carried):
        part = needed_mechanism(whole, {point})
        places = part.layout.places_in(whole.layout)
        assert len(part.topology.labels) == part.layout.unknowns
        assert np.array_equal(part.map.residual(y[places]), [rows[label] for label in part.topology.labels])
        for name in ("drawn", "drawn_lacks", "drawn_doubt"):
            assert np.array_equal(getattr(part, name), getattr(whole, name)[places])
        assert point in part.topology.points
        assert np.array_equal(part.places(y[places])[point], whole.places(y)[point])
        assert (part.origin is whole.origin, part.unit is whole.unit) == (True, True)
        assert set(part.carrier_weights) == set(part.topology.carried)
        # And with it everything that rides on bodies that are there, if it was asked for, and nothing else.
        assert set(part.topology.carried) == ({point} & set(whole.topology.carried))
        there = set(part.topology.points)
        assert set(part.topology.bodies) == {
            b for b, ends in whole.topology.bodies.items() if set(ends) <= there
        }


@by_car
def test_a_point_of_an_arm_hangs_on_the_arm_alone_and_one_of_the_rack_on_the_rack(car: SampleCar) -> None:
    topology = car.topology
    ball = needed_topology(topology, {"lower_ball_joint"})
    assert ball.moving == ("lower_ball_joint",)
    assert ball.required_inputs == ("arm_angle",)
    assert len(ball.constraints) == 3  # two links and the height
    rack = needed_topology(topology, {"tie_rod_inner"})
    assert rack.moving == ("tie_rod_inner",)
    assert rack.required_inputs == ("rack",)
    both = needed_topology(topology, {"tie_rod_inner", "lower_ball_joint"})
    assert set(both.moving) == {"tie_rod_inner", "lower_ball_joint"}
    assert both.required_inputs == topology.required_inputs


@by_car
def test_the_wheel_hangs_on_every_input_and_brings_the_knuckle_along(car: SampleCar) -> None:
    wheel = needed_topology(car.topology, {"wheel_centre"})
    assert wheel.required_inputs == car.topology.required_inputs
    assert wheel.bodies[wheel.knuckle] == car.topology.bodies[wheel.knuckle]
    assert tuple(wheel.carried) == ("wheel_centre",)


@by_car
def test_where_everything_is_asked_for_or_nothing_moves_the_linkage_is_whole(car: SampleCar) -> None:
    topology, mechanism = car.topology, car.mechanism()
    assert needed_topology(topology, topology.points) is topology
    assert needed_topology(topology, topology.chassis) is topology
    assert needed_topology(topology, ()) is topology
    assert needed_mechanism(mechanism, mechanism.topology.points) is mechanism
