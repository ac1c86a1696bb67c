r"""The numbers of a file's columns as a design gives them, and how they change with each hardpoint, exactly.

Positions and angles over time or inputs are read off poses that are solved one by one; rates off the motion;
what is over a travel off the design's own map. With dq/dp at held inputs and dq/dx from `slopes`, a number at
a row of the file changes by

    dq/dp + sum over the inputs x of dq/dx dx/dp.

An input that the file gives is the same in every design; one that it does not give is as drawn, and the
drawing changes. The input that reaches a travel h is another one in every design: what is held is
h(x, p) - h(x_0, p), with x_0 the drawing's own input, so that

    dx/dp = -(dh/dp - dh_0/dp - sum dh_0/dx_0 dx_0/dp + sum over the other inputs dh/dx dx/dp) / (dh/dx).
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
from validate.measured.poses import Found, OverMap, poses_of

Array = NDArray[np.float64]
Bools = NDArray[np.bool_]

AXES = "xyz"
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
        if self._alone:
            return Solved(self, design, self._by_poses(design, values))
        poses = poses_of(design, self.measured)
        return Solved(self, design, poses.at(values), poses if isinstance(poses, OverMap) else None)

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
        given |= {name.removeprefix(f"{INPUT}.") for name in self.measured.held}
        over_time = self.measured.independent[0].meaning.kind == TIME
        required = self.scene.mechanism.topology.required_inputs
        return () if over_time else tuple(name for name in required if name not in given)

    @property
    def travel(self) -> str:
        """The point whose travel a row has; empty if it has none."""
        held = (name for name in self.measured.held if name.startswith(f"{TRAVEL}."))
        given = (s.meaning.words for s in self.measured.independent if s.meaning.kind == TRAVEL)
        return next((name.partition(".")[2] for name in (*given, *held)), "")

    @property
    def _alone(self) -> bool:
        """Whether every row's inputs are known in any design, and every number is one of its pose."""
        return not self.travel and all(
            s.meaning.quantity == PLACES or angle_of(s.meaning) is not None for s in self.measured.numbers
        )

    def _by_poses(self, design: Scene, values: Sequence[Array]) -> Found:
        inputs: dict[str, Array] = {}
        count = len(values[0])
        inside: Bools = np.ones(count, dtype=bool)
        for s, value in zip(self.measured.independent, values, strict=True):
            if s.meaning.kind == TIME:
                start, stop = design.time.start, design.time.stop
                inside = np.asarray((value >= start) & (value <= stop))
                times = np.clip(value, start, stop)
                inputs |= {name: law.series(times, 0)[:, 0] for name, law in design.functions.items()}
            else:
                inputs[s.meaning.name] = value
        inputs |= {
            name.removeprefix(f"{INPUT}."): np.full(count, value)
            for name, value in self.measured.held.items()
        }
        drawn = drawn_inputs(design) if self.as_drawn else {}
        inputs |= {name: np.full(count, drawn[name]) for name in self.as_drawn}
        poses = solve_poses(design, inputs)
        reasons = {row: str(error) for row, error in poses.failures.items()}
        reasons |= {int(row): "is outside the scene's time" for row in np.flatnonzero(~inside)}
        reached: Bools = np.asarray(poses.solved & inside)
        part = design.mechanism
        axes = CarAxes(np.array(part.up), np.array(part.right), part.outboard)
        places = {name: np.where(reached[:, None], place, np.nan) for name, place in poses.position.items()}
        numbers: dict[str, dict[str, Array]] = {PLACES: places}
        for s in self.measured.numbers:
            angle = angle_of(s.meaning)
            if angle is not None:
                start_of, end_of = (places[point] for point in angle.ends(part.topology))
                numbers.setdefault(s.meaning.quantity, {})[s.meaning.name] = angle.value(
                    start_of, end_of, axes
                )
        bounds = {PLACES: {name: np.zeros_like(place) for name, place in places.items()}}
        return Found(numbers, bounds, reached, reasons, inputs)


@dataclass(frozen=True)
class Solved:
    """A design at the rows of a file.

    Attributes:
        found: its numbers. map: what they were read off, over a travel.
    """

    curves: Curves
    design: Scene
    found: Found
    map: OverMap | None = None

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
        return {
            name: np.stack([value[rows], np.zeros(len(rows)), np.zeros(len(rows))], axis=-1)
            for name, value in self.found.inputs.items()
        }

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
        if self.map is None or not self.map.solved:
            return found
        solved = inputs.index(self.map.solved)
        home, by_home = self._home_height(drawn)
        change = self._height(places, by_drawing)
        further = self._height(places, by_inputs)
        others = [i for i in range(len(inputs)) if i != solved]
        change += np.einsum("xn,xpn->pn", further[others], found[others])
        found[solved] = -(change - home - by_home) / further[solved]
        return found

    def _home_height(self, drawn: Mapping[str, Array]) -> tuple[Array, Array]:
        """How the height from which a travel counts changes: at held inputs, and by those as drawn."""
        over = self.map
        assert over is not None  # a travel is over a map
        names = self.curves.scene.mechanism.topology.required_inputs
        inputs = {name: over.drawn[name] if name in over.map.inputs else over.held[name] for name in names}
        # What varies, or was left out of the file, is as drawn at home; what the file holds is held.
        going = tuple(name for name in names if name in over.map.inputs or name in self.curves.as_drawn)
        places = {name: place[None] for name, place in solve_poses(self.design, inputs).position.items()}
        laws = {name: np.array([[value, 0.0, 0.0]]) for name, value in inputs.items()}
        by_drawing, by_inputs = CarSlopes(self.design, self.curves.moves, going).at(places, laws, (PLACES,))
        further = self._height(places, by_inputs)
        moved = sum(
            (drawn[name][:, None] * further[i] for i, name in enumerate(going)),
            np.zeros((len(self.curves.free), 1)),
        )
        return self._height(places, by_drawing), moved

    def _height(self, places: Mapping[str, Array], slopes: Slopes) -> Array:
        """How the height of the point that travels changes, (directions, rows)."""
        part, point = self.design.mechanism, self.curves.travel
        up, changes = np.array(part.up), slopes[PLACES]
        if point != CONTACT:
            return np.asarray(changes[point] @ up)
        inner, outer = part.topology.wheel_axis
        lean, leaning = _share(places[outer] - places[inner], changes[outer] - changes[inner], up)
        # The lowest point of a thin disc is R sqrt(1 - lean^2) below its centre.
        radius = self.curves.measured.rolling_radius
        return np.asarray(
            changes[part.topology.wheel_centre] @ up + radius * lean * leaning / np.sqrt(1.0 - lean**2)
        )

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


def drawn_inputs(scene: Scene) -> Mapping[str, float]:
    """The inputs of a closed drawing."""
    mechanism = scene_mechanism(scene)
    y = close_drawing(mechanism).y
    read = mechanism.input_values(y[mechanism.map.unknowns :])
    return {name: float(np.ravel(read[name])[0]) for name in mechanism.topology.required_inputs}
