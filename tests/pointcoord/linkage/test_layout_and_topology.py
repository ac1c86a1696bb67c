"""The order of coordinates and the topologies: every number has one place, also in a part of them."""

import numpy as np
import pytest
from sample_cars import SampleCar, by_car

from pointcoord import UnknownName
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.linkage.needed_part import needed_mechanism, needed_topology
from pointcoord.linkage.topology import Topology
from pointcoord.mechanism import mechanism_file, shipped
from validate.paper.printed import TOPOLOGY

SHIPPED = [mechanism_file(name).topology(c) for name in shipped() for c in mechanism_file(name).closures]
# Equations that only a drawing shows to be redundant leave a mechanism no input of its own.
EVERY = [*(topology for topology in SHIPPED if topology.drives), TOPOLOGY]
by_name = pytest.mark.parametrize("topology", EVERY, ids=lambda topology: topology.name)


@by_name
def test_every_index_of_the_coordinates_is_used_once(topology: Topology) -> None:
    layout = topology.layout
    used = [layout.zero, layout.one]
    for name in (*layout.moving, *layout.vectors, *layout.chassis, *layout.directions):
        used += layout.vector(name)
    used += [layout.scalar(name) for name in (*layout.ratios, *layout.driven, *layout.constants)]
    assert sorted(used) == list(range(layout.size))


@by_name
def test_there_are_as_many_equations_as_unknowns_and_each_unknown_is_in_one(topology: Topology) -> None:
    layout, system = topology.layout, topology.map
    assert len(system.rows) == len(topology.labels) == len(set(topology.labels)) == layout.unknowns
    touched = {i for row in system.rows for product in row for i in (*product.left, *product.right)}
    assert touched >= set(range(layout.unknowns))


def test_inputs_by_name_are_checked(strut: Mechanism) -> None:
    one = np.array([1.0])
    with pytest.raises(UnknownName, match="arm_angle, rack") as caught:
        strut.known_series({"arm_angle": one, "rack": one, "roll": one})
    assert caught.value.name == "roll"
    with pytest.raises(UnknownName, match="rack"):
        strut.known_series({"arm_angle": one})


@by_name
def test_of_a_force_in_one_row_its_constraint_takes_part_and_no_other(topology: Topology) -> None:
    row = 0
    for constraint in topology.constraints:
        for _ in constraint.labels:
            forces = np.zeros(len(topology.labels))
            forces[row] = -3.0
            assert topology.strongest(forces) == (constraint.name,)
            row += 1
    assert row == len(topology.labels)


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
    bad, pair = mechanism.turned_over(poses)
    assert bad.tolist() == expected.any(axis=1).tolist()
    assert pair == (pairs[int(np.flatnonzero(expected.any(axis=0))[0])] if expected.any() else None)
    for y, turned in zip(poses, expected, strict=True):
        alone, its_pair = mechanism.turned_over(y)
        assert alone.shape == ()
        assert bool(alone) == any(turned)
        assert its_pair == (pairs[list(turned).index(True)] if any(turned) else None)


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
def test_where_everything_is_asked_for_or_nothing_moves_the_linkage_is_whole(car: SampleCar) -> None:
    topology, mechanism = car.topology, car.mechanism()
    assert needed_topology(topology, topology.points) is topology
    assert needed_topology(topology, topology.chassis) is topology
    assert needed_topology(topology, ()) is topology
    assert needed_mechanism(mechanism, mechanism.topology.points) is mechanism
