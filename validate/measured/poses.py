r"""Our own numbers at the rows of a file: over time from the motion, over inputs and travels pose by pose.

A travel is treated as an input of the same car: the height of its point is driven, instead of the input that
moves the wheel up and down. So rows over travels are rows over inputs. The pose of a row is the one that is
reached from the drawing; beyond an extreme of the travel there is no pose.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from pointcoord import Motion, Scene, designs_of, simulate
from pointcoord.effects.car_number import BY_TRAVEL
from pointcoord.effects.registry import EFFECTS
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.mechanism.file import MECHANISMS, read_tables
from pointcoord.numerics.infinitesimal import slope_of
from pointcoord.poses import PoseSolver
from pointcoord.scene.mechanism_part import MechanismPart
from pointcoord.simulation import scene_mechanism
from pointcoord.sweeping.hardpoint_slopes import ByHardpoints, moves_of, slopes_of_motion, slopes_of_poses
from validate.arrays import Array, Flags
from validate.measured.mapping import Measured, Series
from validate.measured.meanings import CONTACT, PLACES, TIME, TRAVEL
from validate.tables.errors import FileError

Numbers = dict[str, dict[str, Array]]

# Largest range of an input to either side of the drawing: an angle, and a length relative to the car's size.
# No suspension moves farther, and a mistyped row must not cause a long search.
FARTHEST = {"rad": 1.2, "mm": 0.5}


@dataclass(frozen=True)
class Found:
    """A car at the rows of a file.

    Attributes:
        driven: the car.
        numbers, bounds: numbers and their error bounds, by quantity and name, (N, 3) or (N,); NaN at rows
            without a pose.
        reached: which rows have a pose, (N,).
        reasons: why a row has no pose, by row.
        inputs: values of the inputs at each row, (N,); over time, only the time.
    """

    driven: Driven
    numbers: Numbers
    bounds: Numbers
    reached: Flags
    reasons: Mapping[int, str]
    inputs: Mapping[str, Array]


@dataclass(frozen=True)
class Driven:
    """The car of a scene, driven by the independent columns of a file.

    Attributes:
        scene: the scene, asked for all points and for the effects that the file's columns need.
        columns: the input of each independent column, or the time.
        travel: the input that is a travel; empty if there is none.
        own: if a travel drives the car: the same scene with its own inputs, with which its drawing closes.
        held: inputs that are fixed by the map, or by the scene at another value than drawn.
        notes: the inputs that the file does not give, in words.
    """

    scene: Scene
    columns: tuple[str, ...]
    travel: str = ""
    own: Scene | None = None
    held: Mapping[str, float] = field(default_factory=dict)
    notes: tuple[str, ...] = ()

    @classmethod
    def of(cls, scene: Scene, measured: Measured) -> Driven:
        """The car, with inputs from the file and its map, and the drawing for all others.

        Raises:
            FileError: data for a travel are missing, or no input is left to reach it.
            PointcoordError: the hardpoints do not form a mechanism, or the drawing cannot be closed.
        """
        scene = _asked(scene, measured)
        columns = tuple(s.meaning.drives for s in measured.independent)
        if columns == (TIME,):
            return cls(scene, columns)
        given = (*columns, *measured.held)
        travels = [name for name in given if name.startswith(f"{TRAVEL}.")]
        if len(travels) > 1:
            problem = f"{' and '.join(travels)} are several travels in the same rows"
            raise FileError(measured.source, "", problem, "one travel, given or held")
        car = cls(scene, columns, held=measured.held)
        for travel in travels:
            car = replace(car, scene=_driven_by(scene, travel, given, measured), travel=travel, own=scene)
        held, notes, topology = dict(measured.held), list[str](), car.scene.mechanism.topology
        for name in topology.required_inputs:
            if name in given:
                continue
            unit = topology.input_units[name]
            law = car.scene.functions[name].series(car.scene.instants, 0)[:, 0]
            if (law == law[0]).all() and law[0] != car.drawn[name]:
                held[name] = float(law[0])
                how = f"at {law[0]:.6g} {unit}: as in the scene, because"
            else:
                how = f"as drawn, {car.drawn[name]:.6g} {unit}:"
            notes.append(f"{name} is held {how} the file does not give it")
        return replace(car, held=held, notes=tuple(notes))

    @property
    def over_time(self) -> bool:
        """Whether the rows are instants of the scene's own motion."""
        return self.columns == (TIME,)

    def redrawn(self, offsets: Mapping[str, float]) -> Driven:
        """The car with hardpoints moved.

        Args:
            offsets: offset of each moved coordinate, mm.
        Raises:
            SceneError: the hardpoints do not form a mechanism.
        """
        scene = designs_of(self.scene, offsets=offsets).design(0)
        own = None if self.own is None else designs_of(self.own, offsets=offsets).design(0)
        return replace(self, scene=scene, own=own)

    @cached_property
    def solver(self) -> PoseSolver:
        """The solver of the car's poses."""
        return PoseSolver(self.scene, scene_mechanism(self.scene))

    @cached_property
    def closing(self) -> PoseSolver:
        """The solver of the poses with the scene's own inputs."""
        return self.solver if self.own is None else PoseSolver(self.own, scene_mechanism(self.own))

    @cached_property
    def drawn(self) -> Mapping[str, float]:
        """The inputs of the closed drawing: used for inputs that are not given; travels count from here."""
        found = {name: float(value) + 0.0 for name, value in self.solver.mechanism.drawn_inputs.items()}
        if self.travel:
            found[self.travel] = float(self._risen(self.closing.mechanism, self.closing.closed.y))
        return found

    def _risen(self, mechanism: Mechanism, y: Array) -> Array:
        """Height of the point of a travel in a pose, y (..., size), above its drawn height, (...), mm."""
        # As an input a travel counts from the drawing before it is closed.
        part, point = self.scene.mechanism, self.travel.partition(".")[2]
        there = {name: place * mechanism.unit[..., None] for name, place in mechanism.places(y).items()}
        return _height(part, point, there) - _height(part, point, mechanism.drawn_places)

    def level(self, name: str) -> float:
        """The input at the zero of its column: for a travel that of the closed drawing, otherwise 0."""
        return self.drawn[name] if name == self.travel else 0.0

    def inputs(self, values: Sequence[Array]) -> tuple[dict[str, Array], dict[int, str]]:
        """Every input at values of the independent columns, each (N,), and why a row is refused.

        A row is refused, and has the drawn value, where an input is farther from the drawing than FARTHEST,
        or outside the values that it can have at all.
        """
        given = {**self.held, **dict(zip(self.columns, values, strict=True))}
        found = {name: np.full(len(values[0]), value) for name, value in self.drawn.items()}
        found |= {name: np.full(len(values[0]), value) + self.level(name) for name, value in given.items()}
        mechanism, reasons = self.solver.mechanism, dict[int, str]()
        for name, drive in {drive.input: drive for drive in mechanism.topology.drives}.items():
            drawn = self.drawn[name]
            wide = FARTHEST[drive.unit] * (float(mechanism.unit) if drive.unit == "mm" else 1.0)
            beyond = drive.extremes(mechanism.drawing)
            ends = sorted(float(np.ravel(drive.input_value(end, mechanism.drawing))[0]) for end in beyond)
            low, high = ends if np.isfinite(ends).all() else (-np.inf, np.inf)
            low, high = max(low, drawn - wide), min(high, drawn + wide)
            inside = (found[name] >= low) & (found[name] <= high)
            why = f"is out of reach; searched from {low:.6g} to {high:.6g}"
            reasons |= {i: f"{name} = {found[name][i]:.10g} {why}" for i in np.flatnonzero(~inside).tolist()}
            found[name] = np.where(inside, found[name], drawn)
        return found, reasons

    # Our numbers.

    @cached_property
    def motion(self) -> Motion:
        """The motion of the scene."""
        return simulate(self.scene)

    def at(self, values: Sequence[Array], tolerance: float | None = None, bounded: bool = True) -> Found:
        """Our numbers at values of the independent columns, each (N,).

        Args:
            tolerance: tolerance of poses, mm; the scene's own if not given.
            bounded: whether to compute the error bounds of the numbers.
        """
        if self.over_time:
            return self._over_time(values[0], bounded)
        inputs, refused = self.inputs(values)
        poses = self.solver.solve(inputs, tolerance)
        failed = {row: f"is out of reach: {error}" for row, error in poses.failures.items()}
        reached = poses.solved
        reached[[*refused]] = False
        computed = {quantity: channel for quantity, channel in poses.numbers.items() if channel.computed}
        numbers = spread(computed, reached, reached)
        found = Found(self, numbers, {}, reached, {**failed, **refused}, inputs)
        if not (bounded and reached.any()):
            return found
        off = np.maximum(poses.bound, poses.carried_bound)
        return replace(found, bounds=self.within(found, np.where(reached, off, 0.0)))

    def _over_time(self, times: Array, bounded: bool) -> Found:
        start, stop = self.scene.time.start, self.scene.time.stop
        reached: Flags = (times >= start) & (times <= stop)
        why = f"is outside the scene's time, {start:.10g} to {stop:.10g} s"
        reasons = {int(i): f"t = {times[i]:.10g} s {why}" for i in np.flatnonzero(~reached)}
        found = Found(self, {}, {}, reached, reasons, {TIME: times})
        if not reached.any():
            return found
        # Samples need instants in ascending order, each once.
        instants, rows = np.unique(times[reached], return_inverse=True)
        samples = self.motion.at(instants)
        proven = self.motion.proof_of(samples, rates=True).proven if bounded else {}
        bounds = spread({q: proven[q] for q in samples.numbers if q in proven}, reached, rows)
        return replace(found, numbers=spread(samples.numbers, reached, rows), bounds=bounds)

    def slopes(self, found: Found, coordinates: Sequence[str]) -> Numbers:
        """Derivatives of our numbers by drawn coordinates, (coordinates, N, 3) or (coordinates, N), per mm.

        An input that the file gives has the same value in every design, but a travel counts from the drawing
        of the design. An input that is neither given nor held is as drawn. NaN at rows without a pose.

        Raises:
            AssemblyError: see `slopes_of_poses`.
        """
        inputs = {name: value[found.reached] for name, value in found.inputs.items()}
        if self.over_time:
            slopes = slopes_of_motion(self.scene, self.motion.solved, inputs[TIME], coordinates)
            return spread(slopes.numbers, found.reached, axis=1)
        levels = {}
        if self.travel:
            # The level of a travel changes with the drawing, mm per mm.
            moved = ByHardpoints(self.closing.readout, moves_of(self.closing.scene, coordinates))
            closed = moved.at(self.closing.closed.y[None], moved.drawn_inputs, {})
            levels[self.travel] = slope_of(self._risen(moved.moved, closed.states[0]))[:, 0]
        drawn = [name for name in self.drawn if name not in (*self.columns, *self.held)]
        slopes = slopes_of_poses(self.solver, inputs, coordinates, drawn, levels)
        return spread(slopes.numbers, found.reached, axis=1)

    def within(self, found: Found, off: Array) -> Numbers:
        """Error bounds of numbers whose points are off by up to `off`, (N,), mm.

        NaN where points this far off may belong to another pose.
        """
        # Imported here: these modules need an optional package.
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
        bounded = np.ones(int(rows.sum()), dtype=bool) if stated.blind is None else ~stated.blind
        seen = rows.copy()
        seen[rows] = bounded
        return spread(stated.claims, seen, bounded)


def row_by_row(scene: Scene, inputs: Mapping[str, Array]) -> Scene:
    """A scene that passes through values of inputs, each (N,), one row per second."""
    content = scene.model_dump(exclude_none=True, exclude={"points"})
    count = len(next(iter(inputs.values())))
    times, laws = np.arange(float(count)), dict[str, Any]()
    for name, values in inputs.items():
        # A table needs four values.
        if count < 4:
            laws[name] = {"polynomial": np.polynomial.polynomial.polyfit(times, values, count - 1).tolist()}
        else:
            laws[name] = {"table": {"times": times.tolist(), "values": values.tolist()}}
    content["inputs"] = laws
    content["time"] = {"start": 0.0, "stop": count - 1.0, "samples": count}
    return Scene.from_mapping(content, scene.title or "scene")


def columns_of(
    series: Sequence[Series], numbers: Mapping[str, Mapping[str, Array]], *shape: int, absent: float = np.nan
) -> Array:
    """Our numbers, bounds or slopes for columns of a file, (columns, *shape); `absent` if not computed."""
    found = np.full((len(series), *shape), absent)
    for i, meaning in enumerate(s.meaning for s in series):
        value = numbers.get(meaning.quantity, {}).get(meaning.name)
        if value is not None:
            found[i] = value if meaning.axis is None else value[..., meaning.axis]
    return found


def swings(
    driven: Driven, measured: Measured, offs: Sequence[Array], ours: Array, tolerance: float | None = None
) -> Array:
    """Largest change of our numbers at either end of the rounding of each independent column.

    Args:
        offs: rounding error of each independent column, (N,).
        ours: our numbers, (columns, N).
    Returns:
        Changes, (independent columns, columns, N).
    """
    values, changes = [s.values for s in measured.independent], np.zeros((len(offs), *ours.shape))
    for i, off in enumerate(offs):
        for end in (-off, off) if off.any() else ():
            there = driven.at([*values[:i], values[i] + end, *values[i + 1 :]], tolerance, bounded=False)
            moved = columns_of(measured.numbers, there.numbers, len(off))
            gaps = [s.apart(*pair) for s, *pair in zip(measured.numbers, moved, ours, strict=True)]
            changes[i] = np.fmax(changes[i], np.abs(gaps))
    return changes


def spread(
    numbers: Mapping[str, Mapping[str, Any]], reached: Flags, rows: Any = slice(None), axis: int = 0
) -> Numbers:
    """Numbers of some rows as arrays of all rows, NaN elsewhere.

    Args:
        reached: the rows that have numbers, (N,).
        rows: which number each of them has; in order if not given.
        axis: the axis of the rows.
    """

    def all_rows(array: Any) -> Array:
        some = np.moveaxis(np.asarray(array), axis, 0)[rows]
        found = np.full((len(reached), *some.shape[1:]), np.nan)
        found[reached] = some
        return np.moveaxis(found, 0, axis)

    return {quantity: {name: all_rows(one) for name, one in of.items()} for quantity, of in numbers.items()}


def _driven_by(scene: Scene, travel: str, given: Sequence[str], measured: Measured) -> Scene:
    """A scene that drives a travel instead of the input that moves its wheel up and down."""
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
    corner = (topology.wheel_centre if point == CONTACT else point).rpartition(".")[0]
    moving = (*topology.driven_along(BY_TRAVEL, corner), *topology.required_inputs)
    solved = next((name for name in moving if name not in given), "")
    if not solved:
        problem = f"{travel} needs an input that is not given, and all inputs are given"
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
    """Height of a point, mm, or of the contact: the lowest point of a thin disc about the wheel's centre."""
    up = np.array(part.up)
    if point != CONTACT:
        return np.asarray(places[point] @ up)
    inner, outer = part.topology.wheel_axis
    spin = places[outer] - places[inner]
    square, lean = np.sum(spin**2, axis=-1), spin @ up
    radius = part.wheel_radius or 0.0
    return np.asarray(places[part.topology.wheel_centre] @ up - radius * np.sqrt(1.0 - lean**2 / square))


def _asked(scene: Scene, measured: Measured) -> Scene:
    """The scene with the effects that a file's columns need, and with all points."""
    gives = {name: effect.gives_numbers(scene.mechanism.topology) for name, effect in EFFECTS.items()}
    effects, had = dict.fromkeys(scene.effects), scene.mechanism.effects
    for quantity, name in dict.fromkeys(s.meaning.row for s in measured.numbers):
        names = {effect: numbers.get(quantity, ()) for effect, numbers in gives.items()}
        giving = [effect for effect, some in names.items() if some is None or name in some]
        # If the car has no such effect, asking for one reports what the car lacks.
        effects |= dict.fromkeys([effect for effect in giving if effect in had] or giving)
    return scene.model_copy(update={"points": None, "effects": tuple(effects)})
