r"""Our own numbers at the poses of a file: over time by the motion, over inputs and travels by the map.

A travel h(x) is what a point rises by when an input goes to x, others as they are. The map gives h anywhere,
so the pose that has a travel is a root, bracketed on the part about the drawing where h goes one way: beyond
the place where it turns back two poses have the same travel, and a file does not say which. Bisection ends
at neighbouring doubles; what is left is that h itself is off by twice the map's proven bound, which counts
as a rounding of the travel.

Rates over inputs and travels are those of the inputs' own rates, as far as the file gives them; one that is
the same in every row has none. That of an input which is solved for follows from the travel's, v = h': the
input goes so that x' = (v - w) / h_x, w the part of v that the others make, and its second derivative
likewise. A derivative by an independent column is the rate where that goes at 1 per unit and the others stand
still. An h_x that is off by b puts its rates off by b / |h_x| of themselves.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from pointcoord import (
    KinematicMap,
    Motion,
    NotCovered,
    PointcoordError,
    Scene,
    kinematic_map,
    simulate,
)
from pointcoord.data_classes import dataclass
from pointcoord.effects.effect import Effect
from pointcoord.effects.registry import EFFECTS, QUANTITIES
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.simulation import scene_mechanism
from pointcoord.solve.assembly import close_drawing
from validate.formulations.asked_numbers import per_second
from validate.measured.errors import ResultsError
from validate.measured.mapping import CONTACT, INPUT, RATES, TIME, TRAVEL, Measured, Series
from validate.plain_text import shown

Array = NDArray[np.float64]
Bools = NDArray[np.bool_]
Numbers = dict[str, dict[str, Array]]

# How far an input goes to either side of the drawing at most: an angle, and a length in parts of the car's
# size. No suspension goes farther, and a slip in one row must not make the map coarse for all.
WIDEST = {"rad": 1.2, "mm": 0.5}
GRID = 256  # parts of that to either side, on which travels are seen to go one way
HALVINGS = 60  # of one such part: rounding
ROWS = 4096  # that are solved for at a time
SPEED = next(q for q, of in QUANTITIES.items() if of.of == "point" and per_second(q) == 1)


@dataclass(frozen=True)
class Slopes:
    """Derivatives of all places by one of the independent columns.

    Attributes:
        places, bounds: by point, (N, 3), NaN where there is no pose.
        laws: what every input changes by it, (N,); none over time.
    """

    places: Mapping[str, Array]
    bounds: Mapping[str, Array]
    laws: Mapping[str, Array]


@dataclass(frozen=True)
class Found:
    """Our numbers at the rows of a file.

    Attributes:
        numbers, bounds: by quantity and name, (N, 3) or (N,); NaN where there is no pose.
        reached: at which rows there is a pose, (N,).
        reasons: by row, why there is none.
        inputs: at each row, (N,), as far as they are known; none over time.
        laws: their rates and second derivatives likewise, (N, 2), 0 as far as they are not known.
        slopes: of the columns that derivatives are by.
        unrated: why there are no rates, in words; empty where there are.
    """

    numbers: Numbers
    bounds: Numbers
    reached: Bools
    reasons: Mapping[int, str]
    inputs: Mapping[str, Array] = field(default_factory=dict)
    laws: Mapping[str, Array] = field(default_factory=dict)
    slopes: Mapping[str, Slopes] = field(default_factory=dict)
    unrated: str = ""


class Poses(Protocol):
    """Our numbers over what a file is over."""

    @property
    def notes(self) -> tuple[str, ...]:
        """What was taken without being told."""
        ...

    def at(self, values: Sequence[Array], rates: Sequence[Array] = ()) -> Found:
        """Our numbers at values of the independent columns and of the file's rates, each (N,)."""
        ...

    def extra(self, series: Series) -> float:
        """How far an independent value is off beside its rounding, in its unit."""
        ...


def poses_of(scene: Scene, measured: Measured) -> Poses:
    """What gives our numbers at a file's rows.

    Raises:
        ResultsError: a travel cannot be followed.
        PointcoordError: the scene cannot be solved.
    """
    scene = asked_scene(scene, measured)
    if measured.independent[0].meaning.kind == TIME:
        return OverTime(simulate(scene), bool(slopes_of(measured)))
    return OverMap.of(scene, measured)


def slopes_of(measured: Measured) -> tuple[str, ...]:
    """The columns that derivatives in a file are by, in words."""
    return tuple(dict.fromkeys(s.meaning.per for s in measured.numbers if s.meaning.per))


def asked_scene(scene: Scene, measured: Measured) -> Scene:
    """The scene with the effects that a file's columns need, and with all points."""
    effects = dict.fromkeys(scene.effects)
    for s in measured.numbers:
        for effect in EFFECTS.values():
            if _gives(effect, s):
                effects[effect.name] = None
    content = scene.model_dump(exclude_none=True)
    content.pop("points", None)
    return Scene.from_mapping(content | {"effects": tuple(effects)}, scene.title or "scene")


def _gives(effect: Effect, series: Series) -> bool:
    quantity, name = series.meaning.quantity, series.meaning.name
    if series.meaning.per and SPEED in effect.gives_numbers:
        return True
    if quantity not in effect.gives_numbers:
        return False
    names = effect.gives_numbers[quantity]
    return names is None or name in names


@dataclass(frozen=True, repr=False)
class OverTime:
    """By the motion of the scene's own laws."""

    motion: Motion
    sloped: bool = False

    @property
    def notes(self) -> tuple[str, ...]:
        """None: what the scene leaves to us is told of the scene."""
        return ()

    def extra(self, series: Series) -> float:
        """None: times are what they are."""
        return 0.0

    def at(self, values: Sequence[Array], rates: Sequence[Array] = ()) -> Found:
        """Inside the scene's time; each number with its proven bound."""
        (times,) = values
        start, stop = float(self.motion.times[0]), float(self.motion.times[-1])
        reached: Bools = np.asarray((times >= start) & (times <= stop))
        reasons = {
            int(i): f"t = {times[i]:.10g} s is outside the scene's time, {start:.10g} to {stop:.10g} s"
            for i in np.flatnonzero(~reached)
        }
        numbers: Numbers = {}
        bounds: Numbers = {}
        if reached.any():
            # Samples want their instants in order and once each.
            instants, places = np.unique(times[reached], return_inverse=True)
            samples = self.motion.at(instants)
            proven = self.motion.proof_of(samples, rates=True).proven
            for quantity, channel in samples.numbers.items():
                numbers[quantity] = {n: _spread(a[places], reached) for n, a in channel.items()}
                bounds[quantity] = {n: _spread(a[places], reached) for n, a in proven[quantity].items()}
        slopes = {}
        if self.sloped and reached.any():
            slopes[TIME] = Slopes(numbers[SPEED], bounds[SPEED], {})
        return Found(numbers, bounds, reached, reasons, slopes=slopes)


def _spread(array: Array, reached: Bools) -> Array:
    """Rows put where they belong, NaN elsewhere."""
    found = np.full((len(reached), *array.shape[1:]), np.nan)
    found[reached] = array
    return found


@dataclass(frozen=True)
class Plan:
    """Which inputs the rows of a file have, over inputs and a travel.

    Attributes:
        kinds: what each independent column is: travel or input, and its name.
        solved: the input that a travel is reached by; empty if there is no travel.
        held: every other input that no column gives. level: the travel that every row has, or None.
        drawn: the inputs of the closed drawing.
        taken: what was taken without being told.
    """

    kinds: tuple[tuple[str, str], ...]
    solved: str
    held: Mapping[str, float]
    level: tuple[str, float] | None
    drawn: Mapping[str, float]
    taken: tuple[str, ...]

    @classmethod
    def of(cls, scene: Scene, measured: Measured) -> Plan:
        """What the file gives and holds, and of the rest the drawing.

        Raises:
            ResultsError: a travel without what it needs, or of which no input can be solved for.
        """
        mechanism = scene_mechanism(scene)
        topology = mechanism.topology
        y = close_drawing(mechanism).y
        read = mechanism.input_values(y[mechanism.map.unknowns :])
        drawn = {name: float(np.ravel(read[name])[0]) + 0.0 for name in topology.required_inputs}
        levels = {n: v for n, v in measured.held.items() if n.startswith(f"{TRAVEL}.")}
        held = {n.partition(".")[2]: v for n, v in measured.held.items() if n not in levels}
        kinds = tuple((s.meaning.kind, s.meaning.name) for s in measured.independent)
        travels = [name for kind, name in kinds if kind == TRAVEL] + [n.partition(".")[2] for n in levels]
        if len(travels) > 1:
            problem = f"{' and '.join(travels)} are travels of the same rows"
            raise ResultsError(measured.source, "", problem, "one travel, given or held")
        if CONTACT in travels and not topology.wheel_axis:
            problem = f"{TRAVEL}.{CONTACT} needs the role wheel_axis, which {topology.name!r} does not have"
            allowed = f"{TRAVEL}.POINT, or wheel_axis under [roles] of the mechanism"
            raise ResultsError(measured.source, "", problem, allowed)
        if CONTACT in travels and not measured.rolling_radius > 0.0:
            problem = f"{TRAVEL}.{CONTACT} needs the wheel's rolling radius"
            raise ResultsError(measured.source, "", problem, "rolling_radius = MM in a map, above 0")
        given = {name for kind, name in kinds if kind == INPUT} | set(held)
        open_ = [name for name in topology.required_inputs if name not in given]
        level = next(((n.partition(".")[2], v) for n, v in levels.items()), None)
        solved = ""
        if travels:
            solved = measured.solve_for or _strongest(scene, mechanism, travels[0], open_, drawn, measured)
            if solved not in open_:
                problem = f"{TRAVEL}.{travels[0]} is to be reached by an input, and all are given"
                raise ResultsError(measured.source, "", problem, "a travel, or the inputs")
        taken = []
        for name in open_:
            if name != solved:
                held[name] = drawn[name]
                unit = topology.input_units[name]
                taken.append(f"{name} is held as drawn, {drawn[name]:.6g} {unit}: the file does not give it")
        return cls(kinds, solved, held, level, drawn, tuple(taken))


@dataclass(frozen=True, repr=False)
class OverMap:
    """By the kinematic map, over inputs and a travel.

    Attributes:
        map: of the scene's suspension.
        kinds: what each independent column is: travel or input, and its name.
        solved: the input that is solved for; empty if there is no travel.
        held: every other input that no column gives. level: the travel that every row has, or None.
        drawn: the inputs of the closed drawing.
        radius: the rolling radius, mm.
        taken: what was taken without being told.
        sloped: the columns that derivatives are asked by, in words.
        rated: the rates that rows give, likewise.
        rates: those that every row has.
    """

    map: KinematicMap
    kinds: tuple[tuple[str, str], ...]
    solved: str
    held: Mapping[str, float]
    level: tuple[str, float] | None
    drawn: Mapping[str, float]
    radius: float
    taken: tuple[str, ...]
    sloped: tuple[str, ...] = ()
    rated: tuple[str, ...] = ()
    rates: Mapping[str, float] = field(default_factory=dict)

    @classmethod
    def of(cls, scene: Scene, measured: Measured) -> OverMap:
        """Makes a map that reaches from the drawing to all that a file asks for.

        Raises:
            ResultsError: a travel without what it needs, or of which no input can be solved for.
        """
        plan, mechanism = Plan.of(scene, measured), scene_mechanism(scene)
        topology, held, drawn = mechanism.topology, plan.held, plan.drawn
        ranges: dict[str, tuple[float, float]] = {}
        for name in topology.required_inputs:
            wide = widest(mechanism, name)
            if name == plan.solved:
                ranges[name] = sensible(mechanism, name, (drawn[name] - wide, drawn[name] + wide))
                continue
            if name in held:
                rated = {*measured.held_rates, *(s.meaning.words for s in measured.rates)}
                # A map takes no rate of an input that it holds.
                wide = 1e-3 * wide if any(f"{INPUT}.{name}.{word}" in rated for word in RATES) else 0.0
                ranges[name] = sensible(mechanism, name, (held[name] - wide, held[name] + wide))
                continue
            s = next(s for s in measured.independent if s.meaning.name == name)
            low, high = float(np.min(s.values - s.off)), float(np.max(s.values + s.off))
            low = max(min(low, drawn[name]), drawn[name] - wide)
            high = min(max(high, drawn[name]), drawn[name] + wide)
            if low == high:
                low, high = low - 1e-3 * wide, high + 1e-3 * wide
            ranges[name] = sensible(mechanism, name, (low, high))
        if all(low == high for low, high in ranges.values()):
            # Every row has the same pose, by a heave or by held inputs alone; a map wants a free input.
            name = topology.required_inputs[0]
            wide = 1e-3 * widest(mechanism, name)
            ranges[name] = (ranges[name][0] - wide, ranges[name][0] + wide)
        map = kinematic_map(scene, ranges)
        return cls(
            map,
            plan.kinds,
            plan.solved,
            held,
            plan.level,
            drawn,
            measured.rolling_radius,
            plan.taken,
            slopes_of(measured),
            tuple(s.meaning.words for s in measured.rates),
            measured.held_rates,
        )

    @property
    def notes(self) -> tuple[str, ...]:
        """Inputs that are held as drawn."""
        return self.taken

    def extra(self, series: Series) -> float:
        """What the map leaves of a travel."""
        return 2.0 * self.map.bound.position if series.meaning.kind == TRAVEL else 0.0

    def at(self, values: Sequence[Array], rates: Sequence[Array] = ()) -> Found:
        """Where the map is proven; each number with its proven bound."""
        count = len(values[0])
        inputs = {name: np.full(count, value) for name, value in self.held.items()}
        wanted = None if self.level is None else (self.level[0], np.full(count, self.level[1]))
        for (kind, name), value in zip(self.kinds, values, strict=True):
            if kind == TRAVEL:
                wanted = name, value
            else:
                inputs[name] = value
        reasons: dict[int, str] = {}
        reached = np.ones(count, dtype=bool)
        for name, value in inputs.items():
            if name in self.map.ranges:
                low, high = self.map.ranges[name]
                for i in np.flatnonzero(reached & ~((value >= low) & (value <= high))):
                    reasons[int(i)] = (
                        f"{name} = {value[i]:.10g} is out of reach, {low:.6g} to {high:.6g} being looked at"
                    )
                    reached[i] = False
        if wanted is not None:
            inputs[self.solved] = np.full(count, self.drawn[self.solved])
            for first in range(0, count, ROWS):
                rows = np.flatnonzero(reached)[first : first + ROWS]
                if len(rows):
                    some = {name: value[rows] for name, value in inputs.items()}
                    roots, lost = self._roots(wanted[0], wanted[1][rows], some)
                    inputs[self.solved][rows] = roots
                    for lacking, why in lost.items():
                        reasons[int(rows[lacking])] = why
            reached[[*reasons]] = False
        free = {name: inputs[name] for name in self.map.inputs if name in inputs}
        free |= {name: np.full(count, self.held[name]) for name in self.map.inputs if name not in free}
        if not reached.any():
            return Found({}, {}, reached, reasons)
        covered = np.zeros(count, dtype=bool)
        covered[reached] = self.map.covers({name: value[reached] for name, value in free.items()})
        for i in np.flatnonzero(reached & ~covered):
            here = {name: float(value[i]) for name, value in free.items()}
            told = ", ".join(f"{name} = {value:.10g}" for name, value in here.items())
            reasons[int(i)] = f"{told} is out of the car's reach: {self._why(here)}"
        if not covered.any():
            return Found({}, {}, covered, reasons)
        moved = {n: inputs[n] for n in self.map.mechanism.topology.chassis_inputs if n in inputs}
        mine = {n: np.asarray(v[covered]) for n, v in (free | moved).items()}
        given = dict(zip(self.rated, (rate[covered] for rate in rates), strict=True))
        laws, unrated = self._laws(mine, given)
        rates_of, bends_of = (*laws, None, None)[:2]
        poses = self.map(mine, rates_of, bends_of, bounds=True)
        numbers = {
            quantity: {name: _spread(np.asarray(array), covered) for name, array in channel.items()}
            for quantity, channel in poses.numbers.items()
            if channel.computed
        }
        bounds = {
            quantity: {name: _spread(np.asarray(array), covered) for name, array in part.items()}
            for quantity, part in poses.bounds.items()
        }
        self._widen(numbers, bounds, mine, laws, covered)
        known = {name: np.zeros((count, 2)) for name in inputs}
        for order, law in enumerate(laws):
            for name, rate in law.items():
                known[name][covered, order] = rate
        slopes = {words: self._slopes(words, mine, covered) for words in self.sloped}
        return Found(numbers, bounds, covered, reasons, inputs, known, slopes, unrated)

    def _laws(
        self, here: Mapping[str, Array], given: Mapping[str, Array]
    ) -> tuple[list[dict[str, Array]], str]:
        """Time derivatives of what the map takes as far as they are known, and why there are no more."""
        count = len(next(iter(here.values())))
        moving = {f"{kind}.{name}" for kind, name in self.kinds}
        constant = {f"{INPUT}.{name}" for name in self.held}
        constant |= set() if self.level is None else {f"{TRAVEL}.{self.level[0]}"}
        found: list[dict[str, Array]] = []
        for word in RATES:
            lacking = [
                f"{whole}.{word}"
                for whole in sorted(moving)
                if f"{whole}.{word}" not in (*given, *self.rates)
            ]
            if lacking:
                what = "rates need" if not found else "second derivatives need"
                said = " and ".join(lacking)
                return found, f"{what} a column of {TIME}, or {said}: a column, or held by a map"
            known = {
                whole: given.get(f"{whole}.{word}", np.full(count, self.rates.get(f"{whole}.{word}", 0.0)))
                for whole in (*moving, *constant)
            }
            law = {n: known[f"{INPUT}.{n}"] for n in here if n != self.solved and n not in self._fixed}
            if self.solved:
                law[self.solved] = self._followed(here, [*found, law], known[f"{TRAVEL}.{self._travelling}"])
            found.append(law)
        return found, ""

    @property
    def _fixed(self) -> frozenset[str]:
        """Inputs that the map holds."""
        return frozenset(n for n, (low, high) in self.map.ranges.items() if low == high)

    @property
    def _travelling(self) -> str:
        """The point whose travel is given or held; empty where none is solved for."""
        names = [name for kind, name in self.kinds if kind == TRAVEL]
        names += [] if self.level is None else [self.level[0]]
        return names[0] if names else ""

    def _followed(
        self, here: Mapping[str, Array], laws: Sequence[Mapping[str, Array]], wanted: Array
    ) -> Array:
        """The solved input's derivative where the travel's is given; the last of the laws lacks it."""
        zero = np.zeros(len(wanted))
        states = [np.stack([here[n] for n in self.map.inputs], axis=-1)]
        states += [np.stack([law.get(n, zero) for n in self.map.inputs], axis=-1) for law in laws]
        rest = self._heights(self._travelling, *states)[-1]
        return np.asarray((wanted - rest) / self._steepness(here))

    def _steepness(self, here: Mapping[str, Array]) -> Array:
        """How much the travel changes with the solved input, (N,)."""
        place = np.stack([here[n] for n in self.map.inputs], axis=-1)
        alone = np.zeros_like(place)
        alone[:, self.map.inputs.index(self.solved)] = 1.0
        return self._heights(self._travelling, place, alone)[1]

    def _part_off(self, here: Mapping[str, Array]) -> Array:
        """By what part of itself the solved input's rate may be off, as the slope of the travel is."""
        # The height of a contact turns with two points of the spin axis beside the centre's own movement.
        off = 3.0 * self.map.bound.velocity[self.solved]
        return np.asarray(2.0 * off / np.abs(self._steepness(here)))

    def _slopes(self, words: str, here: Mapping[str, Array], covered: Bools) -> Slopes:
        """Derivatives of all places by an independent column."""
        count = int(covered.sum())
        travelled = words.startswith(f"{TRAVEL}.")
        law = {n: np.full(count, float(words == f"{INPUT}.{n}")) for n in here if n not in self._fixed}
        if self.solved:
            del law[self.solved]
            law[self.solved] = self._followed(here, [law], np.full(count, float(travelled)))
        poses = self.map(here, law, bounds=True)
        places = {n: np.asarray(a) for n, a in poses.numbers[SPEED].items()}
        bounds = {n: np.asarray(a) for n, a in poses.bounds[SPEED].items()}
        if self.solved:
            part = self._part_off(here)[:, None]
            bounds = {n: b + part * np.abs(places[n]) for n, b in bounds.items()}
        return Slopes(
            {n: _spread(a, covered) for n, a in places.items()},
            {n: _spread(a, covered) for n, a in bounds.items()},
            {n: _spread(a, covered) for n, a in law.items()},
        )

    def _widen(
        self,
        numbers: Mapping[str, Mapping[str, Array]],
        bounds: Mapping[str, dict[str, Array]],
        here: Mapping[str, Array],
        laws: Sequence[Mapping[str, Array]],
        covered: Bools,
    ) -> None:
        """Adds to the bounds of rates what the solved input's own are off by."""
        if not self.solved or not laws:
            return
        part = _spread(self._part_off(here), covered)[:, None]
        for quantity, own in bounds.items():
            order = per_second(quantity)
            for name in own if order else ():
                # All of it may be the solved input's; its square is in a second derivative.
                largest = np.abs(numbers[quantity][name])
                own[name] = own[name] + 2.0 * order * part * largest

    def _why(self, inputs: Mapping[str, float]) -> str:
        try:
            self.map(inputs)
        except NotCovered as error:
            return error.reason
        except PointcoordError as error:
            return str(error)
        return "no pose is proven"

    def _roots(self, point: str, wanted: Array, inputs: Mapping[str, Array]) -> tuple[Array, dict[int, str]]:
        """Values of the solved input at which a point has a travel, (N,), and why there are none by row."""
        low, high = self.map.ranges[self.solved]
        drawn, count = self.drawn[self.solved], len(wanted)
        grid = np.concatenate(
            [np.linspace(low, drawn, GRID + 1)[:-1], [drawn], np.linspace(drawn, high, GRID + 1)[1:]]
        )
        others = {n: v for n, v in inputs.items() if n in self.map.inputs and n != self.solved}
        # Rows that differ in nothing but the travel share one curve.
        keys = np.stack([*others.values(), np.zeros(count)], axis=-1)
        curves, which = np.unique(keys, axis=0, return_inverse=True)
        which = which.reshape(-1)
        every = {self.solved: np.broadcast_to(grid, (len(curves), len(grid)))}
        every |= {
            n: np.broadcast_to(curves[:, i, None], every[self.solved].shape) for i, n in enumerate(others)
        }
        covered = self.map.covers(every)
        heights = np.full(covered.shape, np.nan)
        if covered.any():
            heights[covered] = self._travel(point, {n: v[covered] for n, v in every.items()})
        first, last = np.empty(len(curves), dtype=int), np.empty(len(curves), dtype=int)
        ends = []
        for c, curve in enumerate(heights):
            first[c], last[c], end = _one_way(curve, GRID)
            ends.append(end)
        roots, lost = np.full(count, drawn), {}
        begin, finish = heights[which, first[which]], heights[which, last[which]]
        inside = (np.minimum(begin, finish) <= wanted) & (wanted <= np.maximum(begin, finish))
        for i in np.flatnonzero(~inside):
            c = int(which[i])
            if not covered[c, GRID]:
                lost[int(i)] = "the car has no pose there with this travel's input as drawn"
                continue
            reach = sorted((float(begin[i]), float(finish[i])))
            lost[int(i)] = (
                f"{TRAVEL}.{shown(point)} = {wanted[i]:.6g} mm is out of reach: {reach[0]:.6g} to "
                f"{reach[1]:.6g} mm ({self.solved} {grid[first[c]]:.4g} to {grid[last[c]]:.4g}; {ends[c]})"
            )
        rows = np.flatnonzero(inside)
        if len(rows):
            a, b = grid[first[which[rows]]].copy(), grid[last[which[rows]]].copy()
            rising = finish[rows] > begin[rows]
            mine = {n: v[rows] for n, v in others.items()}
            for _ in range(HALVINGS):
                middle = 0.5 * (a + b)
                above = self._travel(point, {self.solved: middle, **mine}) > wanted[rows]
                upper = above == rising
                a, b = np.where(upper, a, middle), np.where(upper, middle, b)
            roots[rows] = 0.5 * (a + b)
        return roots, lost

    def _travel(self, point: str, free: Mapping[str, Array]) -> Array:
        """How much higher a point is than in the closed drawing, mm, the chassis at rest."""
        home = self._home
        return self._height(point, free) - float(self._height(point, home)[0])

    @property
    def _home(self) -> dict[str, Array]:
        return {name: np.array([self.drawn[name]]) for name in self.map.inputs}

    def _height(self, point: str, free: Mapping[str, Array]) -> Array:
        return self._heights(point, np.stack([free[name] for name in self.map.inputs], axis=-1))[0]

    def _heights(self, point: str, *states: Array) -> list[Array]:
        """Height of a point and its time derivatives, by those of the map's inputs, each (N, inputs)."""
        mechanism = self.map.mechanism
        topology, up = mechanism.topology, mechanism.drawing.vectors["up"]
        found = self.map.evaluate(*states)
        number = {name: i for i, name in enumerate(self.map.points)}
        if point != CONTACT:
            return [np.asarray(state[..., number[point], :] @ up) for state in found]
        inner, outer = (number[name] for name in topology.wheel_axis)
        spins = [state[..., outer, :] - state[..., inner, :] for state in found]
        # The knuckle carries both ends: the spin axis keeps its length.
        long = np.linalg.norm(spins[0], axis=-1)
        lean, *leaning = [(spin @ up) / long for spin in spins]
        flat = np.sqrt(1.0 - lean**2)
        # The lowest point of a thin disc: centre - R unit(up - (up . n) n).
        centre = [state[..., number[topology.wheel_centre], :] @ up for state in found]
        heights = [np.asarray(centre[0] - self.radius * flat)]
        if leaning:
            heights.append(np.asarray(centre[1] + self.radius * lean * leaning[0] / flat))
        if len(leaning) > 1:
            bend = (leaning[0] ** 2 + lean * leaning[1]) / flat + (lean * leaning[0]) ** 2 / flat**3
            heights.append(np.asarray(centre[2] + self.radius * bend))
        return heights


def _one_way(curve: Array, home: int) -> tuple[int, int, str]:
    """The part of a curve about its middle that goes one way, and what ends it, in words."""
    if np.isnan(curve[home]):
        return home, home, "no pose"
    step = np.diff(curve)
    side = step[home] if np.isfinite(step[home]) else step[home - 1]
    first = last = home
    ends = []
    while first > 0 and step[first - 1] * side > 0.0:
        first -= 1
    while last < len(step) and step[last] * side > 0.0:
        last += 1
    if first > 0:
        ends.append("no pose is proven below" if np.isnan(step[first - 1]) else "it turns back below")
    if last < len(step):
        ends.append("no pose is proven above" if np.isnan(step[last]) else "it turns back above")
    return first, last, ", ".join(ends) or "it is looked for no farther"


def widest(mechanism: Mechanism, name: str) -> float:
    unit = mechanism.topology.input_units[name]
    return WIDEST[unit] * (float(mechanism.unit) if unit == "mm" else 1.0)


def sensible(mechanism: Mechanism, name: str, ends: tuple[float, float]) -> tuple[float, float]:
    """Ends of an input inside of what it has a meaning at."""
    drive = next(drive for drive in mechanism.topology.drives if drive.input == name)
    beyond = drive.extremes(mechanism.drawing)
    read = [float(np.ravel(drive.input_value(end, mechanism.drawing))[0]) for end in beyond]
    inside = sorted(value for value in read if np.isfinite(value))
    low, high = ends
    if len(inside) == 2:
        low, high = max(low, inside[0]), min(high, inside[1])
    return low, high


def _strongest(
    scene: Scene,
    mechanism: Mechanism,
    point: str,
    inputs: Sequence[str],
    drawn: Mapping[str, float],
    measured: Measured,
) -> str:
    """The open input by which a travel changes most, each over the same part of its widest range."""
    found = {}
    for name in inputs:
        wide = 1e-3 * widest(mechanism, name)
        ranges = {n: (drawn[n], drawn[n]) for n in drawn} | {name: (drawn[name] - wide, drawn[name] + wide)}
        map = kinematic_map(scene, ranges)
        probe = OverMap(map, (), name, {}, None, drawn, measured.rolling_radius, ())
        found[name] = float(np.abs(probe._travel(point, {name: np.array([drawn[name] + wide])}))[0])
    return max(found, key=lambda name: found[name], default="")
