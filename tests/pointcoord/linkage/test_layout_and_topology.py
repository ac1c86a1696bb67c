"""The order of coordinates and the topologies: every number has one place and every place one number."""

import numpy as np
import pytest

from pointcoord import InputOutOfRange, UnknownName
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.linkage.topology import Topology
from pointcoord.mechanism import mechanism_file, shipped
from validate.paper.printed import TOPOLOGY

SHIPPED = [mechanism_file(name).topology(c) for name in shipped() for c in mechanism_file(name).closures]
# Equations that only a drawing shows to be redundant leave a mechanism no input of its own.
EVERY = [*(topology for topology in SHIPPED if topology.drives), TOPOLOGY]
by_name = pytest.mark.parametrize("topology", EVERY, ids=lambda topology: topology.name)
CORNERS = [topology for topology in EVERY if topology.knuckle]
by_corner = pytest.mark.parametrize("topology", CORNERS, ids=lambda topology: topology.name)


@by_name
def test_every_index_of_the_coordinates_is_used_once(topology: Topology) -> None:
    layout = topology.layout
    used = [layout.zero, layout.one]
    for name in (*layout.moving, *layout.vectors, *layout.chassis, *layout.directions):
        used += layout.vector(name)
    used += [layout.scalar(name) for name in (*layout.ratios, *layout.driven, *layout.constants)]
    used += [layout.squared_length(*link) for link in layout.squared_lengths]
    assert sorted(used) == list(range(layout.size))


@by_name
def test_every_unknown_has_a_name_of_its_own(topology: Topology) -> None:
    layout = topology.layout
    names = [layout.describe(i) for i in range(layout.unknowns)]
    assert len(set(names)) == layout.unknowns
    for name in (*layout.moving, *layout.vectors):
        assert [names[i] for i in layout.vector(name)] == [f"{axis} of {name}" for axis in "xyz"]
    for name in layout.ratios:
        assert names[layout.scalar(name)] == name


@by_name
def test_there_are_as_many_equations_as_unknowns_and_each_unknown_is_in_one(topology: Topology) -> None:
    layout, system = topology.layout, topology.map
    assert len(system.rows) == len(topology.labels) == len(set(topology.labels)) == layout.unknowns
    touched = {i for row in system.rows for product in row for i in (*product.left, *product.right)}
    assert touched >= set(range(layout.unknowns))


@by_corner
def test_the_parts_that_a_topology_names_are_its_own(topology: Topology) -> None:
    body = topology.bodies[topology.knuckle]
    riding = {name for name, carriers in topology.carried.items() if set(carriers) <= set(body)}
    assert set(topology.wheel_axis) <= riding | set(topology.moving)
    assert topology.wheel_axis[1:] == (topology.wheel_centre,)
    assert not topology.steering_axis or set(topology.steering_axis) & set(body)
    assert topology.inboard in topology.chassis
    assert set(topology.input_units) == set(topology.inputs)
    # What an input drives is a known coordinate, a point moves with it, and along a direction of the chassis.
    for drive in topology.drives:
        assert drive.coordinate in topology.layout.driven
        assert drive.point in topology.moving
        assert drive.direction in topology.directions


def test_inputs_by_name_are_checked(strut: Mechanism) -> None:
    one = np.array([1.0])
    with pytest.raises(UnknownName, match="arm_angle, rack") as caught:
        strut.known_series({"arm_angle": one, "rack": one, "roll": one})
    assert caught.value.name == "roll"
    with pytest.raises(UnknownName, match="rack"):
        strut.known_series({"arm_angle": one})


@pytest.mark.parametrize("bad", [np.inf, -np.inf, np.nan])
def test_an_input_or_rate_that_is_not_finite_is_refused_by_name(strut: Mechanism, bad: float) -> None:
    laws = {"arm_angle": np.array([1.0, 0.5, 0.0]), "rack": np.array([2.0, bad, 0.0])}
    with pytest.raises(InputOutOfRange, match="finite values and rates of every order") as caught:
        strut.known_series(laws)
    assert caught.value.name == "rack"
    assert np.array_equal(caught.value.value, bad, equal_nan=True)


def test_rates_whose_products_are_not_finite_are_refused_with_the_largest(strut: Mechanism) -> None:
    laws = {"rack": np.array([2.0, 5.0, 0.0]), "arm_angle": np.array([1.0, -1e200, 0.0])}
    with pytest.raises(InputOutOfRange, match="stay finite in every product") as caught:
        strut.known_series(laws)
    assert (caught.value.name, caught.value.value) == ("arm_angle", 1e200)


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
