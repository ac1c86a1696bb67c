r"""Our own numbers at the rows of a file: over time by the motion, over inputs and travels pose by pose.

A travel is an input of the same car: one that holds the height of its point in place of the input that moves
that point most. So rows over travels are rows over inputs. A pose is the one that is reached from the
drawing; where the travel turns back there is none beyond.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pointcoord import Motion, Scene, designs_of, simulate
from pointcoord.effects.registry import EFFECTS
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.mechanism.file import MECHANISMS, read_tables
from pointcoord.numerics.infinitesimal import slope_of
from pointcoord.numerics.rounding import EPS
from pointcoord.poses import PoseSolver
from pointcoord.scene.scene_file import MechanismPart
from pointcoord.simulation import scene_mechanism
from pointcoord.sweeping.hardpoint_slopes import ByHardpoints, moves_of, slopes_of_motion, slopes_of_poses
from validate.measured.mapping import Measured, Series
from validate.measured.meanings import CONTACT, PLACES, TIME, TRAVEL
from validate.tables.errors import FileError

Array = NDArray[np.float64]
Bools = NDArray[np.bool_]
Numbers = dict[str, dict[str, Array]]

# How far an input goes to either side of the drawing at most: an angle, and a length in parts of the car's
# size. No suspension goes farther, and a slip in one row must not cost a search.
WIDEST = {"rad": 1.2, "mm": 0.5}
LITTLE = 1e-3  # part of that by which an input is moved to see what it moves


@dataclass(frozen=True)
class Found:
    """Our numbers at the rows of a file.

    Attributes:
        numbers, bounds: by quantity and name, (N, 3) or (N,); NaN where there is no pose.
        reached: at which rows there is a pose, (N,).
        reasons: by row, why there is none.
        inputs: at each row, (N,); over time that.
    """

    numbers: Numbers
    bounds: Numbers
    reached: Bools
    reasons: Mapping[int, str]
    inputs: Mapping[str, Array]


@dataclass(frozen=True)
class Driven:
    """The car of a scene, driven by what the rows of a file are taken by.

    Attributes:
        scene: it asks for all points and for the effects that the file's columns need.
        own: where it is driven by a travel, the same by the scene's own inputs, by which its drawing closes.
        columns: the input of each independent column; time itself over time.
        held: inputs that the map holds, or the scene at another value than drawn.
        notes: inputs that the file does not give, in words.
    """

    scene: Scene
    columns: tuple[str, ...]
    own: Scene | None = None
    held: Mapping[str, float] = field(default_factory=dict)
    notes: tuple[str, ...] = ()

    @classmethod
    def of(cls, scene: Scene, measured: Measured) -> Driven:
        """A scene by what a file gives and holds, and by the drawing for the rest.

        Raises:
            FileError: a travel without what it needs, or of which no input can be solved for.
            PointcoordError: the hardpoints make no mechanism, or a travel's drawing cannot be closed.
        """
        scene = _asked(scene, measured)
        columns = tuple(s.meaning.drives for s in measured.independent)
        if columns == (TIME,):
            return cls(scene, columns)
        given = (*columns, *measured.held)
        travels = [name for name in given if name.startswith(f"{TRAVEL}.")]
        if len(travels) > 1:
            problem = f"{' and '.join(travels)} are travels of the same rows"
            raise FileError(measured.source, "", problem, "one travel, given or held")
        driven = _driven_by(scene, travels[0], given, measured) if travels else scene
        car = cls(driven, columns, scene if travels else None, measured.held)
        held, notes, topology = dict(measured.held), list[str](), driven.mechanism.topology
        for name in topology.required_inputs:
            if name in given:
                continue
            law, how = driven.functions[name].series(driven.instants, 0)[:, 0], "as drawn, "
            value, by = car.drawn[name], ""
            if (law == law[0]).all() and law[0] != value:
                held[name] = value = float(law[0])
                how, by = "at ", "the scene does, and "
            unit = topology.input_units[name]
            notes.append(f"{name} is held {how}{value:.6g} {unit}: {by}the file does not give it")
        return replace(car, held=held, notes=tuple(notes))

    @property
    def over_time(self) -> bool:
        """Whether rows are instants of the scene's own motion."""
        return self.columns == (TIME,)

    def redrawn(self, offsets: Mapping[str, float]) -> Driven:
        """The same of a car with hardpoints moved.

        Args:
            offsets: of coordinates, mm.
        Raises:
            SceneError: the hardpoints make no mechanism.
        """
        scene = designs_of(self.scene, offsets=offsets).design(0)
        own = None if self.own is None else designs_of(self.own, offsets=offsets).design(0)
        return replace(self, scene=scene, own=own)

    @cached_property
    def solver(self) -> PoseSolver:
        """Of the car's poses."""
        return PoseSolver(self.scene, scene_mechanism(self.scene))

    @cached_property
    def closing(self) -> PoseSolver:
        """The same by the scene's own inputs."""
        return self.solver if self.own is None else PoseSolver(self.own, scene_mechanism(self.own))

    @property
    def travel(self) -> str:
        """The input that is a travel; empty if none is."""
        given = () if self.own is None else (*self.columns, *self.held)
        return next((name for name in given if name.startswith(f"{TRAVEL}.")), "")

    @cached_property
    def drawn(self) -> Mapping[str, float]:
        """The inputs of the closed drawing, which all others have, and from which a travel counts."""
        found = {name: float(value) + 0.0 for name, value in self.solver.mechanism.drawn_inputs.items()}
        if self.travel:
            found[self.travel] = float(self._risen(self.closing.mechanism, self.closing.closed.y))
        return found

    def _risen(self, mechanism: Mechanism, y: Array) -> Array:
        """How much higher the point of a travel is in a pose, (..., size), than drawn, (...), mm."""
        # As an input it counts from the drawing as it stands, which need not close.
        part, point = self.scene.mechanism, self.travel.partition(".")[2]
        there = {name: place * mechanism.unit[..., None] for name, place in mechanism.places(y).items()}
        return _height(part, point, there) - _height(part, point, mechanism.drawn_places)

    def level(self, name: str) -> float:
        """From where an input's column counts: a travel from the closed drawing."""
        return self.drawn[name] if name == self.travel else 0.0

    def inputs(self, values: Sequence[Array]) -> tuple[dict[str, Array], dict[int, str]]:
        """Every input at values of the columns of inputs, each (N,), and why a row has none."""
        count, given = len(values[0]), {**self.held, **dict(zip(self.columns, values, strict=True))}
        found = {name: np.full(count, value) for name, value in self.drawn.items()}
        found |= {name: np.full(count, value) + self.level(name) for name, value in given.items()}
        reasons: dict[int, str] = {}
        for name, (low, high) in self.sensible.items():
            value = found[name]
            inside = (value >= low) & (value <= high)
            told = f"is out of reach, {low:.6g} to {high:.6g} being looked at"
            reasons |= {int(i): f"{name} = {value[i]:.10g} {told}" for i in np.flatnonzero(~inside)}
            found[name] = np.where(inside, value, self.drawn[name])
        return found, reasons

    @cached_property
    def sensible(self) -> dict[str, tuple[float, float]]:
        """Between which values inputs have a meaning and are no slip."""
        mechanism, found = self.solver.mechanism, {}
        for drive in mechanism.topology.drives:
            name, wide = drive.input, _widest(mechanism, drive.input)
            beyond = drive.extremes(mechanism.drawing)
            ends = [float(np.ravel(drive.input_value(end, mechanism.drawing))[0]) for end in beyond]
            low, high = sorted(ends) if np.isfinite(ends).all() else (-np.inf, np.inf)
            found[name] = max(low, self.drawn[name] - wide), min(high, self.drawn[name] + wide)
        return found

    # Our numbers.

    @cached_property
    def motion(self) -> Motion:
        """The scene's own."""
        return simulate(self.scene)

    def at(self, values: Sequence[Array], tolerance: float | None = None, bounded: bool = True) -> Found:
        """Our numbers at values of the independent columns, each (N,).

        Args:
            tolerance: of poses, mm; the scene's own unless given.
            bounded: whether each number is to have its bound.
        """
        if self.over_time:
            return self._over_time(values[0], bounded)
        return self.solved(*self.inputs(values), tolerance, bounded)

    def _over_time(self, times: Array, bounded: bool) -> Found:
        start, stop = self.scene.time.start, self.scene.time.stop
        reached: Bools = (times >= start) & (times <= stop)
        told = f"is outside the scene's time, {start:.10g} to {stop:.10g} s"
        reasons = {int(i): f"t = {times[i]:.10g} s {told}" for i in np.flatnonzero(~reached)}
        found = Found({}, {}, reached, reasons, {TIME: times})
        if not reached.any():
            return found
        # Samples want their instants in order and once each.
        instants, rows = np.unique(times[reached], return_inverse=True)
        samples = self.motion.at(instants)
        proven = self.motion.proof_of(samples, rates=True).proven if bounded else {}
        bounds = spread({q: proven[q] for q in samples.numbers if q in proven}, reached, rows)
        return replace(found, numbers=spread(samples.numbers, reached, rows), bounds=bounds)

    def solved(
        self,
        inputs: Mapping[str, Array],
        reasons: Mapping[int, str],
        tolerance: float | None = None,
        bounded: bool = False,
    ) -> Found:
        """The same at inputs, pose by pose; where there is a reason there is no pose."""
        poses = self.solver.solve(inputs, tolerance)
        failed = {row: f"is out of reach: {error}" for row, error in poses.failures.items()}
        reached = poses.solved
        reached[[*reasons]] = False
        computed = {quantity: channel for quantity, channel in poses.numbers.items() if channel.computed}
        found = Found(spread(computed, reached, reached), {}, reached, {**failed, **reasons}, inputs)
        if not (bounded and reached.any()):
            return found
        off = np.maximum(poses.bound, poses.carried_bound)
        return replace(found, bounds=self.within(found, np.where(reached, off, 0.0)))

    def slopes(self, found: Found, coordinates: Sequence[str]) -> Numbers:
        """What our numbers change by with drawn coordinates, (coordinates, N, 3) or (coordinates, N), per mm.

        An input that the file gives is the same in every design, but a travel counts from the design's own
        drawing; one that nothing gives or holds is as drawn. NaN where there is no pose.

        Raises:
            AssemblyError: as `slopes_of_poses`.
        """
        rows, scene = found.reached, self.scene
        inputs = {name: value[rows] for name, value in found.inputs.items()}
        if self.over_time:
            slopes = slopes_of_motion(scene, self.motion.solved, inputs[TIME], coordinates)
        else:
            given = (*self.columns, *self.held)
            drawn = [name for name in self.drawn if name not in given]
            slopes = slopes_of_poses(self.solver, inputs, coordinates, drawn, self._levels(coordinates))
        # Where each row is among those that have a pose.
        at = np.maximum(np.cumsum(rows) - 1, 0)
        return {
            quantity: {
                name: np.where(rows if array.ndim == 2 else rows[:, None], array[:, at], np.nan)
                for name, array in part.items()
            }
            for quantity, part in slopes.numbers.items()
        }

    def _levels(self, coordinates: Sequence[str]) -> dict[str, Array]:
        """What a travel's level changes by with drawn coordinates, (coordinates,), mm per mm."""
        if not self.travel:
            return {}
        by_hardpoints = ByHardpoints(self.closing.readout, moves_of(self.closing.scene, coordinates))
        closed = by_hardpoints.at(self.closing.closed.y[None], by_hardpoints.drawn_inputs, {})
        return {self.travel: slope_of(self._risen(by_hardpoints.moved, closed.states[0]))[:, 0]}

    def within(self, found: Found, off: Array) -> Numbers:
        """How far numbers may be off whose points are off by so much, (N,), mm.

        NaN where that may be another pose.
        """
        # Their packages are an extra.
        from validate.formulations.input_rates import laws_of
        from validate.formulations.stated_accuracy import accuracy_at

        rows, scene = found.reached, self.scene
        places = {name: place[rows] for name, place in found.numbers[PLACES].items()}
        inputs = {name: value[rows] for name, value in found.inputs.items()}
        if self.over_time:
            laws = laws_of(scene, inputs[TIME])
        else:
            scene = row_by_row(scene, inputs)
            still = np.zeros((int(rows.sum()), 2))
            laws = {name: np.column_stack([value, still]) for name, value in inputs.items()}
        stated = accuracy_at(scene, off[rows], places, laws)
        blind = np.zeros(len(rows), dtype=bool)
        blind[rows] = False if stated.blind is None else stated.blind
        bounds = spread(stated.claims, rows)
        for claim in (claim for part in bounds.values() for claim in part.values()):
            claim[blind] = np.nan
        return bounds


def row_by_row(scene: Scene, inputs: Mapping[str, Array]) -> Scene:
    """A scene that is at inputs, each (N,), one row after the other, a second apart."""
    content = scene.model_dump(exclude_none=True, exclude={"points"})
    content["inputs"] = {name: _from_row_to_row(values) for name, values in inputs.items()}
    count = len(next(iter(inputs.values())))
    content["time"] = {"start": 0.0, "stop": count - 1.0, "samples": count}
    return Scene.from_mapping(content, scene.title or "scene")


def _from_row_to_row(values: Array) -> dict[str, Any]:
    """A law that has these values at whole seconds; a straight one, which is solved soonest, if it may be."""
    times, first = np.arange(float(len(values))), float(values[0])
    step = float(values[-1] - values[0]) / max(len(values) - 1, 1)
    if np.abs(values - (first + step * times)).max() <= 4.0 * EPS * np.abs(values).max():
        return {"polynomial": [first, step]} if step else {"constant": first}
    return {"table": {"times": times.tolist(), "values": values.tolist()}}


def at_either_end(
    values: Sequence[Array], offs: Sequence[Array]
) -> Iterator[tuple[int, tuple[list[Array], list[Array]]]]:
    """By the place of each column that is rounded: all values, with its own at either end of the rounding."""
    for i, off in enumerate(offs):
        if off.any():
            below, above = ([*values[:i], values[i] + side * off, *values[i + 1 :]] for side in (-1.0, 1.0))
            yield i, (below, above)


def ours_of(series: Series, numbers: Mapping[str, Mapping[str, Array]]) -> Array | None:
    """What of our numbers, of their bounds or slopes, belongs to a column, (..., N); None if not known."""
    value, axis = numbers.get(series.meaning.quantity, {}).get(series.meaning.name), series.meaning.axis
    return value if value is None or axis is None else value[..., axis]


def spread(numbers: Mapping[str, Mapping[str, Any]], reached: Bools, rows: Any = slice(None)) -> Numbers:
    """Numbers of some rows put where they belong, NaN elsewhere."""
    found: Numbers = {}
    for quantity, part in numbers.items():
        found[quantity] = {}
        for name, array in part.items():
            some = np.asarray(array)[rows]
            found[quantity][name] = np.full((len(reached), *some.shape[1:]), np.nan)
            found[quantity][name][reached] = some
    return found


def _widest(mechanism: Mechanism, name: str) -> float:
    """How far an input goes to either side at most, rad or mm."""
    unit = mechanism.topology.input_units[name]
    return WIDEST[unit] * (float(mechanism.unit) if unit == "mm" else 1.0)


def _driven_by(scene: Scene, travel: str, given: Sequence[str], measured: Measured) -> Scene:
    """A scene that drives a travel in place of the input that moves it most."""
    part, point = scene.mechanism, travel.partition(".")[2]
    topology, radius = part.topology, part.wheel_radius
    table: dict[str, Any] = {"height": point}
    if point == CONTACT:
        if not topology.wheel_axis:
            problem = f"{travel} needs the role wheel_axis, which {topology.name!r} does not have"
            allowed = f"{TRAVEL}.POINT, or wheel_axis under [roles] of the mechanism"
            raise FileError(measured.source, "", problem, allowed)
        table = {"contact": list(topology.wheel_axis)}
        radius = measured.rolling_radius if measured.rolling_radius > 0.0 else radius
        if radius is None:
            problem = f"{travel} needs the wheel's rolling radius"
            raise FileError(measured.source, "", problem, "rolling_radius = MM in a map, above 0")
    rising = topology.wheel_centre if point == CONTACT else point
    solved = _strongest(scene, rising, [name for name in topology.required_inputs if name not in given])
    if not solved:
        problem = f"{travel} is to be reached by an input, and all are given"
        raise FileError(measured.source, "", problem, "a travel, or the inputs")
    content = scene.model_dump(exclude_none=True)
    own = content["mechanism"]
    if "type" in own:
        own |= read_tables(MECHANISMS / f"{own.pop('type')}.toml")
    own["inputs"] = own.get("inputs", {}) | {travel: table}
    if radius is not None:
        own["wheel_radius"] = radius
    content["inputs"] = {n: law for n, law in content["inputs"].items() if n != solved}
    content["inputs"][travel] = {"constant": 0.0}
    return Scene.from_mapping(content, scene.title or "scene")


def _height(part: MechanismPart, point: str, places: Mapping[str, Array]) -> Array:
    """How high a point is, or the contact: the lowest point of a thin disc about the wheel's centre, mm."""
    up = np.array(part.up)
    if point != CONTACT:
        return np.asarray(places[point] @ up)
    inner, outer = part.topology.wheel_axis
    spin = places[outer] - places[inner]
    square, lean = np.sum(spin**2, axis=-1), spin @ up
    radius = part.wheel_radius or 0.0
    return np.asarray(places[part.topology.wheel_centre] @ up - radius * np.sqrt(1.0 - lean**2 / square))


def _strongest(scene: Scene, point: str, inputs: Sequence[str]) -> str:
    """The input by which a point rises most, each moved by the same part of its widest range."""
    mechanism, up, found = scene_mechanism(scene), np.array(scene.mechanism.up), {}
    solver, drawn = PoseSolver(scene, mechanism), mechanism.drawn_inputs
    for name in inputs:
        step = LITTLE * _widest(mechanism, name)
        place = solver.solve(drawn | {name: drawn[name] + np.array([-step, step])}).position[point]
        found[name] = float(np.abs(np.nan_to_num(np.diff(place @ up)))[0])
    return max(found, key=lambda name: found[name], default="")


def _asked(scene: Scene, measured: Measured) -> Scene:
    """The scene with the effects that a file's columns need, and with all points."""
    gives = {name: effect.gives_numbers(scene.mechanism.topology) for name, effect in EFFECTS.items()}
    effects = dict.fromkeys(scene.effects)
    for quantity, name in dict.fromkeys(s.meaning.row for s in measured.numbers):
        names = {effect: numbers.get(quantity, ()) for effect, numbers in gives.items()}
        giving = [effect for effect, some in names.items() if some is None or name in some]
        # Where the car has none of them, one says what is missing.
        effects |= dict.fromkeys([effect for effect in giving if effect in scene.mechanism.effects] or giving)
    return scene.model_copy(update={"points": None, "effects": tuple(effects)})
