r"""How the numbers of a pose change with each coordinate of the drawing and each input: exact derivatives.

The constraints C(y, p, x) = 0 hold in every design, so with a change of a coordinate p of the drawing, or of
an input x, at the same other inputs

    dy / dp = -C_y^-1 C_p,      and likewise for y' and y'' from the equations differentiated by time.

All of it is the reference's own text of its equations, evaluated with dual numbers of arrays
(`reference.in_doubles`). What the equations take of the drawing (points of the chassis, squared lengths, the
knuckle's shape, the number that an input stands for) are roots and quotients of polynomials of its points,
whose slopes are differences in exact fractions or many digits over a step of 2^-100 of the car's size: what a
difference leaves out is of that size as well, 10^14 times below the rounding of a double, and nothing is lost
by subtracting.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene
from pointcoord.data_classes import dataclass
from pointcoord.effects.registry import QUANTITIES
from validate.extras import MissingPackage
from validate.formulations.asked_numbers import per_second

try:
    from flint import ctx

    from validate.reference import Design
    from validate.reference.design import balls, values_only
    from validate.reference.drives import Drive
    from validate.reference.dual import Dual, slope_of
    from validate.reference.effects.effect import Axes
    from validate.reference.effects.registry import EFFECTS
    from validate.reference.exact import as_ball, as_fraction
    from validate.reference.in_doubles import (
        ORDERS,
        Constant,
        changes_of,
        floats_of_jet,
        inverse_of,
        jacobian_of,
        known_in_doubles,
        lift,
        local_places,
        newton_step,
        order_of,
        part_of,
        unknown_jets_of,
        with_slopes,
    )
    from validate.reference.jet import Jet
    from validate.reference.kinematics import body_turns
    from validate.reference.linkage import Known, Link
    from validate.reference.vectors import Vector, dot, minus, plus
except ImportError as error:
    raise MissingPackage("validate.fitting", error) from None

Array = NDArray[np.float64]
# By coordinate, the points that move with it, each along an axis.
Moves = Mapping[str, Sequence[tuple[str, int]]]
Slopes = dict[str, dict[str, Array]]

STEP = Fraction(1, 2**100)  # of the car's size
BITS = 300  # of numbers that are no fractions: the step's 100 and three doubles more
DIGITS = 60  # of an input as drawn
JUMP = 2.0**-40  # what changes by more over a step is a choice of scale that fell out differently
AT_ONCE = 1024  # instants: each has a slope of every unknown by every coordinate
OFF_THE_POSE = 1e-6  # of the size: what Newton's method moves a pose by that the equations do not hold at


@dataclass(frozen=True)
class _Moved:
    """A drawing a step away: its points, its lengths, the knuckle's shape, and the step; local, exact."""

    table: Mapping[str, Vector]
    lengths: Mapping[Link, Fraction]
    shape: Mapping[str, Vector]
    step: Fraction


@dataclass(frozen=True)
class CarSlopes:
    """A car and what of it changes.

    Attributes:
        moves: the coordinates, one direction each. inputs: further directions, at a held drawing.
    """

    scene: Scene
    moves: Moves
    inputs: tuple[str, ...] = ()

    def at(
        self, places: Mapping[str, Array], laws: Mapping[str, Array], wanted: Iterable[str]
    ) -> tuple[Slopes, Slopes]:
        """Slopes of quantities at some instants, by coordinates and by inputs; per mm or rad.

        Args:
            places: where every point is, (N, 3), mm.
            laws: of every input that does not rest at zero, value, rate and acceleration, (N, 3); rad or mm.
            wanted: quantities.
        Returns:
            By quantity and name, (directions, N, 3) of points and bodies and (directions, N) of the car. NaN
            at an instant whose pose is not one of the equations, or singular.
        """
        count = len(next(iter(places.values())))
        names = tuple(wanted)
        parts = [
            self._at(
                {name: place[low : low + AT_ONCE] for name, place in places.items()},
                {name: law[low : low + AT_ONCE] for name, law in laws.items()},
                names,
            )
            for low in range(0, count, AT_ONCE)
        ]
        whole = {
            q: {n: np.concatenate([part[q][n] for part in parts], axis=1) for n in parts[0][q]} for q in names
        }
        coordinates = len(self.moves)
        by_drawing = {q: {n: a[:coordinates] for n, a in part.items()} for q, part in whole.items()}
        by_inputs = {q: {n: a[coordinates:] for n, a in part.items()} for q, part in whole.items()}
        return by_drawing, by_inputs

    def drawn(self) -> dict[str, Array]:
        """How the drawing's own inputs change with each coordinate, (coordinates,), rad or mm per mm."""
        design = self._design
        return {
            name: np.array([_drawn_change(design, moved, drive) for moved in self._moved])
            / float(design.unit)
            for name, drive in design.linkage.inputs.items()
        }

    @cached_property
    def _design(self) -> Design:
        part = self.scene.mechanism
        return Design.from_points(dict(part.points), part.up, part.right, part.side, part.closure, part.type)

    @cached_property
    def _moved(self) -> tuple[_Moved, ...]:
        design = self._design
        found: list[_Moved] = []
        for moved in self.moves.values():
            for step in (STEP, -STEP):
                table = {name: _stepped(place, name, moved, step) for name, place in design.table.items()}
                lengths = {}
                for a, b in design.linkage.links:
                    link = minus(table[a], table[b])
                    lengths[a, b] = dot(link, link)
                shape = design.linkage.shape(table)
                jumped = any(
                    abs(x - y) > JUMP
                    for name, place in shape.items()
                    for x, y in zip(place, design.knuckle[name], strict=True)
                )
                if not jumped:
                    break
            found.append(_Moved(table, lengths, shape, step))
        return tuple(found)

    def _at(self, places: Mapping[str, Array], laws: Mapping[str, Array], wanted: Sequence[str]) -> Slopes:
        design, count = self._design, len(next(iter(places.values())))
        linkage, directions = design.linkage, len(self.moves) + len(self.inputs)
        plain = known_in_doubles(design, laws, count)
        still = values_only(plain)
        values = np.array(linkage.unknown_of(local_places(design, places), still), dtype=float)
        step = newton_step(values, inverse_of(jacobian_of(list(values), still)), still)
        lost = ~(np.abs(step).max(axis=0) < OFF_THE_POSE)
        values = np.where(lost, values, values - step)
        inverse = inverse_of(jacobian_of(list(values), still))
        jets = unknown_jets_of(list(values), inverse, plain)
        known = self._known(plain, laws)
        solved = with_slopes(jets, changes_of(jets, inverse, known, directions))
        points, unit = linkage.points_of(solved, known), float(design.unit)
        # A coordinate moves by mm, and an input by its own unit; both slopes are of local lengths until here.
        per = np.array([1.0 / unit] * len(self.moves) + [1.0] * len(self.inputs))[:, None]
        shape = (directions, count)

        def slopes(vector: Vector, factor: float) -> Array:
            parts = [
                np.where(lost, np.nan, factor * per * np.broadcast_to(slope_of(x), shape)) for x in vector
            ]
            return np.stack(parts, axis=-1)

        found: Slopes = {}
        for quantity in wanted:
            d, of = per_second(quantity), QUANTITIES[quantity].of
            if of == "point":
                found[quantity] = {name: slopes(order_of(p, d), unit) for name, p in points.items()}
            elif of == "body":
                turns = body_turns(solved, points, known)
                found[quantity] = {name: slopes(turn[d - 1], 1.0) for name, turn in turns.items()}
            else:
                axes = Axes.of({name: order_of(p, 0) for name, p in points.items()}, known, design.outboard)
                found[quantity] = {
                    name: np.where(
                        lost, np.nan, per * np.broadcast_to(slope_of(effect.evaluate(axes)), shape)
                    )
                    for name, effect in EFFECTS.items()
                }
        return found

    def _known(self, plain: Known, laws: Mapping[str, Array]) -> Known:
        """What the equations take as given, with its slopes, by local lengths and by inputs."""
        design, moved = self._design, self._moved
        still = [0.0] * len(self.inputs)

        def column(differences: Iterable[Fraction]) -> Array:
            steps = (float(x / one.step) for x, one in zip(differences, moved, strict=True))
            return np.array([*steps, *still])[:, None]

        def vector(base: Vector, others: Sequence[Vector]) -> Vector:
            x, y, z = (Dual(float(base[i]), column(other[i] - base[i] for other in others)) for i in range(3))
            return x, y, z

        rise = lift(design, laws)
        chassis = {}
        for name in design.linkage.chassis:
            place = vector(design.table[name], [one.table[name] for one in moved])
            chassis[name] = plus((Jet(place[0]), Jet(place[1]), Jet(place[2])), rise)
        lengths = {
            link: column(one.lengths[link] - squared for one in moved)
            for link, squared in design.squared_length.items()
        }
        return replace(
            plain,
            chassis=chassis,
            squared_length={
                link: Dual(Constant(float(squared)), lengths[link])
                for link, squared in design.squared_length.items()
            },
            driven={
                name: self._driven(name, drive, plain.driven[name], laws, lengths)
                for name, drive in design.linkage.inputs.items()
            },
            knuckle={
                name: vector(place, [one.shape[name] for one in moved])
                for name, place in design.knuckle.items()
            },
        )

    def _driven(
        self, name: str, drive: Drive, plain: Jet, laws: Mapping[str, Array], lengths: Mapping[Link, Array]
    ) -> Jet:
        """The number that the equations take for an input, with its slopes by lengths and by the input."""
        design, count = self._design, np.shape(plain.value)[0]
        slopes = np.zeros((ORDERS, len(self.moves) + len(self.inputs), count))
        with ctx.workprec(BITS):
            rows = [
                Jet(*(as_fraction(x, name) for x in law))
                for law in laws.get(name, np.zeros((count, ORDERS))).tolist()
            ]
            bases = [drive.driven(balls(row), design.squared_length, design.unit) for row in rows]
            for link in _read(drive, balls(rows[0]), design):
                longer = {**design.squared_length, link: design.squared_length[link] + STEP}
                moved = [drive.driven(balls(row), longer, design.unit) for row in rows]
                slopes += _quotients(moved, bases)[:, None, :] * lengths[link]
            if name in self.inputs:
                moved = [
                    drive.driven(
                        balls(replace(row, value=row.value + STEP)), design.squared_length, design.unit
                    )
                    for row in rows
                ]
                slopes[:, len(self.moves) + self.inputs.index(name)] = _quotients(moved, bases)
        return Jet(*(Dual(part_of(plain, d), slopes[d]) for d in range(ORDERS)))


class _Noting(dict[Link, Fraction]):
    """Lengths that note which of them are read."""

    def __init__(self, lengths: Mapping[Link, Fraction]) -> None:
        super().__init__(lengths)
        self.read: dict[Link, None] = {}

    def __getitem__(self, link: Link) -> Fraction:
        self.read[link] = None
        return super().__getitem__(link)


def _read(drive: Drive, value: Jet, design: Design) -> Iterator[Link]:
    """The lengths on which the number of an input depends."""
    noting = _Noting(design.squared_length)
    drive.driven(value, noting, design.unit)
    yield from noting.read


def _quotients(moved: Sequence[Jet], bases: Sequence[Jet]) -> Array:
    """Differences over the step, (orders, N)."""
    step = as_ball(STEP)
    found = [
        floats_of_jet(Jet(*((part_of(a, d) - part_of(b, d)) / step for d in range(ORDERS))))
        for a, b in zip(moved, bases, strict=True)
    ]
    return np.array(found).reshape(-1, ORDERS).T


def _stepped(place: Vector, name: str, moved: Sequence[tuple[str, int]], step: Fraction) -> Vector:
    x, y, z = (place[i] + (step if (name, i) in moved else 0) for i in range(3))
    return x, y, z


def _drawn_change(design: Design, moved: _Moved, drive: Drive) -> float:
    """What a step makes of the drawing's own input, over the step."""
    drawings = ((moved.table, moved.lengths), (design.table, design.squared_length))
    with ctx.workprec(BITS):
        there, here = (
            as_fraction(
                drive.input_of(drive.drawn(table, design.up, design.right), lengths, design.unit, DIGITS),
                "an input as drawn",
            )
            for table, lengths in drawings
        )
    return float((there - here) / moved.step)
