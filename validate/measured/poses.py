r"""Our own numbers at the poses of a file: over time by the motion, over inputs and travels by the map.

A travel is an input of the same car: one that holds the height of its point in place of the input that moves
that point most. So rows over travels are rows over inputs, and their rates and derivatives are those of
inputs. A pose is the one that is reached from the drawing; where the travel turns back there is none beyond.

A derivative by an independent column is the rate where that goes at 1 per unit and the others stand still.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pointcoord import KinematicMap, Motion, Scene, kinematic_map, simulate, solve_poses
from pointcoord.drawing_stands import drawn_inputs
from pointcoord.effects.angle import Angle
from pointcoord.effects.corner import Wheel
from pointcoord.effects.effect import Effect
from pointcoord.effects.registry import EFFECTS, QUANTITIES
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.mapping.kinematic_map import mapped_instead_of
from pointcoord.mechanism.file import MECHANISMS, read_tables
from pointcoord.scene.scene_file import MechanismPart
from pointcoord.simulation import scene_mechanism
from pointcoord.solve.assembly import close_drawing
from validate.diagnosis.evidence import axes_of
from validate.formulations.asked_numbers import per_second
from validate.measured.mapping import Measured, Series
from validate.measured.meanings import CONTACT, INPUT, PLACES, RATES, TIME, TRAVEL, Meaning, angle_of
from validate.tables.errors import FileError

Array = NDArray[np.float64]
Bools = NDArray[np.bool_]
Numbers = dict[str, dict[str, Array]]

# How far an input goes to either side of the drawing at most: an angle, and a length in parts of the car's
# size. No suspension goes farther, and a slip in one row must not cost a search.
WIDEST = {"rad": 1.2, "mm": 0.5}
# Part of that by which an input that stands still is moved: to see what it moves, and for its rates.
LITTLE = 1e-3
OF_A_POSE = ("car", "joint")  # what numbers belong to that single poses give where a map does not
SPEED = next(q for q, of in QUANTITIES.items() if of.of == "point" and per_second(q) == 1)


@dataclass(frozen=True)
class Found:
    """Our numbers at the rows of a file.

    Attributes:
        numbers, bounds: by quantity and name, (N, 3) or (N,); NaN where there is no pose.
        reached: at which rows there is a pose, (N,).
        reasons: by row, why there is none.
        inputs: at each row, (N,), as far as they are known; none over time.
        laws: their rates and second derivatives likewise, (N, 2), 0 as far as they are not known.
        slopes: by column that derivatives are by, the velocities where that goes at 1 per s and others rest.
        unrated: why there are no rates, in words; empty where there are.
    """

    numbers: Numbers
    bounds: Numbers
    reached: Bools
    reasons: Mapping[int, str] = field(default_factory=dict)
    inputs: Mapping[str, Array] = field(default_factory=dict)
    laws: Mapping[str, Array] = field(default_factory=dict)
    slopes: Mapping[str, Found] = field(default_factory=dict)
    unrated: str = ""


NOTHING = Found({}, {}, np.zeros(0, dtype=bool))


@dataclass(frozen=True)
class Driven:
    """The car of a scene, driven by what the rows of a file are taken by.

    Attributes:
        scene: it asks for all points and for the effects that the file's columns need.
        columns: the input of each independent column; time itself over time.
        said: every other input that the map holds, or the scene at another value than drawn.
        as_drawn: those of which nothing is said.
        drawn: the inputs of the closed drawing, from which a travel counts.
        by_scene: those that the scene holds.
        home: where the points of the closed drawing are, mm.
    """

    scene: Scene
    columns: tuple[str, ...]
    said: Mapping[str, float]
    as_drawn: tuple[str, ...]
    drawn: Mapping[str, float] = field(default_factory=dict)
    by_scene: tuple[str, ...] = ()
    home: Mapping[str, Array] = field(default_factory=dict)

    @classmethod
    def of(cls, scene: Scene, measured: Measured) -> Driven:
        """A scene by what a file gives and holds, and by the drawing for the rest.

        Raises:
            FileError: a travel without what it needs, or of which no input can be solved for.
        """
        scene = asked_scene(scene, measured)
        columns = tuple(input_of(s.meaning.words) for s in measured.independent)
        said = {input_of(name): value for name, value in measured.held.items()}
        if columns == (TIME,):
            return cls(scene, columns, {}, ())
        given = (*columns, *said)
        travels = [name for name in given if name.startswith(f"{TRAVEL}.")]
        if len(travels) > 1:
            problem = f"{' and '.join(travels)} are travels of the same rows"
            raise FileError(measured.source, "", problem, "one travel, given or held")
        driven = _driven_by(scene, travels[0], given, measured) if travels else scene
        car = cls(driven, columns, said, ()).redrawn(scene, driven)
        rests, left = {}, [name for name in driven.mechanism.topology.required_inputs if name not in given]
        for name in left:
            law = driven.functions[name].series(driven.instants, 0)[:, 0]
            if (law == law[0]).all() and law[0] != car.drawn[name]:
                rests[name] = float(law[0])
        as_drawn = tuple(name for name in left if name not in rests)
        return replace(car, said={**said, **rests}, as_drawn=as_drawn, by_scene=tuple(rests))

    def redrawn(self, drawn: Scene, driven: Scene) -> Driven:
        """A design of the same car, driven by the same.

        Args:
            drawn: the design by the scene's own inputs, which say where its drawing closes.
        """
        if self.columns == (TIME,):
            return replace(self, scene=driven)
        inputs, home = _closed(drawn)
        known = {name: inputs.get(name, 0.0) for name in driven.mechanism.topology.required_inputs}
        part = driven.mechanism
        there = {point: np.array(place) for point, place in part.points.items()}
        for name in known.keys() - inputs.keys():
            # As an input it counts from the drawing as it stands, which need not close.
            rises = (height_of(part, name.partition(".")[2], part.wheel_radius, at) for at in (home, there))
            known[name] = float(next(rises) - next(rises))
        return replace(self, scene=driven, drawn=known, home=home)

    @property
    def notes(self) -> tuple[str, ...]:
        """Inputs that are held as drawn, or as the scene holds them."""
        units = self.scene.mechanism.topology.input_units
        held = {name: f"as drawn, {self.drawn[name]:.6g}" for name in self.as_drawn}
        held |= {name: f"at {self.said[name]:.6g}" for name in self.by_scene}
        by = dict.fromkeys(self.by_scene, "the scene does, and ")
        return tuple(
            f"{name} is held {value} {units[name]}: {by.get(name, '')}the file does not give it"
            for name, value in held.items()
        )

    def inputs(self, values: Sequence[Array]) -> tuple[dict[str, Array], dict[int, str]]:
        """Every input at values of the independent columns, each (N,), and why a row has none."""
        if self.columns == (TIME,):
            (times,) = values
            start, stop = self.scene.time.start, self.scene.time.stop
            outside = np.flatnonzero(~((times >= start) & (times <= stop)))
            there = np.clip(np.nan_to_num(times), start, stop)
            found = {name: law.series(there, 0)[:, 0] for name, law in self.scene.functions.items()}
            told = f"is outside the scene's time, {start:.10g} to {stop:.10g} s"
            return found, {int(i): f"t = {times[i]:.10g} s {told}" for i in outside}
        count = len(values[0])
        found = {name: np.full(count, self.drawn[name]) for name in self.as_drawn}
        found |= {name: np.full(count, value) + self.level(name) for name, value in self.said.items()}
        found |= {n: v + self.level(n) for n, v in zip(self.columns, values, strict=True)}
        reasons: dict[int, str] = {}
        for name, (low, high) in self.sensible.items():
            value = found[name]
            inside = (value >= low) & (value <= high)
            told = f"is out of reach, {low:.6g} to {high:.6g} being looked at"
            reasons |= {int(i): f"{name} = {value[i]:.10g} {told}" for i in np.flatnonzero(~inside)}
            found[name] = np.where(inside, value, self.drawn[name])
        return found, reasons

    def level(self, name: str) -> float:
        """From where an input's column counts: a travel from the closed drawing."""
        return self.drawn.get(name, 0.0) if name.startswith(f"{TRAVEL}.") else 0.0

    @cached_property
    def sensible(self) -> dict[str, tuple[float, float]]:
        """Between which values inputs have a meaning and are no slip."""
        mechanism, found = scene_mechanism(self.scene), {}
        for drive in mechanism.topology.drives:
            name, wide = drive.input, widest(mechanism, drive.input)
            beyond = drive.extremes(mechanism.drawing)
            ends = [float(np.ravel(drive.input_value(end, mechanism.drawing))[0]) for end in beyond]
            low, high = sorted(ends) if np.isfinite(ends).all() else (-np.inf, np.inf)
            found[name] = max(low, self.drawn[name] - wide), min(high, self.drawn[name] + wide)
        return found

    def poses(self, values: Sequence[Array], tolerance: float | None = None) -> Found:
        """Numbers of poses solved one by one; without bounds."""
        return self.solved(*self.inputs(values), tolerance)

    def solved(
        self, inputs: Mapping[str, Array], reasons: Mapping[int, str], tolerance: float | None = None
    ) -> Found:
        """The same at inputs; where there is a reason there is no pose."""
        poses = solve_poses(self.scene, inputs, tolerance)
        failed = {row: f"is out of reach: {error}" for row, error in poses.failures.items()}
        reasons = {**failed, **reasons}
        reached = poses.solved
        reached[[*reasons]] = False
        computed = {quantity: channel for quantity, channel in poses.numbers.items() if channel.computed}
        return Found(spread(computed, reached, reached), {}, reached, reasons, inputs)


def at_either_end(
    values: Sequence[Array], offs: Sequence[Array]
) -> Iterator[tuple[int, tuple[list[Array], list[Array]]]]:
    """By the place of each column that is rounded: all values, with its own at either end of the rounding."""
    for i, off in enumerate(offs):
        if off.any():
            below, above = ([*values[:i], values[i] + side * off, *values[i + 1 :]] for side in (-1.0, 1.0))
            yield i, (below, above)


def input_of(words: str) -> str:
    """The input that a column or an entry of [held] stands for; a travel is one of its own name."""
    return words.removeprefix(f"{INPUT}.")


def words_of(name: str) -> str:
    """What a column of an input is called, the other way."""
    return name if name.startswith(f"{TRAVEL}.") else f"{INPUT}.{name}"


def ours_of(series: Series, found: Found, scene: Scene) -> tuple[Array | None, Array | None]:
    """Our numbers of a column and their bounds, (N,); None if not known."""
    meaning, angle = series.meaning, angle_of(series.meaning)
    of, quantity = found, meaning.quantity
    if meaning.per and angle is None:
        of, quantity = found.slopes.get(meaning.per, NOTHING), SPEED
    if meaning.name not in of.numbers.get(quantity, {}) or (meaning.per and meaning.per not in found.slopes):
        return None, None
    if angle is not None and meaning.per:
        return _slope_of_an_angle(meaning, angle, found, scene)
    value = of.numbers[quantity][meaning.name]
    bound = of.bounds.get(quantity, {}).get(meaning.name, np.zeros_like(value))
    return (value, bound) if meaning.axis is None else (value[:, meaning.axis], bound[:, meaning.axis])


def _slope_of_an_angle(meaning: Meaning, angle: Angle, found: Found, scene: Scene) -> tuple[Array, Array]:
    """An angle's derivative, and how far it may be off.

    With s and c the components that an angle f is the atan2 of, f' = (s' c - c' s) / (s^2 + c^2).
    """
    wheel = Wheel.of(scene.mechanism.topology, meaning.name)
    axes, (start, end) = axes_of(scene).on(wheel.side), angle.ends(wheel)

    def line(of: Found, quantity: str) -> tuple[Array, Array, Array]:
        """Both components from end to end, and how far they may be off: each end may be along each axis."""
        places, bounds = of.numbers[quantity], of.bounds[quantity]
        ends = [np.max(bounds[name], axis=-1) for name in (start, end) if name in bounds]
        along, off = places[end] - places[start], 2.0 * math.sqrt(3.0) * np.max(ends, axis=0)
        return axes.component(along, angle.sine), axes.component(along, angle.cosine), np.asarray(off)

    s, c, off = line(found, PLACES)
    s_, c_, off_ = line(found.slopes[meaning.per], SPEED)
    square = s**2 + c**2
    value = (s_ * c - c_ * s) / square
    changed = (np.abs(c) + np.abs(s)) * off_ + (np.abs(s_) + np.abs(c_)) * off
    # To first order; what is left is smaller by the bound / the line's length.
    return value, 1.001 * (changed / square + 2.0 * np.abs(value) * off / np.sqrt(square))


def of_a_pose(meaning: Meaning) -> bool:
    """Whether a number is one of places alone."""
    return not meaning.per and (meaning.quantity == PLACES or angle_of(meaning) is not None)


def widest(mechanism: Mechanism, name: str) -> float:
    """How far an input goes to either side at most, rad or mm."""
    unit = mechanism.topology.input_units[name]
    return WIDEST[unit] * (float(mechanism.unit) if unit == "mm" else 1.0)


def _driven_by(scene: Scene, travel: str, given: Sequence[str], measured: Measured) -> Scene:
    """A scene that drives a travel in place of one of its inputs."""
    part, point = scene.mechanism, travel.partition(".")[2]
    topology = part.topology
    table: dict[str, Any] = {"height": point}
    radius = part.wheel_radius
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
    open_ = [name for name in topology.required_inputs if name not in given]
    rising = topology.wheel_centre if point == CONTACT else point
    solved = measured.solve_for or _strongest(scene, rising, open_)
    if solved not in open_:
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


def _closed(scene: Scene) -> tuple[dict[str, float], dict[str, Array]]:
    """The inputs of a closed drawing and where its points are, mm."""
    mechanism = scene_mechanism(scene)
    y, unit = close_drawing(mechanism).y, float(mechanism.unit)
    read = mechanism.input_values(y[mechanism.map.unknowns :])
    inputs = {name: float(read[name]) + 0.0 for name in mechanism.topology.required_inputs}
    return inputs, {name: place * unit + mechanism.origin for name, place in mechanism.places(y).items()}


def height_of(part: MechanismPart, point: str, radius: float | None, places: Mapping[str, Array]) -> Array:
    """How high a point is, or the contact: the lowest point of a thin disc about the wheel's centre, mm."""
    up = np.array(part.up)
    if point != CONTACT:
        return np.asarray(places[point] @ up)
    inner, outer = part.topology.wheel_axis
    spin = places[outer] - places[inner]
    lean = (spin @ up) / np.linalg.norm(spin, axis=-1)
    return np.asarray(places[part.topology.wheel_centre] @ up - (radius or 0.0) * np.sqrt(1.0 - lean**2))


def _strongest(scene: Scene, point: str, inputs: Sequence[str]) -> str:
    """The input by which a point rises most, each moved by the same part of its widest range."""
    drawn, up, found = drawn_inputs(scene), np.array(scene.mechanism.up), {}
    for name in inputs:
        step = LITTLE * widest(scene_mechanism(scene), name)
        place = solve_poses(scene, drawn | {name: drawn[name] + np.array([-step, step])}).position[point]
        found[name] = float(np.abs(np.nan_to_num(np.diff(place @ up)))[0])
    return max(found, key=lambda name: found[name], default="")


def poses_of(scene: Scene, measured: Measured) -> OverTime | OverMap:
    """What gives our numbers at a file's rows.

    Raises:
        FileError: a travel cannot be followed.
        PointcoordError: the scene cannot be solved.
    """
    driven = Driven.of(scene, measured)
    if driven.columns == (TIME,):
        return OverTime(driven, simulate(driven.scene))
    return OverMap.of(driven, measured)


def asked_scene(scene: Scene, measured: Measured) -> Scene:
    """The scene with the effects that a file's columns need, and with all points."""
    effects, available = dict.fromkeys(scene.effects), scene.mechanism.effects
    for s in measured.numbers:
        giving = [effect.name for effect in EFFECTS.values() if _gives(effect, s.meaning, scene)]
        # Where the car has none of them, one says what is missing.
        effects |= dict.fromkeys([name for name in giving if name in available] or giving)
    content = scene.model_dump(exclude_none=True, exclude={"points"})
    return Scene.from_mapping(content | {"effects": tuple(effects)}, scene.title or "scene")


def _gives(effect: Effect, meaning: Meaning, scene: Scene) -> bool:
    """Whether a number needs an effect; a derivative needs velocities."""
    numbers = effect.gives_numbers(scene.mechanism.topology)
    names = numbers.get(meaning.quantity, ())
    return bool(meaning.per and SPEED in numbers) or names is None or meaning.name in names


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


@dataclass(frozen=True, repr=False)
class OverTime:
    """By the motion of the scene's own laws."""

    driven: Driven
    motion: Motion

    def at(self, values: Sequence[Array], rates: Sequence[Array] = ()) -> Found:
        """Inside the scene's time; each number with its proven bound."""
        (times,) = values
        _, reasons = self.driven.inputs(values)
        reached: Bools = np.ones(len(times), dtype=bool)
        reached[[*reasons]] = False
        if not reached.any():
            return Found({}, {}, reached, reasons)
        # Samples want their instants in order and once each.
        instants, rows = np.unique(times[reached], return_inverse=True)
        samples = self.motion.at(instants)
        proven = self.motion.proof_of(samples, rates=True).proven
        found = Found(
            spread(samples.numbers, reached, rows),
            spread({quantity: proven[quantity] for quantity in samples.numbers}, reached, rows),
            reached,
            reasons,
        )
        return replace(found, slopes={TIME: found})


@dataclass(frozen=True, repr=False)
class OverMap:
    """By the kinematic map, over inputs.

    Attributes:
        map: of the driven car, about all of the file's poses.
        measured: the file, which says what rates there are and by what derivatives are asked.
        by_pose: the scene with the effects of the file's columns that a map does not give and a pose does,
            such as gradients and roll centres; None if there are none.
    """

    driven: Driven
    measured: Measured
    map: KinematicMap
    by_pose: Scene | None

    @classmethod
    def of(cls, driven: Driven, measured: Measured) -> OverMap:
        """Makes a map that reaches from the drawing to all that a file asks for and the car has."""
        rates = (*(s.meaning.words for s in measured.rates), *measured.held_rates)
        sides = [[s.values + side * s.off for s in measured.independent] for side in (-1.0, 0.0, 1.0)]
        solved = [driven.poses(side) for side in sides]
        required = driven.scene.mechanism.topology.required_inputs
        ranges: dict[str, tuple[float, float]] = {}
        for name in required:
            there = np.concatenate([found.inputs[name][found.reached] for found in solved])
            if name in driven.columns or not len(there):
                there = np.append(there, driven.drawn[name])
            low, high = float(there.min()), float(there.max())
            # A map takes no rate of an input that it holds.
            moving = any(f"{words_of(name)}.{word}" in rates for word in RATES)
            # Every row may have the same pose, by a heave or by held inputs alone; a map wants a free input.
            alone = name == required[0] and not any(n in driven.columns for n in required)
            if low == high and (name in driven.columns or moving or alone):
                wide = LITTLE * widest(scene_mechanism(driven.scene), name)
                low, high = low - wide, high + wide
            ranges[name] = low, high
        scene = driven.scene
        others = [EFFECTS[name] for name in scene.effects if mapped_instead_of(EFFECTS[name])]
        told = (
            effect.name
            for effect in others
            if not effect.derivative and any(_gives(effect, s.meaning, scene) for s in measured.numbers)
        )
        by_pose = scene.model_copy(update={"effects": effects}) if (effects := tuple(told)) else None
        mapped = tuple(name for name in scene.effects if EFFECTS[name] not in others)
        map = kinematic_map(scene.model_copy(update={"effects": mapped}), ranges)
        return cls(driven, measured, map, by_pose)

    def at(self, values: Sequence[Array], rates: Sequence[Array] = ()) -> Found:
        """Where the map is proven; each number with its proven bound."""
        inputs, reasons = self.driven.inputs(values)
        covered = np.ones(len(values[0]), dtype=bool)
        for name, (low, high) in self.map.ranges.items():
            covered &= (inputs[name] >= low) & (inputs[name] <= high)
        covered[[*reasons]] = False
        if covered.any():
            covered[covered] = self.map.covers({name: inputs[name][covered] for name in self.map.inputs})
        if len(lost := np.flatnonzero(~covered)):
            why = self.driven.poses([value[lost] for value in values]).reasons
            unproven = "is out of reach: no pose is proven there, a fold is near"
            reasons = {int(row): why.get(i, unproven) for i, row in enumerate(lost)}
        if not covered.any():
            return Found({}, {}, covered, reasons)
        mine = {name: value[covered] for name, value in inputs.items()}
        laws, unrated = self._laws(mine, [rate[covered] for rate in rates])
        found = self._found(mine, laws, covered)
        if self.by_pose is not None:
            found = _with_poses(found, self.by_pose, mine)
        slopes = {}
        for words in dict.fromkeys(s.meaning.per for s in self.measured.numbers if s.meaning.per):
            law = {n: np.full(covered.sum(), float(n == input_of(words))) for n in mine if n in self._free}
            slopes[words] = self._found(mine, [law], covered)
        return replace(found, reasons=reasons, inputs=inputs, slopes=slopes, unrated=unrated)

    def _found(self, here: Mapping[str, Array], laws: Sequence[Mapping[str, Array]], covered: Bools) -> Found:
        """What the map has at inputs with their time derivatives, as far as these are known."""
        rates, bends = (*laws, None, None)[:2]
        poses = self.map(here, rates, bends, bounds=True)
        computed = {quantity: channel for quantity, channel in poses.numbers.items() if channel.computed}
        known = {name: np.zeros((len(covered), 2)) for name in here}
        for order, law in enumerate(laws):
            for name, rate in law.items():
                known[name][covered, order] = rate
        return Found(spread(computed, covered), spread(poses.bounds, covered), covered, laws=known)

    def _laws(self, here: Mapping[str, Array], rates: Sequence[Array]) -> tuple[list[dict[str, Array]], str]:
        """Time derivatives of what the map takes as far as they are known, and why there are no more."""
        count = len(next(iter(here.values())))
        told = {name: np.full(count, value) for name, value in self.measured.held_rates.items()}
        told |= {s.meaning.words: rate for s, rate in zip(self.measured.rates, rates, strict=True)}
        found: list[dict[str, Array]] = []
        for word in RATES:
            known = {n: told[f"{words_of(n)}.{word}"] for n in here if f"{words_of(n)}.{word}" in told}
            lacking = [words_of(n) for n in self.driven.columns if n not in known]
            if lacking:
                what = "rates need" if not found else "second derivatives need"
                said = " and ".join(f"{name}.{word}" for name in sorted(lacking))
                return found, f"{what} a column of {TIME}, or {said}: a column, or held by a map"
            found.append({n: known.get(n, np.zeros(count)) for n in here if n in self._free})
        return found, ""

    @property
    def _free(self) -> frozenset[str]:
        """Inputs that the map does not hold."""
        return frozenset(n for n, (low, high) in self.map.ranges.items() if low != high)


def _with_poses(found: Found, scene: Scene, here: Mapping[str, Array]) -> Found:
    """With the numbers of effects that single poses give, at the rows that are reached, and their bounds.

    Where that may be off is what points that are as far off as the poses are make of a number.
    """
    # Their packages are an extra that files without such columns need not.
    from validate.formulations.stated_accuracy import accuracy_at

    rows = found.reached
    poses = solve_poses(scene, here)
    still = {name: np.stack([value, *np.zeros((2, len(value)))], axis=-1) for name, value in here.items()}
    places = {name: place[rows] for name, place in found.numbers[PLACES].items()}
    off = np.maximum(poses.bound, poses.carried_bound)
    claims = accuracy_at(scene, np.where(np.isfinite(off), off, 0.0), places, still).claims
    given = {
        q: {n: array for n, array in channel.items() if n in claims.get(q, {})}
        for q, channel in poses.numbers.items()
        if QUANTITIES[q].of in OF_A_POSE and channel.computed
    }
    numbers, bounds = spread(given, rows), spread({q: claims[q] for q in given if q in claims}, rows)
    return replace(
        found,
        numbers={q: found.numbers.get(q, {}) | numbers.get(q, {}) for q in {**found.numbers, **numbers}},
        bounds={q: found.bounds.get(q, {}) | bounds.get(q, {}) for q in {**found.bounds, **bounds}},
    )


Poses = OverTime | OverMap
"""Our numbers over what a file is over: by the car that `driven` says, `at` values of its columns."""
