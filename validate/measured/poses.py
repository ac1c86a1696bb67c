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
from pointcoord.simulation import scene_mechanism
from pointcoord.sweeping.hardpoint_slopes import ByHardpoints, moves_of, slopes_of_motion, slopes_of_poses
from validate.arrays import Array, Indices
from validate.formulations.protocol import Numbers, numbers_at
from validate.measured.mapping import Measured
from validate.measured.meanings import CONTACT, PLACES, TIME, TRAVEL
from validate.plain_text import some_of
from validate.tables.errors import FileError

# Largest range of an input to either side of the drawing: an angle, and a length relative to the car's size.
# No suspension moves farther, and a mistyped row must not cause a long search.
FARTHEST = {"rad": 1.2, "mm": 0.5}
NAMED = 3  # largest number of rows or columns named in a note


@dataclass(frozen=True)
class Found:
    """A car at the rows of a file; of N rows R have a pose, and only these have numbers here.

    Attributes:
        driven: the car.
        rows: the rows that have a pose, (R,).
        reasons: why a row has no pose, by row.
        inputs: values of the inputs, (R,); over time, only the time.
        numbers: by quantity and name, (R, 3) or (R,).
        off: error bound of the poses that are solved one by one, (R,), mm.
    """

    driven: Driven
    rows: Indices
    reasons: Mapping[int, str]
    inputs: Mapping[str, Array]
    numbers: Numbers
    off: Array

    def columns(self, numbers: Numbers, *shape: int) -> Array:
        """Numbers, bounds or slopes, (*shape, R, ...), by the columns of the file, (columns, *shape, N).

        NaN where there are none.
        """
        measured = self.driven.measured
        found = np.full((len(measured.numbers), *shape, len(measured.rows)), np.nan)
        for column, meaning in zip(found, (s.meaning for s in measured.numbers), strict=True):
            if (value := numbers.get(meaning.quantity, {}).get(meaning.name)) is not None:
                column[..., self.rows] = value if meaning.axis is None else value[..., meaning.axis]
        return found

    @property
    def left_out(self) -> list[str]:
        """A note on the rows without a pose, with the reasons of the first few; empty if there are none."""
        rows = self.driven.measured.rows
        lost = [f"{rows[i]} ({why})" for i, why in sorted(self.reasons.items())]
        return [f"rows without a pose are left out: {some_of(lost, NAMED)}"] if lost else []


@dataclass(frozen=True)
class Driven:
    """The car of a scene, driven by the independent columns of a file.

    Attributes:
        measured: the file.
        scene: the scene, asked for all points and for the effects that the file's columns need.
        columns: the input of each independent column, or the time.
        travel: the input that is a travel; empty if there is none.
        own: the same scene with its own inputs, with which its drawing closes.
        held: inputs that are fixed by the map, or by the scene at another value than drawn.
        notes: the inputs that the file does not give, in words.
    """

    measured: Measured
    scene: Scene
    columns: tuple[str, ...]
    travel: str
    own: Scene
    held: Mapping[str, float] = field(default_factory=dict)
    notes: tuple[str, ...] = ()

    @classmethod
    def of(cls, scene: Scene, measured: Measured) -> Driven:
        """The car, with inputs from the file and its map, and the drawing for all others.

        Raises:
            FileError: data for a travel are missing, or no input is left to reach it.
            PointcoordError: the hardpoints do not form a mechanism, or the drawing cannot be closed.
        """
        own = _asked(scene, measured)
        columns = tuple(s.meaning.drives for s in measured.independent)
        if columns == (TIME,):
            return cls(measured, own, columns, "", own)
        given = (*columns, *measured.said.held)
        travel = next((name for name in given if name.startswith(f"{TRAVEL}.")), "")
        scene = _driven_by(own, travel, given, measured) if travel else own
        car = cls(measured, scene, columns, travel, own)
        held, notes, topology = dict(measured.said.held), list[str](), car.scene.mechanism.topology
        for name in topology.required_inputs:
            if name in given:
                continue
            value, how, law = car.drawn[name], "as drawn", car.scene.functions[name]
            constant = float(law.series(car.scene.instants[:1], 0)[0, 0])
            if law.still and constant != value:
                held[name] = value = constant
                how = "as in the scene"
            unit = topology.input_units[name]
            notes.append(f"{name} is held at {value:.6g} {unit}: {how}, because the file does not give it")
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
        scene, own = (designs_of(one, offsets=offsets).design(0) for one in (self.scene, self.own))
        return replace(self, scene=scene, own=own)

    @cached_property
    def solver(self) -> PoseSolver:
        """The solver of the car's poses."""
        return PoseSolver(self.scene, scene_mechanism(self.scene))

    @cached_property
    def closing(self) -> PoseSolver:
        """The solver of the poses with the scene's own inputs."""
        return PoseSolver(self.own, scene_mechanism(self.own))

    @cached_property
    def drawn(self) -> Mapping[str, float]:
        """The inputs of the closed drawing: used for inputs that are not given; travels count from here."""
        found = {name: float(value) + 0.0 for name, value in self.solver.mechanism.drawn_inputs.items()}
        if self.travel:
            found[self.travel] = float(self._risen(self.closing.mechanism, self.closing.closed.y))
        return found

    def level(self, name: str) -> float:
        """The input at the zero of its column: for a travel that of the closed drawing, otherwise 0."""
        return self.drawn[name] if name == self.travel else 0.0

    def _risen(self, mechanism: Mechanism, y: Array) -> Array:
        """Height of the point of the travel in a pose, y (..., size), above its drawn height, (...), mm."""
        # As an input a travel counts from the drawing before it is closed.
        there = {name: place * mechanism.unit[..., None] for name, place in mechanism.places(y).items()}
        return self._height(there) - self._height(mechanism.drawn_places)

    def _height(self, places: Mapping[str, Array]) -> Array:
        """Height of the travel's point, mm; of a contact: of the lowest point of a thin disc on the wheel."""
        part, point = self.scene.mechanism, self.travel.partition(".")[2]
        up = np.array(part.up)
        if point != CONTACT:
            return np.asarray(places[point] @ up)
        inner, outer = part.topology.wheel_axis
        spin = places[outer] - places[inner]
        square, lean = np.sum(spin**2, axis=-1), spin @ up
        radius = part.wheel_radius or 0.0
        return np.asarray(places[part.topology.wheel_centre] @ up - radius * np.sqrt(1.0 - lean**2 / square))

    def inputs(self, values: Sequence[Array]) -> tuple[dict[str, Array], dict[int, str]]:
        """Every input at values of the independent columns, each (N,), and why a row is refused.

        A row is refused where an input is farther from the drawing than FARTHEST, or outside the values that
        it can have at all.
        """
        rows, reasons = np.zeros(len(values[0])), dict[int, str]()
        given = {**self.held, **dict(zip(self.columns, values, strict=True))}
        found = {name: rows + value for name, value in self.drawn.items()}
        found |= {name: rows + np.asarray(value) + self.level(name) for name, value in given.items()}
        for drive in self.solver.mechanism.topology.drives:
            name, drawn = drive.input, self.drawn[drive.input]
            wide = FARTHEST[drive.unit] * (float(self.solver.mechanism.unit) if drive.unit == "mm" else 1.0)
            low, high = max(drive.limits[0], drawn - wide), min(drive.limits[1], drawn + wide)
            why = f"is out of reach; searched from {low:.6g} to {high:.6g}"
            for i in np.flatnonzero((found[name] < low) | (found[name] > high)).tolist():
                reasons[i] = f"{name} = {found[name][i]:.10g} {why}"
        return found, reasons

    @cached_property
    def motion(self) -> Motion:
        """The motion of the scene."""
        return simulate(self.scene)

    def at(self, values: Sequence[Array] = (), tolerance: float | None = None) -> Found:
        """Our numbers at the rows of the file.

        Args:
            values: values of the independent columns, each (N,); the file's if not given.
            tolerance: tolerance of poses, mm; the scene's own if not given.
        """
        values = values or [s.values for s in self.measured.independent]
        if self.over_time:
            return self._over_time(values[0])
        inputs, reasons = self.inputs(values)
        rows = np.setdiff1d(np.arange(len(values[0])), [*reasons])
        poses = self.solver.solve({name: value[rows] for name, value in inputs.items()}, tolerance)
        reasons |= {int(rows[i]): f"is out of reach: {error}" for i, error in poses.failures.items()}
        there = poses.solved
        rows, off = rows[there], np.maximum(poses.bound, poses.carried_bound)[there]
        inputs = {name: value[rows] for name, value in inputs.items()}
        return Found(self, rows, reasons, inputs, numbers_at(poses.numbers, there), off)

    def _over_time(self, times: Array) -> Found:
        start, stop = self.scene.time.start, self.scene.time.stop
        there = (times >= start) & (times <= stop)
        why = f"is outside the scene's time, {start:.10g} to {stop:.10g} s"
        reasons = {i: f"t = {times[i]:.10g} s {why}" for i in np.flatnonzero(~there).tolist()}
        rows, times = np.flatnonzero(there), times[there]
        return Found(self, rows, reasons, {TIME: times}, self.motion.at(times).numbers, 0.0 * times)

    def swings(self, ours: Array, offs: Sequence[Array], tolerance: float | None = None) -> Array:
        """Largest change of our numbers at either end of the rounding of each independent column.

        Args:
            ours: our numbers, (columns, N).
            offs: rounding error of each independent column, (N,).
        Returns:
            Changes, (independent columns, columns, N).
        """
        values, changes = [s.values for s in self.measured.independent], np.zeros((len(offs), *ours.shape))
        for i, off in enumerate(offs):
            for end in (-off, off) if off.any() else ():
                there = self.at([*values[:i], values[i] + end, *values[i + 1 :]], tolerance)
                moved = zip(self.measured.numbers, there.columns(there.numbers), ours, strict=True)
                changes[i] = np.fmax(changes[i], [np.abs(s.apart(new, old)) for s, new, old in moved])
        return changes

    def bounds(self, found: Found) -> Numbers:
        """Our error bounds of numbers, in their shapes: over time those that are proven."""
        if not self.over_time:
            return self.within(found, found.off)
        return self.motion.proof_of(self.motion.at(found.inputs[TIME]), rates=True).proven

    def within(self, found: Found, off: Array) -> Numbers:
        """Error bounds of numbers whose points are off by up to `off`, (R,), mm.

        NaN where points this far off may belong to another pose.
        """
        # Imported here: these modules need an optional package.
        from validate.formulations.input_rates import laws_of
        from validate.formulations.stated_accuracy import accuracy_at

        scene, inputs = self.scene, found.inputs
        if self.over_time:
            laws = laws_of(scene, inputs[TIME])
        else:
            scene = row_by_row(scene, inputs)
            laws = {name: np.outer(value, [1.0, 0.0, 0.0]) for name, value in inputs.items()}
        stated = accuracy_at(scene, off, found.numbers[PLACES], laws)
        seen = np.where(np.asarray(stated.blind, dtype=bool), np.nan, 1.0)
        return {q: {n: (seen * bound.T).T for n, bound in of.items()} for q, of in stated.claims.items()}

    def slopes(self, found: Found, coordinates: Sequence[str]) -> Numbers:
        """Derivatives of our numbers by drawn coordinates, (coordinates, R, 3) or (coordinates, R), per mm.

        An input that the file gives has the same value in every design, but a travel counts from the drawing
        of the design. An input that is neither given nor held is as drawn.

        Raises:
            AssemblyError: see `slopes_of_poses`.
        """
        if self.over_time:
            return slopes_of_motion(self.scene, self.motion.solved, found.inputs[TIME], coordinates).numbers
        levels = {}
        if self.travel:
            # The level of a travel changes with the drawing, mm per mm.
            moved = ByHardpoints(self.closing.readout, moves_of(self.closing.scene, coordinates))
            closed = moved.at(self.closing.closed.y[None], moved.drawn_inputs, {})
            levels[self.travel] = slope_of(self._risen(moved.moved, closed.states[0]))[:, 0]
        drawn = [name for name in self.drawn if name not in (*self.columns, *self.held)]
        return slopes_of_poses(self.solver, found.inputs, coordinates, drawn, levels).numbers


def row_by_row(scene: Scene, inputs: Mapping[str, Array]) -> Scene:
    """A scene that passes through values of inputs, each (N,), one row per second."""
    count = len(next(iter(inputs.values())))
    # A table needs four values.
    times = np.arange(float(max(count, 4)))
    tables = {name: np.resize(values, len(times)).tolist() for name, values in inputs.items()}
    content = scene.model_dump(exclude_none=True, exclude={"points"})
    content["inputs"] = {n: {"table": {"times": times.tolist(), "values": v}} for n, v in tables.items()}
    content["time"] = {"start": 0.0, "stop": count - 1.0, "samples": count}
    return Scene.from_mapping(content, scene.title or "scene")


def _driven_by(scene: Scene, travel: str, given: Sequence[str], measured: Measured) -> Scene:
    """A scene that drives a travel instead of the input that moves its wheel up and down."""
    point, topology, radius = travel.partition(".")[2], scene.mechanism.topology, scene.mechanism.wheel_radius
    table: dict[str, Any] = {"height": point}
    if point == CONTACT:
        table = {"contact": list(topology.wheel_axis)}
        point = topology.wheel_centre
        radius = measured.said.rolling_radius or radius
        if radius is None:
            problem = f"{travel} needs the wheel's rolling radius"
            raise FileError(measured.source, "", problem, "rolling_radius = MM in a map, above 0")
    moving = (*topology.driven_along(BY_TRAVEL, point.rpartition(".")[0]), *topology.required_inputs)
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
    content["inputs"] = {name: law for name, law in content["inputs"].items() if name != solved}
    content["inputs"][travel] = {"constant": 0.0}
    return Scene.from_mapping(content, scene.title or "scene")


def _asked(scene: Scene, measured: Measured) -> Scene:
    """The scene with the effects that a file's columns need, and with all points."""
    topology, had, effects = scene.mechanism.topology, scene.mechanism.effects, dict.fromkeys(scene.effects)
    gives = {name: effect.gives_numbers(topology) for name, effect in EFFECTS.items()}
    for quantity, name in dict.fromkeys(s.meaning.row for s in measured.numbers):
        names = {effect: numbers.get(quantity, ()) for effect, numbers in gives.items()}
        giving = [effect for effect, some in names.items() if some is None or name in some]
        # If the car has no such effect, asking for one reports what the car lacks.
        effects |= dict.fromkeys([effect for effect in giving if effect in had] or giving)
    return scene.model_copy(update={"points": None, "effects": tuple(effects)})
