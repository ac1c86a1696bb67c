"""The subsystem that the requested points need: the rest of a linkage is not solved.

The blocks of the map that give the points, and those that these read, are kept with all that they are made
of: a constraint with all its rows and its own coordinates, a point and a vector with all three coordinates.
So what is left is a linkage like any other. Where its points are does not depend on what is left out, nor on
whether that can be assembled.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

from pointcoord.linkage.constraints.constraint import Constraint
from pointcoord.linkage.layout import Layout
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.linkage.topology import Topology


def needed_topology(topology: Topology, points: Collection[str]) -> Topology:
    """The part of a topology that some of its points hang on; all of it if no input moves them."""
    wanted = frozenset(points)
    if wanted.issuperset(topology.points) or topology.left_out:
        return topology
    carriers = {name for point in wanted & topology.carried.keys() for name in topology.carried[point]}
    moving = (wanted | carriers).intersection(topology.moving)
    layout = topology.layout
    chosen, read = _kept(topology, {i for name in moving for i in layout.vector(name)})
    drives = tuple(drive for drive in topology.drives if layout.scalar(drive.coordinate) in read)
    if not drives:
        return topology
    names = tuple(name for name in topology.moving if not read.isdisjoint(layout.vector(name)))
    there = {*names, *topology.chassis}
    carried = {n: by for n, by in topology.carried.items() if n in wanted and there.issuperset(by)}
    there |= carried.keys()
    return replace(
        topology,
        moving=names,
        bodies={body: ends for body, ends in topology.bodies.items() if there.issuperset(ends)},
        carried=carried,
        constraints=chosen,
        drives=drives,
    )


def needed_mechanism(mechanism: Mechanism, points: Collection[str]) -> Mechanism:
    """The part of a mechanism that some of its points hang on, with the same origin and unit."""
    topology = needed_topology(mechanism.topology, points)
    if topology is mechanism.topology:
        return mechanism
    places = topology.layout.places_in(mechanism.layout)
    return replace(
        mechanism,
        topology=topology,
        drawn=mechanism.drawn[..., places],
        drawn_lacks=mechanism.drawn_lacks[..., places],
        drawn_doubt=mechanism.drawn_doubt[..., places],
        carrier_weights={name: mechanism.carrier_weights[name] for name in topology.carried},
    )


def _kept(topology: Topology, unknowns: set[int]) -> tuple[tuple[Constraint, ...], set[int]]:
    """The constraints that some unknowns hang on, and all coordinates that they read."""
    system, layout = topology.map, topology.layout
    rows = topology.rows_of
    own = [_own(constraint, layout) for constraint in topology.constraints]
    block_of = {row: block for block in system.block_order.blocks for row in block.rows}
    triples = [layout.vector(name) for name in (*layout.moving, *layout.vectors)]
    wanted, read, kept = set(unknowns), set[int](), set[int]()
    while True:
        blocks = [system.block_order.blocks[number] for number in system.block_order.needed(wanted)]
        solved = {row for block in blocks for row in block.rows}
        more = {
            number
            for number, numbers in enumerate(rows)
            if not (solved.isdisjoint(numbers) and own[number].isdisjoint(read | wanted))
        }
        read = wanted.union(*(system.reads[row] for number in more for row in rows[number]))
        whole = {i for triple in triples if not read.isdisjoint(triple) for i in triple}
        # Rows of a constraint that is kept may belong to blocks that were not asked for.
        theirs = {i for number in more for row in rows[number] for i in block_of[row].unknowns}
        found = whole | theirs | {i for i in read if i < system.unknowns}
        if more == kept and found <= wanted:
            return tuple(topology.constraints[number] for number in sorted(kept)), read
        wanted, kept = wanted | found, more


def _own(constraint: Constraint, layout: Layout) -> set[int]:
    """The coordinates that belong to a constraint alone."""
    vectors = {i for name in constraint.vectors for i in layout.vector(name)}
    return vectors | {layout.scalar(name) for name in (*constraint.slides, *constraint.constants)}
