"""Solves blocks of designs, with the checks that `simulate` makes of one scene.

The checks run on arrays of all designs. Only a design that may be at fault is checked again as a scene of its
own, so that its error is the error of the scene.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from itertools import combinations

import numpy as np

from pointcoord.drawing_stands import drawn_angles
from pointcoord.effects.registry import Plan, plan_effects
from pointcoord.errors import (
    AssemblyError,
    MechanismError,
    NotFollowed,
    PointcoordError,
    SceneError,
)
from pointcoord.linkage.chassis import ChassisMotion
from pointcoord.linkage.hardpoints import build_mechanism
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.method import SERIES
from pointcoord.numerics.arrays import Array, Flags, Indices
from pointcoord.results.by_series import ByChain
from pointcoord.results.closing import ALLOWED, NOTICED, NOTICED_SHARE, car_size, closing, movements
from pointcoord.results.readout import BLOCK as INSTANTS
from pointcoord.results.readout import Readout
from pointcoord.results.table import Table
from pointcoord.scene.drawing_doubts import doubts_of_drawings
from pointcoord.scene.scene_file import Scene
from pointcoord.simulation import (
    chain_settings,
    check_range,
    pose_tolerance,
    require_the_drawn_car,
    scene_mechanism,
    simulate,
    tolerance_notes,
)
from pointcoord.solve.assembly import close_drawing
from pointcoord.solve.many_designs import solve_designs
from pointcoord.sweeping.designs import Designs
from pointcoord.sweeping.swept import Failure, Noted, Sweep, merged

Points = Mapping[str, Array]

# Most designs that are solved together: of 128 to 2048 this is the fastest, or nearly so.
TOGETHER = 512
# Bytes of intermediate results: for a design, its matrices, series and their products; for each number of the
# results at an instant, the arrays of the effects.
OF_A_DESIGN, OF_A_NUMBER = 450_000, 16
# Sums of the same three products in different order differ by less than this share of the largest product.
SLACK = 1e-12


@dataclass(frozen=True)
class Course:
    """Designs ready to be solved.

    Attributes:
        scene: the scene that the designs share, checked.
        plan: the effects to compute.
    """

    designs: Designs
    scene: Scene
    plan: Plan

    @classmethod
    def of(cls, designs: Designs) -> Course:
        """Check the scene that the designs share.

        Raises:
            SceneError: the scene was changed after it was read and is wrong.
        """
        scene = Scene.checked(designs.scene, designs.scene.title or "scene")
        plan = plan_effects(scene.effects, None, scene.unreported_points)
        return cls(designs, scene, plan)

    @cached_property
    def table(self) -> Table:
        return Table.of(self.plan, self.scene.mechanism.topology)

    def readout(self, mechanism: Mechanism) -> Readout:
        chassis = ChassisMotion.of(mechanism, self.scene.functions)
        return Readout(mechanism=mechanism, plan=self.plan, chassis=chassis, axes=self.scene.mechanism.axes)

    @property
    def bytes_of_a_design(self) -> int:
        """Bytes that the numbers of one design take."""
        return 8 * self.table.height * len(self.scene.instants)

    @property
    def bytes_on_the_way(self) -> int:
        """Bytes that solving one design takes in addition to its numbers."""
        table, count = self.table, min(len(self.scene.instants), INSTANTS)
        return (
            OF_A_DESIGN + (OF_A_NUMBER * table.height * bool(table.computed) + 24 * len(table.spare)) * count
        )

    def solve(self, first: int, last: int, memory: float = np.inf) -> Sweep:
        """Solve the designs from number `first` up to, but not including, `last`.

        Args:
            memory: most bytes for solving, in addition to the numbers.
        Raises:
            InputOutOfRange: a law leaves the range of an input, whatever the design.
        """
        rows = np.empty((last - first, self.table.height, len(self.scene.instants)))
        block = _Block.empty(self, first, rows)
        together = max(int(min(TOGETHER, memory // self.bytes_on_the_way)), 1)
        for low in range(first, last, together):
            block.solve(np.arange(low, min(low + together, last)))
        return block.sweep()


@dataclass(frozen=True)
class _Block:
    """Results of a block of designs, filled while the designs are solved.

    Attributes:
        first: number of the first design.
        rows: table of each design, (D, height, N).
        filled: whether the table of each design is filled, (D,).
        closing, drawn: see `Sweep`.
        failures, notes: those found so far.
    """

    course: Course
    first: int
    rows: Array
    filled: Flags
    closing: Array
    drawn: dict[str, Array]
    failures: dict[int, Failure] = field(default_factory=dict)
    notes: list[Noted] = field(default_factory=list)

    @classmethod
    def empty(cls, course: Course, first: int, rows: Array) -> _Block:
        names = [
            name
            for effect in course.plan.computed
            if effect.derivative == 0 and not effect.reports_states
            for name in effect.names(course.scene.mechanism.topology)
        ]
        nothing = np.full(len(rows), np.nan)
        return cls(course, first, rows, nothing == 0.0, nothing, {name: nothing.copy() for name in names})

    def sweep(self) -> Sweep:
        course, scene = self.course, self.course.scene
        numbers = np.arange(self.first, self.first + len(self.rows))
        solved = self.alive(numbers)
        assert (self.filled | ~solved).all()  # no failure is lost; rows that were not filled are arbitrary
        self.rows[~solved] = np.nan
        if not self.filled.any():
            scene_mechanism(scene)  # raises if no design can have a mechanism
        samples = course.table.named(scene.instants, self.rows)
        return Sweep(
            times=samples.times,
            numbers=samples.numbers,
            designs=course.designs,
            first=self.first,
            varied=course.designs.varied(numbers),
            solved=solved,
            closing=self.closing,
            drawn=self.drawn,
            failures=dict(sorted(self.failures.items())),
            notes=merged(self.notes),
        )

    def fail(self, members: Iterable[int], error: PointcoordError) -> None:
        for number in members:
            self.failures[int(number)] = Failure(int(number), reason_of(error), error)

    def alive(self, members: Indices) -> Flags:
        return ~np.isin(members, list(self.failures))

    def solve(self, members: Indices) -> None:
        designs, scene = self.course.designs, self.course.scene
        topology = scene.mechanism.topology
        points = designs.points(members)
        for place in np.flatnonzero(_suspicious(designs, points)).tolist():
            try:
                designs.design(int(members[place]))
            except SceneError as error:
                self.fail([members[place]], error)
        sound = self.alive(members)
        members, points = members[sound], {name: place[sound] for name, place in points.items()}
        laws = [scene.functions[name] for name in topology.required_inputs]
        certain = all((law.rounding(scene.instants) <= scene.tolerance).all() for law in laws)
        if topology.left_out or not certain:
            # The drawing decides which rows follow from others, and how far the error of a law moves a pose.
            for number in members.tolist():
                self._alone(number, whole=True)
            return
        for some, mechanism in self._mechanisms(members, points):
            places = np.searchsorted(members, some)
            own = {name: place[places] for name, place in points.items()}
            for i, doubt in enumerate(doubts_of_drawings(topology, own, self.course.scene.mechanism.axes)):
                self._note(f"doubt {i}", some, doubt.where, doubt.words)
            self._move(some, mechanism)

    def _mechanisms(self, members: Indices, points: Points) -> Iterator[tuple[Indices, Mechanism]]:
        """Mechanisms of the members that have one: a batch in which a member fails is divided in halves."""
        part = self.course.scene.mechanism
        if not len(members):
            return
        try:
            directions = {"up": part.up, "right": part.right}
            yield members, build_mechanism(part.topology, points, directions)
        except MechanismError as error:
            if len(members) == 1:
                self.fail(members, SceneError(f"design {members[0]}", "mechanism.points", error.problem))
                return
            half = len(members) // 2
            for some in (slice(None, half), slice(half, None)):
                yield from self._mechanisms(members[some], {n: p[some] for n, p in points.items()})

    def _note(
        self,
        kind: str,
        members: Indices,
        where: Flags,
        words: str | Callable[[tuple[int, ...]], str],
        weights: Array | None = None,
        warns: bool = True,
    ) -> None:
        """Add a note on the members marked by `where`, in the words for the member of largest weight."""
        count = int(np.count_nonzero(where))
        if count:
            place = int(np.argmax(where if weights is None else np.where(where, weights, -np.inf)))
            weight = 0.0 if weights is None else float(weights[place])
            text = words if isinstance(words, str) else words((place,))
            self.notes.append(Noted(kind, warns, count, int(members[place]), text, weight))

    def _move(self, members: Indices, mechanism: Mechanism) -> None:
        course, scene = self.course, self.course.scene
        time = scene.time
        functions = {name: scene.functions[name] for name in mechanism.topology.required_inputs}
        # The range of an input is the same for every design.
        check_range(mechanism.taken(0), functions, scene.instants)
        settings = chain_settings(scene, mechanism, course.plan.derivative)
        allowed = pose_tolerance(scene, SERIES, mechanism)
        solved = solve_designs(mechanism, functions, time.start, time.stop, settings, allowed)
        self._look_at_closing(members, mechanism, solved.closed)
        for each in solved.followed:
            readout = course.readout(mechanism.taken(each.numbers))
            self._fill(ByChain.of(readout, functions, each.chain), scene.instants, members[each.numbers])
        moved = members[solved.solved]
        if len(moved):
            for words in tolerance_notes(scene, mechanism.taken(int(solved.solved[0]))):
                self._note("tolerance", moved, self.alive(moved), words, warns=False)
            self._note_missing(moved[self.alive(moved)])
        for place, error in solved.failures.items():
            if members[place] in self.failures:
                continue
            if isinstance(error, NotFollowed):
                # A motion that fails in a batch may succeed for the design alone, or by a map.
                self._alone(int(members[place]))
            else:
                self.fail([members[place]], error)

    def _look_at_closing(self, members: Indices, mechanism: Mechanism, closed: Array) -> None:
        """Refuse drawings that closing turns into another car, and note how far the others move."""
        moved = np.max(list(movements(mechanism, closed).values()), axis=0)
        size, places = car_size(mechanism), members - self.first
        self.closing[places] = moved
        for name, angle in self._angles(mechanism, closed).items():
            self.drawn[name][places] = angle
        # A closure that puts points in place is requested by name; then points may move any distance.
        far = (moved > (1.0 - SLACK) * ALLOWED * size) & (not mechanism.topology.puts_in_place)
        for place in np.flatnonzero(far).tolist():
            try:
                require_the_drawn_car(self.course.scene, closing(mechanism.taken(place), closed[place]))
            except SceneError as error:
                self.fail([members[place]], error.of(f"design {members[place]}"))
        with np.errstate(invalid="ignore"):
            noticed = (moved > np.minimum(NOTICED, NOTICED_SHARE * size)) & self.alive(members)

        def words(place: tuple[int, ...]) -> str:
            return closing(mechanism.taken(place[0]), closed[place]).words

        self._note("closing", members, noticed, words, moved)

    def _angles(self, mechanism: Mechanism, closed: Array) -> dict[str, Array]:
        return drawn_angles(mechanism, self.course.scene.mechanism.axes, self.course.plan.effects, closed)

    def _fill(self, solved: ByChain, instants: Array, members: Indices) -> None:
        places = members - self.first
        self.filled[places] = True
        together = self.rows[places[0] : places[-1] + 1]
        if len(together) == len(members):
            solved.fill(instants, together)
        else:
            rows = np.empty((len(members), *self.rows.shape[1:]))
            solved.fill(instants, rows)
            self.rows[places] = rows

    def _alone(self, number: int, whole: bool = False) -> None:
        """Solve one design separately, as a scene with any method that can follow its laws.

        Args:
            whole: whether the closing of its drawing is still to be noted.
        """
        try:
            motion = simulate(self.course.designs.design(number))
        except PointcoordError as error:
            self.fail([number], error)
            return
        place = number - self.first
        self.filled[place] = True
        for quantity, names in self.course.table.places.items():
            for name in names:
                self.course.table.put(self.rows[place], quantity, name, motion.numbers[quantity][name])
        alone = f"solved separately, by the method {motion.method!r}"
        self.notes.append(Noted("alone", False, 1, number, alone))
        if whole:
            mechanism, closed = motion.solved.readout.mechanism, motion.closing
            self.closing[place] = closed.largest
            for name, angle in self._angles(mechanism, close_drawing(mechanism).y).items():
                self.drawn[name][place] = angle
            if closed.noticeable:
                self.notes.append(Noted("closing", True, 1, number, closed.words, closed.largest))

    def _note_missing(self, members: Indices) -> None:
        if not len(members):
            return
        places = members - self.first
        # Consecutive designs are read in place: copying all numbers would cost as much as computing them.
        apart = places[-1] - places[0] != len(places) - 1
        rows = self.rows[places] if apart else self.rows[places[0] : places[-1] + 1]
        for number, why, where in self.course.table.missing(rows):
            words = f"{number} is not a number at some instants{why}"
            self._note(number, members, np.asarray(where.any(axis=-1)), words, warns=False)


def _suspicious(designs: Designs, points: Points) -> Flags:
    """Marks all designs that are not valid as a scene, and hardly any others.

    The faults of a design are numbers that are not finite, a wheel that lies inboard, and two points at one
    position that the shared scene draws apart.
    """
    part = designs.scene.mechanism
    found = np.zeros(len(next(iter(points.values()))), dtype=bool)
    inboard = part.topology.role("inboard")
    if inboard and part.topology.wheel_centre:
        inner, wheel = points[inboard[0]], points[part.topology.wheel_centre]
        with np.errstate(invalid="ignore", over="ignore"):
            slack = SLACK * (np.abs(inner).max(axis=-1) + np.abs(wheel).max(axis=-1))
            found |= ~((inner - wheel) @ part.outboard < -slack)
    for place in points.values():
        found |= ~np.isfinite(place).all(axis=-1)
    for one, other in combinations(points, 2):
        if part.points[one] != part.points[other]:
            found |= (points[one] == points[other]).all(axis=-1)
    return found


def reason_of(error: PointcoordError) -> str:
    """The reason for a failure, in words without numbers."""
    if isinstance(error, AssemblyError | NotFollowed):
        return error.problem
    if isinstance(error, SceneError):
        return error.reason
    if isinstance(error, MechanismError):
        return "the mechanism locks"
    return f"an input is refused ({type(error).__name__})"
