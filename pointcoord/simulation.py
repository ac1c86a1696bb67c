"""From a scene to its motion."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from pointcoord.bounds.enclosed_rates import Summed
from pointcoord.bounds.proof import Proof, prove
from pointcoord.bounds.reported_bounds import Bounds, Reported, loss_of_least_squares
from pointcoord.effects.effect import plan_effects
from pointcoord.errors import (
    AssemblyError,
    InputNotKnown,
    InputOutOfRange,
    MechanismError,
    MotionTooLong,
    MotionTooRough,
    SceneError,
    UnknownName,
)
from pointcoord.linkage.chassis import ChassisMotion
from pointcoord.linkage.hardpoints import build_mechanism
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.counters import Work
from pointcoord.printed import printed_body_loss, printed_body_rates, printed_square_velocity_term
from pointcoord.results.closing import ALLOWED, Closing, closing
from pointcoord.results.motion import Motion, Prover, Samples
from pointcoord.results.readout import Readout, least_squares_rates
from pointcoord.results.states import Sampler, solved_states
from pointcoord.scene.messages import shown
from pointcoord.scene.scene_file import Scene
from pointcoord.solve.assembly import Pose, assemble, close_drawing
from pointcoord.solve.pointwise import Solved, solve_instants, square_velocity_term
from pointcoord.solve.taylor import COARSEST, FINEST, Chain, Settings, build_chain
from pointcoord.suspensions import PRINTED_TOPOLOGIES, SUSPENSIONS
from pointcoord.time_functions import TimeFunction

Array = NDArray[np.float64]
Method = Literal["series", "newton", "printed"]

# Share of a scene's tolerance that one segment may use: carried points lie up to a few lengths of
# their carriers away and multiply the carriers' truncation.
TRUNCATION_SHARE = 0.1


def simulate(scene: Scene, method: Method = "series") -> Motion:
    """Solve a scene by point coordinates.

    Args:
        method: `series` (a chain of power series, dense in time), `newton` (the paper's algorithm, at the
            scene's instants only) or `printed` (the same with the paper's printed formulas).
    Raises:
        SceneError: the hardpoints do not make a mechanism, or the scene was made wrong after it was read.
        InputOutOfRange: an input leaves the values for which it has a meaning.
        InputNotKnown: the terms of an input's law cancel so far that no pose can be proven with it.
        AssemblyError: the mechanism cannot follow the inputs; `partial` is the motion up to there.
        MotionTooLong: the motion takes too many series; likewise.
        MotionTooRough: no series follows an input; likewise.
    """
    require_scene(scene)
    if method not in ("series", "newton", "printed"):
        raise UnknownName("method", method, ("series", "newton", "printed"))
    # Its dictionaries can be written after it was read.
    scene = Scene.checked(scene, scene.title or "scene")
    mechanism = scene_mechanism(scene, printed=method == "printed")
    readout = Readout(
        mechanism=mechanism,
        plan=plan_effects(scene.effects),
        chassis=ChassisMotion.of(mechanism, scene.functions),
        outboard=scene.mechanism.outboard,
        body_rates=printed_body_rates if method == "printed" else least_squares_rates,
        body_loss=printed_body_loss if method == "printed" else loss_of_least_squares,
    )
    functions = {name: scene.functions[name] for name in mechanism.topology.required_inputs}
    _check_range(mechanism, functions, scene.instants)
    readout.chassis.states(scene.instants, readout.plan.derivative_of_points)
    first = scene.time.start
    path = close_drawing(mechanism, first)
    moved = closing(mechanism, path.y)
    _require_the_drawn_car(scene, moved)
    start = {name: f.series(first, 0)[..., 0] for name, f in functions.items()}
    pose = assemble(mechanism, start, first, path)
    solve = _by_series if method == "series" else _by_newton
    return solve(scene, method, readout, functions, pose, moved)


def _require_the_drawn_car(scene: Scene, moved: Closing) -> None:
    """Refuse a drawing whose closing makes another car of it, unless the scene asks for that by name."""
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


def scene_mechanism(scene: Scene, printed: bool = False) -> Mechanism:
    """The mechanism of a scene.

    Raises:
        SceneError: its hardpoints do not make one.
    """
    part = scene.mechanism
    closures = PRINTED_TOPOLOGIES.get(part.type, {}) if printed else SUSPENSIONS[part.type].closures
    source = scene.title or "scene"
    if part.closure not in closures:
        raise SceneError(
            source,
            "mechanism.closure",
            f"the method 'printed' cannot solve a {part.type} with closure = {part.closure!r}: it has the "
            "constraints as a paper prints them",
            ", ".join(
                f"{name} of a {type}" for type, closures in PRINTED_TOPOLOGIES.items() for name in closures
            ),
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


def _by_series(
    scene: Scene,
    method: Method,
    readout: Readout,
    functions: Mapping[str, TimeFunction],
    pose: Pose,
    moved: Closing,
) -> Motion:
    mechanism, plan, time = readout.mechanism, readout.plan, scene.time
    tolerance = TRUNCATION_SHARE * scene.tolerance / float(mechanism.unit)
    settings = Settings(tolerance=tolerance, derivative=plan.derivative)

    def motion(chain: Chain, instants: Array) -> Motion:
        sampler = Sampler(readout, functions, chain, time.start)
        work = pose.work + chain.work + sampler.work
        prover = SceneProver(readout, functions, sampler.coordinates, sampler.summed)
        samples = sampler(instants)
        _require_known(prover, samples, scene.tolerance)
        solved = _motion(samples, method, pose, moved, work, sampler, prover, mechanism)
        said = (*_drawing_notes(scene, moved), *_tolerance_notes(scene, settings, mechanism))
        return replace(solved, notes=(*said, *solved.notes))

    try:
        chain = build_chain(mechanism, functions, pose, time.start, time.stop, settings)
    except (AssemblyError, MotionTooLong, MotionTooRough) as error:
        if isinstance(error.partial, Chain):
            error.partial = motion(error.partial, scene.instants[scene.instants <= error.partial.stop])
        raise
    return motion(chain, scene.instants)


def _drawing_notes(scene: Scene, moved: Closing) -> tuple[str, ...]:
    """How the solved car differs from the drawn one, and what looks wrong with the drawing."""
    return (*((moved.words,) if moved.noticeable else ()), *scene.mechanism.doubts)


def _tolerance_notes(scene: Scene, settings: Settings, mechanism: Mechanism) -> tuple[str, ...]:
    """Where the chain is cut by another tolerance than the scene's."""
    used = min(max(settings.tolerance, FINEST), COARSEST)
    if used == settings.tolerance:
        return ()
    reason = (
        "finer than the rounding of a sum of series" if used == FINEST else "too coarse to keep to one branch"
    )
    held = used * float(mechanism.unit) / TRUNCATION_SHARE
    return (f"the tolerance of {scene.tolerance:.3g} mm is {reason}: {held:.3g} mm was used",)


def _by_newton(
    scene: Scene,
    method: Method,
    readout: Readout,
    functions: Mapping[str, TimeFunction],
    pose: Pose,
    moved: Closing,
) -> Motion:
    term = printed_square_velocity_term if method == "printed" else square_velocity_term

    def motion(solved: Solved) -> Motion:
        states = solved_states(readout, solved)
        plan = readout.plan
        width = sum(3 * len(state) for state in states)
        work = Work(derivatives_evaluated=plan.derivative + 1, coordinates_evaluated=width)
        samples = readout.samples(solved.times, states)
        prover = SceneProver(readout, functions, solved.coordinates, _not_summed)
        _require_known(prover, samples, scene.tolerance)
        cost = pose.work + solved.work + work
        found = _motion(samples, method, pose, moved, cost, None, prover, readout.mechanism)
        return replace(found, notes=(*_drawing_notes(scene, moved), *found.notes))

    try:
        solved = solve_instants(
            readout.mechanism, functions, pose, scene.instants, readout.plan.derivative, term
        )
    except AssemblyError as error:
        if isinstance(error.partial, Solved):
            error.partial = motion(error.partial)
        raise
    return motion(solved)


@dataclass(frozen=True)
class SceneProver:
    """Proves samples of a scene's motion.

    Attributes:
        functions: the laws of the inputs that drive the mechanism.
        coordinates: gives y and the derivatives that were solved for at some of the instants.
        summed: how these were summed; nothing if they were solved for.
    """

    readout: Readout
    functions: Mapping[str, TimeFunction]
    coordinates: Callable[[Array], list[Array]]
    summed: Callable[[Array], Sequence[Summed]]

    def __call__(self, samples: Samples, rates: bool = False) -> Proof:
        """What is proven at each of the samples' times, of every number by itself if `rates`."""
        return self.with_doubts(samples, self.doubts(samples.times), rates)

    def doubts(self, times: Array) -> dict[str, Array]:
        """How far the computed value of each law may be from the law's own, each (N,), rad or mm."""
        return {name: function.rounding(times) for name, function in self.functions.items()}

    def with_doubts(self, samples: Samples, laws: Mapping[str, Array], rates: bool = False) -> Proof:
        """What would be proven if the laws' values were off by so much."""
        mechanism, times = self.readout.mechanism, samples.times
        added = self.readout.offset(times)
        offset = np.broadcast_to(0.0 if added is None else added, (len(times), 3))
        rounding = self.readout.chassis.rounding(times, mechanism.origin)
        reported = self._reported(samples) if rates else None
        position = samples.position
        return prove(mechanism, times, self.coordinates, position, offset, rounding, laws, reported)

    def _reported(self, samples: Samples) -> Reported:
        """All numbers of samples, and what went into them beside the coordinates."""
        readout = self.readout
        return Reported(
            numbers=Bounds(**{f.name: dict(getattr(samples, f.name)) for f in fields(Bounds)}),
            chassis=readout.chassis,
            laws=self.functions,
            lines=readout.angle_lines,
            axes=readout.angle_axes,
            summed=self.summed,
            body_loss=readout.body_loss,
        )


def _not_summed(instants: Array) -> tuple[Summed, ...]:
    return ()


def _require_known(prover: SceneProver, samples: Samples, tolerance: float) -> None:
    """Find out whether a law that is less certain than the scene's tolerance leaves a pose unproven.

    Raises:
        InputNotKnown: it does, and with the law's values as they are the pose is proven.
    """
    doubts = prover.doubts(samples.times)
    if all((doubt <= tolerance).all() for doubt in doubts.values()):
        return
    certain = {name: np.zeros_like(doubt) for name, doubt in doubts.items()}
    unproven = ~np.isfinite(prover(samples).bound)
    unproven &= np.isfinite(prover.with_doubts(samples, certain).bound)
    if unproven.any():
        place = int(np.argmax(unproven))
        name = max(doubts, key=lambda name: float(doubts[name][place]))
        function, instant = prover.functions[name], float(samples.times[place])
        value, law = float(function.series(instant, 0)[0]), type(function).__name__.lower()
        raise InputNotKnown(name, law, value, float(doubts[name][place]), instant)


def _motion(
    samples: Samples,
    method: Method,
    pose: Pose,
    moved: Closing,
    work: Work,
    resample: Callable[[Array], Samples] | None,
    prover: Prover,
    mechanism: Mechanism,
) -> Motion:
    notes = []
    for channel in (samples.angular_velocity, samples.angular_acceleration):
        for body in channel:
            bad = int(np.count_nonzero(~np.isfinite(channel[body]).all(axis=-1)))
            if bad:
                notes.append(
                    f"{channel.quantity} of {body} is not a number at {bad} of {len(samples.times)} "
                    "instants: the printed quotient divides by zero there"
                )
    fields = {name: getattr(samples, name) for name in samples.__dataclass_fields__}
    return Motion(
        **fields,
        method=method,
        start=pose,
        closing=moved,
        work=work,
        notes=tuple(notes),
        unit=float(mechanism.unit),
        resample=resample,
        prover=prover,
    )
