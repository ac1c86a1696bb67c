"""A topology: how points are joined, as data, without dimensions of a particular car."""

from __future__ import annotations

from collections.abc import Collection, Hashable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import combinations

import numpy as np

from pointcoord.linkage.constraints.constraint import Constraint
from pointcoord.linkage.drives import Drive
from pointcoord.linkage.layout import Layout
from pointcoord.numerics.arrays import Array, Indices
from pointcoord.numerics.block_order import rows_too_many
from pointcoord.numerics.quadratic import QuadraticMap, quadratic_map

Piece = tuple[str, str]


@dataclass(frozen=True)
class Topology:
    """A linkage as points, bodies, constraints and inputs, with names for the parts that effects need.

    Attributes:
        name: the linkage's name in messages.
        chassis: points of the chassis. moving: points to be solved for.
        bodies: body of three or more points whose rates are needed -> its points.
        carried: point fixed to a body without constraining it -> the three points that carry it.
        directions: vector fixed to the chassis -> the points from and to which it is drawn; where the first
            is empty, the second is a direction of the car.
        constraints: links, slides, rack, driven heights.
        drives: the drives of coordinates by inputs.
        roles: role -> its points (see `mechanisms/README.md`); a part's roles start with the part and a dot;
            for a knuckle, the points that represent it.
        sides: part -> its side of the car, left or right; empty without parts.
        rods: rod -> its two ends.
        joints: point of a ball joint of exactly two bodies, or both of a hinge -> the other points of the
            body that exerts the reported force; empty if that is the chassis.
        sliding: point on a slide whose force is reported -> the slide, and whether the force is reported on
            the line's body instead of the point.
        stand_ins: point that a car need not give -> the point that then stands in for it.
        chassis_inputs: input that moves the whole chassis, zero if not given -> its direction, and for a
            rotation the drawn point about which it turns, else "". Rotations come before displacements, in
            this order.
        rolling: the driven chassis inputs that turn it about a line along the car.
        left_out: numbers of rows that follow from the others; they are not part of the map, and are checked
            again at every solution.
        puts_in_place: whether closing the drawing moves points on purpose, however far.
    """

    name: str
    chassis: tuple[str, ...]
    moving: tuple[str, ...]
    bodies: Mapping[str, tuple[str, ...]]
    carried: Mapping[str, tuple[str, str, str]]
    directions: Mapping[str, Piece]
    constraints: tuple[Constraint, ...]
    drives: tuple[Drive, ...]
    roles: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    sides: Mapping[str, str] = field(default_factory=dict)
    rods: Mapping[str, Piece] = field(default_factory=dict)
    joints: Mapping[tuple[str, ...], tuple[str, ...]] = field(default_factory=dict)
    sliding: Mapping[str, tuple[str, bool]] = field(default_factory=dict)
    stand_ins: Mapping[str, str] = field(default_factory=dict)
    chassis_inputs: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    rolling: tuple[str, ...] = ()
    puts_in_place: bool = False
    left_out: tuple[int, ...] = ()

    @cached_property
    def points(self) -> tuple[str, ...]:
        """Every point that a car with this linkage has."""
        return (*self.chassis, *self.moving, *self.carried)

    @property
    def required_points(self) -> tuple[str, ...]:
        """Points that must be given."""
        return tuple(name for name in self.points if name not in self.stand_ins)

    def role(self, name: str) -> tuple[str, ...]:
        """The points of a role; empty without such a role."""
        return self.roles.get(name, ())

    @property
    def wheel_axis(self) -> tuple[str, ...]:
        """The wheel axis of a mechanism without parts."""
        return self.role("wheel_axis")

    @property
    def wheel_centre(self) -> str:
        """The outer point of the wheel's axis; empty without one."""
        return self.wheel_axis[1] if self.wheel_axis else ""

    def driven_along(self, way: str, part: str = "") -> tuple[str, ...]:
        """The driven inputs of a kind: the travel of a slide (`by_rack`), other inputs of the linkage
        (`by_travel`), or inputs that roll the chassis (`by_roll`).

        Args:
            part: part whose wheel they move; inputs of other parts are left out.
        """
        if way == "by_roll":
            return self.rolling
        steering = {drive.input for drive in self.drives if drive.of_slide}
        others = tuple(f"{other}." for other in self.sides if other != part)
        return tuple(
            name
            for name in self.holding_inputs
            if (name in steering) == (way == "by_rack") and not name.startswith(others)
        )

    @cached_property
    def required_inputs(self) -> tuple[str, ...]:
        """Inputs that must be given: those that drive a coordinate.

        Chassis inputs are included where a height over the ground is driven.
        """
        return tuple(dict.fromkeys(drive.input for drive in self.drives))

    @property
    def holding_inputs(self) -> tuple[str, ...]:
        """The required inputs that hold a freedom of the mechanism."""
        return tuple(name for name in self.required_inputs if name not in self.chassis_inputs)

    @cached_property
    def turning(self) -> tuple[str, ...]:
        """The inputs that are rotations without limits, from the drawing; each has two coordinates."""
        return tuple(dict.fromkeys(drive.input for drive in self.drives if drive.is_turn))

    @cached_property
    def driven(self) -> tuple[int, ...]:
        """Indices of the driven coordinates, drive by drive."""
        return tuple(self.layout.scalar(drive.coordinate) for drive in self.drives)

    @property
    def inputs(self) -> tuple[str, ...]:
        """Every input that may be given."""
        return tuple(dict.fromkeys((*self.required_inputs, *self.chassis_inputs)))

    @property
    def input_units(self) -> dict[str, str]:
        """The unit of every input, rad or mm."""
        chassis = {name: "rad" if about else "mm" for name, (_, about) in self.chassis_inputs.items()}
        return {drive.input: drive.unit for drive in self.drives} | chassis

    @cached_property
    def _every_label(self) -> tuple[str, ...]:
        return tuple(label for constraint in self.constraints for label in constraint.labels)

    @cached_property
    def labels(self) -> tuple[str, ...]:
        """A name for each row of the map."""
        return tuple(label for row, label in enumerate(self._every_label) if row not in self.left_out)

    @cached_property
    def left_labels(self) -> tuple[str, ...]:
        """A name for each row that is left out."""
        return tuple(self._every_label[row] for row in self.left_out)

    @cached_property
    def rows_of(self) -> tuple[tuple[int, ...], ...]:
        """Row numbers of each constraint in the map; fewer than the constraint has if some are left out."""
        found, every, number = [], iter(range(len(self._every_label))), 0
        for constraint in self.constraints:
            kept = sum(next(every) not in self.left_out for _ in constraint.labels)
            found.append(tuple(range(number, number + kept)))
            number += kept
        return tuple(found)

    def largest(self, parts: Array) -> tuple[str, ...]:
        """Names of the constraints with the largest parts of a sum over the rows, down to a tenth.

        Args:
            parts: one per row, shape (rows,).
        """
        sizes = {
            constraint.name: abs(float(parts[list(rows)].sum()))
            for constraint, rows in zip(self.constraints, self.rows_of, strict=True)
        }
        ranked = sorted(sizes, key=sizes.__getitem__, reverse=True)
        return tuple(name for name in ranked if sizes[name] > 0.1 * sizes[ranked[0]])

    @cached_property
    def layout(self) -> Layout:
        """The order of the coordinates."""
        return Layout(
            moving=self.moving,
            ratios=tuple(name for c in self.constraints for name in c.slides),
            chassis=self.chassis,
            directions=tuple(self.directions),
            driven=tuple(dict.fromkeys(drive.coordinate for drive in self.drives)),
            vectors=tuple(name for c in self.constraints for name in c.vectors),
            constants=tuple(name for c in self.constraints for name in c.constants),
        )

    @cached_property
    def paired_pieces(self) -> tuple[tuple[tuple[Piece, Piece], ...], Indices]:
        """Pairs of pieces of one line, and the coordinates of their starts and ends, (pairs, 2, 2, 3).

        A piece is a pair of points with a sense along the line: a link on it, or its start and a slider.
        """
        on_lines: dict[Piece, list[str]] = {}
        for constraint in self.constraints:
            if constraint.aligned:
                start, end, point = constraint.aligned
                on_lines.setdefault((start, end), []).append(point)
        links = [ends for constraint in self.constraints for ends in constraint.squared_lengths]
        pairs: list[tuple[Piece, Piece]] = []
        for (start, end), slides in on_lines.items():
            rigid = [link for link in links if {start, end, *slides}.issuperset(link)]
            pairs += combinations([*rigid, *((start, point) for point in slides)], 2)
        places = [[[self.layout.vector(end) for end in piece] for piece in pair] for pair in pairs]
        return tuple(pairs), np.array(places, dtype=np.intp).reshape(-1, 2, 2, 3)

    @cached_property
    def map(self) -> QuadraticMap:
        """All constraints as one quadratic map, shared by all cars of this topology."""
        return self._map_of([row for row in range(len(self._every_label)) if row not in self.left_out])

    @cached_property
    def left_map(self) -> QuadraticMap:
        """The rows that are left out, as a map of the same coordinates."""
        return self._map_of(self.left_out)

    def _map_of(self, numbers: Iterable[int]) -> QuadraticMap:
        rows = [row for constraint in self.constraints for row in constraint.rows(self.layout)]
        return quadratic_map([rows[number] for number in numbers], self.layout.unknowns, self.layout.size)

    def without(self, rows: tuple[int, ...]) -> Topology:
        """The topology with redundant rows left out; cached."""
        if rows not in self._others:
            self._others[rows] = replace(self, left_out=rows)
        return self._others[rows]

    def part(self, points: Collection[str]) -> Topology:
        """The part that determines some points; cached. The whole topology if no input moves these points.

        The blocks of the map that give the points are kept, and all blocks that these read. A constraint is
        kept with all its rows and its own coordinates, a point or a vector with all three coordinates. So the
        part is a linkage like any other. The places of its points do not depend on what is left out, nor on
        whether the rest can be assembled.
        """
        wanted = frozenset(points)
        if wanted.issuperset(self.points) or self.left_out:
            return self
        if wanted not in self._others:
            self._others[wanted] = self._part(wanted)
        return self._others[wanted]

    @cached_property
    def _others(self) -> dict[Hashable, Topology]:
        return {}

    def _part(self, wanted: frozenset[str]) -> Topology:
        layout = self.layout
        carriers = {name for point in wanted & self.carried.keys() for name in self.carried[point]}
        moving = (wanted | carriers).intersection(self.moving)
        chosen, read = self._kept({i for name in moving for i in layout.vector(name)})
        drives = tuple(drive for drive in self.drives if layout.scalar(drive.coordinate) in read)
        if not drives:
            return self
        names = tuple(name for name in self.moving if not read.isdisjoint(layout.vector(name)))
        there = {*names, *self.chassis}
        carried = {n: by for n, by in self.carried.items() if n in wanted and there.issuperset(by)}
        there |= carried.keys()
        bodies = {body: ends for body, ends in self.bodies.items() if there.issuperset(ends)}
        return replace(self, moving=names, bodies=bodies, carried=carried, constraints=chosen, drives=drives)

    def _kept(self, unknowns: set[int]) -> tuple[tuple[Constraint, ...], set[int]]:
        """The constraints that determine some unknowns, and all coordinates that these constraints read."""
        system, layout, order = self.map, self.layout, self.map.block_order
        own = [_own(constraint, layout) for constraint in self.constraints]
        block_of = {row: block for block in order.blocks for row in block.rows}
        triples = [layout.vector(name) for name in (*layout.moving, *layout.vectors)]
        read, before = set(unknowns), set[int]()
        while read != before:
            before = set(read)
            solved = {row for number in order.needed(read) for row in order.blocks[number].rows}
            kept = [
                number
                for number, rows in enumerate(self.rows_of)
                if not (solved.isdisjoint(rows) and own[number].isdisjoint(read))
            ]
            for row in (row for number in kept for row in self.rows_of[number]):
                # Rows of a kept constraint may belong to further blocks.
                read.update(system.reads[row], block_of[row].unknowns)
            read.update(i for triple in triples if not read.isdisjoint(triple) for i in triple)
        return tuple(self.constraints[number] for number in kept), read

    @cached_property
    def fighting(self) -> tuple[str, ...]:
        """Inputs of rows that outnumber the coordinates they determine, in every drawing of the car."""
        rows = rows_too_many(self.map.reads, self.map.unknowns)
        read = {coordinate for row in rows for coordinate in self.map.reads[row]}
        named = (drive.input for drive in self.drives if self.layout.scalar(drive.coordinate) in read)
        return tuple(dict.fromkeys(named))


def _own(constraint: Constraint, layout: Layout) -> set[int]:
    """The coordinates that belong to this constraint alone."""
    vectors = {i for name in constraint.vectors for i in layout.vector(name)}
    return vectors | {layout.scalar(name) for name in (*constraint.slides, *constraint.constants)}
