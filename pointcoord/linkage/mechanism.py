r"""A mechanism: a topology and the hardpoints of one car or of a batch of cars.

Lengths are measured from an origin near the mechanism, in a unit that is about its size and a power of two.
So neither the distance from the user's origin nor the size of the car costs accuracy, and scaling by a power
of two changes no bit of a result.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from pointcoord.errors import InputOutOfRange
from pointcoord.linkage.drawing import Drawing
from pointcoord.linkage.layout import Layout
from pointcoord.linkage.topology import Piece, Topology
from pointcoord.numerics.arrays import Array, Flags, Indices
from pointcoord.numerics.linear import Factors, factorise
from pointcoord.numerics.quadratic import QuadraticMap
from pointcoord.numerics.vectors import cross


@dataclass(frozen=True, eq=False)
class Mechanism:
    """A topology with hardpoints; build it with `hardpoints.build_mechanism`.

    Attributes:
        origin: origin of its coordinates, shape (..., 3), mm.
        unit: length of one unit of its coordinates, a power of two, shape (...,), mm.
        drawing: its drawn points and directions in its own coordinates.
        drawn: the coordinates y of the drawing, shape (..., size).
        drawn_lacks: rounding error of the known ones of these, to be added to them, shape (..., size).
        drawn_doubt: their uncertainty after that correction, shape (..., size).
        carrier_weights: coordinates of each carried point in the frame of its three carriers, shape (..., 3).
    """

    topology: Topology
    origin: Array
    unit: Array
    drawing: Drawing
    drawn: Array
    drawn_lacks: Array
    drawn_doubt: Array
    carrier_weights: Mapping[str, Array]

    @property
    def layout(self) -> Layout:
        """The order of the coordinates."""
        return self.topology.layout

    @property
    def map(self) -> QuadraticMap:
        """The constraints."""
        return self.topology.map

    @cached_property
    def drawn_places(self) -> Mapping[str, Array]:
        """Drawn place of every point, each of shape (..., 3), mm from the origin."""
        unit = self.unit[..., None]
        return {name: self.drawing.vectors[name] * unit for name in self.topology.points}

    @cached_property
    def drawn_factors(self) -> Factors:
        """Factorisation of C_u in the drawing."""
        return factorise(self.map.jacobian(self.drawn))

    @cached_property
    def carried_gain(self) -> float:
        """Largest ratio of a carried point's error bound to that of its carriers' coordinates.

        |dp| <= |1 - a - b| |dp_0| + |a| |dp_1| + |b| |dp_2| + |c| |d(e1 x e2)|. The error of an edge is twice
        that of its ends; the error of a component of the cross product is that times the edges' other
        components. The maximum is over all points, and over all cars of a batch.
        """
        gains = [1.0] * (not self.topology.carried)
        for name, carriers in self.topology.carried.items():
            base, first, second = (self.drawing.vectors[point] for point in carriers)
            sides = np.abs(first - base) + np.abs(second - base)
            others = (sides.sum(axis=-1, keepdims=True) - sides).max(axis=-1)
            a, b, c = np.moveaxis(self.carrier_weights[name], -1, 0)
            gain = np.abs(1.0 - a - b) + np.abs(a) + np.abs(b) + 2.0 * np.abs(c) * others
            gains.append(float(np.max(gain)))
        return max(gains)

    def part(self, points: Collection[str]) -> Mechanism:
        """The part that determines some points (see `Topology.part`), with the same origin and unit."""
        topology = self.topology.part(points)
        if topology is self.topology:
            return self
        places = topology.layout.places_in(self.layout)
        return replace(
            self,
            topology=topology,
            drawn=self.drawn[..., places],
            drawn_lacks=self.drawn_lacks[..., places],
            drawn_doubt=self.drawn_doubt[..., places],
            carrier_weights={name: self.carrier_weights[name] for name in topology.carried},
        )

    def taken(self, members: Indices | int) -> Mechanism:
        """Some members of a batch with one dimension, by number, or one car of it."""
        vectors, lacks = (
            {name: place[members] if place.ndim > 1 else place for name, place in table.items()}
            for table in (self.drawing.vectors, self.drawing.lacks)
        )
        return replace(
            self,
            origin=self.origin[members],
            unit=self.unit[members],
            drawing=Drawing(vectors, self.unit[members], lacks),
            drawn=self.drawn[members],
            drawn_lacks=self.drawn_lacks[members],
            drawn_doubt=self.drawn_doubt[members],
            carrier_weights={name: weights[members] for name, weights in self.carrier_weights.items()},
        )

    def places(self, y: Array) -> dict[str, Array]:
        """Every point of poses y, shape (..., size), in the mechanism's units; each of shape (..., 3)."""
        topology = self.topology
        found = {name: y[..., self.layout.span(name)] for name in (*topology.chassis, *topology.moving)}
        for name, carriers in topology.carried.items():
            found[name] = carried_place(self.carrier_weights[name], *(found[one] for one in carriers))
        return found

    def turned_over(self, y: Array) -> tuple[Flags, tuple[Piece, Piece] | None]:
        """Which poses y, (..., size), have two pieces of a line that turn over; and one such pair of pieces.

        In a drawing that is not assembled, points are first moved onto their line. Pieces drawn more than a
        right angle apart, each in its own direction, would reverse relative to each other on the way, and the
        drawing does not tell which of them was meant.
        """
        pairs, places = self.topology.paired_pieces

        def along(coordinates: Array) -> Array:
            """Signs of the scalar products of each pair, (..., pairs)."""
            ends = coordinates[..., places]
            edges = ends[..., 1, :] - ends[..., 0, :]
            return np.asarray(np.sign((edges[..., 0, :] * edges[..., 1, :]).sum(axis=-1)))

        flipped = np.broadcast_to(along(self.drawn) != along(y), (*y.shape[:-1], len(pairs)))
        bad = np.asarray(flipped.any(axis=-1))
        if not bad.any():
            return bad, None
        return bad, pairs[int(np.argmax(flipped.reshape(-1, len(pairs)).any(axis=0)))]

    def known_series(self, inputs: Mapping[str, Array]) -> Array:
        """Series of all known coordinates from the series of the inputs.

        Args:
            inputs: coefficients of each input that drives a coordinate, shape (..., order + 1), rad or mm
                per s**k. Chassis inputs take no part in the constraints (see `chassis`).
        Returns:
            Coefficients, shape (..., order + 1, known coordinates), in the mechanism's units.
        Raises:
            InputOutOfRange: a value or a rate that is not finite, or a value outside its drive's range.
        """
        topology, layout = self.topology, self.layout
        shapes = {s.shape[:-1] for s in inputs.values()} | {self.drawn.shape[:-1]}
        batch = () if shapes == {()} else np.broadcast_shapes(*shapes)
        orders = inputs[topology.required_inputs[0]].shape[-1]
        known = np.zeros((*batch, orders, layout.size - layout.unknowns), self.drawn.dtype)
        known[..., 0, :] = self.drawn[..., layout.unknowns :]
        for drive, place in zip(topology.drives, topology.driven, strict=True):
            known[..., place - layout.unknowns] = drive.series(inputs[drive.input], self.drawing)
        # NaN in an input becomes NaN in the coordinate that it drives.
        if np.isfinite(known).all():
            return known
        for name, series in inputs.items():
            if not np.isfinite(series).all():
                worst = float(series[~np.isfinite(series)][0])
                raise InputOutOfRange(name, worst, "finite values and rates of every order")
        largest = max(inputs, key=lambda name: float(np.abs(inputs[name]).max()))
        worst = float(np.abs(inputs[largest]).max())
        raise InputOutOfRange(largest, worst, "values and rates that stay finite in every product")

    def input_values(self, known: Array) -> dict[str, Array]:
        """The inputs for known coordinates, shape (..., known coordinates) to (...)."""
        first = self.layout.unknowns
        found: dict[str, Array] = {}
        for drive in self.topology.drives:
            value = drive.input_value(known[..., self.layout.scalar(drive.coordinate) - first], self.drawing)
            turned = drive.input in found and drive.unit == "rad"
            # For a rotation, the cosine gives the size, and then the sine gives the sign.
            found[drive.input] = np.copysign(found[drive.input], value) if turned else value
        return found

    @property
    def drawn_inputs(self) -> dict[str, Array]:
        """The inputs at which the drawing stands, which closing it keeps, each (...), rad or mm."""
        return self.input_values(self.drawn[..., self.layout.unknowns :])

    def known_data(self, y: Array, laws: Mapping[str, Array] | None = None) -> tuple[Array, Array]:
        """Rounding errors of the known coordinates, to be added to them, and the uncertainties that remain.

        Drawn points and directions are exact, except where rows are left out of the mechanism. The errors of
        lengths and other constants of the drawing were stored with the drawing; drives compute theirs (see
        `drives`).

        Args:
            laws: error bound of the value of each input, shape (...,), rad or mm; zero unless given.
        Returns:
            Two arrays of shape (..., size): y plus the first is exact to within the second.
        """
        layout = self.layout
        lacking, uncertainty = (
            np.broadcast_to(drawn, y.shape).copy() for drawn in (self.drawn_lacks, self.drawn_doubt)
        )
        for drive in self.topology.drives:
            place = layout.scalar(drive.coordinate)
            lacking[..., place], uncertainty[..., place] = drive.rounding(
                y[..., place], self.drawing, 0.0 if laws is None else laws[drive.input]
            )
        return lacking, uncertainty


def carried_place(
    weights: Array,
    base: Array,
    first: Array,
    second: Array,
    *,
    product: Callable[[Array, Array], Array] = cross,
) -> Array:
    """A point fixed to a body, p = p_0 + a e1 + b e2 + c e1 x e2, shape (..., 3).

    The weights are constants from the drawing (see `constraints.in_body`), so the point needs no equation.

    Args:
        weights: (a, b, c), shape (..., 3).
        base, first, second: places of the three carriers, shape (..., 3).
        product: cross product of two vectors.
    """
    e1, e2 = first - base, second - base
    a, b, c = (weights[..., i, None] for i in range(3))
    return np.asarray(base + a * e1 + b * e2 + c * product(e1, e2))
