"""Solves a scene: from its hardpoints, inputs and instants to its motion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from os import PathLike
from typing import TYPE_CHECKING

import numpy as np

from pointcoord.effects.registry import plan_effects
from pointcoord.errors import (
    InputOutOfRange,
    MechanismError,
    NotCovered,
    NotFollowed,
    PointcoordError,
    SceneError,
)
from pointcoord.linkage.chassis import ChassisMotion
from pointcoord.linkage.hardpoints import build_mechanism
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.method import AUTO, MAP, SERIES, Method, method_of
from pointcoord.numerics.arrays import Array
from pointcoord.numerics.counters import Work
from pointcoord.numerics.rounding import EPS
from pointcoord.results.by_series import AtInstants, ByChain
from pointcoord.results.closing import ALLOWED, ANOTHER_CAR, Closing, closing
from pointcoord.results.motion import Motion, read
from pointcoord.results.readout import Readout
from pointcoord.results.samples import Samples
from pointcoord.results.solved_scene import SolvedScene
from pointcoord.scene.scene_file import Scene
from pointcoord.solve.assembly import Pose, assemble, blocked, close_drawing, path_of_part
from pointcoord.solve.follower import follow
from pointcoord.solve.status import Status
from pointcoord.solve.step_rule import COARSEST, FINEST, Settings
from pointcoord.solve.taylor import MOST_SEGMENTS, SOLVED, build_chain
from pointcoord.time_functions import TimeFunction
from pointcoord.wording import shown

if TYPE_CHECKING:
    from pointcoord.patches.flood import Limits
    from pointcoord.results.by_map import ByMap


# Poses that are tried between the end of a map and the next instant, to find what stops the motion.
TRIED = 32
# Largest share of a scene's tolerance that solved points may use (see `truncation_share`).
TRUNCATION_SHARE = 0.1
# Instants that are checked at a time: the known coordinates of each take some 5 MB.
BLOCK = 2**14


def simulate(scene: Scene | str | PathLike[str], method: Method | str = AUTO) -> Motion:
    """Solve a scene by point coordinates.

    Args:
        scene: a scene, the name of a built-in one, or the path of a file.
        method: `auto` (`series`, or `map` where `series` needs too many series or cannot follow an input);
            dense in time `series` (a chain of power series) and `map` (series in the inputs, on patches
            that cover their path); at the scene's instants only `newton` (the paper's algorithm),
            `newton-cold` (each instant from the drawing) and `chord` (a factorisation kept); or a method of
            your own. The motion's `method` and notes say which was used, and why.
    Raises:
        UnknownName: there is no such method.
        SceneError: the hardpoints do not make a mechanism, or the scene was made invalid after reading.
        InputOutOfRange: an input leaves its valid values, or the terms of its law cancel so far that no pose
            can be proven.
        AssemblyError: the mechanism cannot follow the inputs. For this and the next two errors `partial` is
            the motion up to there, or None if nothing was solved.
        NotFollowed: the motion takes too many series, or none follows an input.
        NotCovered: no map covers the path of the inputs, though no pose on it is singular.

    >>> motion = simulate("steer")
    >>> motion.position["wheel_centre"].shape
    (81, 3)
    >>> bool(motion.proof().bound.max() < 1e-11)
    True
    """
    if isinstance(scene, str | PathLike):
        scene = Scene.load(str(scene))
    return solve_task(prepare_task(scene, method_of(method)))


def solve_task(task: Task) -> Motion:
    """Solve a prepared scene by the method of the task.

    Raises:
        InputOutOfRange, AssemblyError, NotFollowed, NotCovered: as `simulate`.
    """
    if task.method.by_series and task.method.by_map:
        task, solved = solve_by_either(task)
    elif task.method.by_series:
        solved = solve_by_series(task)
    else:
        solved = solve_by_map(task) if task.method.by_map else _at_instants(task)
    motion = _motion(task, solved)
    error = solved.status.error(motion)
    if error is not None:
        raise error
    assert motion is not None  # a complete motion has at least its first instant
    return motion


@dataclass(frozen=True)
class Effort:
    """Work that the method `auto` does for the accuracy that a scene asks for.

    Attributes:
        task, solved: the scene as prepared, with the method used, and its solution between the instants.
        tolerance: tolerance of positions, mm: the scene's, or the nearest that a series can keep.
        part: that tolerance as a share of the car's size, used for rates.
        unknowns: number of unknown coordinates in the series.
        not_needed: number of unknowns that are not solved for, because nothing reported depends on them.
    """

    task: Task
    solved: SolvedScene
    tolerance: float
    part: float
    unknowns: int
    not_needed: int

    @property
    def work(self) -> Work:
        """All work but the sums at the instants."""
        return self.task.start.work + self.solved.solving


def effort(scene: Scene) -> Effort:
    """Find the work of solving a scene by building its series or its map, without sums at its instants.

    Raises:
        PointcoordError: the errors that `simulate` raises before a motion begins.
    """
    task, solved = solve_by_either(prepare_task(scene, AUTO))
    mechanism = task.readout.mechanism
    unknowns, whole = mechanism.map.unknowns, task.scene.mechanism.topology.layout.unknowns
    kept = chain_settings(task.scene, mechanism, task.readout.plan.derivative).kept.tolerance
    part = kept / truncation_share(mechanism)
    return Effort(task, solved, part * float(mechanism.unit), part, unknowns, whole - unknowns)


@dataclass(frozen=True)
class Task:
    """A prepared scene: checked, its drawing closed and its first pose assembled.

    Attributes:
        functions: the laws of the inputs that drive the linkage.
        start: the pose at the first instant.
        closing: how far closing the drawing moved its points.
        instants: the scene's instants, s.
    """

    scene: Scene
    method: Method
    readout: Readout
    functions: Mapping[str, TimeFunction]
    start: Pose
    closing: Closing
    instants: Array

    @property
    def unsolved(self) -> tuple[str, ...]:
        """The points that are not solved for."""
        there = self.readout.mechanism.topology.points
        return tuple(name for name in self.scene.mechanism.topology.points if name not in there)


def prepare_task(scene: Scene, method: Method) -> Task:
    """Check everything that can be checked before the motion, and assemble the first pose.

    Raises:
        SceneError, InputOutOfRange, AssemblyError: as `simulate`.
    """
    require_scene(scene)
    # A scene's dictionaries can be changed after reading.
    scene = Scene.checked(scene, scene.title or "scene")
    whole = scene_mechanism(scene, method)
    plan = plan_effects(scene.effects, method.effects, scene.unreported_points)
    mechanism = whole.part(plan.derivatives(whole.topology))
    laws, instants = scene.functions, scene.instants
    readout = Readout(
        mechanism=mechanism,
        plan=plan,
        chassis=ChassisMotion.of(mechanism, laws),
        axes=scene.mechanism.axes,
    )
    functions = {name: laws[name] for name in whole.topology.required_inputs}
    check_range(whole, functions, instants)
    readout.laws(instants)
    # The whole drawing is closed, not only the part to be solved: all of the car must be the drawn one.
    first, tolerance = scene.time.start, pose_tolerance(scene, method, whole)
    closed = close_drawing(whole, first, tolerance)
    moved = closing(whole, closed.y)
    require_the_drawn_car(scene, moved)
    functions = {name: functions[name] for name in mechanism.topology.required_inputs}
    inputs = {name: f.series(first, 0)[..., 0] for name, f in functions.items()}
    begun = path_of_part(closed, whole, mechanism)
    start = assemble(mechanism, inputs, first, begun, pose_tolerance(scene, method, mechanism))
    return Task(scene, method, readout, functions, start, moved, instants)


def solve_by_series(task: Task, *, hopeful: bool = True) -> SolvedScene:
    """Solve a motion as a chain of power series.

    Args:
        hopeful: whether to go on up to the most segments even if the first ones show that more are needed.
    """
    mechanism, time = task.readout.mechanism, task.scene.time
    settings = chain_settings(task.scene, mechanism, task.readout.plan.derivative)
    settings = replace(settings, hopeful=hopeful)
    chain = build_chain(mechanism, task.functions, task.start, time.start, time.stop, settings)
    notes = tolerance_notes(task.scene, mechanism)
    return ByChain.of(task.readout, task.functions, chain, notes)


def solve_by_map(task: Task, why: str = "") -> SolvedScene:
    """Solve a motion by a map of its inputs along their path.

    Args:
        why: a note on why the map is used, if the user did not ask for it.
    """
    # Imported here: few scenes need it.
    from pointcoord.patches.way_map import map_way
    from pointcoord.results.by_map import ByMap

    readout, time = task.readout, task.scene.time
    mechanism = readout.mechanism
    limits = map_limits(task.scene, mechanism, readout.plan.derivative)
    span, effort = (time.start, time.stop), task.method.map_effort
    way = map_way(mechanism, task.functions, task.start, *span, limits, effort)
    notes = (*((why,) if why else ()), *tolerance_notes(task.scene, mechanism), *way.notes)
    solved = ByMap.of(readout, task.functions, way, time.start, notes)
    return replace(solved, status=Status(_stop_of_map(task, solved))) if way.reason else solved


def solve_by_either(task: Task) -> tuple[Task, SolvedScene]:
    """Solve a motion by series, or by a map where the series are too many or do not follow an input.

    Returns:
        The task with the method that was used, and the motion; the series' motion if neither is complete.
    """
    stopped: PointcoordError | None = foreseen(task)
    if stopped is None:
        solved = solve_by_series(task, hopeful=False)
        stopped = solved.status.stopped
    if isinstance(stopped, NotFollowed):
        if stopped.name:
            why = f"no series in time follows {stopped.name!r} after t = {stopped.instant:.10g} s"
        else:
            why = f"series in time would be about {stopped.expected:.2g}, and {stopped.limit} are allowed"
        mapped = solve_by_map(task, f"solved by a map of the inputs: {why}")
        if mapped.status.complete:
            return replace(task, method=MAP), mapped
        # Neither is complete: take the series as far as they reach.
        solved = solve_by_series(task)
    return replace(task, method=SERIES), solved


def foreseen(task: Task) -> NotFollowed | None:
    """The error of a chain that is certainly too long, before it is built: a segment ends at every break."""
    time = task.scene.time
    every = (instant for law in task.functions.values() for instant in law.breaks)
    inner = sorted({instant for instant in every if time.start < instant < time.stop})
    if len(inner) < MOST_SEGMENTS:
        return None
    reached = float(inner[MOST_SEGMENTS - 1])
    return NotFollowed(reached, limit=MOST_SEGMENTS, start=time.start, stop=time.stop)


def _stop_of_map(task: Task, solved: ByMap) -> PointcoordError:
    """Why a map does not cover the path of the inputs.

    The path is followed from the last covered pose to the next instant, in short straight steps. If one of
    them is blocked, that is what stops the motion.
    """
    mechanism, functions, way, time = task.readout.mechanism, task.functions, solved.way, task.scene.time
    until = max(way.until, time.start)
    known = mechanism.known_series({name: f.series(until, 0) for name, f in functions.items()})
    inputs = {name: float(value) for name, value in mechanism.input_values(known[..., 0, :]).items()}
    y = task.start.y if way.until == -np.inf else solved.coordinates(np.array([until]), 0)[0][0]
    later = task.scene.instants[task.scene.instants > until]
    goal = float(later[0]) if len(later) else time.stop
    for instant in np.linspace(until, goal, TRIED + 1)[1:].tolist():
        target = mechanism.known_series({name: f.series(instant, 0) for name, f in functions.items()})[0]
        path = follow(mechanism.map, y, target)
        if path.done < 1.0:
            problem = "the mechanism cannot be assembled"
            return blocked(mechanism, problem, path.y, path.factors, target, path.done < 1.0, instant)
        y = path.y
    return NotCovered(inputs, way.reason, instant=until)


def _at_instants(task: Task) -> SolvedScene:
    """Solve a motion at each of the scene's instants separately."""
    mechanism, instants, plan = task.readout.mechanism, task.instants, task.readout.plan
    term = task.method.square_velocity_term
    allowed = pose_tolerance(task.scene, task.method, mechanism)
    solver = task.method.at_instants
    solved = solver(mechanism, task.functions, task.start, instants, plan.derivative, term, allowed)
    return AtInstants.of(task.readout, task.functions, solved)


def _motion(task: Task, solved: SolvedScene) -> Motion | None:
    """The motion, whole or up to the last solved instant; None if no instant is solved."""
    times = task.instants[task.instants <= solved.stop]
    if not len(times):
        return None
    rows = solved.readout.room(len(times))
    samples = read(solved, times, rows)
    require_known(solved, samples, task.scene.tolerance)
    return Motion(
        times=samples.times,
        numbers=samples.numbers,
        method=task.method.name,
        status=solved.status,
        start=task.start,
        closing=task.closing,
        work=task.start.work + solved.work,
        notes=_notes(task, solved, rows),
        solved=solved,
    )


def _notes(task: Task, solved: SolvedScene, rows: Array) -> tuple[str, ...]:
    """Notes for the user: on the drawing, on the solution, and on missing numbers.

    Args:
        rows: the table of the motion's numbers.
    """
    notes = [task.closing.words] if task.closing.noticeable else []
    if task.unsolved:
        notes.append(
            f"not solved for, because nothing reported depends on them: {', '.join(task.unsolved)}; "
            "whether these points can follow the inputs is not checked"
        )
    missing = (
        f"{number} is not a number at {np.count_nonzero(where)} of {len(where)} instants{why}"
        for number, why, where in solved.readout.table.missing(rows)
    )
    return (*notes, *task.scene.mechanism.doubts, *solved.notes, *missing)


def require_the_drawn_car(scene: Scene, moved: Closing) -> None:
    """Refuse a drawing that changes too much when it is closed, unless the scene asks for that by name.

    Raises:
        SceneError: the closed drawing is another car.
    """
    if moved.changes_the_car and not scene.mechanism.topology.puts_in_place:
        raise SceneError(
            scene.title or "scene",
            "mechanism.points",
            f"{moved.words}: that is another car",
            f"at most {ALLOWED:.0%} of the car's size, {ALLOWED * moved.size:.3g} mm; draw the points that "
            "miss where they belong",
            ANOTHER_CAR,
        )


def require_scene(scene: object) -> None:
    """Refuse an object that is not a scene, such as the name of one.

    Raises:
        SceneError: the object is not a scene.
    """
    if not isinstance(scene, Scene):
        allowed = "a Scene, as Scene.load(name) gives it"
        raise SceneError(shown(scene), "", f"is of type {type(scene).__name__}, not a scene", allowed)


def scene_mechanism(scene: Scene, method: Method = SERIES) -> Mechanism:
    """The mechanism of a scene, as a method solves it.

    Raises:
        SceneError: its hardpoints do not make a mechanism, or the method cannot solve such a suspension.
    """
    part = scene.mechanism
    source, topology = scene.title or "scene", part.topology
    if method.linkage is not None:
        own = method.linkage(topology)
        if own is None:
            problem = (
                f"the method {method.name!r} cannot solve the {part.name} with closure = {part.closure!r}"
            )
            raise SceneError(source, "mechanism.closure", problem, method.only)
        topology = own
    try:
        return build_mechanism(topology, dict(part.points), part.directions)
    except MechanismError as error:
        raise SceneError(source, "mechanism.points", error.problem) from error


def check_range(mechanism: Mechanism, functions: Mapping[str, TimeFunction], instants: Array) -> None:
    """Check the inputs' ranges at the scene's instants before anything is solved."""
    for low in range(0, len(instants), BLOCK):
        block = instants[low : low + BLOCK]
        series = {name: function.series(block, 0) for name, function in functions.items()}
        try:
            mechanism.known_series(series)
        except InputOutOfRange as error:
            when = float(block[np.argmax(series[error.name][:, 0] == error.value)])
            raise InputOutOfRange(error.name, error.value, error.allowed, when) from None


def truncation_share(mechanism: Mechanism) -> float:
    """Share of a scene's tolerance for solved points, whose errors are enlarged in points fixed to a body."""
    return min(TRUNCATION_SHARE, 1.0 / mechanism.carried_gain)


def chain_settings(scene: Scene, mechanism: Mechanism, derivative: int) -> Settings:
    """Settings that cut a scene's chain of series; many designs take the finest cut that any of them needs.

    Args:
        derivative: highest time derivative that will be evaluated.
    """
    return Settings(truncation_share(mechanism) * scene.tolerance / float(mechanism.unit.max()), derivative)


def map_limits(scene: Scene, mechanism: Mechanism, derivative: int) -> Limits:
    """Error limits of the patches of a scene's map; rounding is bounded separately, as for series."""
    from pointcoord.patches.flood import Limits

    kept = chain_settings(scene, mechanism, derivative).kept.tolerance
    tolerance = kept * float(mechanism.unit) / truncation_share(mechanism)
    return Limits(tolerance, derivative, keep_rounded=True)


def finest_tolerance(scene: Scene) -> float:
    """The finest tolerance that a chain of series can keep, mm: below it rounding exceeds truncation.

    Raises:
        SceneError: the hardpoints do not make a mechanism.
    """
    mechanism = scene_mechanism(scene)
    # Enlarged by the rounding of taking a share of it.
    return FINEST * (1.0 + 4.0 * EPS) * float(mechanism.unit) / truncation_share(mechanism)


def pose_tolerance(scene: Scene, method: Method, mechanism: Mechanism) -> float:
    """Largest error of a solved pose against the exact assembly, without rounding, in mechanism units."""
    settings = chain_settings(scene, mechanism, 0)
    if method.dense:
        return SOLVED * settings.kept.tolerance
    # May be finer than a sum of series can be, but not coarser.
    return min(settings.tolerance, COARSEST)


def tolerance_notes(scene: Scene, mechanism: Mechanism) -> tuple[str, ...]:
    """A note where the chain is cut to another tolerance than the scene's."""
    settings = chain_settings(scene, mechanism, 0)
    used = settings.kept.tolerance
    if used == settings.tolerance:
        return ()
    reason = (
        "finer than the rounding of a sum of series" if used == FINEST else "too coarse to keep to one branch"
    )
    kept = used * float(mechanism.unit) / truncation_share(mechanism)
    return (f"the tolerance of {scene.tolerance:.3g} mm is {reason}: {kept:.3g} mm was used",)


def require_known(solved: SolvedScene, samples: Samples, tolerance: float) -> None:
    """Refuse a pose that is unproven only because a law is less certain than the scene's tolerance.

    Raises:
        InputOutOfRange: such a pose exists; with exactly known values of the law it is proven.
    """
    rounding = {name: law.rounding(samples.times) for name, law in solved.functions.items()}
    if all((error <= tolerance).all() for error in rounding.values()):
        return
    # Imported here: few laws are so uncertain.
    from pointcoord.results.proof import prove

    unproven = ~np.isfinite(prove(solved, samples).bound)
    unproven &= np.isfinite(prove(solved, samples, certain=True).bound)
    if unproven.any():
        place = int(np.argmax(unproven))
        name = max(rounding, key=lambda name: float(rounding[name][place]))
        function, instant = solved.functions[name], float(samples.times[place])
        value, law = float(function.series(instant, 0)[0]), type(function).__name__.lower()
        uncertainty = float(rounding[name][place])
        raise InputOutOfRange(name, value, "", instant, doubt=uncertainty, law=law)
