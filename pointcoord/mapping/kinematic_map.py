r"""A suspension's kinematics as a function of its inputs: solved once, proven, and quick to evaluate.

    map = kinematic_map(Scene.load("steer"), {"arm_angle": (0.9, 1.1), "rack": (-10.0, 10.0)})
    map({"arm_angle": angles, "rack": racks}).position["wheel_centre"]      # mm, of the inputs' shape

Everything that moves depends on time through the inputs only, p(t) = Y(a(t), b(t)). The map holds Y as power
series in the inputs, in patches, each with a proven bound; any laws are then composed with it:

    v = Y_a a' + Y_b b',    acceleration = Y_a a'' + Y_b b'' + Y_aa a'^2 + 2 Y_ab a' b' + Y_bb b'^2.

What moves the chassis (heave, roll) is done to it, outside. The branch is the drawing's: patches are proven
outwards from the closed drawing (see `flood`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from os import PathLike
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pointcoord.effects.effect import Effect, Poses
from pointcoord.effects.plan import plan_effects
from pointcoord.effects.registry import EFFECTS, QUANTITIES
from pointcoord.errors import (
    InputOutOfRange,
    MapError,
    NotComputed,
    NotCovered,
    UnknownName,
)
from pointcoord.linkage.car_axes import CarAxes
from pointcoord.linkage.chassis import ChassisMotion
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.mapping.effect_bounds import Evaluated
from pointcoord.mapping.stored import Stored, read, write
from pointcoord.mechanism.freedoms import held_rows
from pointcoord.numerics.rounding import UNIT_ROUNDOFF
from pointcoord.patches.domain import Domain
from pointcoord.patches.evaluation import OnePatch, sum_series
from pointcoord.patches.flood import Limits, Patches, flood
from pointcoord.patches.jet import Jet
from pointcoord.patches.lookup import Lookup, part_of
from pointcoord.patches.reported_points import moving_points
from pointcoord.patches.way_map import order_for
from pointcoord.results.closing import closing
from pointcoord.results.samples import Channel
from pointcoord.scene.scene_file import Scene
from pointcoord.simulation import require_scene, require_the_drawn_car, scene_mechanism
from pointcoord.solve.assembly import assemble, close_drawing

Array = NDArray[np.float64]
Whole = NDArray[np.int64]
Ranges = Mapping[str, tuple[float, float]]

HALVINGS = 6
MOST_HALVINGS = 10  # a table of 2^20 boxes of two inputs
# Patches of one map: a few hundred MB while it is made.
MOST = 4096
VARIABLES = 3
# Widths and ends between which squares and products of series are numbers; no car has others.
NARROWEST, FARTHEST = 1e-100, 1e12


@dataclass(frozen=True)
class Bound:
    """How far what a map gives is off, at most.

    A velocity is off by at most the sum of velocity[i] |x_i'| and an acceleration by that of
    velocity[i] |x_i''| and acceleration[i, j] |x_i'| |x_j'|, x the inputs, over all i and j in both orders.

    Attributes:
        position: of every coordinate of a point, mm; what adding the user's origin rounds is in it, and what
            a chassis' motion rounds is not, nor that a turn of the car mixes the coordinates.
        velocity: by input, mm per its unit (rad or mm).
        acceleration: by two inputs, mm per the product of their units.
    """

    position: float
    velocity: Mapping[str, float]
    acceleration: Mapping[tuple[str, str], float]

    @classmethod
    def of(cls, off: Jet, half: Array, names: Sequence[str], shifted: float) -> Bound:
        """The largest of some patches, from derivatives by parts of their half widths (P, p).

        Args:
            shifted: what adding the user's origin rounds, mm.
        """
        first = (off.first.max(axis=-1) / half).max(axis=0)
        second = (off.second.max(axis=-1) / (half[:, :, None] * half[:, None])).max(axis=0)
        return cls(
            float(off.value.max()) + shifted,
            {name: float(first[i]) for i, name in enumerate(names)},
            {(a, b): float(second[i, j]) for i, a in enumerate(names) for j, b in enumerate(names)},
        )


@dataclass(frozen=True)
class Patch:
    """A part of a map: a box of inputs with one series, and what is proven of it.

    Attributes:
        ranges: of the inputs, rad or mm.
        condition: condition number of the Jacobian in its middle.
        contraction: at most this of an error is left by each step of the proof's map, below 1.
    """

    ranges: Ranges
    bound: Bound
    condition: float
    contraction: float


@dataclass(frozen=True)
class Uncovered:
    """A box of inputs at which nothing is proven, and why."""

    ranges: Ranges
    reason: str


@dataclass(frozen=True, repr=False)
class MappedPoses:
    """What a map gives at some inputs; every quantity is an attribute too, such as `position`.

    Attributes:
        numbers: by quantity and name, of points and bodies (..., 3), of the car (...), for inputs of shape
            (...); see `effects.registry.QUANTITIES` for what there is and its units.
        bounds: how far each of these may be off, proven, of the same shapes; empty unless asked for.
    """

    numbers: Mapping[str, Channel]
    bounds: Mapping[str, Mapping[str, Array]] = field(default_factory=dict)

    def __getattr__(self, name: str) -> Channel:
        numbers: Mapping[str, Channel] = self.__dict__.get("numbers", {})
        if name in numbers:
            return numbers[name]
        raise AttributeError(f"{type(self).__name__} has no {name!r}; its quantities: {', '.join(numbers)}")

    def __repr__(self) -> str:
        return f"<MappedPoses: {', '.join(c.quantity.words for c in self.numbers.values() if c.computed)}>"


@dataclass(frozen=True, repr=False)
class KinematicMap:
    """A scene's suspension as a function of its inputs; make one with `kinematic_map`.

    It can be pickled, and saved to a file that another program reads.

    Attributes:
        scene: whose suspension it is, and which effects it gives.
        tolerance: largest bound of a position on any patch, before the user's origin is added, mm.
        stored: its patches.
    """

    scene: Scene
    tolerance: float
    stored: Stored

    @property
    def ranges(self) -> Ranges:
        """Of every input that drives the suspension, rad or mm; held where both ends are the same."""
        return MappingProxyType(dict(self.stored.ranges))

    @cached_property
    def inputs(self) -> tuple[str, ...]:
        """The inputs that it is a function of, in the order of the columns of `evaluate`."""
        return self.domain.free

    @cached_property
    def points(self) -> tuple[str, ...]:
        """The points that move, in the order of `evaluate`."""
        return moving_points(self.mechanism.topology)

    @property
    def order(self) -> int:
        """Total degree of its series."""
        return self.stored.order

    @cached_property
    def mechanism(self) -> Mechanism:
        """The mechanism of the scene."""
        return scene_mechanism(self.scene)

    @cached_property
    def domain(self) -> Domain:
        """Its ranges, cut into boxes."""
        return Domain(self.mechanism, self.stored.ranges, self.stored.halvings)

    @cached_property
    def bound(self) -> Bound:
        """What is proven of all that it covers."""
        return Bound.of(self.stored.off, self._boxes[1], self.inputs, self._shifted)

    @cached_property
    def _shifted(self) -> float:
        """Rounding of a sum with the mechanism's origin, mm; none where that is zero."""
        origin = float(np.abs(self.mechanism.origin).max())
        reach = float(np.abs(self.stored.coefficients).sum(axis=1).max())
        return 1.01 * UNIT_ROUNDOFF * (origin + reach) if origin > 0.0 else 0.0

    @property
    def patches(self) -> tuple[Patch, ...]:
        """Its patches."""
        half, off = self._boxes[1], self.stored.off
        found = []
        for place in range(len(half)):
            here = slice(place, place + 1)
            bound = Bound.of(Jet(*(part[here] for part in off.parts)), half[here], self.inputs, self._shifted)
            ranges = self._ranges_of(self.stored.low[place], self.stored.high[place])
            condition, rest = self.stored.condition[place], self.stored.contraction[place]
            found.append(Patch(ranges, bound, float(condition), float(rest)))
        return tuple(found)

    @property
    def uncovered(self) -> tuple[Uncovered, ...]:
        """Where nothing is proven."""
        boxes = zip(self.stored.gap_low, self.stored.gap_high, self.stored.gap_reason, strict=True)
        return tuple(
            Uncovered(self._ranges_of(low, high), self.stored.reasons[reason]) for low, high, reason in boxes
        )

    @cached_property
    def share_covered(self) -> float:
        """Share of its range that is covered, 0 to 1."""
        covered = (self.stored.high - self.stored.low).prod(axis=-1).sum()
        return float(covered / self.domain.parts ** len(self.inputs))

    def __repr__(self) -> str:
        over = ", ".join(f"{name} {low:.6g} to {high:.6g}" for name, (low, high) in self.ranges.items())
        count, bound = len(self.stored.low), self.bound.position
        part = "" if self.share_covered == 1.0 else f", {self.share_covered:.1%} covered"
        return (
            f"<KinematicMap over {over}{part}: {count} patches of order {self.order} within {bound:.2g} mm>"
        )

    def __call__(
        self,
        inputs: Mapping[str, ArrayLike],
        rates: Mapping[str, ArrayLike] | None = None,
        accelerations: Mapping[str, ArrayLike] | None = None,
        bounds: bool = False,
    ) -> MappedPoses:
        """Poses at some inputs, and their time derivatives where the inputs' own are given.

        Args:
            inputs: of each input that is not held, numbers or arrays that broadcast to one shape, rad or mm;
                what moves the chassis may be given too, and is zero if it is not.
            rates, accelerations: likewise, per s and per s^2.
            bounds: whether to prove how far each number is off, at its own pose, for the inputs as they are
                given; of 1,000 poses and more with both rates it takes some seven times as long.
        Returns:
            Positions of all points, their velocities and accelerations where rates and accelerations are
            given, and the scene's effects as far as these are known.
        Raises:
            UnknownName: an input that is missing, or that there is not.
            InputOutOfRange: a value outside the map's range, or a rate that is not finite.
            NotCovered: inputs at which nothing is proven.
            NotComputed: accelerations without rates.
            MapError: what is no number, or shapes that do not broadcast.
        """
        given = [inputs] if rates is None else [inputs, rates]
        if accelerations is not None:
            if rates is None:
                raise _needs_rates()
            given.append(accelerations)
        states, laws, shape = self._split(given)
        found = self.evaluate(*states)
        places = [
            self._chassis(d, shape) | {name: state[..., i, :] for i, name in enumerate(self.points)}
            for d, state in enumerate(found)
        ]
        numbers = self._read(places, laws)
        if not bounds:
            return MappedPoses(numbers)
        return MappedPoses(numbers, self._bounds(states, found, laws, numbers))

    def evaluate(
        self, values: ArrayLike, rates: ArrayLike | None = None, accelerations: ArrayLike | None = None
    ) -> Array:
        """States of the points that move as one array, for loops that call it often.

        The chassis stands still: nothing is added for what moves it.

        Args:
            values: inputs in the order of `inputs`, shape (..., p), rad or mm.
            rates, accelerations: their time derivatives, likewise.
        Returns:
            Shape (1 to 3 derivatives, ..., points, 3), mm from the mechanism's origin (`mechanism.origin`,
            zero for a car that is drawn near the user's), per s^d.
        Raises:
            InputOutOfRange: a value outside the map's range, or a rate that is not finite.
            NotCovered: inputs at which nothing is proven.
            MapError: an array without a column for each input, or not of numbers.
        """
        states = [_numbers(STATES[0], values)]
        if rates is None and accelerations is None and states[0].shape == self._single_shape:
            place = states[0].tolist()
            return self._ready[self._patch_of(place)].at(place).reshape(1, -1, 3)
        if accelerations is not None and rates is None:
            raise _needs_rates()
        given = zip(STATES[1:], (rates, accelerations), strict=True)
        states += [_numbers(what, state) for what, state in given if state is not None]
        for d, state in enumerate(states):
            if state.shape[-1:] != (len(self.inputs),):
                allowed = f"(..., {len(self.inputs)}), a column for each of {', '.join(self.inputs)}"
                raise MapError(STATES[d], f"have the shape {state.shape}", allowed)
            if d > 0 and not np.isfinite(state).all():
                place = tuple(np.argwhere(~np.isfinite(state))[0])
                raise InputOutOfRange(
                    self.inputs[place[-1]], float(state[place]), f"{STATES[d]} that are finite"
                )
        middle, half = self._boxes
        table, order = self.stored.coefficients, self.order
        if all(state.ndim == 1 for state in states):
            single = [state.tolist() for state in states]
            return self._ready[self._patch_of(single[0])].moving(single).reshape(len(states), -1, 3)
        batch = _common_shape([state.shape[:-1] for state in states], "arrays")
        flat = [np.broadcast_to(s, (*batch, len(self.inputs))).reshape(-1, len(self.inputs)) for s in states]
        patch = self._patches_of(flat[0])
        found = sum_series(table, middle, half, order, patch, flat)
        return found.reshape(len(states), *batch, len(self.points), 3)

    def __reduce__(self) -> tuple[type[KinematicMap], tuple[Scene, float, Stored]]:
        """What is made of it for quicker calls is made again."""
        return type(self), (self.scene, self.tolerance, self.stored)

    def covers(self, inputs: Mapping[str, ArrayLike]) -> NDArray[np.bool_]:
        """Whether poses are covered, of the inputs' shape; False outside the ranges too."""
        (values,), _, _ = self._split([inputs])
        low, high = self.domain.ends
        inside = np.asarray(((values >= low) & (values <= high)).all(axis=-1))
        number = self._lookup.at(np.where(inside[..., None], values, low))
        return np.asarray(inside & (number >= 0))

    def save(self, path: str | PathLike[str]) -> None:
        """Write it to an npz file, which `load` and any program that reads numpy's files can read.

        Raises:
            MapError: the file cannot be written.
        """
        write(path, self.scene, self.tolerance, self.stored)

    @classmethod
    def load(cls, path: str | PathLike[str]) -> KinematicMap:
        """Read a map that was saved.

        Raises:
            MapError: there is no such file, it is another one, of another version, or damaged.
        """
        return cls(*read(path))

    def _chassis(self, derivative: int, shape: tuple[int, ...]) -> dict[str, Array]:
        """The points of the chassis, which are where they are drawn, (..., 3), mm."""
        mechanism, factor = self.mechanism, 0.0 if derivative else float(self.mechanism.unit)
        vectors = mechanism.drawing.vectors
        names = mechanism.topology.chassis
        return {name: np.broadcast_to(vectors[name] * factor, (*shape, 3)) for name in names}

    @cached_property
    def _boxes(self) -> tuple[Array, Array]:
        """Middles and half widths of the patches, (P, p)."""
        return self.domain.middle_and_half(self.stored.low, self.stored.high)

    @cached_property
    def _lookup(self) -> Lookup:
        """The patch of each of the smallest boxes, or -1 - the place of the reason why there is none."""
        lookup = Lookup.of(self.domain, self.stored.low, self.stored.high)
        boxes = zip(self.stored.gap_low, self.stored.gap_high, self.stored.gap_reason, strict=True)
        for low, high, reason in boxes:
            lookup.table[part_of(low, high)] = -1 - reason
        return lookup

    def _ranges_of(self, low: Whole, high: Whole) -> Ranges:
        """The ranges of a box."""
        first, last = self.domain.inputs_at(2 * low), self.domain.inputs_at(2 * high)
        return {name: (float(first[i]), float(last[i])) for i, name in enumerate(self.inputs)}

    def _patches_of(self, values: Array) -> Whole:
        """The patch of each pose, (N, p) to (N,)."""
        low, high = self.domain.ends
        for i, name in enumerate(self.inputs):
            column = values[:, i]
            # False for what is not a number as well.
            if column.size and not (column.min() >= low[i] and column.max() <= high[i]):
                worst = column[~((column >= low[i]) & (column <= high[i]))][0]
                raise self._out_of_range(name, float(worst))
        if self._lookup.single:
            return np.zeros(len(values), dtype=np.int64)
        number = self._lookup.at(values)
        if (number < 0).any():
            gaps = np.flatnonzero(number < 0)
            raise self._not_covered(values[gaps[0]], int(number[gaps[0]]), len(gaps), len(values))
        return number

    @cached_property
    def _single_shape(self) -> tuple[int]:
        """Of one pose's inputs."""
        return (len(self.inputs),)

    @cached_property
    def _ready(self) -> tuple[OnePatch, ...]:
        """The patches, for one pose at a time."""
        parts = zip(self.stored.coefficients, *self._boxes, strict=True)
        return tuple(OnePatch.of(table, middle, half, self.order) for table, middle, half in parts)

    @cached_property
    def _ends(self) -> tuple[list[tuple[str, float, float, float]], int, memoryview]:
        """Each input with its ends and the smallest boxes per unit, how many of these lie along a range, and
        the patch of each of them."""
        table = np.ascontiguousarray(self._lookup.table).ravel()
        return list(zip(self.inputs, *self._lookup.corner, strict=True)), self.domain.parts, table.data

    def _patch_of(self, value: list[float]) -> int:
        """The patch of one pose."""
        ends, parts, table = self._ends
        box = 0
        for number, (name, low, high, along) in zip(value, ends, strict=True):
            if not low <= number <= high:
                raise self._out_of_range(name, number)
            place = int((number - low) * along)
            box = box * parts + (place if place < parts else parts - 1)
        patch: int = table[box]
        if patch < 0:
            raise self._not_covered(np.array(value), patch, 1, 1)
        return patch

    def _out_of_range(self, name: str, value: float) -> InputOutOfRange:
        low, high = self.stored.ranges[name]
        unit = self.mechanism.topology.input_units[name]
        return InputOutOfRange(name, value, f"{low:.10g} to {high:.10g} {unit}, the range of this map")

    def _not_covered(self, value: Array, number: int, count: int, asked: int) -> NotCovered:
        inputs = {name: float(value[i]) for i, name in enumerate(self.inputs)}
        return NotCovered(inputs, self.stored.reasons[-1 - number], count, asked)

    def _split(
        self, given: Sequence[Mapping[str, ArrayLike]]
    ) -> tuple[list[Array], dict[str, list[Array]], tuple[int, ...]]:
        """The map's inputs as columns, (..., p); what moves the chassis by input and derivative, each of the
        poses' shape, (...); and this shape.
        """
        topology = self.mechanism.topology
        held = {name: low for name, (low, high) in self.stored.ranges.items() if low == high}
        for d, state in enumerate(given):
            if not isinstance(state, Mapping):
                raise MapError(STATES[d], f"is a {type(state).__name__}", "numbers or arrays by input")
            kind = ("input", "input with a rate", "input with an acceleration")[d]
            for name in state:
                if name not in topology.inputs:
                    raise UnknownName(kind, name, topology.inputs)
                wanted = held.get(name) if d == 0 else 0.0 if name in held else None
                value = np.ravel(_numbers(f"values of {kind} {name!r}", state[name]))
                if wanted is not None and (value != wanted).any():
                    worst = float(value[np.argmax(value != wanted)])
                    raise InputOutOfRange(name, worst, f"{wanted:.10g}, as the map holds this input")
            for name in self.inputs:
                if name not in state:
                    raise UnknownName(f"given {kind}", name, state)
        arrays = [{name: np.asarray(value, dtype=float) for name, value in state.items()} for state in given]
        shape = _common_shape([value.shape for state in arrays for value in state.values()], "inputs")
        columns = [
            np.stack([np.broadcast_to(state[name], shape) for name in self.inputs], axis=-1)
            for state in arrays
        ]
        named = (name for name in self._motion.directions if any(name in state for state in arrays))
        laws = {
            name: [np.broadcast_to(state.get(name, np.zeros(())), shape) for state in arrays]
            for name in named
        }
        for name, law in laws.items():
            for value in law:
                if not np.isfinite(value).all():
                    raise InputOutOfRange(name, float(value[~np.isfinite(value)][0]), "finite values")
        return columns, laws, shape

    @cached_property
    def _motion(self) -> ChassisMotion:
        """How the chassis moves by what is given."""
        return ChassisMotion.of(self.mechanism, {})

    def _bounds(
        self,
        states: Sequence[Array],
        found: Array,
        laws: Mapping[str, Sequence[Array]],
        numbers: Mapping[str, Channel],
    ) -> dict[str, dict[str, Array]]:
        """Proven errors of all numbers, of their shapes."""
        flat = [np.ascontiguousarray(state).reshape(-1, len(self.inputs)) for state in states]
        count = len(flat[0])
        axes = CarAxes.of(self.mechanism.drawing, self.scene.mechanism.outboard)

        def one_by_one(array: Array, of: str) -> Array:
            return array.reshape((count,) if of == "car" else (count, 3))

        evaluated = Evaluated(
            self.mechanism,
            axes,
            self.points,
            self.stored.off,
            self._boxes[1],
            self._patches_of(flat[0]),
            flat[1:],
            found.reshape(len(flat), count, len(self.points), 3),
            self._motion,
            {name: [value.reshape(count) for value in law] for name, law in laws.items()},
            {
                quantity: {name: one_by_one(array, channel.quantity.of) for name, array in channel.items()}
                for quantity, channel in numbers.items()
            },
        )
        bounds = evaluated.bounds(self._effects[len(states) - 1])
        return {
            quantity: {name: array.reshape(numbers[quantity][name].shape) for name, array in arrays.items()}
            for quantity, arrays in bounds.items()
            if arrays
        }

    @cached_property
    def _effects(self) -> tuple[tuple[Effect, ...], tuple[Effect, ...], tuple[Effect, ...]]:
        """What is evaluated with values alone, with rates, and with accelerations."""
        asked = plan_effects((*self.scene.effects, *POINT_STATES)).computed
        always = set(POINT_STATES)
        found = []
        for derivative in range(3):
            states = [e for e in asked if e.name not in always or e.derivative <= derivative]
            found.append(tuple(e for e in states if e.derivative <= derivative))
        return found[0], found[1], found[2]

    def _read(
        self, places: Sequence[Mapping[str, Array]], laws: Mapping[str, Sequence[Array]]
    ) -> dict[str, Channel]:
        """Effects of states in the chassis' frame, which moves."""
        mechanism = self.mechanism
        places = self._motion.turned_by(laws, places)
        flat = {name: [value.ravel() for value in law] for name, law in laws.items()}
        shape = next((law[0].shape for law in laws.values()), ())
        lifts: list[Array | None] = [s.reshape(*shape, 3) for s in self._motion.shifts(flat)]
        axes = CarAxes.of(mechanism.drawing, self.scene.mechanism.outboard)
        origin = mechanism.origin if mechanism.origin.any() else None
        added = lifts or [None] * len(places)
        if origin is not None:
            added[0] = origin if added[0] is None else origin + added[0]
        poses = Poses(mechanism, axes, states=places, added=added)
        found: dict[str, dict[str, Array]] = {quantity: {} for quantity in QUANTITIES}
        computed = self._effects[len(places) - 1]
        for effect in computed:
            for quantity, arrays in effect.evaluate(poses).items():
                found[quantity] |= arrays
        missing = [effect for effect in EFFECTS.values() if effect not in computed]
        numbers = {}
        for name, arrays in found.items():
            left_out = {e.name: e.gives_numbers[name] for e in missing if name in e.gives_numbers}
            numbers[name] = Channel(QUANTITIES[name], arrays, left_out)
        return numbers


STATES = ("values", "rates", "accelerations")
POINT_STATES = tuple(n for n, e in EFFECTS.items() if all(q.of == "point" for q in e.quantities))
"""Effects that a map gives wherever it is told the rates."""


def _needs_rates() -> NotComputed:
    return NotComputed("an acceleration of a point", "", "give the rates of the inputs as well")


def kinematic_map(
    scene: Scene, ranges: Ranges, tolerance: float = 1e-9, halvings: int = HALVINGS
) -> KinematicMap:
    """Solve a scene's suspension as a function of its inputs.

    Args:
        scene: whose suspension; the laws of its inputs and its instants are not looked at.
        ranges: the lower and the upper end of each input that drives it, rad or mm; one whose ends are the
            same is held there. What moves the chassis has none: it may be anything.
        tolerance: largest proven bound of a position, mm, on every patch, in the chassis' frame and near the
            mechanism: what a far origin rounds comes to it.
        halvings: how often the range of an input is halved at most, towards places where assemblies end.
    Returns:
        A map of all that could be reached and proven; the rest is in its `uncovered`.
    Raises:
        UnknownName: a range that is missing, or of no input that drives the suspension.
        InputOutOfRange: an end at which the input has no meaning.
        MapError: a range, tolerance or number of halvings that makes no map.
        SceneError: the hardpoints do not make a mechanism, or closing them makes another car.
        AssemblyError: the range cannot be reached from the drawing.
        NotCovered: nothing of it can be proven.
        MechanismError: a row that was left out, as it followed from others at the drawing, is violated.

    >>> map = kinematic_map(Scene.load("steer"), {"arm_angle": (0.9, 1.1), "rack": (-10.0, 10.0)})
    >>> map({"arm_angle": 1.0, "rack": [0.0, 5.0]}).position["wheel_centre"].shape
    (2, 3)
    >>> map.bound.position < 1e-9
    True
    """
    require_scene(scene)
    scene = Scene.checked(scene, scene.title or "scene")
    mechanism = scene_mechanism(scene)
    domain = Domain(mechanism, _checked_ranges(mechanism, ranges), _checked_halvings(halvings))
    if not 1 <= len(domain.free) <= VARIABLES:
        raise MapError("ranges", f"leave {len(domain.free)} inputs free", f"1 to {VARIABLES} of them")
    if not (_is_number(tolerance) and np.isfinite(tolerance) and tolerance > 0.0):
        raise MapError("tolerance", f"is {tolerance!r}", "a finite number of mm above 0")
    domain.known_at(np.stack(domain.ends))
    closed = close_drawing(mechanism)
    moved = closing(mechanism, closed.y)
    require_the_drawn_car(scene, moved)
    twice = domain.nearest_place(mechanism.input_values(closed.y[mechanism.map.unknowns :]))
    values = domain.inputs_at(twice)
    held = {name: np.array(low) for name, (low, high) in domain.ranges.items() if low == high}
    start = assemble(mechanism, held | dict(zip(domain.free, values, strict=True)), None, closed)
    order = order_for(tolerance, float(mechanism.unit), 0, len(domain.free))
    cover = flood(domain, order, Limits(tolerance), (twice, start.y), MOST)
    reasons = tuple(dict.fromkeys(reason for _, reason in cover.given_up))
    if cover.patches is None:
        inputs = {name: float(value) for name, value in zip(domain.free, values, strict=True)}
        raise NotCovered(inputs, reasons[0], 1, 1)
    if mechanism.topology.left_out:
        _hold_rows(domain, order, cover.patches)
    return KinematicMap(scene, tolerance, Stored.of(domain, order, cover, reasons))


def _hold_rows(domain: Domain, order: int, patches: Patches) -> None:
    """Look at the rows that were left out, all over some patches.

    A row has products of two coordinates, each a series of the map's order; so of each input it is a
    polynomial of twice that, which between Chebyshev's nodes is nowhere larger than some four times its
    largest value at them (Lebesgue's constant).

    Raises:
        MechanismError: one is violated.
    """
    count = 2 * order + 1
    nodes = np.cos(np.pi * (np.arange(count) + 0.5) / count)
    places = np.stack(np.meshgrid(*[nodes] * len(domain.free), indexing="ij"), -1)
    middle, half = domain.middle_and_half(patches.low, patches.high)
    for number, (centre, width) in enumerate(zip(middle, half, strict=True)):
        values = (centre + width * places).reshape(-1, len(centre))
        patch = np.full(len(values), number)
        unknown = sum_series(patches.series, middle, half, order, patch, [values])[0]
        y = np.concatenate([unknown, domain.known_at(values)], axis=-1)
        held_rows(domain.mechanism, y, np.full(len(values), patches.error[number].max()))


def _checked_halvings(halvings: int) -> int:
    whole = isinstance(halvings, int | np.integer) and not isinstance(halvings, bool)
    if not (whole and 0 <= halvings <= MOST_HALVINGS):
        raise MapError("halvings", f"is {halvings!r}", f"a whole number from 0 to {MOST_HALVINGS}")
    return int(halvings)


def _is_number(value: object) -> bool:
    return isinstance(value, int | float | np.integer | np.floating) and not isinstance(value, bool)


def _numbers(what: str, value: ArrayLike) -> Array:
    """Numbers as doubles."""
    try:
        return np.asarray(value, dtype=float)
    except (TypeError, ValueError) as error:
        raise MapError(what, f"cannot be read as numbers: {error}", "numbers or arrays of them") from error


def _common_shape(shapes: Sequence[tuple[int, ...]], what: str) -> tuple[int, ...]:
    """The shape that some broadcast to."""
    try:
        return np.broadcast_shapes(*shapes)
    except ValueError as error:
        told = ", ".join(map(str, dict.fromkeys(shapes)))
        raise MapError(what, f"have the shapes {told}", "shapes that broadcast to one") from error


def _checked_ranges(mechanism: Mechanism, ranges: Ranges) -> dict[str, tuple[float, float]]:
    """The range of each driving input, in their order."""
    topology = mechanism.topology
    if not isinstance(ranges, Mapping):
        raise MapError("ranges", f"is a {type(ranges).__name__}", "a pair of numbers by input")
    for name in ranges:
        if name in topology.chassis_inputs:
            raise MapError(
                f"ranges[{name!r}]",
                "is given",
                "no range: it moves the whole chassis, whatever it is",
            )
        if name not in topology.required_inputs:
            raise UnknownName("driving input", name, topology.required_inputs)
    found = {}
    for name in topology.required_inputs:
        if name not in ranges:
            raise UnknownName("range of an input", name, ranges)
        try:
            low, high = (float(end) for end in ranges[name])
        except (TypeError, ValueError):
            low, high = np.nan, np.nan
        if not (np.isfinite(low) and np.isfinite(high) and low <= high):
            raise MapError(
                f"ranges[{name!r}]",
                f"is {ranges[name]!r}",
                "two finite numbers, the lower first; the same to hold it",
            )
        if max(abs(low), abs(high)) > FARTHEST or 0.0 < high - low < NARROWEST:
            raise MapError(
                f"ranges[{name!r}]",
                f"is {ranges[name]!r}",
                f"ends within {FARTHEST:g} that are {NARROWEST:g} apart at least, or the same to hold it",
            )
        found[name] = (low + 0.0, high + 0.0)
    return found
