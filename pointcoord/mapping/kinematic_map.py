r"""A suspension's kinematics as a function of its inputs: solved once, proven, and fast to evaluate.

    map = kinematic_map(Scene.load("steer"), {"arm_angle": (0.9, 1.1), "rack": (-10.0, 10.0)})
    map({"arm_angle": angles, "rack": racks}).position["wheel_centre"]      # mm, of the inputs' shape

The positions depend on time through the inputs only, p(t) = Y(a(t), b(t)). The map stores Y as power series
in the inputs, on patches with a proven error bound each. Any laws of the inputs can be composed with it:

    v = Y_a a' + Y_b b',    acceleration = Y_a a'' + Y_b b'' + Y_aa a'^2 + 2 Y_ab a' b' + Y_bb b'^2.

The motion of the chassis (heave, roll) is added afterwards. The branch is that of the drawing: patches are
proven outwards from the closed drawing (see `flood`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cached_property
from itertools import chain
from math import isfinite
from os import PathLike, fspath
from types import MappingProxyType
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike

from pointcoord.effects.effect import Effect
from pointcoord.effects.registry import EFFECTS, Plan, plan_effects
from pointcoord.errors import InputOutOfRange, NotComputed, NotCovered, WrongArgument
from pointcoord.linkage.chassis import ChassisMotion
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.mapping.asked import STATES, Ranges, checked_ranges, columns_of, numbers_of
from pointcoord.mapping.effect_bounds import Evaluated
from pointcoord.mapping.stored import ALLOWED, Gaps, packed, unpacked
from pointcoord.mechanism.freedoms import locked
from pointcoord.numerics.arrays import Array, Flags, Integers
from pointcoord.numerics.rounding import UNIT_ROUNDOFF
from pointcoord.patches.domain import Domain
from pointcoord.patches.evaluation import sum_one, table_of_exponents
from pointcoord.patches.flood import Limits, flood, start_at_drawing
from pointcoord.patches.lookup import Lookup, part_of
from pointcoord.patches.patches import Patches, ProvenPatches
from pointcoord.patches.reported_points import moving_points
from pointcoord.results.closing import closing
from pointcoord.results.read_only import ReadOnly
from pointcoord.results.readout import Readout
from pointcoord.results.samples import Channel, Named
from pointcoord.scene.scene_file import Scene
from pointcoord.simulation import require_scene, require_the_drawn_car, scene_mechanism
from pointcoord.solve.assembly import close_drawing

T = TypeVar("T")

HALVINGS = 6  # 64 smallest boxes along a range
MOST_HALVINGS = 10  # a table of 2^20 boxes for two inputs
VARIABLES = 3  # with more inputs even a series of the lowest order has too many powers


@dataclass(frozen=True)
class Bound:
    """Error bounds of positions, velocities and accelerations of points, for the whole map.

    With x the inputs, the error of a velocity is at most sum_i velocity[i] |x_i'|, and the error of an
    acceleration at most sum_i velocity[i] |x_i''| + sum_ij acceleration[i, j] |x_i'| |x_j'|, over all pairs
    i, j in both orders.

    Attributes:
        position: error bound of every coordinate of a point, mm. Includes the rounding by the user's origin,
            but not the rounding by the chassis' motion, nor that a rotation of the car mixes coordinates.
        velocity: error bound per rate of an input, by input, mm per rad or mm.
        acceleration: error bound per product of two rates, by two inputs, mm per the product of their units.
    """

    position: float
    velocity: Mapping[str, float]
    acceleration: Mapping[tuple[str, str], float]


@dataclass(frozen=True)
class Uncovered:
    """A box of inputs in which nothing is proven, and the reason."""

    ranges: Ranges
    reason: str


@dataclass(frozen=True, repr=False)
class MappedPoses(Named):
    """The numbers of a map at some inputs.

    Attributes:
        numbers: numbers by quantity and name, (..., 3) of points and bodies and (...) of the car, for inputs
            of shape (...); see `effects.registry.QUANTITIES` for all quantities and their units.
        bounds: proven error bound of each number, in arrays of the same shapes; empty unless requested.
    """

    numbers: Mapping[str, Channel]
    bounds: Mapping[str, Mapping[str, Array]] = field(default_factory=dict)


@dataclass(frozen=True, repr=False)
class KinematicMap(ReadOnly):
    """A scene's suspension as a function of its inputs; make one with `kinematic_map`.

    A map can be pickled, and saved to a file that another program can read.

    Attributes:
        scene: the scene with the suspension and the effects.
        tolerance: largest error bound of a position on any patch, before the user's origin is added, mm.
        series: the patches, read-only.
        gaps: corners of the boxes that are not covered, each with the reason.
    """

    scene: Scene
    tolerance: float
    series: Patches
    gaps: Gaps

    @property
    def ranges(self) -> Ranges:
        """Range of every input that drives the suspension, rad or mm; a held input has two equal ends."""
        return MappingProxyType(dict(self.domain.ranges))

    @cached_property
    def inputs(self) -> tuple[str, ...]:
        """The free inputs, of which the map is a function, in the order of `evaluate`."""
        return self.domain.free

    @cached_property
    def points(self) -> tuple[str, ...]:
        """The points that move, in the order of `evaluate`."""
        return moving_points(self.mechanism.topology)

    @property
    def order(self) -> int:
        """Total degree of the series."""
        return self.series.order

    @property
    def mechanism(self) -> Mechanism:
        """The mechanism of the scene."""
        return self.domain.mechanism

    @property
    def domain(self) -> Domain:
        """The ranges, divided into boxes."""
        return self.series.domain

    @cached_property
    def bound(self) -> Bound:
        """Error bounds that hold on all patches."""
        off, half, names = self.series.off, self.series.boxes[1], self.inputs
        # Derivatives by shares of the half widths become derivatives by inputs; the largest of all patches.
        first = (off.first.max(axis=-1) / half).max(axis=0)
        second = (off.second.max(axis=-1) / (half[:, :, None] * half[:, None])).max(axis=0)
        # Adding the mechanism's origin rounds once, unless the origin is zero.
        origin = float(np.abs(self.mechanism.origin).max())
        reach = float(np.abs(self.series.coefficients).sum(axis=1).max())
        return Bound(
            float(off.value.max()) + (1.01 * UNIT_ROUNDOFF * (origin + reach) if origin > 0.0 else 0.0),
            {name: float(first[i]) for i, name in enumerate(names)},
            {(a, b): float(second[i, j]) for i, a in enumerate(names) for j, b in enumerate(names)},
        )

    @property
    def uncovered(self) -> tuple[Uncovered, ...]:
        """The boxes in which nothing is proven, with reasons."""
        found = []
        for key, reason in self.gaps:
            ends = self.domain.inputs_at(2 * np.array(key)).T.tolist()
            ranges = {name: (low, high) for name, (low, high) in zip(self.inputs, ends, strict=True)}
            found.append(Uncovered(ranges, reason))
        return tuple(found)

    @cached_property
    def share_covered(self) -> float:
        """Share of the ranges' volume that is covered, 0 to 1."""
        covered = (self.series.high - self.series.low).prod(axis=-1).sum()
        return float(covered / self.domain.parts ** len(self.inputs))

    def __repr__(self) -> str:
        over = ", ".join(f"{name} {low:.6g} to {high:.6g}" for name, (low, high) in self.ranges.items())
        count, bound = len(self.series.low), self.bound.position
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
        """Poses at some inputs, and their time derivatives if rates of the inputs are given.

        Args:
            inputs: values of every free input, numbers or arrays that broadcast to one shape, rad or mm.
                Inputs that move the chassis may be given as well, and are zero otherwise.
            rates, accelerations: rates and accelerations of the inputs, likewise, per s and per s^2.
            bounds: whether to prove an error bound of each number at each pose, with the given inputs as
                exact. For 1,000 or more poses with rates and accelerations this takes about seven times as
                long.
        Returns:
            Positions of all points; velocities and accelerations if rates and accelerations are given; and
            the scene's effects for which enough is given.
        Raises:
            UnknownName: an input that is missing, or that does not exist.
            InputOutOfRange: a value outside the map's range, or a rate that is not finite.
            NotCovered: inputs at which nothing is proven.
            NotComputed: accelerations without rates.
            WrongArgument: a value that is not a number, or shapes that do not broadcast.
        """
        given = _states(inputs, rates, accelerations)
        states, laws, shape = columns_of(self.domain, given)
        readout, patch = self._readouts[len(states) - 1], self._patches_of(states)
        rows = readout.room(len(patch))
        found = readout.states(rows)
        # The first rows of a table are those of the moving points, by derivative.
        height = 3 * len(self.points)
        places = [rows[d * height : (d + 1) * height] for d in range(len(states))]
        sums = self.series.sums(self.series.coefficients, states, patch, places)
        moving = [part.copy() for part in sums] if bounds else sums
        readout.complete(laws, found, rows)
        samples = readout.table.named(np.zeros(len(patch)), rows)
        numbers = samples.shaped(shape).numbers
        if not bounds:
            return MappedPoses(numbers)
        evaluated = Evaluated(self.series, readout, patch, states[1:], moving, laws, samples.numbers)
        return MappedPoses(numbers, evaluated.bounds(shape))

    def evaluate(
        self,
        values: Sequence[float] | Array,
        rates: Sequence[float] | Array | None = None,
        accelerations: Sequence[float] | Array | None = None,
    ) -> Array:
        """States of the moving points at one pose, for time loops; fifty times as fast as a call of the map.

        The chassis stands still: no motion of the chassis is added.

        Args:
            values: inputs in the order of `inputs`, (p,), rad or mm.
            rates, accelerations: rates and accelerations of the inputs, likewise.
        Returns:
            Shape (1 to 3 derivatives, points, 3), mm per s^d, from the mechanism's origin
            (`mechanism.origin`, zero for a car that is drawn near the user's origin).
        Raises:
            InputOutOfRange: a value outside the map's range, or a rate that is not finite.
            NotCovered: inputs at which nothing is proven.
            WrongArgument: an array that does not have one number for each input.
        """
        states = []
        for what, given in zip(STATES, _states(values, rates, accelerations), strict=False):
            state = numbers_of(what, given)
            if state.shape != self._shape:
                allowed = f"{self._shape}, a number for each of {', '.join(self.inputs)}"
                raise WrongArgument(what, f"have the shape {state.shape}", allowed)
            states.append(state.tolist())
        number = self._lookup.at_one(states[0])
        if number < 0 or not all(map(isfinite, chain(*states[1:]))):
            self._patches_of([np.array([state]) for state in states])  # raises the error
        ready = self._ready[number]
        if ready is None:
            boxes = np.stack(self.series.boxes, axis=-1)[number].tolist()
            parts = table_of_exponents(self.series.coefficients[number], len(boxes), self.order)
            ready = self._ready[number] = (boxes, *parts)
        boxes, first, table = ready
        local = [[(x - middle) / half for x, (middle, half) in zip(states[0], boxes, strict=True)]]
        for state in states[1:]:
            local.append([x / half for x, (_, half) in zip(state, boxes, strict=True)])
        return sum_one(first, table, local).reshape(len(states), -1, 3)

    @cached_property
    def _shape(self) -> tuple[int]:
        return (len(self.inputs),)

    @cached_property
    def _ready(self) -> list[tuple[list[list[float]], Array, Array] | None]:
        """Box and table of exponents of each patch, filled when `evaluate` first uses the patch."""
        return [None] * len(self.series.low)

    def covers(self, inputs: Mapping[str, ArrayLike]) -> Flags:
        """Whether poses are covered, in the inputs' shape; False also outside the ranges."""
        (values,), _, shape = columns_of(self.domain, [inputs])
        low, high = self.domain.ends
        inside = np.asarray(((values >= low) & (values <= high)).all(axis=-1))
        number = self._lookup.at(np.where(inside[:, None], values, low))
        return np.asarray(inside & (number >= 0)).reshape(shape)

    def save(self, path: str | PathLike[str]) -> None:
        """Write the map to an npz file for `load`, or any program that reads numpy's files.

        Raises:
            WrongArgument: the file cannot be written.
        """
        data = packed((self.scene, self.tolerance, self.series, self.gaps))
        with _of_file(path, "written", "a path to write to"), open(path, "wb") as stream:
            stream.write(data)

    @classmethod
    def load(cls, path: str | PathLike[str]) -> KinematicMap:
        """Read a saved map.

        Raises:
            WrongArgument: the file does not exist, is not a map, is of another version, or is damaged.
        """
        with _of_file(path, "read", ALLOWED), open(path, "rb") as stream:
            data = stream.read()
        return cls(*unpacked(data, f"file {fspath(path)!r}"))

    @cached_property
    def _lookup(self) -> Lookup:
        """Number of the patch of each smallest box, or -1 - the number of its gap."""
        table = self.series.lookup.table.copy()
        for number, ((low, high), _) in enumerate(self.gaps):
            table[part_of(low, high)] = -1 - number
        return Lookup(self.domain, table)

    def _patches_of(self, states: Sequence[Array]) -> Integers:
        """Number of the patch of each pose, (N,), from the inputs and their rates, each (N, p).

        Raises:
            InputOutOfRange: a value outside the map's range, or a rate that is not finite.
            NotCovered: inputs at which nothing is proven.
        """
        low, high = self.domain.ends
        units = self.mechanism.topology.input_units
        for d, state in enumerate(states):
            # False for NaN as well.
            good = (state >= low) & (state <= high) if d == 0 else np.isfinite(state)
            if not good.all():
                row, i = np.argwhere(~good)[0]
                name = self.inputs[i]
                allowed = f"{low[i]:.10g} to {high[i]:.10g} {units[name]}, the range of this map"
                raise InputOutOfRange(
                    name, float(state[row, i]), allowed if d == 0 else f"finite {STATES[d]}"
                )
        number = self._lookup.at(states[0])
        if (number < 0).any():
            gaps = np.flatnonzero(number < 0)
            inputs = dict(zip(self.inputs, states[0][gaps[0]].tolist(), strict=True))
            raise NotCovered(inputs, self.gaps[-1 - number[gaps[0]]][1], len(gaps), len(number))
        return number

    @cached_property
    def _readouts(self) -> tuple[Readout, ...]:
        """The readouts for values alone, with rates, and with accelerations."""
        asked = plan_effects((*self.scene.effects, *POINT_STATES)).computed
        still, axes = ChassisMotion.of(self.mechanism, {}), self.scene.mechanism.axes
        return tuple(
            Readout(self.mechanism, Plan(tuple(e for e in asked if e.derivative <= d)), still, axes)
            for d in range(len(STATES))
        )


POINT_STATES = tuple(
    name for name, effect in EFFECTS.items() if effect.reports_states and effect.derivative < len(STATES)
)
"""Effects that report the states of points, which a map gives whenever the rates are given."""


def _states(values: T, rates: T | None, accelerations: T | None) -> list[T]:
    if accelerations is not None and rates is None:
        raise NotComputed("an acceleration of a point", "", "give the rates of the inputs as well")
    return [state for state in (values, rates, accelerations) if state is not None]


def kinematic_map(
    scene: Scene, ranges: Ranges, tolerance: float = 1e-9, halvings: int = HALVINGS
) -> KinematicMap:
    """Solve a scene's suspension as a function of its inputs.

    Args:
        scene: the scene with the suspension; the laws of its inputs and its instants are not used.
        ranges: lower and upper end of the range of each input that drives the suspension, rad or mm; an input
            with two equal ends is held. An input that moves the chassis has no range and may have any value,
            unless a height over the ground is driven.
        tolerance: largest proven error bound of a position, mm, on every patch, in the chassis' frame from
            the mechanism's origin. The rounding by a far origin is added.
        halvings: most halvings of the range of an input, towards poses where assemblies end.
    Returns:
        A map of all inputs that could be reached and proven; the others are in its `uncovered`.
    Raises:
        UnknownName: a range that is missing, or of an input that does not drive the suspension.
        InputOutOfRange: an end outside the values that the input can have.
        WrongArgument: a range, tolerance or number of halvings that is not allowed.
        SceneError: the hardpoints do not make a mechanism, or closing the drawing makes another car.
        AssemblyError: the ranges cannot be reached from the drawing.
        NotCovered: nothing in the ranges can be proven.
        MechanismError: an equation that was left out, as it followed from others in the drawing, is violated.

    >>> map = kinematic_map(Scene.load("steer"), {"arm_angle": (0.9, 1.1), "rack": (-10.0, 10.0)})
    >>> map({"arm_angle": 1.0, "rack": [0.0, 5.0]}).position["wheel_centre"].shape
    (2, 3)
    >>> map.bound.position < 1e-9
    True
    """
    require_scene(scene)
    scene = Scene.checked(scene, scene.title or "scene")
    mechanism = scene_mechanism(scene)
    whole = isinstance(halvings, int | np.integer) and not isinstance(halvings, bool)
    if not (whole and 0 <= halvings <= MOST_HALVINGS):
        raise WrongArgument("halvings", f"is {halvings!r}", f"a whole number from 0 to {MOST_HALVINGS}")
    domain = Domain(mechanism, checked_ranges(mechanism, ranges), int(halvings))
    if not 1 <= len(domain.free) <= VARIABLES:
        raise WrongArgument("ranges", f"leave {len(domain.free)} inputs free", f"1 to {VARIABLES} of them")
    number = isinstance(tolerance, int | float | np.integer | np.floating) and not isinstance(tolerance, bool)
    if not (number and np.isfinite(tolerance) and tolerance > 0.0):
        raise WrongArgument("tolerance", f"is {tolerance!r}", "a finite number of mm above 0")
    for effect in plan_effects(scene.effects).computed:
        if others := mapped_instead_of(effect):
            raise WrongArgument("effects", f"has {effect.name!r}", others)
    closed = close_drawing(mechanism)
    require_the_drawn_car(scene, closing(mechanism, closed.y))
    start = start_at_drawing(domain, closed)
    cover = flood(domain, Limits(tolerance), start)
    if not len(cover.patches.low):
        values = domain.inputs_at(start[0]).tolist()
        raise NotCovered(dict(zip(domain.free, values, strict=True)), cover.reasons[0], 1, 1)
    if mechanism.topology.left_out:
        _hold_rows(cover.patches)
    return KinematicMap(scene, tolerance, cover.patches.reported, cover.given_up)


def mapped_instead_of(effect: Effect) -> str:
    """The kinds of effects that a map can give, in words, if it cannot give this one; else empty."""
    if effect.way:
        return "effects without derivatives by an input"
    if effect.derivative >= len(STATES):
        return "effects of rates and accelerations; a motion by the method 'map' gives higher ones"
    return ""


def _hold_rows(patches: ProvenPatches) -> None:
    """Check everywhere on the patches that the left-out rows hold.

    A row has products of two coordinates, and each coordinate is a series of the map's order. So the row is
    a polynomial of twice that order in each input. Between the Chebyshev nodes it is at most about 4^p times
    its largest value at the nodes, for p inputs (Lebesgue's constant, once for each input).

    Raises:
        MechanismError: a row is violated.
    """
    domain, count = patches.domain, 2 * patches.order + 1
    nodes = np.cos(np.pi * (np.arange(count) + 0.5) / count)
    places = np.stack(np.meshgrid(*[nodes] * len(domain.free), indexing="ij"), -1)
    for number, (centre, width) in enumerate(zip(*patches.boxes, strict=True)):
        values = (centre + width * places).reshape(-1, len(centre))
        (unknown,) = patches.sums(patches.series, [values], np.full(len(values), number))
        y = np.concatenate([unknown.T, domain.known_at(values)], axis=-1)
        for error in locked(domain.mechanism, y, np.full(len(values), patches.error[number].max())).values():
            raise error


@contextmanager
def _of_file(path: object, done: str, allowed: str) -> Iterator[None]:
    """Turns the errors of reading or writing a file into `WrongArgument`."""
    if not isinstance(path, str | PathLike):
        raise WrongArgument(f"path {path!r}", f"is of type {type(path).__name__}", "the path of a file")
    try:
        yield
    except OSError as error:
        raise WrongArgument(
            f"file {fspath(path)!r}", f"cannot be {done}: {error.strerror or error}", allowed
        ) from error
