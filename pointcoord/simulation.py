"""From a scene to its motion."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from pointcoord.data_classes import dataclass
from pointcoord.effects.plan import plan_effects
from pointcoord.errors import (
    InputNotKnown,
    InputOutOfRange,
    MechanismError,
    SceneError,
)
from pointcoord.linkage.car_axes import CarAxes
from pointcoord.linkage.chassis import ChassisMotion
from pointcoord.linkage.hardpoints import build_mechanism
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.method import SERIES, Method, method_of
from pointcoord.numerics.counters import Work
from pointcoord.numerics.rounding import EPS
from pointcoord.results.closing import ALLOWED, Closing, closing
from pointcoord.results.motion import Motion
from pointcoord.results.readout import Readout
from pointcoord.results.samples import Samples
from pointcoord.results.solved_scene import SolvedScene
from pointcoord.results.states import StatesAtInstants, StatesOfChain
from pointcoord.scene.messages import shown
from pointcoord.scene.scene_file import Scene
from pointcoord.solve.assembly import Pose, assemble, close_drawing
from pointcoord.solve.status import Status
from pointcoord.solve.taylor import COARSEST, FINEST, SOLVED, Chain, Settings, build_chain
from pointcoord.time_functions import TimeFunction

Array = NDArray[np.float64]

# Largest share of a scene's tolerance that solved points may use (see `truncation_share`).
TRUNCATION_SHARE = 0.1


def simulate(scene: Scene, method: Method | str = SERIES) -> Motion:
    """Solve a scene by point coordinates.

    Args:
        method: `series` (a chain of power series, dense in time); at the scene's instants only `newton` (the
            paper's algorithm), `newton-cold` (each instant from the drawing) and `chord` (a factorisation
            kept); or a method of your own.
    Raises:
        UnknownName: there is no such method.
        SceneError: the hardpoints do not make a mechanism, or the scene was made wrong after it was read.
        InputOutOfRange: an input leaves the values for which it has a meaning.
        InputNotKnown: the terms of an input's law cancel so far that no pose can be proven with it.
        AssemblyError: the mechanism cannot follow the inputs; `partial` is the motion up to there, None if
            there is none.
        MotionTooLong: the motion takes too many series; likewise.
        MotionTooRough: no series follows an input; likewise.

    >>> motion = simulate(Scene.load("steer"))
    >>> motion.position["wheel_centre"].shape
    (81, 3)
    >>> bool(motion.proof().bound.max() < 1e-11)
    True
    """
    require_scene(scene)
    # Its dictionaries can be written after it was read.
    task = prepare_task(Scene.checked(scene, scene.title or "scene"), method_of(method))
    solved = solve_by_series(task) if task.method.by_series else _at_instants(task)
    motion = _motion(task, solved)
    error = solved.states.status.error(motion)
    if error is not None:
        raise error
    assert motion is not None  # what is complete has its first instant at least
    return motion


@dataclass(frozen=True)
class Effort:
    """What the accuracy that a scene asks for makes the method `series` do.

    Attributes:
        tolerance: of positions, mm: the scene's, or the nearest that a series holds.
        part: the same as a part of the car's size, which rates are held to.
        orders: of each series.
        start: what assembling the start takes.
        work: what all of it takes, but for the sums at the instants.
        stop: how far the series reach, s.
        status: whether that is the end, and if not, why.
    """

    tolerance: float
    part: float
    orders: tuple[int, ...]
    start: Work
    work: Work
    stop: float
    status: Status


def effort(scene: Scene) -> Effort:
    """Find what solving a scene takes, by building its series; nothing is summed at its instants.

    Raises:
        PointcoordError: what `simulate` raises before a motion begins.
    """
    require_scene(scene)
    task = prepare_task(Scene.checked(scene, scene.title or "scene"), SERIES)
    mechanism = task.readout.mechanism
    chain = _chain(task)
    kept = chain_settings(scene, mechanism, task.readout.plan.derivative).kept.tolerance
    return Effort(
        tolerance=kept * float(mechanism.unit) / truncation_share(mechanism),
        part=kept / truncation_share(mechanism),
        orders=tuple(segment.order for segment in chain.segments),
        start=task.start.work,
        work=task.start.work + chain.work,
        stop=chain.stop if chain.segments else scene.time.start,
        status=chain.status,
    )


@dataclass(frozen=True)
class Task:
    """A scene ready to be solved: checked, its drawing closed and its first pose assembled.

    Attributes:
        functions: the laws of the inputs that drive the linkage.
        start: the pose at the first instant.
        closing: how far closing the drawing moved its points.
    """

    scene: Scene
    method: Method
    readout: Readout
    functions: Mapping[str, TimeFunction]
    start: Pose
    closing: Closing


def prepare_task(scene: Scene, method: Method) -> Task:
    """Check everything that can be checked before the motion, and assemble its start.

    Raises:
        SceneError, InputOutOfRange, AssemblyError: as `simulate`.
    """
    mechanism = scene_mechanism(scene, method)
    readout = Readout(
        mechanism=mechanism,
        plan=plan_effects(scene.effects, method.effects),
        chassis=ChassisMotion.of(mechanism, scene.functions),
        axes=CarAxes.of(mechanism.drawing, scene.mechanism.outboard),
    )
    functions = {name: scene.functions[name] for name in mechanism.topology.required_inputs}
    _check_range(mechanism, functions, scene.instants)
    readout.chassis.states(scene.instants, readout.derivative_of_every_point)
    first, tolerance = scene.time.start, pose_tolerance(scene, method, mechanism)
    closed = close_drawing(mechanism, first, tolerance)
    moved = closing(mechanism, closed.y)
    require_the_drawn_car(scene, moved)
    inputs = {name: f.series(first, 0)[..., 0] for name, f in functions.items()}
    start = assemble(mechanism, inputs, first, closed, tolerance)
    return Task(scene, method, readout, functions, start, moved)


def solve_by_series(task: Task) -> SolvedScene:
    """Solve a motion as a chain of power series."""
    notes = _tolerance_notes(task.scene, task.readout.mechanism)
    states = StatesOfChain(task.readout, task.functions, _chain(task), task.scene.time.start, notes)
    return SolvedScene(task.readout, task.functions, states)


def _chain(task: Task) -> Chain:
    mechanism, time = task.readout.mechanism, task.scene.time
    settings = chain_settings(task.scene, mechanism, task.readout.plan.derivative)
    return build_chain(mechanism, task.functions, task.start, time.start, time.stop, settings)


def _at_instants(task: Task) -> SolvedScene:
    """Solve a motion at each of the scene's instants by itself."""
    mechanism, instants, plan = task.readout.mechanism, task.scene.instants, task.readout.plan
    term = task.method.square_velocity_term
    allowed = pose_tolerance(task.scene, task.method, mechanism)
    solver = task.method.at_instants
    solved = solver(mechanism, task.functions, task.start, instants, plan.derivative, term, allowed)
    return SolvedScene(task.readout, task.functions, StatesAtInstants(task.readout, solved))


def _motion(task: Task, solved: SolvedScene) -> Motion | None:
    """The motion, whole or up to where it was solved; None if it is nowhere."""
    times = solved.states.covered(task.scene.instants)
    if not len(times):
        return None
    samples = solved.samples(times)
    _require_known(solved, samples, task.scene.tolerance)
    return Motion(
        times=samples.times,
        numbers=samples.numbers,
        method=task.method.name,
        status=solved.states.status,
        start=task.start,
        closing=task.closing,
        work=task.start.work + solved.states.work,
        notes=_notes(task, solved, samples),
        solved=solved,
    )


def _notes(task: Task, solved: SolvedScene, samples: Samples) -> tuple[str, ...]:
    """What the user should know: of the drawing, of how it was solved, and of single numbers."""
    closed = (task.closing.words,) if task.closing.noticeable else ()
    return (
        *closed,
        *task.scene.mechanism.doubts,
        *solved.states.notes,
        *_missing_numbers(solved, samples),
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
    source = scene.title or "scene"
    closures = method.suspensions[part.type].closures if part.type in method.suspensions else {}
    if part.closure not in closures:
        why = f": {method.only}" if method.only else ""
        raise SceneError(
            source,
            "mechanism.closure",
            f"the method {method.name!r} cannot solve a {part.type} with closure = {part.closure!r}{why}",
            ", ".join(f"{name} of a {s.type}" for s in method.suspensions.values() for name in s.closures),
        )
    topology = closures[part.closure]
    try:
        return build_mechanism(topology, dict(part.points), {"up": part.up, "right": part.right})
    except MechanismError as error:
        raise SceneError(source, "mechanism.points", error.problem) from error


def _check_range(mechanism: Mechanism, functions: Mapping[str, TimeFunction], instants: Array) -> None:
    """Find an input out of range at the scene's instants before anything is solved."""
    try:
        mechanism.known_series({name: f.series(instants, 0) for name, f in functions.items()})
    except InputOutOfRange as error:
        values = functions[error.name].series(instants, 0)[:, 0]
        when = float(instants[np.argmax(values == error.value)])
        raise InputOutOfRange(error.name, error.value, error.allowed, when) from None


def truncation_share(mechanism: Mechanism) -> float:
    """Share of a scene's tolerance that solved points may use: carried ones multiply what these are off."""
    return min(TRUNCATION_SHARE, 1.0 / mechanism.carried_gain)


def chain_settings(scene: Scene, mechanism: Mechanism, derivative: int) -> Settings:
    """How a scene's chain of series is cut.

    Args:
        derivative: highest time derivative that will be evaluated.
    """
    return Settings(truncation_share(mechanism) * scene.tolerance / float(mechanism.unit), derivative)


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
    if method.by_series:
        return SOLVED * settings.kept.tolerance
    # Finer than a sum of series can be, but no coarser.
    return min(settings.tolerance, COARSEST)


def _tolerance_notes(scene: Scene, mechanism: Mechanism) -> tuple[str, ...]:
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


def _require_known(solved: SolvedScene, samples: Samples, tolerance: float) -> None:
    """Find out whether a law that is less certain than the scene's tolerance leaves a pose unproven.

    Raises:
        InputNotKnown: it does, and with the law's values as they are the pose is proven.
    """
    doubts = solved.doubts(samples.times)
    if all((doubt <= tolerance).all() for doubt in doubts.values()):
        return
    certain = {name: np.zeros_like(doubt) for name, doubt in doubts.items()}
    unproven = ~np.isfinite(solved.proof(samples).bound)
    unproven &= np.isfinite(solved.proof(samples, doubts=certain).bound)
    if unproven.any():
        place = int(np.argmax(unproven))
        name = max(doubts, key=lambda name: float(doubts[name][place]))
        function, instant = solved.functions[name], float(samples.times[place])
        value, law = float(function.series(instant, 0)[0]), type(function).__name__.lower()
        raise InputNotKnown(name, law, value, float(doubts[name][place]), instant)


def _missing_numbers(solved: SolvedScene, samples: Samples) -> tuple[str, ...]:
    """Which numbers are none, and why."""
    notes = []
    for effect in solved.readout.plan.computed:
        why = f": {effect.no_number}" if effect.no_number else ""
        for channel in (samples.numbers[quantity] for quantity in effect.gives_numbers):
            for name in effect.names or channel:
                is_number = np.isfinite(channel[name]).reshape(len(samples.times), -1).all(axis=-1)
                if bad := int(np.count_nonzero(~is_number)):
                    notes.append(
                        f"{channel.quantity.words} of {name} is not a number at {bad} of "
                        f"{len(samples.times)} instants{why}"
                    )
    return tuple(notes)
