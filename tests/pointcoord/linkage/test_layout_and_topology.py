"""The order of coordinates and the topologies: every number has one place and every place one number."""

from collections.abc import Callable

import numpy as np
import pytest

from pointcoord import UnknownName
from pointcoord.linkage.layout import Layout
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.linkage.topology import Topology
from pointcoord.method import SERIES
from pointcoord.suspensions import SUSPENSIONS
from validate.paper.printed import PRINTED

EVERY = [
    topology
    for method in (SERIES, PRINTED)
    for suspension in method.suspensions.values()
    for topology in suspension.closures.values()
]
by_name = pytest.mark.parametrize("topology", EVERY, ids=lambda topology: topology.name)


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
def test_unknown_coordinates_come_first(topology: Topology) -> None:
    layout = topology.layout
    vectors = {i for name in (*layout.moving, *layout.vectors) for i in layout.vector(name)}
    first = vectors | {layout.scalar(name) for name in layout.ratios}
    assert first == set(range(layout.unknowns))


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


@by_name
def test_points_of_bodies_and_carriers_are_points_of_the_car(topology: Topology) -> None:
    for points in (*topology.bodies.values(), *topology.carried.values()):
        assert set(points) <= set(topology.points)
    assert len(set(topology.points)) == len(topology.points)


@by_name
@pytest.mark.parametrize(
    ("read", "near", "valid"),
    [
        (
            lambda layout: layout.vector("strut_topp"),
            "strut_top",
            lambda layout: (*layout.moving, *layout.chassis),
        ),
        (
            lambda layout: layout.scalar("rack travle"),
            "rack travel",
            lambda layout: (*layout.ratios, *layout.driven),
        ),
    ],
    ids=["point", "scalar"],
)
def test_unknown_name_raises_with_the_names_that_exist(
    topology: Topology,
    read: Callable[[Layout], object],
    near: str,
    valid: Callable[[Layout], tuple[str, ...]],
) -> None:
    with pytest.raises(UnknownName, match=f"did you mean '{near}'") as caught:
        read(topology.layout)
    assert set(valid(topology.layout)) <= set(caught.value.valid)
    assert all(name in str(caught.value) for name in caught.value.valid)


def test_unknown_link_raises_with_the_links_that_exist() -> None:
    layout = SUSPENSIONS["macpherson"].closures["drawn"].layout
    with pytest.raises(UnknownName, match="tie_rod_inner"):
        layout.squared_length("strut_top", "wheel_centre")


def test_inputs_by_name_are_checked(strut: Mechanism) -> None:
    one = np.array([1.0])
    with pytest.raises(UnknownName, match="arm_angle, rack") as caught:
        strut.known_series({"arm_angle": one, "rack": one, "roll": one})
    assert caught.value.name == "roll"
    with pytest.raises(UnknownName, match="rack"):
        strut.known_series({"arm_angle": one})
