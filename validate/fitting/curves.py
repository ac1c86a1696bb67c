r"""The numbers of a file's columns as a design gives them, and how they change with each hardpoint.

Positions and angles are read off poses that are solved one by one, and rates off the motion. An input that
the file gives is the same in every design; one that it does not give is as drawn, and the drawing changes.
The input x that reaches a travel is another one in every design: the travel is h = height(x, p) less that
of the drawing's own inputs, and what is held is h. So a number q at a row changes with a coordinate p by

    dq/dp - dq/dx (dh/dp) / (dh/dx),    dq/dp = (q(p + s) - q(p - s)) / 2 s at the same x.

Central differences of solved designs lack s^2 / 6 of the third derivative: with s = STEP and points some
100 mm apart a part of 1e-8 of a slope; poses that are solved to 1e-12 mm make it off by 1e-10. The search
ends at 1e-9 of the sum of squares, where a part of 1e-5 of a slope would matter.

Which pose has a travel is meant as in `measured.poses`: the one on the part about the drawing where h goes
one way. The car as drawn is followed there in steps, each by Newton's method; a moved design is solved for
from there, and no try counts at which h goes the other way.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pointcoord import PointcoordError, Scene, designs_of, solve_poses
from pointcoord.data_classes import dataclass
from pointcoord.linkage.car_axes import CarAxes
from pointcoord.simulation import scene_mechanism
from pointcoord.solve.assembly import close_drawing
from validate.fitting.errors import FitError
from validate.measured.comparing import ours_of
from validate.measured.mapping import (
    CONTACT,
    INPUT,
    PLACES,
    TIME,
    TRAVEL,
    Measured,
    angle_of,
)
from validate.measured.poses import Found, Plan, asked_scene, poses_of

Array = NDArray[np.float64]
Bools = NDArray[np.bool_]

TRIES = 40  # of an input that reaches a travel: Newton's method takes some five, halved steps more
CLOSE = 1e-6  # mm of a travel, from which one more step leaves rounding
TIGHT = 1e-12  # mm, of poses
STEP = 0.02  # mm, of differences by coordinates
NEAR = 1e-5  # rad or mm, of differences by an input
PARTS = 8  # in which the car as drawn is followed to a travel
NO_POSE = "the car has no pose there with this travel's input as drawn"


@dataclass(frozen=True)
class Curves:
    """The columns of a file over the designs of a scene.

    Attributes:
        scene: as drawn. free: the coordinates that vary, such as lower_ball_joint.z.
    """

    scene: Scene
    measured: Measured
    free: tuple[str, ...]

    def design(self, amounts: Array) -> Scene:
        """The scene with its free coordinates moved, (free,), mm.

        Raises:
            SceneError: the hardpoints make no mechanism.
        """
        offsets = dict(zip(self.free, amounts.tolist(), strict=True))
        return designs_of(self.scene, offsets=offsets).design(0)

    def solved(self, amounts: Array, values: Sequence[Array] | None = None) -> Solved:
        """A design at values of the independent columns, the file's own unless given.

        Raises:
            PointcoordError: the design cannot be solved.
        """
        design = self.design(amounts)
        if values is None:
            values = [s.values for s in self.measured.independent]
        if self._over_time and not self._poses_do:
            return Solved(self, design, poses_of(design, self.measured).at(values))
        return Solved(self, design, self._by_poses(design, values))

    def at(self, amounts: Array, values: Sequence[Array] | None = None) -> Array:
        """Every column one after the other, (columns * rows,), in our units; NaN where there is no pose."""
        try:
            return self.solved(amounts, values).numbers
        except PointcoordError:
            return np.full(len(self.measured.numbers) * len(self.measured.rows), np.nan)

    @cached_property
    def as_drawn(self) -> tuple[str, ...]:
        """Inputs that the file does not give; that by which it reaches a travel is one of them."""
        given = {s.meaning.name for s in self.measured.independent if s.meaning.kind == INPUT}
        required = self.scene.mechanism.topology.required_inputs
        return () if self._over_time else tuple(n for n in required if n not in given and n not in self.held)

    @cached_property
    def held(self) -> dict[str, float]:
        """Inputs that every row has."""
        every = self.measured.held.items()
        return {n.removeprefix(f"{INPUT}."): v for n, v in every if n.startswith(f"{INPUT}.")}

    @cached_property
    def travel(self) -> str:
        """The point whose travel a row has; empty if it has none."""
        given = (s.meaning.words for s in self.measured.independent if s.meaning.kind == TRAVEL)
        every = (*given, *(name for name in self.measured.held if name.startswith(f"{TRAVEL}.")))
        return next((name.partition(".")[2] for name in every), "")

    @property
    def solved_input(self) -> str:
        """The input that a travel is reached by; empty if there is none."""
        return self.plan.solved if self.travel else ""

    @cached_property
    def plan(self) -> Plan:
        """Which inputs rows have that are not over time.

        Raises:
            ResultsError: a travel cannot be followed.
        """
        return Plan.of(asked_scene(self.scene, self.measured), self.measured)

    @property
    def _over_time(self) -> bool:
        return self.measured.independent[0].meaning.kind == TIME

    @property
    def _poses_do(self) -> bool:
        """Whether every number is one of a pose."""
        return all(
            s.meaning.quantity == PLACES or angle_of(s.meaning) is not None for s in self.measured.numbers
        )

    def _by_poses(self, design: Scene, values: Sequence[Array], roots: Array | None = None) -> Found:
        """Poses of a design; of travels at these values of the input that reaches them, if they are known."""
        inputs: dict[str, Array] = {}
        count = len(values[0])
        reached: Bools = np.ones(count, dtype=bool)
        reasons: dict[int, str] = {}
        wanted: Array | None = None
        for s, value in zip(self.measured.independent, values, strict=True):
            if s.meaning.kind == TIME:
                start, stop = design.time.start, design.time.stop
                reached = np.asarray((value >= start) & (value <= stop))
                times = np.clip(value, start, stop)
                inputs |= {name: law.series(times, 0)[:, 0] for name, law in design.functions.items()}
                reasons = {int(row): "is outside the scene's time" for row in np.flatnonzero(~reached)}
            elif s.meaning.kind == TRAVEL:
                wanted = value
            else:
                inputs[s.meaning.name] = value
        inputs |= {name: np.full(count, value) for name, value in self.held.items()}
        drawn = drawn_inputs(design) if self.as_drawn else {}
        inputs |= {name: np.full(count, drawn[name]) for name in self.as_drawn}
        if self.travel:
            if wanted is None:
                wanted = np.full(count, self.measured.held[f"{TRAVEL}.{self.travel}"])
            if roots is None:
                roots, reasons = self._roots(design, wanted, inputs, drawn, self._begin(drawn))
            inputs[self.solved_input] = roots
            reached = np.array([row not in reasons for row in range(count)])
        poses = solve_poses(design, inputs, TIGHT)
        reasons = {row: str(error) for row, error in poses.failures.items()} | reasons
        reached = np.asarray(poses.solved & reached)
        part = design.mechanism
        axes = CarAxes(np.array(part.up), np.array(part.right), part.outboard)
        places = {name: np.where(reached[:, None], place, np.nan) for name, place in poses.position.items()}
        numbers: dict[str, dict[str, Array]] = {PLACES: places}
        for s in self.measured.numbers:
            angle = angle_of(s.meaning)
            if angle is not None:
                start_of, end_of = (places[point] for point in angle.ends(part.topology))
                value = angle.value(start_of, end_of, axes)
                numbers.setdefault(s.meaning.quantity, {})[s.meaning.name] = value
        bounds = {PLACES: {name: np.zeros_like(place) for name, place in places.items()}}
        return Found(numbers, bounds, reached, reasons, inputs)

    def home_inputs(self, drawn: Mapping[str, float]) -> dict[str, float]:
        """The inputs of the pose from which travels count: as drawn, but for those that are held."""
        names = self.scene.mechanism.topology.required_inputs
        return {name: self.held.get(name, drawn[name]) for name in names}

    @cached_property
    def _wanted(self) -> Array:
        """The travels of the rows."""
        count = len(self.measured.rows)
        level = self.measured.held.get(f"{TRAVEL}.{self.travel}", 0.0)
        given = (s.values for s in self.measured.independent if s.meaning.kind == TRAVEL)
        return next(given, np.full(count, level))

    @cached_property
    def _drawn_roots(self) -> tuple[Array, Mapping[int, str]]:
        """The inputs at which the car as drawn has the file's travels, and why there are none, by row."""
        count, drawn = len(self.measured.rows), self.plan.drawn
        given = {s.meaning.name: s.values for s in self.measured.independent if s.meaning.kind == INPUT}
        inputs = {name: np.full(count, value) for name, value in drawn.items()}
        inputs |= {name: np.full(count, value) for name, value in self.held.items()} | given
        # Rows of other given inputs have another travel there: all are followed from the one that they have.
        start = self._travel_at(self.scene, inputs, drawn)
        roots, reasons = inputs[self.solved_input], {int(i): NO_POSE for i in np.flatnonzero(np.isnan(start))}
        for part in np.linspace(0.0, 1.0, PARTS + 1)[1:].tolist():
            roots, reasons = self._roots(
                self.scene,
                np.where(np.isnan(start), 0.0, start + part * (self._wanted - start)),
                inputs,
                drawn,
                (roots, reasons),
            )
        return roots, reasons

    def _travel_at(self, design: Scene, inputs: Mapping[str, Array], drawn: Mapping[str, float]) -> Array:
        home = {name: np.array([value]) for name, value in self.home_inputs(drawn).items()}
        level = self.height(design, solve_poses(design, home, TIGHT).position)
        return self.height(design, solve_poses(design, inputs, TIGHT).position) - level

    def _roots(
        self,
        design: Scene,
        wanted: Array,
        inputs: Mapping[str, Array],
        drawn: Mapping[str, float],
        begin: tuple[Array, Mapping[int, str]],
    ) -> tuple[Array, dict[int, str]]:
        """The inputs at which a design has travels, by Newton's method, and why there are none, by row."""
        name, reasons = self.solved_input, dict(begin[1])
        rows = np.array([row for row in range(len(wanted)) if row not in reasons], dtype=np.intp)
        found = begin[0].copy()
        if not len(rows):
            return found, reasons
        home = {n: np.array([value]) for n, value in self.home_inputs(drawn).items()}
        level, way = (number[0] for number in self._heights(design, home))
        others = {n: value[rows] for n, value in inputs.items() if n != name}
        x = found[rows]
        step, told = np.zeros(len(rows)), np.full(len(rows), np.inf)
        for _ in range(TRIES):
            here, slope = self._heights(design, {**others, name: x + step})
            left = wanted[rows] - (here - level)
            # A step to where the car has no pose, or goes the other way, or is farther off, was too long.
            good = np.isfinite(left / slope) & (slope * way > 0.0) & (np.abs(left) < np.maximum(told, CLOSE))
            x, told = np.where(good, x + step, x), np.where(good, np.abs(left), told)
            step = np.where(good, left / np.where(good, slope, 1.0), 0.5 * step)
            if (good & (told <= CLOSE)).all():
                break
        # The last step leaves a part of CLOSE, as the slope is off by a part of NEAR: rounding.
        far = ~(told <= CLOSE)
        found[rows] = np.where(far, found[rows], x + step)
        travel = f"{TRAVEL}.{self.travel}"
        reasons |= {int(i): f"{travel} = {wanted[i]:.6g} mm is out of reach" for i in rows[far]}
        return found, reasons

    def _heights(self, design: Scene, inputs: Mapping[str, Array]) -> tuple[Array, Array]:
        """How high the point that travels is, and how that changes with the input that is solved for."""
        name = self.solved_input
        both = {n: np.concatenate([value, value + NEAR * (n == name)]) for n, value in inputs.items()}
        here, there = np.split(self.height(design, solve_poses(design, both, TIGHT).position), 2)
        return here, (there - here) / NEAR

    def _begin(self, drawn: Mapping[str, float]) -> tuple[Array, Mapping[int, str]]:
        """Where to look for the inputs of a design first: as far from its drawing as the car as drawn."""
        roots, reasons = self._drawn_roots
        return roots + (drawn[self.solved_input] - self.plan.drawn[self.solved_input]), reasons

    def height(self, design: Scene, places: Mapping[str, Array]) -> Array:
        """How high the point that travels is, (rows,), mm."""
        part = design.mechanism
        up = np.array(part.up)
        if self.travel != CONTACT:
            return np.asarray(places[self.travel] @ up)
        inner, outer = part.topology.wheel_axis
        spin = places[outer] - places[inner]
        lean = (spin @ up) / np.linalg.norm(spin, axis=-1)
        # The lowest point of a thin disc is R sqrt(1 - lean^2) below its centre.
        centre = places[part.topology.wheel_centre] @ up
        return np.asarray(centre - self.measured.rolling_radius * np.sqrt(1.0 - lean**2))

    def slopes(self, amounts: Array, here: Solved, used: Bools) -> Array:
        """How the used numbers change with each coordinate, (used, free), in our units by mm.

        Args:
            here: the design that these amounts make, solved.
        Raises:
            FitError: a design beside it has no pose there.
        """
        roots = here.found.inputs.get(self.solved_input)

        def change(moved: Array, step: float, near: float = 0.0) -> tuple[Array, Array]:
            sides = (self._at_roots(way * moved + amounts, roots, way * near) for way in (1.0, -1.0))
            numbers, travel = ((a - b) / (2.0 * step) for a, b in zip(*sides, strict=True))
            return numbers[used], np.tile(travel, len(self.measured.numbers))[used]

        found = np.empty((int(used.sum()), len(self.free)))
        by_input, rising = change(np.zeros(len(self.free)), NEAR, NEAR) if roots is not None else (0.0, 1.0)
        for i, moved in enumerate(STEP * np.eye(len(self.free))):
            by_drawing, travel = change(moved, STEP)
            found[:, i] = by_drawing - by_input * travel / rising
        if not np.isfinite(found).all():
            lost = int(np.flatnonzero(used)[int(np.argmin(np.isfinite(found).all(axis=1)))])
            problem = "the car's numbers have no slope there: its pose is next to a singular one"
            row = self.measured.rows[lost % len(self.measured.rows)]
            raise FitError(row, problem, "rows away from where the car jams")
        return found

    def _at_roots(self, amounts: Array, roots: Array | None, more: float) -> tuple[Array, Array]:
        """Every column of a design, and the travel of its rows at values of the input that reaches it."""
        count = len(self.measured.rows)
        if roots is None:
            return self.at(amounts), np.zeros(count)
        try:
            design = self.design(amounts)
            found = self._by_poses(design, [s.values for s in self.measured.independent], roots + more)
            home = {n: np.array([v]) for n, v in self.home_inputs(drawn_inputs(design)).items()}
            level = self.height(design, solve_poses(design, home, TIGHT).position)
        except PointcoordError:
            return np.full(len(self.measured.numbers) * count, np.nan), np.full(count, np.nan)
        return Solved(self, design, found).numbers, self.height(design, found.numbers[PLACES]) - level


@dataclass(frozen=True)
class Solved:
    """A design at the rows of a file.

    Attributes:
        found: its numbers.
    """

    curves: Curves
    design: Scene
    found: Found

    @cached_property
    def numbers(self) -> Array:
        """Every column one after the other, (columns * rows,), in our units; NaN where there is no pose."""
        nothing = np.full(len(self.found.reached), np.nan)
        columns = [ours_of(s, self.found, self.curves.scene)[0] for s in self.curves.measured.numbers]
        return np.concatenate([nothing if c is None else c for c in columns])


def drawn_inputs(scene: Scene) -> Mapping[str, float]:
    """The inputs of a closed drawing."""
    mechanism = scene_mechanism(scene)
    y = close_drawing(mechanism).y
    read = mechanism.input_values(y[mechanism.map.unknowns :])
    return {name: float(np.ravel(read[name])[0]) for name in mechanism.topology.required_inputs}
