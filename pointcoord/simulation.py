"""From a scene to its motion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from os import PathLike
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from pointcoord.effects.plan import plan_effects
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
from pointcoord.numerics.counters import Work
from pointcoord.numerics.rounding import EPS
from pointcoord.results.by_series import AtInstants, ByChain
from pointcoord.results.closing import ALLOWED, Closing, closing
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

Array = NDArray[np.float64]

# How many places are tried between the end of a map and the next instant, to tell what stops it.
TRIED = 32
# Largest share of a scene's tolerance that solved points may use (see `truncation_share`).
TRUNCATION_SHARE = 0.1
# Instants that are checked at a time: the known coordinates of each take some 5 MB.
BLOCK = 2**14


def simulate(scene: Scene | str | PathLike[str], method: Method | str = AUTO) -> Motion:
    """Solve a scene by point coordinates.

    Args:
        scene: or the name of a built-in one, or the path of a file.
        method: `auto` (`series`, and `map` where that would take too many series or cannot follow an input);
            dense in time `series` (a chain of power series) and `map` (series in the inputs, on patches
            that cover their way); at the scene's instants only `newton` (the paper's algorithm),
            `newton-cold` (each instant from the drawing) and `chord` (a factorisation kept); or a method of
            your own. The motion's `method` and notes say which was used, and why.
    Raises:
        UnknownName: there is no such method.
        SceneError: the hardpoints do not make a mechanism, or the scene was made wrong after it was read.
        InputOutOfRange: an input leaves the values for which it has a meaning, or the terms of its law
            cancel so far that no pose can be proven with it.
        AssemblyError: the mechanism cannot follow the inputs; `partial` is the motion up to there, None if
            there is none.
        NotFollowed: the motion takes too many series, or none follows an input; likewise.
        NotCovered: no map covers the way of the inputs, though no pose on it is singular; likewise.

    >>> motion = simulate("steer")
    >>> motion.position["wheel_centre"].shape
    (81, 3)
    >>> bool(motion.proof().bound.max() < 1e-11)
    True
    """
    if isinstance(scene, str | PathLike):
        scene = Scene.load(str(scene))
    require_scene(scene)
    return solve_task(checked_task(scene, method_of(method)))


def checked_task(scene: Scene, method: Method) -> Task:
    """A scene ready to be solved.

    Raises:
        SceneError, InputOutOfRange, AssemblyError: as `simulate`.
    """
    # Its dictionaries can be written after it was read.
    return prepare_task(Scene.checked(scene, scene.title or "scene"), method)


def solve_task(task: Task) -> Motion:
    """Solve a scene that is ready, by the method of the task.

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
    assert motion is not None  # what is complete has its first instant at least
    return motion


@dataclass(frozen=True)
class Effort:
    """What the accuracy that a scene asks for makes the method `auto` do.

    Attributes:
        method: which way it goes, `series` or `map`. why: a note that says so where it is the map.
        tolerance: of positions, mm: the scene's, or the nearest that a series holds.
        part: the same as a part of the car's size, which rates are held to.
        orders: of each series.
        moving, still: how many unknown coordinates the series have, and how many are solved once because
            they stand still.
        not_needed: how many are not solved for, because nothing that is reported hangs on them.
        points_not_needed: the points that are not solved for.
        start: what assembling the start takes.
        work: what all of it takes, but for the sums at the instants.
        stop: how far the series reach, s.
        status: whether that is the end, and if not, why.
    """

    method: str
    why: str
    tolerance: float
    part: float
    orders: tuple[int, ...]
    moving: int
    still: int
    not_needed: int
    points_not_needed: tuple[str, ...]
    start: Work
    work: Work
    stop: float
    status: Status


def effort(scene: Scene) -> Effort:
    """Find what solving a scene takes, by building its series or its map; nothing is summed at its instants.

    Raises:
        PointcoordError: what `simulate` raises before a motion begins.
    """
    require_scene(scene)
    task, solved = solve_by_either(prepare_task(Scene.checked(scene, scene.title or "scene"), AUTO))
    mechanism = task.readout.mechanism
    whole, mapped = scene.mechanism.topology, task.method is MAP
    # A map is of all coordinates, whatever moves them.
    moving = mechanism.map.unknowns if mapped else mechanism.moving_part(task.functions).system.unknowns
    kept = chain_settings(scene, mechanism, task.readout.plan.derivative).kept.tolerance
    return Effort(
        method=task.method.name,
        why=solved.notes[0] if mapped else "",
        tolerance=kept * float(mechanism.unit) / truncation_share(mechanism),
        part=kept / truncation_share(mechanism),
        orders=solved.orders,
        moving=moving,
        still=mechanism.map.unknowns - moving,
        not_needed=whole.layout.unknowns - mechanism.map.unknowns,
        points_not_needed=_unsolved(task),
        start=task.start.work,
        work=task.start.work + solved.solving,
        stop=max(solved.stop, scene.time.start),
        status=solved.status,
    )


@dataclass(frozen=True)
class Task:
    """A scene ready to be solved: checked, its drawing closed and its first pose assembled.

    Attributes:
        functions: the laws of the inputs that drive the linkage.
        start: the pose at the first instant.
        closing: how far closing the drawing moved its points.
        instants: of the scene, s.
    """

    scene: Scene
    method: Method
    readout: Readout
    functions: Mapping[str, TimeFunction]
    start: Pose
    closing: Closing
    instants: Array


def prepare_task(scene: Scene, method: Method) -> Task:
    """Check everything that can be checked before the motion, and assemble its start.

    Raises:
        SceneError, InputOutOfRange, AssemblyError: as `simulate`.
    """
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
    # The drawing is closed as a whole: it is all of the car that must be the one that was drawn.
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
        hopeful: whether to go on to the most segments where the first ones tell that these will not do.
    """
    mechanism, time = task.readout.mechanism, task.scene.time
    settings = chain_settings(task.scene, mechanism, task.readout.plan.derivative)
    settings = replace(settings, hopeful=hopeful)
    chain = build_chain(mechanism, task.functions, task.start, time.start, time.stop, settings)
    notes = tolerance_notes(task.scene, mechanism)
    return ByChain.of(task.readout, task.functions, chain, notes)


def solve_by_map(task: Task, why: str = "") -> SolvedScene:
    """Solve a motion by a map of its inputs along their way.

    Args:
        why: a note on why by a map, if that was not asked for.
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
    """Solve a motion by series, or where they are too long or too rough for it by a map.

    Returns:
        The task with the method that was used, and the motion; that of the series if neither is whole.
    """
    stopped: PointcoordError | None = foreseen(task)
    if stopped is None:
        solved = solve_by_series(task, hopeful=False)
        stopped = solved.status.stopped
    if isinstance(stopped, NotFollowed):
        mapped = solve_by_map(task, why_map(stopped))
        if mapped.status.complete:
            return replace(task, method=MAP), mapped
        # As far as they come, then.
        solved = solve_by_series(task)
    return replace(task, method=SERIES), solved


def foreseen(task: Task) -> NotFollowed | None:
    """Whether a chain is too long for certain, before it is built: a segment ends at every break."""
    time = task.scene.time
    every = (instant for law in task.functions.values() for instant in law.breaks)
    inner = sorted({instant for instant in every if time.start < instant < time.stop})
    if len(inner) < MOST_SEGMENTS:
        return None
    reached = float(inner[MOST_SEGMENTS - 1])
    return NotFollowed(reached, limit=MOST_SEGMENTS, start=time.start, stop=time.stop)


def why_map(stopped: NotFollowed) -> str:
    """Why a map was used instead of series, as a note."""
    if stopped.name:
        reason = f"no series in time follows {stopped.name!r} after t = {stopped.instant:.10g} s"
    else:
        reason = f"series in time would be about {stopped.expected:.2g}, and {stopped.limit} are allowed"
    return f"solved by a map of the inputs: {reason}"


def _stop_of_map(task: Task, solved: ByMap) -> PointcoordError:
    """Why a map does not cover the way of the inputs.

    The way is followed a little further from the last pose that is covered, from place to place on straight
    paths; where one of these is blocked, that is what stops the motion.
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
    """Solve a motion at each of the scene's instants by itself."""
    mechanism, instants, plan = task.readout.mechanism, task.instants, task.readout.plan
    term = task.method.square_velocity_term
    allowed = pose_tolerance(task.scene, task.method, mechanism)
    solver = task.method.at_instants
    solved = solver(mechanism, task.functions, task.start, instants, plan.derivative, term, allowed)
    return AtInstants.of(task.readout, task.functions, solved)


def _motion(task: Task, solved: SolvedScene) -> Motion | None:
    """The motion, whole or up to where it was solved; None if it is nowhere."""
    times = task.instants[task.instants <= solved.stop]
    if not len(times):
        return None
    samples = read(solved, times)
    require_known(solved, samples, task.scene.tolerance)
    return Motion(
        times=samples.times,
        numbers=samples.numbers,
        method=task.method.name,
        status=solved.status,
        start=task.start,
        closing=task.closing,
        work=task.start.work + solved.work,
        notes=_notes(task, solved, samples),
        solved=solved,
    )


def _notes(task: Task, solved: SolvedScene, samples: Samples) -> tuple[str, ...]:
    """What the user should know: of the drawing, of how it was solved, and of single numbers."""
    closed = (task.closing.words,) if task.closing.noticeable else ()
    return (
        *closed,
        *_unsolved_in_words(task),
        *task.scene.mechanism.doubts,
        *solved.notes,
        *_missing_numbers(solved, samples),
    )


def _unsolved(task: Task) -> tuple[str, ...]:
    """The points that are not solved for."""
    there = task.readout.mechanism.topology.points
    return tuple(name for name in task.scene.mechanism.topology.points if name not in there)


def _unsolved_in_words(task: Task) -> tuple[str, ...]:
    """Of what nothing is known, not even whether it can follow the inputs."""
    left_out = _unsolved(task)
    if not left_out:
        return ()
    return (
        f"nothing that is reported hangs on {', '.join(left_out)}: not solved for, nor whether it can follow",
    )


def require_the_drawn_car(scene: Scene, moved: Closing) -> None:
    """Refuse a drawing whose closing makes another car of it, unless the scene asks for that by name.

    Raises:
        SceneError: it does.
    """
    if moved.changes_the_car and not scene.mechanism.topology.puts_in_place:
        raise SceneError(
            scene.title or "scene",
            "mechanism.points",
            f"{moved.words}: that is another car",
            f"at most {ALLOWED:.0%} of the car's size, {ALLOWED * moved.size:.3g} mm; draw the points that "
            "miss where they belong",
        )


def require_scene(scene: object) -> None:
    """Find what is no scene, such as the name of one.

    Raises:
        SceneError: it is none.
    """
    if not isinstance(scene, Scene):
        allowed = "a Scene, as Scene.load(name) gives it"
        raise SceneError(shown(scene), "", f"is a {type(scene).__name__}, and no scene", allowed)


def scene_mechanism(scene: Scene, method: Method = SERIES) -> Mechanism:
    """The mechanism of a scene, as a method solves it.

    Raises:
        SceneError: its hardpoints do not make one, or the method does not solve such a suspension.
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
    """Find an input out of range at the scene's instants before anything is solved."""
    for low in range(0, len(instants), BLOCK):
        block = instants[low : low + BLOCK]
        series = {name: function.series(block, 0) for name, function in functions.items()}
        try:
            mechanism.known_series(series)
        except InputOutOfRange as error:
            when = float(block[np.argmax(series[error.name][:, 0] == error.value)])
            raise InputOutOfRange(error.name, error.value, error.allowed, when) from None


def truncation_share(mechanism: Mechanism) -> float:
    """Share of a scene's tolerance that solved points may use: carried ones multiply what these are off."""
    return min(TRUNCATION_SHARE, 1.0 / mechanism.carried_gain)


def chain_settings(scene: Scene, mechanism: Mechanism, derivative: int) -> Settings:
    """How a scene's chain of series is cut; that of many designs as finely as the largest of them needs.

    Args:
        derivative: highest time derivative that will be evaluated.
    """
    return Settings(truncation_share(mechanism) * scene.tolerance / float(mechanism.unit.max()), derivative)


def map_limits(scene: Scene, mechanism: Mechanism, derivative: int) -> Limits:
    """How near the patches of a scene's map must be; what rounding loses is bounded apart, as of series."""
    from pointcoord.patches.flood import Limits

    kept = chain_settings(scene, mechanism, derivative).kept.tolerance
    tolerance = kept * float(mechanism.unit) / truncation_share(mechanism)
    return Limits(tolerance, derivative, keep_rounded=True)


def finest_tolerance(scene: Scene) -> float:
    """The finest tolerance that a chain of series keeps, mm: below it truncation drowns in rounding.

    Raises:
        SceneError: the hardpoints do not make a mechanism.
    """
    mechanism = scene_mechanism(scene)
    # Inflated by what taking a share of it may round.
    return FINEST * (1.0 + 4.0 * EPS) * float(mechanism.unit) / truncation_share(mechanism)


def pose_tolerance(scene: Scene, method: Method, mechanism: Mechanism) -> float:
    """How far a pose that is solved for may be from the exact assembly, rounding apart, in units."""
    settings = chain_settings(scene, mechanism, 0)
    if method.dense:
        return SOLVED * settings.kept.tolerance
    # Finer than a sum of series can be, but no coarser.
    return min(settings.tolerance, COARSEST)


def tolerance_notes(scene: Scene, mechanism: Mechanism) -> tuple[str, ...]:
    """Where the chain is cut by another tolerance than the scene's."""
    settings = chain_settings(scene, mechanism, 0)
    used = settings.kept.tolerance
    if used == settings.tolerance:
        return ()
    reason = (
        "finer than the rounding of a sum of series" if used == FINEST else "too coarse to keep to one branch"
    )
    held = used * float(mechanism.unit) / truncation_share(mechanism)
    return (f"the tolerance of {scene.tolerance:.3g} mm is {reason}: {held:.3g} mm was used",)


def require_known(solved: SolvedScene, samples: Samples, tolerance: float) -> None:
    """Find out whether a law that is less certain than the scene's tolerance leaves a pose unproven.

    Raises:
        InputOutOfRange: it does, and with the law's values as they are the pose is proven.
    """
    doubts = {name: law.rounding(samples.times) for name, law in solved.functions.items()}
    if all((doubt <= tolerance).all() for doubt in doubts.values()):
        return
    # Imported here: few laws are so uncertain.
    from pointcoord.results.proof import prove

    unproven = ~np.isfinite(prove(solved, samples).bound)
    unproven &= np.isfinite(prove(solved, samples, certain=True).bound)
    if unproven.any():
        place = int(np.argmax(unproven))
        name = max(doubts, key=lambda name: float(doubts[name][place]))
        function, instant = solved.functions[name], float(samples.times[place])
        value, law = float(function.series(instant, 0)[0]), type(function).__name__.lower()
        doubt = float(doubts[name][place])
        raise InputOutOfRange(name, value, "", instant, doubt=doubt, law=law)


def _missing_numbers(solved: SolvedScene, samples: Samples) -> tuple[str, ...]:
    """Which numbers are none, and why."""
    notes, count = [], len(samples.times)
    for effect in solved.readout.plan.computed:
        why = f": {effect.no_number}" if effect.no_number else ""
        for quantity, names in effect.gives_numbers(solved.readout.mechanism.topology).items():
            channel = samples.numbers[quantity]
            for name in channel if names is None else names:
                known = np.isfinite(channel[name])
                if not known.all():
                    bad = count - np.count_nonzero(known.reshape(count, -1).all(axis=-1))
                    what = f"{channel.quantity.words} of {name}"
                    notes.append(f"{what} is not a number at {bad} of {count} instants{why}")
    return tuple(notes)
