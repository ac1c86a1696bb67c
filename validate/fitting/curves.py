r"""The numbers of a file's columns as a design gives them, and how they change with each hardpoint, exactly.

Positions and angles are read off poses that are solved one by one, and rates off the motion. With dq/dp at
held inputs and dq/dx from `slopes`, a number at a row of the file changes by

    dq/dp + sum over the inputs x of dq/dx dx/dp.

An input that the file gives is the same in every design; one that it does not give is as drawn, and the
drawing changes. The input that reaches a travel h is another one in every design: what is held is
h(x, p) - h(x_0, p), with x_0 the drawing's own inputs, so that

    dx/dp = -(dh/dp - dh_0/dp - sum dh_0/dx_0 dx_0/dp + sum over the other inputs dh/dx dx/dp) / (dh/dx).

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
from pointcoord.effects.registry import ALWAYS
from pointcoord.linkage.car_axes import CarAxes
from pointcoord.simulation import scene_mechanism
from pointcoord.solve.assembly import close_drawing
from validate.fitting.errors import FitError
from validate.fitting.slopes import CarSlopes, Slopes
from validate.formulations.input_rates import rates
from validate.measured.comparing import ours_of
from validate.measured.mapping import ARCSINE, CONTACT, INPUT, TIME, TRAVEL, Measured, Series, angle_of
from validate.measured.poses import Found, Plan, asked_scene, poses_of

Array = NDArray[np.float64]
Bools = NDArray[np.bool_]

AXES = "xyz"
TRIES = 40  # of an input that reaches a travel: Newton's method takes some five, halved steps more
CLOSE = 1e-6  # mm of a travel, from which one more step leaves rounding
TIGHT = 1e-12  # mm, of poses that a travel is read off
PARTS = 8  # in which the car as drawn is followed to a travel
NO_POSE = "the car has no pose there with this travel's input as drawn"
(PLACES,) = (quantity.name for effect in ALWAYS for quantity in effect.quantities)


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
    def moves(self) -> dict[str, tuple[tuple[str, int], ...]]:
        """By coordinate, the points that move with it."""
        following = designs_of(self.scene, offsets=dict.fromkeys(self.free, 0.0)).following
        found = {}
        for name in self.free:
            point, _, axis = name.partition(".")
            along = AXES.index(axis)
            going = (other for other, leader in following.items() if leader == point)
            found[name] = ((point, along), *((other, along) for other in going))
        return found

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

    def _by_poses(self, design: Scene, values: Sequence[Array]) -> Found:
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
            roots, reasons = self._roots(design, wanted, inputs, drawn, self._begin(drawn))
            inputs[self.solved_input] = roots
            reached = np.array([row not in reasons for row in range(count)])
        poses = solve_poses(design, inputs)
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
        car = CarSlopes(design, {}, (name,))
        home = {n: np.array([value]) for n, value in self.home_inputs(drawn).items()}
        places = dict(solve_poses(design, home, TIGHT).position)
        level = self.height(design, places)[0]
        way = self._going(car, places, home)[0]
        others = {n: value[rows] for n, value in inputs.items() if n != name}
        x = found[rows]
        step, told = np.zeros(len(rows)), np.full(len(rows), np.inf)
        for _ in range(TRIES):
            tried = {**others, name: x + step}
            poses = solve_poses(design, tried, TIGHT)
            some = np.flatnonzero(poses.solved)
            left, slope = np.full(len(rows), np.inf), np.ones(len(rows))
            if len(some):
                places = {n: place[some] for n, place in poses.position.items()}
                left[some] = wanted[rows[some]] - (self.height(design, places) - level)
                slope[some] = self._going(car, places, {n: value[some] for n, value in tried.items()})
            # A step to where the car has no pose, or goes the other way, or is farther off, was too long.
            good = np.isfinite(left / slope) & (slope * way > 0.0) & (np.abs(left) < np.maximum(told, CLOSE))
            x, told = np.where(good, x + step, x), np.where(good, np.abs(left), told)
            step = np.where(good, left / np.where(good, slope, 1.0), 0.5 * step)
            if (good & (told <= CLOSE)).all():
                break
        # The last step leaves about the square of CLOSE, by the size of the car: rounding.
        far = ~(told <= CLOSE)
        found[rows] = np.where(far, found[rows], x + step)
        travel = f"{TRAVEL}.{self.travel}"
        reasons |= {int(i): f"{travel} = {wanted[i]:.6g} mm is out of reach" for i in rows[far]}
        return found, reasons

    def _going(self, car: CarSlopes, places: Mapping[str, Array], inputs: Mapping[str, Array]) -> Array:
        """How the height that travels changes with the input that is solved for, (rows,)."""
        laws = {name: _at_rest(value) for name, value in inputs.items()}
        return np.asarray(self.height_change(car.scene, places, car.at(places, laws, (PLACES,))[1])[0])

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

    def height_change(self, design: Scene, places: Mapping[str, Array], slopes: Slopes) -> Array:
        """How that changes, (directions, rows)."""
        part, changes = design.mechanism, slopes[PLACES]
        up = np.array(part.up)
        if self.travel != CONTACT:
            return np.asarray(changes[self.travel] @ up)
        inner, outer = part.topology.wheel_axis
        lean, leaning = _share(places[outer] - places[inner], changes[outer] - changes[inner], up)
        sinking = self.measured.rolling_radius * lean * leaning / np.sqrt(1.0 - lean**2)
        return np.asarray(changes[part.topology.wheel_centre] @ up + sinking)


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

    def slopes(self, used: Bools) -> Array:
        """How the used numbers change with each coordinate, (used, free), in our units by mm.

        Raises:
            FitError: a pose is so near a singular one that it has none.
        """
        curves, rows = self.curves, np.flatnonzero(self.found.reached)
        free, count = len(curves.free), len(self.found.reached)
        told = used.reshape(len(curves.measured.numbers), count)
        asked = [s for s, own in zip(curves.measured.numbers, told, strict=True) if own.any()]
        places = {name: place[rows] for name, place in self.found.numbers[PLACES].items()}
        inputs = curves.as_drawn
        car = CarSlopes(self.design, curves.moves, inputs)
        wanted = dict.fromkeys((PLACES, *(s.meaning.quantity for s in asked)))
        by_drawing, by_inputs = car.at(places, self._laws(rows), wanted)
        along = self._inputs_by_drawing(car, places, by_drawing, by_inputs)
        found = np.full((len(told), count, free), np.nan)
        for i, s in enumerate(curves.measured.numbers):
            if s in asked:
                change = self._column(s, places, by_drawing)
                further = self._column(s, places, by_inputs)
                found[i, rows] = (change + np.einsum("xn,xpn->pn", further, along)).T
        matrix = found.reshape(-1, free)[used]
        if not np.isfinite(matrix).all():
            row = int(np.flatnonzero(used)[int(np.argmin(np.isfinite(matrix).all(axis=1)))]) % count
            problem = "the car's numbers have no slope there: its pose is next to a singular one"
            raise FitError(curves.measured.rows[row], problem, "rows away from where the car jams")
        return matrix

    def _laws(self, rows: NDArray[np.intp]) -> dict[str, Array]:
        """Value, rate and acceleration of every input at some rows, (rows, 3)."""
        independent = self.curves.measured.independent[0]
        if independent.meaning.kind == TIME:
            times = independent.values[rows]
            return {name: rates(law, times) for name, law in self.design.inputs.items()}
        return {name: _at_rest(value[rows]) for name, value in self.found.inputs.items()}

    def _inputs_by_drawing(
        self, car: CarSlopes, places: Mapping[str, Array], by_drawing: Slopes, by_inputs: Slopes
    ) -> Array:
        """How the inputs of a row that the file does not give change, (inputs, free, rows)."""
        inputs, count = self.curves.as_drawn, len(next(iter(places.values())))
        found = np.zeros((len(inputs), len(self.curves.free), count))
        if not inputs:
            return found
        drawn = car.drawn()
        for i, name in enumerate(inputs):
            found[i] = drawn[name][:, None]
        if not self.curves.travel:
            return found
        solved = inputs.index(self.curves.solved_input)
        home, by_home = self._home_height(drawn)
        change = self.curves.height_change(self.design, places, by_drawing)
        further = self.curves.height_change(self.design, places, by_inputs)
        others = [i for i in range(len(inputs)) if i != solved]
        change += np.einsum("xn,xpn->pn", further[others], found[others])
        found[solved] = -(change - home - by_home) / further[solved]
        return found

    def _home_height(self, drawn: Mapping[str, Array]) -> tuple[Array, Array]:
        """How the height from which a travel counts changes: at held inputs, and by those as drawn."""
        curves, free = self.curves, len(self.curves.free)
        inputs = curves.home_inputs(drawn_inputs(self.design))
        going = tuple(name for name in inputs if name not in curves.held)
        rows = {name: np.array([value]) for name, value in inputs.items()}
        places = dict(solve_poses(self.design, rows).position)
        laws = {name: _at_rest(value) for name, value in rows.items()}
        by_drawing, by_inputs = CarSlopes(self.design, curves.moves, going).at(places, laws, (PLACES,))
        further = curves.height_change(self.design, places, by_inputs)
        moved = np.zeros((free, 1))
        for i, name in enumerate(going):
            moved += drawn[name][:, None] * further[i]
        return curves.height_change(self.design, places, by_drawing), moved

    def _column(self, s: Series, places: Mapping[str, Array], slopes: Slopes) -> Array:
        """Slopes of a column, (directions, rows)."""
        meaning = s.meaning
        if s.definition == ARCSINE:
            angle = angle_of(meaning)
            assert angle is not None  # the map of columns was checked
            part = self.design.mechanism
            axes = CarAxes(np.array(part.up), np.array(part.right), part.outboard)
            start, end = angle.ends(part.topology)
            line, changes = places[end] - places[start], slopes[PLACES][end] - slopes[PLACES][start]
            along = np.array([axes.component(unit, angle.sine) for unit in np.eye(3)])
            sine, change = _share(line, changes, along)
            return np.asarray(change / np.sqrt(1.0 - sine**2))
        found = slopes[meaning.quantity][meaning.name]
        return found if meaning.axis is None else found[..., meaning.axis]


def _share(line: Array, changes: Array, direction: Array) -> tuple[Array, Array]:
    """The part of lines, (N, 3), along a unit vector, by their length, (N,), and its slopes, (D, N)."""
    long = np.linalg.norm(line, axis=-1)
    share = (line @ direction) / long
    longer = np.einsum("dnk,nk->dn", changes, line) / long
    return np.asarray(share), np.asarray((changes @ direction - share * longer) / long)


def _at_rest(values: Array) -> Array:
    """Value, rate and acceleration of an input that is what it is, (rows, 3)."""
    return np.stack([values, np.zeros_like(values), np.zeros_like(values)], axis=-1)


def drawn_inputs(scene: Scene) -> Mapping[str, float]:
    """The inputs of a closed drawing."""
    mechanism = scene_mechanism(scene)
    y = close_drawing(mechanism).y
    read = mechanism.input_values(y[mechanism.map.unknowns :])
    return {name: float(np.ravel(read[name])[0]) for name in mechanism.topology.required_inputs}
