"""A mechanism's description, compiled: its equations C(y, w) = 0, each at most quadratic.

The unknowns y are, in local coordinates (see `design`) and relative to the chassis:

    a body hinged on the chassis        c, s      rotation about n, the line of its two points there:
                                                  v -> n (n.v)/n^2 + c (v - n (n.v)/n^2) + s (n x v)
    any other body                      c1 c2 c3  the columns of its matrix R
      whose first point is not placed   p         and the position of this point
    a point on a slide                  s         its place on the line, p = through + s line
    a free point                        p         its position, unless it is on a slide of the chassis
    a contact height, or an angle between two moving bodies: one or two further numbers, see `drives`

and the rows are

    n^2 s^2 + c^2 = 1,  ci . cj = 1 if i = j else 0      a body rotates and does not deform
    p = p'                                               two bodies share a point, three rows
    R u . (p - p') = R v . (p - p') = 0                  the second point of a hinge, two rows; u, v across it
    |a - b|^2 = d^2                                      a rod
    p = through + s R line                               a point on a slide; if the slide may not turn also
                                                         R u . R' v - R v . R' u = 0, u, v across the line
    and the rows of the inputs: see `drives`

The rows also hold for a hinge that is mounted the wrong way round, an angle that is off by half a turn, and a
mirrored body. No path of regular poses leads there from the drawing.

A point shared with an earlier body places a body, so its position is not an unknown, unless every joint is
to have rows (see `loads`). The numbers w are functions of the inputs. All data of the drawing are exact.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import combinations, combinations_with_replacement
from typing import Any

import numpy as np
from flint import arb

from validate.reference.car_data import directions
from validate.reference.errors import NoReferenceError
from validate.reference.exact import as_ball
from validate.reference.jet import Jet
from validate.reference.polynomial import Polynomial, at, of_kind, ordered, polynomial
from validate.reference.vectors import (
    AXES,
    Exact,
    Placement,
    Scalar,
    Vector,
    across,
    cross,
    dot,
    each,
    minus,
    near_one,
    plus,
    times,
)

CHASSIS = "chassis"
SAME_ROW = 1e-9  # relative to the largest pivot: a row with a smaller pivot depends on others, in doubles
Table = Mapping[str, Vector]
Columns = tuple[Vector, Vector, Vector]
Reader = Callable[[Table, Sequence[Scalar], Exact, Sequence[Scalar]], Sequence[Scalar]]


@dataclass(frozen=True)
class Drive:
    """An input of a mechanism.

    Attributes:
        numbers: gives the numbers w from the input and from all inputs, rad or mm, as jets of any kind of
            number, and a function that converts a fraction to this kind.
        input_of: gives the input, rad or mm, from its numbers w; an angle from the drawing has the least
            magnitude.
        drawn: gives the input as drawn, rad or mm.
        turns: whether the input is an angle without limit.
    """

    numbers: Callable[[Jet, Mapping[str, Jet], Exact], Sequence[Jet]]
    input_of: Callable[[Sequence[arb]], arb]
    drawn: Callable[[], arb] = lambda: arb(0)
    turns: bool = False


class Mechanism:
    """The compiled description of a mechanism.

    Attributes:
        size: number of unknowns y; symbols of the numbers w are -1, -2 and so on, see `polynomial`.
        count: number of the numbers w.
        rows: C(y, w), each row with a name.
        frames: two vectors fixed in each moving body, not parallel.
        readers: functions that read the unknowns from assembled points, one after the other, from points,
            earlier unknowns, a function that converts a fraction, and the numbers w.
        drives: the inputs, without those that move the chassis.
        driving: for each of these, the last row with its numbers w.
        rods: row of each rod's length.
        gaps: for each shared point and each point on a slide whose two places have rows: the body of the
            first place, the first row, and the vectors whose products with first - second are the rows.
        lines: for each slide, the places of its points on the line, its direction as drawn, and the square of
            its length.
        free: positions of the points of no body.
        bodies: the bodies in the equations.
        holder: the first body of each point.
    """

    def __init__(self, plain: Mapping[str, Any], table: Table, unit: Fraction, hangs: bool = True) -> None:
        """Compile bodies, slides and rods.

        Args:
            table: the points, local.
            unit: unit of the local coordinates, mm.
            hangs: whether shared points and hinges place a body on an earlier one, and lines of the chassis
                place free points, without rows. Otherwise every joint and slide has rows.
        """
        self.plain, self.table, self.unit, self.hangs = plain, table, unit, hangs
        self.size, self.count = 0, 0
        self.rows: list[tuple[str, Polynomial]] = []
        self.readers: list[Reader] = []
        self.frames: dict[str, tuple[Vector, Vector]] = {}
        self.drives: dict[str, Drive] = {}
        self.driving: dict[str, int] = {}
        self.rods: dict[str, int] = {}
        self.gaps: dict[str, tuple[str, int, Sequence[Vector]]] = {}
        self.lines: dict[str, tuple[list[Polynomial], Vector, Fraction]] = {}
        self.free: dict[str, Vector] = {}
        self.bodies = {CHASSIS: Placement(AXES, (0, 0, 0))}
        self.holder = dict.fromkeys(plain["bodies"][CHASSIS], CHASSIS)
        for name in self._in_order():
            self._add_body(name)
        for name, slide in plain["slides"].items():
            self._add_slide(name, slide)
        for name, ends in plain["rods"].items():
            gap, drawn = minus(*map(self.place, ends)), self.drawn_line(f"the length of {name}", *ends)
            self.rods[name] = len(self.rows)
            self.row(name, dot(gap, gap) - dot(drawn, drawn))

    @cached_property
    def places(self) -> dict[str, Vector]:
        """Position of every point, relative to the chassis."""
        return {name: self.place(name) for name in self.table}

    @cached_property
    def chosen(self) -> tuple[int, ...]:
        """The rows that are solved, as many as unknowns; the other rows depend on these as drawn.

        QR with pivoting takes, one by one, the row with the largest part independent of those taken.

        Raises:
            NoReferenceError: the inputs do not determine all degrees of freedom.
        """
        rows, size = len(self.rows), self.size
        if rows == size:
            return tuple(range(size))
        from scipy.linalg import qr  # few mechanisms need it, and it takes long to import

        drawn = [float(x) for x in ordered(self.drawn_unknown, self.drawn_numbers)]
        matrix = np.zeros((rows, size))
        for i, (_, row) in enumerate(self.rows):
            for j in row.unknowns:
                matrix[i, j] = row.derivative(j).of_kind(float).at(drawn)
        triangle, taken = qr(matrix.T / np.linalg.norm(matrix, axis=1), mode="r", pivoting=True)
        rank = int((np.abs(np.diag(triangle)) > SAME_ROW).sum())
        if rank < size:
            allowed = f"{size}: drive {size - rank} more of what can move"
            problem = f"are {rank} independent rows for {size} unknowns"
            raise NoReferenceError("the equations", problem, allowed, rank)
        return tuple(sorted(int(row) for row in taken[:size]))

    def numbers(self, inputs: Mapping[str, Jet], exact: Exact) -> list[Jet]:
        """The numbers w from all inputs as jets of any kind of number; `exact` converts a fraction."""
        return [w for name, one in self.drives.items() for w in one.numbers(inputs[name], inputs, exact)]

    @property
    def drawn_inputs(self) -> dict[str, Jet]:
        """All inputs as drawn, rad and mm, at the present precision; those of the chassis are zero."""
        drives = self.drives
        return {n: Jet(drives[n].drawn() if n in drives else arb(0)) for n in self.plain["inputs"]}

    @property
    def drawn_numbers(self) -> list[arb]:
        """The numbers w at the drawn inputs, at the present precision."""
        return [w.value for w in self.numbers(self.drawn_inputs, as_ball)]

    @property
    def drawn_unknown(self) -> list[arb]:
        """The unknowns from the points as drawn, exact; the drawing need not satisfy the rows."""
        places = {name: each(as_ball, place) for name, place in self.table.items()}
        return [arb(number).mid() for number in self.unknown_of(places, self.drawn_numbers, as_ball)]

    def unknown_of(self, points: Table, numbers: Sequence[Scalar], exact: Exact) -> list[Scalar]:
        """The unknowns from assembled points, relative to the chassis, and the numbers w, in one kind of
        number; `exact` converts a fraction.
        """
        unknown: list[Scalar] = []
        for read in self.readers:
            unknown.extend(read(points, unknown, exact, numbers))
        return unknown

    def unknowns(self, count: int, read: Reader) -> list[Polynomial]:
        """Add unknowns, and their reader."""
        first = self.size
        self.size += count
        self.readers.append(read)
        return [Polynomial.symbol(first + i) for i in range(count)]

    def number(self) -> Polynomial:
        """Add a number w."""
        self.count += 1
        return Polynomial.symbol(-self.count)

    def row(self, name: str, row: Scalar) -> None:
        """Add the row `row` = 0."""
        self.rows.append((name, polynomial(row)))

    def place(self, point: str) -> Vector:
        """Position of a point, relative to the chassis."""
        if point in self.holder:
            return self.bodies[self.holder[point]].place(self.table[point])
        if point not in self.free:
            self.free[point] = self._position(point)
        return self.free[point]

    def drawn_line(self, what: str, start: str, end: str) -> Vector:
        """From one point to another as drawn; NoReferenceError if they are in one place."""
        line = minus(self.table[end], self.table[start])
        if dot(line, line) == 0:
            raise NoReferenceError(f"{what}: {end}", f"is in the place of {start}", "another place")
        return line

    def _position(self, point: str) -> Vector:
        x, y, z = self.unknowns(3, lambda points, *_: points[point])
        return x, y, z

    def _close(
        self, point: str, name: str, apart: Vector, along: Sequence[Vector] = AXES, body: str = ""
    ) -> None:
        """Add the rows of a gap: it is zero along these vectors."""
        self.gaps[point] = body, len(self.rows), along
        for vector in along:
            self.row(name, dot(apart, vector))

    def _in_order(self) -> Iterator[str]:
        """The moving bodies, each after those that place it."""
        left = {name: set(points) for name, points in self.plain["bodies"].items() if name != CHASSIS}
        chassis = set(self.plain["bodies"][CHASSIS])
        placed = set(chassis)
        while left:
            name = max(left, key=lambda n: (min(len(left[n] & chassis), 2), bool(left[n] & placed)))
            placed |= left.pop(name)
            yield name

    def _add_body(self, name: str) -> None:
        points: list[str] = self.plain["bodies"][name]
        shared = {other: [p for p in points if p in self.plain["bodies"][other]] for other in self.bodies}
        # Bodies that share two points, a hinge, come first, the chassis before others.
        ties = sorted(((o, both) for o, both in shared.items() if both), key=lambda tie: -len(tie[1]))
        on_hinge = self.hangs and len(shared[CHASSIS]) == 2
        columns = self._hinged(name, *shared[CHASSIS]) if on_hinge else self._loose(name, points)
        tied = {*shared[CHASSIS]} if on_hinge else set[str]()
        if ties and self.hangs:
            other, (base, *_) = ties[0]
            tied |= {base}
            place = self.bodies[other].place(self.table[base])
        else:
            base = points[0]
            place = self._position(base)
        body = self.bodies[name] = Placement.of(columns, self.table[base], place)
        self.frames[name] = columns[:2]
        for other, both in ties:
            for i, point in enumerate(both):
                if point in tied:
                    continue
                tied.add(point)
                apart = minus(*(one.place(self.table[point]) for one in (body, self.bodies[other])))
                along: Sequence[Vector] = AXES
                if i:  # the second point of a hinge: across its line
                    sides = across(self.drawn_line(f"the hinge of {name} and {other}", *both))
                    along = [self.bodies[other].turned(side) for side in sides]
                self._close(point, f"{point} of {name} and {other}", apart, along, name)
        for point in points:
            self.holder.setdefault(point, name)

    def _hinged(self, name: str, a: str, b: str) -> Columns:
        """The columns of R of a body on a hinge of the chassis."""
        n = near_one(self.drawn_line(f"the hinge of {name}", a, b))
        nn = dot(n, n)
        beside = {p: cross(n, minus(self.table[p], self.table[a])) for p in self.plain["bodies"][name]}
        seen = max(beside, key=lambda point: float(dot(beside[point], beside[point])))
        g = beside[seen]
        _require_extent(name, dot(g, g))
        h = times(cross(g, n), Fraction(1) / nn)  # from the hinge to the point, perpendicular to the hinge
        cosine, sine = times(h, 1 / dot(h, h)), times(g, 1 / dot(g, g))

        def read(points: Table, _: Sequence[Scalar], exact: Exact, *__: object) -> list[Scalar]:
            r = minus(points[seen], points[a])
            return [dot(r, each(exact, cosine)), dot(r, each(exact, sine))]

        c, s = self.unknowns(2, read)
        self.row(f"turn of {name}", c * c + s * s * nn - 1)

        def turned(v: Vector) -> Vector:
            along = times(n, dot(n, v) / nn)
            return plus(along, plus(times(minus(v, along), c), times(cross(n, v), s)))

        x, y, z = map(turned, AXES)
        return x, y, z

    def _loose(self, name: str, points: Sequence[str]) -> Columns:
        """The columns of R of a body that is not on a hinge of the chassis."""
        ends = {(p, q): minus(self.table[p], self.table[q]) for p, q in combinations(points, 2)}
        squared = {pair: dot(end, end) for pair, end in ends.items()}

        def spread(edges: tuple[tuple[str, str], tuple[str, str]]) -> float:
            """|k x m|^2 / (|k|^2 + |m|^2): the greater, the less do errors of the edges rotate a body."""
            k, m = edges
            both, part = squared[k] + squared[m], dot(ends[k], ends[m])
            return float(squared[k] * squared[m] - part * part) / (float(both) or 1.0)

        (i, j), (k, m) = max(combinations(ends, 2), key=spread)
        one, two = ends[i, j], ends[k, m]
        normal = cross(one, two)
        area = dot(normal, normal)
        _require_extent(name, area)
        # The reciprocal vectors of `one`, `two` and `normal`.
        duals = [times(g, 1 / area) for g in (cross(two, normal), cross(normal, one), normal)]

        def read(points: Table, _: Sequence[Scalar], exact: Exact, *__: object) -> list[Scalar]:
            a, b = minus(points[i], points[j]), minus(points[k], points[m])
            rows, g = tuple(zip(a, b, cross(a, b), strict=True)), [each(exact, dual) for dual in duals]
            return [dot(row, column) for column in zip(*g, strict=True) for row in rows]

        y = self.unknowns(9, read)
        columns = ((y[0], y[1], y[2]), (y[3], y[4], y[5]), (y[6], y[7], y[8]))
        for p, q in combinations_with_replacement(range(3), 2):
            self.row(f"turn of {name}", dot(columns[p], columns[q]) - int(p == q))
        return columns

    def _add_slide(self, name: str, slide: Mapping[str, Any]) -> None:
        """Add the points on a line of a body."""
        body, through = slide["body"], slide["through"]
        along = directions(self.plain).get(slide["along"])
        # A direction of the car has length 1, up to rounding; a line towards a point has its drawn length.
        squared = Fraction(1)
        if along is None:
            along = near_one(self.drawn_line(f"slides.{name}", through, slide["along"]))
            squared = dot(along, along)
        line, start = self.bodies[body].turned(along), self.bodies[body].place(self.table[through])
        shorter, shares = times(line, 1 / dot(along, along)), list[Polynomial]()
        for point in slide["points"]:

            def read(
                points: Table, unknown: Sequence[Scalar], exact: Exact, *_: object, point: str = point
            ) -> list[Scalar]:
                now = at(of_kind(shorter, exact), [*unknown, exact(Fraction(0))])
                return [dot(minus(points[point], points[through]), now)]

            (share,) = self.unknowns(1, read)
            shares.append(share)
            there = plus(start, times(line, share))
            if self.hangs and body == CHASSIS and point not in self.holder and point not in self.free:
                self.free[point] = there  # its position needs no further unknowns
            else:
                self._close(point, f"{point} on {name}", minus(self.place(point), there))
        self.lines[name] = (shares, along, squared)
        if not slide["turns"]:
            # The axis of the rotation between the bodies has no component along the line: a body drawn off
            # the line is rotated onto it by the smallest rotation.
            held = self._on_slide(name, slide)
            (u, v), (u2, v2) = (map(self.bodies[one].turned, across(along)) for one in (body, held))
            self.row(f"turn of {name}", dot(u, v2) - dot(v, u2))

    def _on_slide(self, name: str, slide: Mapping[str, Any]) -> str:
        """The body of all points of a slide."""
        for body in self.bodies:
            if body != slide["body"] and {*slide["points"]} <= {*self.plain["bodies"][body]}:
                return body
        raise NoReferenceError(f"slides.{name}: turns", "is False", "points of one other body")


def _require_extent(name: str, squared: Fraction) -> None:
    if squared == 0:
        raise NoReferenceError(f"the points of {name}", "are all on one line", "a point beside it")
