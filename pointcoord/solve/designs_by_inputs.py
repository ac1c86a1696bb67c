r"""Many designs as functions of their inputs: boxes of series in one or two inputs, a design a column.

What a linkage does depends on time through its inputs only. Where designs share their laws, the inputs of
all of them go one way, and boxes that hold it hold the motion of every design, however often it comes back,

    y(t) = sum_ij c_ij s1(t)^i s2(t)^j,      s = (input - centre) / half width,

with powers that all designs share: one matrix product sums a coordinate of all of them, and another its
rates.

The range of the inputs is one box, or a grid of boxes of which those are solved that the way touches. The
centre of a box is reached from the start, or from the centre of the box beside it, by proven steps (see
`paths_together`). A box is held to what a segment of a chain is (see `taylor`): its last terms, and what they
contribute to the rates that are asked for, are below the tolerance relative to the size of these; at each
corner Newton's method finds the assembly, from a first step of no more than the tolerance and rounding, on
the branch of the centre, and boxes that share a corner find one assembly there. A box whose terms do not fall
is halved. A way that goes over its range once takes fewer series in time than boxes, so there are at most as
many boxes as passes are begun. A design of which one box is not confirmed so is reported: whoever asked
follows it in time.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from itertools import product
from math import comb

import numpy as np
from numpy.typing import NDArray

from pointcoord.data_classes import dataclass
from pointcoord.errors import InputOutOfRange
from pointcoord.linkage.drives import Drive
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.batch_last.elimination import Eliminated
from pointcoord.numerics.batch_last.mixed_series import MixedSeries
from pointcoord.numerics.batch_last.series import ColumnSeries
from pointcoord.solve.ends_together import Confirmed, confirm, noise
from pointcoord.solve.paths_together import Columns, follow_together
from pointcoord.solve.taylor import SOLVED, Settings
from pointcoord.time_functions import TimeFunction

Array = NDArray[np.float64]
Numbers = NDArray[np.intp]
Flags = NDArray[np.bool_]
Cell = tuple[int, ...]

# Designs at a time: what lies between the operations stays in a cache.
CHUNK = 256
# Degree by which the boxes and their order are chosen, of so many designs; of the boxes by how many inputs
# move, the largest degree.
PILOT, PILOTS = 8, 32
MOST = {1: 30, 2: 20}
# Degrees that are added where some designs need more, and how often.
MORE, OFTEN = 2, 2
# What a box costs beside its powers, in powers: the way to its centre, and its corners.
BOX = 100.0
# Parts that a range is divided into.
PARTS = (1, 2, 3, 4, 6, 8, 12, 16)
# A box is halved where it does for less than all but this share of the designs, and a range at most so often.
FEW, HALVED = 0.25, 4
# A start is taken for the middle of a range if it is no farther from it, in parts of the range.
NEAR_MIDDLE = 0.02
# Boxes that share a corner: what is left of two of Newton's methods, and rounding, in tolerances.
SAME = 4.0
# Least half width of a range, in parts of its size or of 1, of an input that hardly moves.
NARROWEST = 2.0**-20


@dataclass(frozen=True)
class Way:
    """Between which values the inputs lie, over spans of time that follow each other.

    Attributes:
        names: of the inputs that move. low, high: shape (spans, inputs).
        speeds, accelerations: the largest of each input, shape (inputs,), per s and per s^2.
        passes: how often they go over their ranges, at most.
    """

    names: tuple[str, ...]
    low: Array
    high: Array
    speeds: Array
    accelerations: Array
    passes: float


@dataclass(frozen=True)
class Group:
    """Series of unknown coordinates that the same inputs move.

    Attributes:
        coordinates: numbers. powers: of each term, shape (terms, inputs).
        series: coefficients in the mechanism's units, shape (coordinates, terms, members).
    """

    coordinates: Numbers
    powers: Numbers
    series: Array

    def taken(self, members: Flags) -> Group:
        """Of some members."""
        return Group(self.coordinates, self.powers, np.ascontiguousarray(self.series[..., members]))


@dataclass(frozen=True)
class Box:
    """Series about the middle of a box, in s = (input - centre) / half of each input."""

    centre: Array
    half: Array
    groups: tuple[Group, ...]

    @property
    def degree(self) -> int:
        """Of the series."""
        return int(max(group.powers.sum(axis=-1).max() for group in self.groups))


@dataclass(frozen=True)
class Boxes:
    """Boxes that the way of the inputs touches, for some designs.

    Attributes:
        names: of the inputs. members: how many designs.
    """

    names: tuple[str, ...]
    boxes: tuple[Box, ...]
    members: int

    def numbers_of(self, values: Array) -> Numbers:
        """The box in which each of some values of the inputs lies, shape (N, inputs) to (N,)."""
        off = [np.abs((values - box.centre) / box.half).max(axis=-1) for box in self.boxes]
        return np.asarray(np.argmin(off, axis=0))

    def at(self, values: Array, unknowns: int) -> Array:
        """Unknowns at values of the inputs, shape (N, inputs), plainly summed: (members, N, unknowns)."""
        found = np.zeros((len(values), self.members, unknowns))
        for out, number, value in zip(found, self.numbers_of(values).tolist(), values, strict=True):
            box = self.boxes[number]
            for group in box.groups:
                powers = (((value - box.centre) / box.half) ** group.powers).prod(axis=-1)
                out[:, group.coordinates] = np.einsum("k,ckm->mc", powers, group.series)
        return found.swapaxes(0, 1)


def boxes_of(
    columns: Columns,
    mechanism: Mechanism,
    functions: Mapping[str, TimeFunction],
    way: Way,
    y: Array,
    start: float,
    settings: Settings,
) -> tuple[Flags, Boxes | None]:
    """The designs that boxes are confirmed of, and these; none where the inputs are too many, or stand still.

    Args:
        functions: the laws of the inputs that drive the linkage.
        y: assembled at `start`, shape (size, members).
    """
    nobody = np.zeros(y.shape[-1], dtype=bool)
    drives = [drive for drive in mechanism.topology.drives if drive.input in way.names]
    if not 1 <= len(way.names) <= 2 or len(drives) != len(way.names):
        return nobody, None
    drives.sort(key=lambda drive: way.names.index(drive.input))
    begun = np.array([float(functions[name].series(start, 0)[..., 0]) for name in way.names])
    least, most = way.low.min(axis=0), way.high.max(axis=0)
    if not (np.isfinite(least) & np.isfinite(most)).all():
        return nobody, None
    # From the start where that is near the middle, so that the way there is none.
    middle = 0.5 * (least + most)
    centre = np.where(np.abs(begun - middle) <= NEAR_MIDDLE * (most - least), begun, middle)
    narrowest = NARROWEST * np.maximum(np.maximum(np.abs(least), np.abs(most)), 1.0)
    half = np.maximum(np.maximum(most - centre, centre - least), narrowest)
    try:
        course = _Course(columns, mechanism, tuple(drives), way, settings)
        return course.solve(y, begun, centre, half)
    except InputOutOfRange:
        # The range reaches farther than the way does: who follows it in time decides.
        return nobody, None


@dataclass(frozen=True)
class _Expanded:
    """Series of some members about a centre, up to a degree.

    Attributes:
        alone: in each input alone. mixed: the powers of both, if there are two.
    """

    y: Array
    factors: Eliminated
    alone: tuple[ColumnSeries, ...]
    mixed: MixedSeries | None

    @property
    def degree(self) -> int:
        return self.alone[0].count - 1

    def carry_on(self, known: tuple[Array, ...], degree: int) -> None:
        """Up to a degree; known: coefficients of each driven coordinate, (degree + 1, members)."""
        with np.errstate(all="ignore"):
            for k in range(self.degree + 1, degree + 1):
                for series, law in zip(self.alone, known, strict=True):
                    series.carry_on(law[k][None])
                if self.mixed is not None and k > 1:
                    self.mixed.carry_on()

    def sizes(self) -> Array:
        """What the terms of each degree come to anywhere in the box, (degree + 1, members)."""
        n = self.alone[0].rows.unknowns
        found = np.zeros((self.degree + 1, self.y.shape[-1]))
        for k in range(1, self.degree + 1):
            total = np.abs(self.alone[0].y[k, :n])
            for series in self.alone[1:]:
                total += np.abs(series.y[k, :n])
            if self.mixed is not None and k > 1:
                total[self.mixed.unknowns] += np.abs(self.mixed.y[k - 2][:-1]).sum(axis=1)
            found[k] = total.max(axis=0)
        return found

    def powers_of(self, moved: tuple[bool, ...]) -> Numbers:
        """The powers of the inputs in the order of `terms_of`, (terms, inputs)."""
        places = [place for place, moves in enumerate(moved) if moves]
        found = [[0] * len(moved)]
        for place in places:
            for k in range(1, self.degree + 1):
                found.append([k if other == place else 0 for other in range(len(moved))])
        if len(places) > 1:
            found += [[k - j, j] for k in range(2, self.degree + 1) for j in range(1, k)]
        return np.array(found, dtype=np.intp)

    def terms_of(self, coordinates: Numbers, moved: tuple[bool, ...]) -> Array:
        """Coefficients of coordinates that these inputs move, (coordinates, terms, members)."""
        parts = [self.y[None, coordinates]]
        parts += [
            series.y[1 : self.degree + 1, coordinates]
            for series, moves in zip(self.alone, moved, strict=True)
            if moves
        ]
        if sum(moved) > 1 and self.mixed is not None:
            places = self.mixed.places[coordinates]
            parts += [terms[places].swapaxes(0, 1) for terms in self.mixed.y[: self.degree - 1]]
        return np.concatenate(parts).swapaxes(0, 1)


@dataclass(frozen=True)
class _Waiting:
    """A box to be solved.

    Attributes:
        before: number of the box from whose centre this one's is reached; -1 for the middle of the range.
        halved: how often.
    """

    centre: Array
    half: Array
    before: int
    halved: int = 0


@dataclass(frozen=True)
class _Tried:
    """A box, and of whom it is confirmed; by corner the poses there, and what is left of them."""

    box: Box
    good: Flags
    corners: Mapping[Cell, tuple[Array, Array]]


@dataclass(frozen=True)
class _Course:
    """What is expanded, and how finely."""

    columns: Columns
    mechanism: Mechanism
    drives: tuple[Drive, ...]
    way: Way
    settings: Settings

    @property
    def driven(self) -> list[int]:
        """The coordinate of each input."""
        return [self.mechanism.layout.scalar(drive.coordinate) for drive in self.drives]

    def moves(self) -> tuple[Flags, ...]:
        """The coordinates that each input moves, (size,)."""
        system, found = self.columns.map.system, []
        for place in self.driven:
            moved = np.zeros(system.size, dtype=bool)
            moved[place] = True
            for block in system.structure.blocks:
                if moved[list(block.reads)].any():
                    moved[list(block.unknowns)] = True
            found.append(moved)
        return tuple(found)

    def known(self, centre: Array, half: Array, order: int, mechanism: Mechanism) -> tuple[Array, ...]:
        """Coefficients of the driven coordinates, each (order + 1, members)."""
        found = []
        for drive, middle, width in zip(self.drives, centre, half, strict=True):
            law = np.zeros(order + 1)
            law[: min(order + 1, 2)] = (middle, width)[: min(order + 1, 2)]
            series = drive.series(law, mechanism.drawing)
            found.append(np.broadcast_to(series, (len(mechanism.unit), order + 1)).T)
        return tuple(found)

    def solve(self, y: Array, begun: Array, centre: Array, half: Array) -> tuple[Flags, Boxes | None]:
        """Boxes for the members that they can be confirmed of."""
        members = y.shape[-1]
        alive = np.ones(members, dtype=bool)
        here, alive = self._moved(y, begun, centre, alive)
        if not alive.any():
            return alive, None
        parts, order = self._chosen(here, alive, centre, half)
        low, width = centre - half, 2.0 * half / np.array(parts)
        waiting = [
            _Waiting(low + (np.array(cell) + 0.5) * width, 0.5 * width, before)
            for cell, before in self._touched(parts, low, width)
        ]
        poses: list[tuple[Array, Array]] = []
        found: list[Box] = []
        most = max(np.ceil(self.way.passes), 1.0)
        corners: dict[Cell, tuple[Array, Array]] = {}
        while waiting:
            if len(found) + len(waiting) > most:
                return np.zeros_like(alive), None
            one = waiting.pop(0)
            pose, alive = self._moved(
                *(poses[one.before] if one.before >= 0 else (here, centre)), one.centre, alive
            )
            poses.append((pose, one.centre))
            may_halve = one.halved < HALVED and len(found) + len(waiting) + 2 <= most
            tried = self._box(pose, one.centre, one.half, order, alive, may_halve)
            if isinstance(tried, int):
                waiting += self._halves(one, tried, len(poses) - 1)
                continue
            alive &= tried.good
            if not alive.any():
                return alive, None
            found.append(tried.box)
            for sign, (place, left) in tried.corners.items():
                place_of = (one.centre + one.half * np.array(sign) - low) / width * 2.0**HALVED
                corner = tuple(np.rint(place_of).astype(int).tolist())
                if corner in corners:
                    apart = np.abs(place - corners[corner][0]).max(axis=0)
                    alive &= apart <= left + corners[corner][1] + SAME * SOLVED * self.settings.tolerance
                corners[corner] = place, left
        kept = tuple(
            Box(box.centre, box.half, tuple(group.taken(alive) for group in box.groups))
            if not alive.all()
            else box
            for box in found
        )
        return alive, Boxes(self.way.names, kept, int(np.count_nonzero(alive)))

    def _halves(self, one: _Waiting, axis: int, number: int) -> list[_Waiting]:
        """A box in two, as far as the way touches them."""
        half = one.half.copy()
        half[axis] *= 0.5
        found = []
        for side in (-1.0, 1.0):
            centre = one.centre.copy()
            centre[axis] += side * half[axis]
            if ((self.way.low <= centre + half) & (self.way.high >= centre - half)).all(axis=-1).any():
                found.append(_Waiting(centre, half, number, one.halved + 1))
        return found

    def _moved(self, y: Array, before: Array, to: Array, alive: Flags) -> tuple[Array, Flags]:
        """Poses carried from some values of the inputs to others along a straight path; who got there."""
        if (before == to).all():
            return y, alive
        n, numbers = self.columns.map.unknowns, np.flatnonzero(alive)
        here = np.ascontiguousarray(y[:, numbers])
        target = here[n:].copy()
        mechanism = self.mechanism if alive.all() else self.mechanism.taken(numbers)
        for place, law in zip(self.driven, self.known(to, np.zeros_like(to), 0, mechanism), strict=True):
            target[place - n] = law[0]
        reached = follow_together(self.columns, here, target, SOLVED * self.settings.tolerance, closing=False)
        there = y.copy()
        there[:, numbers[reached.done]] = reached.y[:, reached.done]
        arrived = np.zeros_like(alive)
        arrived[numbers[reached.done]] = True
        return there, arrived

    def _expanded(self, y: Array, most: int, spare: _Expanded | None = None) -> _Expanded:
        """Series about poses, with room for a degree."""
        rows, n = self.columns.map, self.columns.map.unknowns
        with np.errstate(all="ignore"):
            factors = self.columns.factorise(rows.differences(y))
            moves = self.moves()
            old = (None,) * len(moves) if spare is None else spare.alone
            alone = tuple(
                ColumnSeries.begin(rows, factors, y, [place], most, room, moved[:n])
                for place, moved, room in zip(self.driven, moves, old, strict=True)
            )
            mixed = None
            if len(alone) == 2:
                room = None if spare is None else spare.mixed
                mixed = MixedSeries.begin(rows, factors, *alone, (moves[0], moves[1]), most, room)
        return _Expanded(y, factors, alone, mixed)

    def _chosen(self, y: Array, alive: Flags, centre: Array, half: Array) -> tuple[Cell, int]:
        """Into how many boxes the range is divided, and the degree of their series, by some members."""
        numbers = np.flatnonzero(alive)
        some = numbers[np.linspace(0, len(numbers) - 1, min(PILOTS, len(numbers))).astype(int)]
        begun = self._expanded(np.ascontiguousarray(y[:, some]), PILOT)
        begun.carry_on(self.known(centre, half, PILOT, self.mechanism.taken(some)), PILOT)
        moved = (True,) * len(self.drives)
        powers = begun.powers_of(moved)
        n = self.columns.map.unknowns
        sizes = np.abs(begun.terms_of(np.arange(n), moved)).max(axis=0)
        typical = np.quantile(sizes, 0.9, axis=-1)
        degrees = powers.sum(axis=-1)
        best = (np.inf, (1,) * len(self.drives), MOST[len(self.drives)])
        for parts in product(PARTS, repeat=len(self.drives)):
            # The way goes from end to end of every range.
            if max(parts) * (BOX + comb(PILOT + len(parts), len(parts))) >= best[0]:
                continue
            scaled = typical / (np.array(parts, dtype=float) ** powers).prod(axis=-1)
            by_degree = [float(scaled[degrees == k].sum()) for k in range(PILOT + 1)]
            order = self._needed(np.array(by_degree), parts)
            each = BOX + comb(order + len(parts), len(parts))
            if order > MOST[len(parts)] or max(parts) * each >= best[0]:
                continue
            cost = len(self._touched(parts, centre - half, 2.0 * half / np.array(parts))) * each
            if cost < best[0]:
                best = (cost, parts, order)
        return best[1], best[2]

    def _needed(self, sizes: Array, parts: Cell) -> int:
        """The degree at which terms that go on to fall so are small enough."""
        late, early = sizes[-1] + sizes[-2], sizes[3] + sizes[4]
        most = MOST[len(self.drives)]
        if not 0.0 < late < early:
            return PILOT if late == 0.0 else most + 1
        fall = (late / early) ** (1.0 / (PILOT - 4))
        orders = np.arange(PILOT, most + 1)
        terms = max(sizes[-1], fall * sizes[-2]) * fall ** (orders - PILOT)
        speed, acceleration = self._rates(parts)
        whole = np.array([1.0, sizes[1] * speed, max(sizes[1] * acceleration, 2.0 * sizes[2] * speed**2)])
        left_out = _left_out(terms, fall, orders, speed, acceleration)
        small = left_out <= self.settings.tolerance * whole[:, None]
        enough = small[: self.settings.derivative + 1].all(axis=0)
        return int(orders[np.argmax(enough)]) if enough.any() else most + 1

    def _rates(self, parts: Cell) -> tuple[float, float]:
        """The largest rates of s, per s and per s^2, where the range is divided so."""
        span = 0.5 * (self.way.high.max(axis=0) - self.way.low.min(axis=0))
        half = np.maximum(span, np.finfo(float).tiny) / np.array(parts)
        return float((self.way.speeds / half).max()), float((self.way.accelerations / half).max())

    def _touched(self, parts: Cell, low: Array, width: Array) -> list[tuple[Cell, int]]:
        """The boxes that the way touches, the nearest to the middle first.

        Each comes with the number of one beside it that comes before it; the first with -1.
        """
        count = np.array(parts)
        first, last = (
            np.clip(np.floor((end - low) / width).astype(int), 0, count - 1)
            for end in (self.way.low, self.way.high)
        )
        ranges = np.unique(np.stack([first, last], axis=1), axis=0).tolist()
        touched = {
            cell for a, b in ranges for cell in product(*(range(x, z + 1) for x, z in zip(a, b, strict=True)))
        }
        middle = 0.5 * (count - 1.0)
        root = min(touched, key=lambda cell: (float(np.abs(np.array(cell) - middle).sum()), cell))
        order = [(root, -1)]
        seen = {root}
        for number, (cell, _) in enumerate(order):
            for axis, step in product(range(len(cell)), (-1, 1)):
                beside = (*cell[:axis], cell[axis] + step, *cell[axis + 1 :])
                if beside in touched and beside not in seen:
                    seen.add(beside)
                    order.append((beside, number))
        return order

    def _box(
        self, y: Array, centre: Array, half: Array, order: int, alive: Flags, may_halve: bool
    ) -> _Tried | int:
        """One box of all members; or, where it may be halved and should be, along which input."""
        members, n = y.shape[-1], self.columns.map.unknowns
        signs = list(product((-1, 1), repeat=len(self.drives)))
        good = np.zeros(members, dtype=bool)
        corners = {sign: (np.zeros((n, members)), np.zeros(members)) for sign in signs}
        most = min(order + MORE * OFTEN, MOST[len(self.drives)])
        spare: _Expanded | None = None
        moves = np.stack(self.moves(), axis=-1)
        kinds = list(product((False, True), repeat=len(self.drives)))
        of_kind = [np.flatnonzero((moves[:n] == np.array(kind)).all(axis=-1)) for kind in kinds]
        rooms: list[Array] = []
        powers: list[Numbers] = []
        degree = order
        for low in range(0, members, CHUNK):
            part = slice(low, min(low + CHUNK, members))
            own = self.mechanism.taken(np.arange(part.start, part.stop))
            here = self._expanded(np.ascontiguousarray(y[:, part]), most, spare)
            law = self.known(centre, half, most, own)
            here.carry_on(law, degree)
            confirmed = self._falls(here, half)
            for _ in range(OFTEN):
                if confirmed[alive[part]].all() or degree + MORE > most or low > 0:
                    break
                # The first designs decide for all.
                degree += MORE
                here.carry_on(law, degree)
                confirmed = self._falls(here, half)
            failing, there = (np.count_nonzero(who) for who in (alive[part] & ~confirmed, alive[part]))
            if may_halve and low == 0 and failing > FEW * there:
                last = slice(here.degree - 1, here.degree + 1)
                return int(np.argmax([np.abs(each.y[last, :n]).max() for each in here.alone]))
            terms = [
                here.terms_of(coordinates, kind) for coordinates, kind in zip(of_kind, kinds, strict=True)
            ]
            powers = [here.powers_of(kind) for kind in kinds]
            ends = self._corner_poses(here, zip(of_kind, powers, terms, strict=True), signs)
            found = self._corners(here, ends, own, centre, half, signs)
            for sign, (end, first) in zip(signs, found, strict=True):
                confirmed &= end.good & first
                corners[sign][0][:, part], corners[sign][1][part] = end.y[:n], end.left
            good[part] = confirmed
            if low == 0:
                rooms = [np.empty((*each.shape[:2], members)) for each in terms]
            for room, each in zip(rooms, terms, strict=True):
                room[..., part] = each
            spare = here
        groups = tuple(
            Group(coordinates, power, room)
            for coordinates, power, room in zip(of_kind, powers, rooms, strict=True)
            if len(coordinates)
        )
        return _Tried(Box(centre, half, groups), good, corners)

    def _falls(self, here: _Expanded, half: Array) -> Flags:
        """Whose last two degrees are small enough, (members,)."""
        sizes, degree = here.sizes(), here.degree
        n, middle = self.columns.map.unknowns, here.degree // 2
        speeds, accelerations = self.way.speeds / half, self.way.accelerations / half
        with np.errstate(all="ignore"):
            # A term that is small by chance is taken for what the ones before it come to.
            late, early = np.maximum(sizes[-1], sizes[-2]), np.maximum(sizes[middle], sizes[middle - 1])
            fall = np.minimum((late / np.maximum(early, 1e-300)) ** (1.0 / (degree - middle)), 1.0)
            last = np.maximum(sizes[-1], fall * np.maximum(sizes[-2], fall * sizes[-3]))
            left_out = _left_out(last, fall, degree, float(speeds.max()), float(accelerations.max()))
            whole = np.zeros_like(left_out)
            whole[0] = 1.0
            for series, speed, acceleration in zip(here.alone, speeds, accelerations, strict=True):
                first, second = (np.abs(series.y[k, :n]).max(axis=0) for k in (1, 2))
                whole[1] = np.maximum(whole[1], speed * first)
                whole[2] = np.maximum(whole[2], np.maximum(acceleration * first, 2.0 * speed**2 * second))
            small = left_out <= self.settings.tolerance * whole
            return np.asarray(
                small[: self.settings.derivative + 1].all(axis=0) & np.isfinite(sizes).all(axis=0)
            )

    def _corner_poses(
        self, here: _Expanded, groups: Iterable[tuple[Numbers, Numbers, Array]], signs: list[Cell]
    ) -> Array:
        """What the series give at each corner, (corners, size, members).

        Args:
            groups: coordinates, powers and coefficients of each.
        """
        found = np.repeat(here.y[None], len(signs), axis=0)
        for coordinates, powers, terms in groups:
            if len(coordinates):
                at = (np.array(signs, dtype=float)[:, None] ** powers).prod(axis=-1)
                found[:, coordinates] = (at @ terms).swapaxes(0, 1)
        return found

    def _corners(
        self, here: _Expanded, ends: Array, own: Mechanism, centre: Array, half: Array, signs: list[Cell]
    ) -> list[tuple[Confirmed, Flags]]:
        """Newton's method at each corner, and whose first step is small enough.

        Args:
            ends: what the series give there.
        """
        columns, tolerance, found = self.columns, self.settings.tolerance, []
        left_out = here.sizes()[-2:].sum(axis=0)
        for sign, y in zip(signs, ends, strict=True):
            values = centre + half * np.array(sign)
            for place, law in zip(self.driven, self.known(values, np.zeros_like(half), 0, own), strict=True):
                y[place] = law[0]
            end = confirm(columns, y, here.factors, left_out, tolerance)
            small = end.first_step <= tolerance
            doubtful = end.good & ~small
            if doubtful.any():
                rounding = noise(columns, end.y[:, doubtful], np.zeros(len(y)))
                small[doubtful] = end.first_step[doubtful] <= tolerance + 2.0 * rounding
            found.append((end, small))
        return found


def _left_out(last: Array, fall: Array, degree: Numbers | int, speed: float, acceleration: float) -> Array:
    """What the terms beyond the last degree come to in the place and in its rates, (3, ...).

    Terms that fall at least by half come to no more than the last one, and others in proportion more.

    Args:
        last: size of the last degree. fall: from one degree to the next.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        beyond = last * np.maximum(fall / (1.0 - fall), 1.0)
        rate = degree * (degree - 1.0) * speed**2 + degree * acceleration
        return np.stack([beyond, beyond * (degree * speed), beyond * rate])
