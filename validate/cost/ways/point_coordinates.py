"""The library's own methods: a chain of power series, and Newton's method at instants.

What is timed is what `simulate` does, in its own order, without the proofs, which nobody pays for who does
not ask. The set-up reads and checks the drawing, closes it and assembles the start. `solve` finds the
positions of all points, `rates` their velocities and accelerations and those of bodies, `output` the
angles, and hands the arrays over. A chain is summed once for positions and once more for rates, positions
among them: some per cent of what building it takes.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene
from pointcoord.effects.effect import Effect
from pointcoord.effects.plan import Plan
from pointcoord.effects.registry import ALWAYS
from pointcoord.method import CHORD, MAP, NEWTON, NEWTON_COLD, SERIES, Method
from pointcoord.numerics.counters import Work
from pointcoord.results.readout import Readout, States
from pointcoord.results.samples import Samples
from pointcoord.results.states import SolvedStates, StatesAtInstants, StatesOfChain
from pointcoord.results.states_of_map import StatesOfMap
from pointcoord.simulation import (
    Task,
    finest_tolerance,
    pose_tolerance,
    prepare_task,
    solve_by_map,
    solve_by_series,
)
from pointcoord.solve.pointwise import Solved, with_rates
from validate.cost.way import LeftOut, Ready, Setting
from validate.formulations.protocol import Numbers

Array = NDArray[np.float64]

TOLERANCES = tuple(10.0**-digits for digits in range(2, 14))
"""Of positions, mm."""


def tolerance_settings(tolerances: tuple[float, ...] = TOLERANCES) -> tuple[Setting, ...]:
    """A setting for each tolerance of positions."""
    return tuple(Setting(f"{short(tolerance)} mm", tolerance) for tolerance in tolerances)


def short(number: float) -> str:
    """A power of ten in tables, such as `1e-9`."""
    return f"{number:.0e}".replace("e-0", "e-")


@dataclass(frozen=True)
class Series:
    """A chain of power series, dense in time."""

    name: str = "series"
    words: str = "point coordinates, by a chain of power series in time"
    package: str | None = None
    settings: tuple[Setting, ...] = tolerance_settings()
    dense: bool = True

    def prepare(self, scene: Scene, setting: Setting) -> Ready:
        """Assemble the start.

        Raises:
            PointcoordError: the library refuses the scene.
        """
        return ReadyChain(prepared(scene, SERIES, setting))


@dataclass(frozen=True)
class ThroughMap:
    """A map of the inputs along their way, dense in time; making it is set-up, as any law can be composed."""

    name: str = "map"
    words: str = "point coordinates, by series in the inputs on patches, made beforehand"
    package: str | None = None
    settings: tuple[Setting, ...] = tolerance_settings()
    dense: bool = True

    def prepare(self, scene: Scene, setting: Setting) -> Ready:
        """Assemble the start and make the map.

        Raises:
            PointcoordError: the library refuses the scene, or no map covers the way of its inputs.
        """
        task = prepared(scene, MAP, setting)
        states = solve_by_map(task).states
        assert isinstance(states, StatesOfMap)
        require_complete(states)
        return ReadyMap(task, states)


@dataclass(frozen=True)
class AtInstants:
    """A method that solves each instant by itself.

    Attributes:
        method: the library's, or one of its kind.
    """

    name: str
    words: str
    method: Method
    settings: tuple[Setting, ...] = (Setting(),)
    package: str | None = None
    dense: bool = False

    def prepare(self, scene: Scene, setting: Setting) -> Ready:
        """Assemble the start.

        Raises:
            LeftOut: the method does not solve such a suspension.
            PointcoordError: the library refuses the scene.
        """
        return ReadyInstants(prepared(scene, self.method, setting))


def prepared(scene: Scene, method: Method, setting: Setting) -> Task:
    """A scene ready to be solved by a method, to a setting's tolerance or as finely as rounding allows.

    Raises:
        LeftOut: the method does not solve such a suspension.
        PointcoordError: the library refuses the scene.
    """
    part = scene.mechanism
    if part.type not in method.suspensions or part.closure not in method.suspensions[part.type].closures:
        raise LeftOut(method.only or f"{method} does not solve a {part.type} with closure {part.closure!r}")
    # A changed copy is checked again, as `simulate` checks its scene.
    tolerance = finest_tolerance(scene) if setting.value is None else setting.value
    return prepare_task(scene.model_copy(update={"tolerance": tolerance}), method)


@dataclass(frozen=True)
class Parts:
    """What a scene asks for, by the phase that gives it."""

    positions: Readout
    rates: Readout
    rest: Readout

    @classmethod
    def of(cls, readout: Readout) -> Parts:
        """Those of a scene's readout."""
        computed = readout.plan.computed

        def only(effects: tuple[Effect, ...]) -> Readout:
            return replace(readout, plan=Plan(effects))

        return cls(
            positions=only(ALWAYS),
            rates=only(tuple(e for e in computed if e.derivative > 0)),
            rest=only(tuple(e for e in computed if e.derivative == 0 and e not in ALWAYS)),
        )


@dataclass(frozen=True)
class Progress:
    """How far a scene is solved.

    Attributes:
        states: of the solved linkage, to be read.
        places: positions of the points in the chassis' frame, as `Readout.samples` takes them.
        found: what is told, phase by phase.
        work: what it took.
    """

    states: SolvedStates
    instants: Array
    places: States
    found: tuple[Samples, ...]
    work: Work


def told(parts: Parts, progress: Progress) -> Numbers:
    """What was computed, and the angles, which are made of positions."""
    found = progress.found
    if parts.rest.plan.computed:
        found = (*found, parts.rest.samples(progress.instants, progress.places))
    numbers: dict[str, dict[str, Array]] = {}
    for samples in found:
        for quantity, channel in samples.numbers.items():
            if channel.computed:
                numbers.setdefault(quantity, {}).update(channel)
    return numbers


def counted(work: Work) -> dict[str, int]:
    """What was done, as rows count it."""
    counts = {
        "factorisations": work.factorisations,
        "residuals": work.residuals,
        "segments": work.segments,
        "series_orders": work.series_orders,
    }
    return {name: count for name, count in counts.items() if count}


@dataclass(frozen=True)
class ReadyChain:
    """A scene to be solved by series."""

    task: Task

    def solve(self, instants: Array) -> Progress:
        """Build the chain over the whole time, as fine as the rates need it, and sum positions."""
        parts = Parts.of(self.task.readout)
        states = solve_by_series(self.task).states
        assert isinstance(states, StatesOfChain)
        require_complete(states)
        places = replace(states, readout=parts.positions).states(instants)
        work = self.task.start.work + states.chain.work
        return Progress(states, instants, places, (parts.positions.samples(instants, places),), work)

    def rates(self, solved: Progress) -> Progress:
        """Sum the derivatives."""
        readout = Parts.of(self.task.readout).rates
        if not readout.plan.computed:
            return solved
        assert isinstance(solved.states, StatesOfChain)
        states = replace(solved.states, readout=readout).states(solved.instants)
        return replace(solved, found=(*solved.found, readout.samples(solved.instants, states)))

    def output(self, solved: Progress) -> Numbers:
        """All arrays."""
        return told(Parts.of(self.task.readout), solved)

    def counts(self, solved: Progress) -> Mapping[str, int]:
        """The chain's."""
        return counted(solved.work)


@dataclass(frozen=True)
class ReadyMap:
    """A scene whose map is made."""

    task: Task
    states: StatesOfMap

    def solve(self, instants: Array) -> Progress:
        """Sum positions."""
        parts = Parts.of(self.task.readout)
        places = replace(self.states, readout=parts.positions).states(instants)
        samples = parts.positions.samples(instants, places)
        return Progress(self.states, instants, places, (samples,), Work())

    def rates(self, solved: Progress) -> Progress:
        """Sum the derivatives."""
        readout = Parts.of(self.task.readout).rates
        if not readout.plan.computed:
            return solved
        states = replace(self.states, readout=readout).states(solved.instants)
        return replace(solved, found=(*solved.found, readout.samples(solved.instants, states)))

    def output(self, solved: Progress) -> Numbers:
        """All arrays."""
        return told(Parts.of(self.task.readout), solved)

    def counts(self, solved: Progress) -> Mapping[str, int]:
        """None: what the map took is set-up."""
        return counted(solved.work)


@dataclass(frozen=True)
class ReadyInstants:
    """A scene to be solved at each instant by itself."""

    task: Task

    def solve(self, instants: Array) -> Progress:
        """Find the poses, each from the one before, the first from the pose at the scene's start."""
        task, parts = self.task, Parts.of(self.task.readout)
        states = StatesAtInstants(parts.positions, self.at(instants))
        places = states.states(instants)
        work = task.start.work + states.solved.work
        return Progress(states, instants, places, (parts.positions.samples(instants, places),), work)

    def at(self, instants: Array) -> Solved:
        """Poses at increasing instants.

        Raises:
            PointcoordError: one of them cannot be reached.
        """
        task, start = self.task, self.task.scene.time.start
        early = bool(instants[0] > start)
        times = np.concatenate([[start], instants]) if early else instants
        mechanism = task.readout.mechanism
        tolerance = pose_tolerance(task.scene, task.method, mechanism)
        term = task.method.square_velocity_term
        solved = task.method.at_instants(mechanism, task.functions, task.start, times, 0, term, tolerance)
        error = solved.status.error(None)
        if error is not None:
            raise error
        return replace(
            solved,
            times=times[early:],
            states=tuple(y[early:] for y in solved.states),
            left=solved.left[early:],
        )

    def rates(self, solved: Progress) -> Progress:
        """Two linear solves at each pose."""
        readout = Parts.of(self.task.readout).rates
        if not readout.plan.computed:
            return solved
        assert isinstance(solved.states, StatesAtInstants)
        poses, derivative, mechanism = solved.states.solved, readout.plan.derivative, readout.mechanism
        known = mechanism.known_series(
            {name: f.series(solved.instants, derivative) for name, f in self.task.functions.items()}
        )
        full = with_rates(
            mechanism.map,
            poses.states[0],
            known,
            solved.instants,
            derivative,
            self.task.method.square_velocity_term,
            Work(),
            poses.left,
        )
        states = StatesAtInstants(readout, full).states(solved.instants)
        found = (*solved.found, readout.samples(solved.instants, states))
        return replace(solved, found=found, work=solved.work + full.work)

    def output(self, solved: Progress) -> Numbers:
        """All arrays."""
        return told(Parts.of(self.task.readout), solved)

    def counts(self, solved: Progress) -> Mapping[str, int]:
        """Newton's."""
        return counted(solved.work)


def require_complete(states: SolvedStates) -> None:
    """See that a scene was solved to its end.

    Raises:
        PointcoordError: it was not.
    """
    error = states.status.error(None)
    if error is not None:
        raise error


WAYS: tuple[Series | ThroughMap | AtInstants, ...] = (
    Series(),
    ThroughMap(),
    *(
        AtInstants(method.name, f"point coordinates, by {words}", method, tolerance_settings())
        for method, words in (
            (NEWTON, "Newton's method from the instant before"),
            (NEWTON_COLD, "Newton's method from the drawing, each instant by itself"),
            (CHORD, "Newton's method with one factorisation kept"),
        )
    ),
)
