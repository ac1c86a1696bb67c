"""From a scene to its motion."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from pointcoord.assembly import Pose, assemble
from pointcoord.chain import Chain, Settings, build_chain, evaluate
from pointcoord.effects import Plan, plan_effects
from pointcoord.errors import (
    AssemblyError,
    InputOutOfRange,
    MechanismError,
    OutsideMotion,
    SceneError,
    UnknownName,
)
from pointcoord.inputs import TimeFunction
from pointcoord.instants import Solved, solve_instants, square_velocity_term
from pointcoord.mechanism import Mechanism, build_mechanism
from pointcoord.motion import Motion, Samples
from pointcoord.printed import printed_body_rates, printed_square_velocity_term
from pointcoord.readout import Readout, least_squares_rates
from pointcoord.rigid import carried_series
from pointcoord.scene import Scene
from pointcoord.suspensions import PRINTED_TOPOLOGIES, TOPOLOGIES
from pointcoord.work import Work

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
        SceneError: the hardpoints do not make a mechanism.
        InputOutOfRange: an input leaves the values for which it has a meaning.
        AssemblyError: the mechanism cannot follow the inputs; `partial` is the motion up to there.
    """
    if method not in ("series", "newton", "printed"):
        raise UnknownName("method", method, ("series", "newton", "printed"))
    mechanism = scene_mechanism(scene, printed=method == "printed")
    readout = Readout(
        mechanism=mechanism,
        plan=plan_effects(scene.effects),
        outboard=scene.mechanism.outboard,
        body_rates=printed_body_rates if method == "printed" else least_squares_rates,
    )
    functions = scene.functions
    _check_range(mechanism, functions, scene.instants)
    first = scene.time.start
    pose = assemble(mechanism, {name: f.series(first, 0)[..., 0] for name, f in functions.items()}, first)
    solve = _by_series if method == "series" else _by_newton
    return solve(scene, method, readout, functions, pose)


def scene_mechanism(scene: Scene, printed: bool = False) -> Mechanism:
    """The mechanism of a scene.

    Raises:
        SceneError: its hardpoints do not make one.
    """
    part = scene.mechanism
    topology = (PRINTED_TOPOLOGIES if printed else TOPOLOGIES)[part.type]
    try:
        return build_mechanism(topology, dict(part.points), {"up": part.up, "right": part.right})
    except MechanismError as error:
        raise SceneError(scene.title or "scene", "mechanism.points", error.problem) from error


def _check_range(mechanism: Mechanism, functions: Mapping[str, TimeFunction], instants: Array) -> None:
    """Find an input out of range at the scene's instants before anything is solved."""
    try:
        mechanism.known_series({name: f.series(instants, 0) for name, f in functions.items()})
    except InputOutOfRange as error:
        values = functions[error.name].series(instants, 0)[:, 0]
        when = float(instants[np.argmax(values == error.value)])
        raise InputOutOfRange(error.name, error.value, error.allowed, when) from None


def _by_series(
    scene: Scene, method: Method, readout: Readout, functions: Mapping[str, TimeFunction], pose: Pose
) -> Motion:
    mechanism, plan, time = readout.mechanism, readout.plan, scene.time
    tolerance = TRUNCATION_SHARE * scene.tolerance / float(mechanism.unit)
    settings = Settings(tolerance=tolerance, derivative=plan.derivative)

    def motion(chain: Chain, instants: Array) -> Motion:
        sampler = Sampler(readout, functions, chain, time.start)
        work = pose.work + chain.work + sampler.work
        return _motion(sampler(instants), method, pose, work, sampler)

    try:
        chain = build_chain(mechanism, functions, pose, time.start, time.stop, settings)
    except AssemblyError as error:
        if isinstance(error.partial, Chain):
            error.partial = motion(error.partial, scene.instants[scene.instants <= error.partial.stop])
        raise
    return motion(chain, scene.instants)


def _by_newton(
    scene: Scene, method: Method, readout: Readout, functions: Mapping[str, TimeFunction], pose: Pose
) -> Motion:
    term = printed_square_velocity_term if method == "printed" else square_velocity_term

    def motion(solved: Solved) -> Motion:
        states = _solved_states(readout, solved)
        plan = readout.plan
        width = sum(3 * len(state) for state in states)
        work = Work(derivatives_evaluated=plan.derivative + 1, coordinates_evaluated=width)
        return _motion(
            readout.samples(solved.times, states), method, pose, pose.work + solved.work + work, None
        )

    try:
        solved = solve_instants(
            readout.mechanism, functions, pose, scene.instants, readout.plan.derivative, term
        )
    except AssemblyError as error:
        if isinstance(error.partial, Solved):
            error.partial = motion(error.partial)
        raise
    return motion(solved)


def _solved_states(readout: Readout, solved: Solved) -> list[dict[str, Array]]:
    """States of the points that the plan asks for, from states of all coordinates."""
    mechanism, plan = readout.mechanism, readout.plan
    layout, topology = mechanism.layout, mechanism.topology
    taylor = np.stack([state / max(order, 1) for order, state in enumerate(solved.states)], axis=-2)
    series = {name: taylor[..., list(layout.vector(name))] for name in (*topology.chassis, *topology.moving)}
    for name, carriers in topology.carried.items():
        series[name] = carried_series(mechanism.carrier_weights[name], *(series[c] for c in carriers))
    names = [set(topology.points)] + [_points_at(mechanism, plan, d) for d in range(1, plan.derivative + 1)]
    return [
        {name: series[name][..., order, :] * max(order, 1) for name in topology.points if name in wanted}
        for order, wanted in enumerate(names)
    ]


def _points_at(mechanism: Mechanism, plan: Plan, derivative: int) -> set[str]:
    """Points whose derivative the plan asks for."""
    if derivative <= plan.derivative_of_points:
        return set(mechanism.topology.points)
    return {point for body in mechanism.topology.bodies.values() for point in body}


@dataclass(frozen=True)
class Sampler:
    """Evaluates a chain at any instants inside it."""

    readout: Readout
    functions: Mapping[str, TimeFunction]
    chain: Chain
    start: float

    def __call__(self, instants: Array) -> Samples:
        """The plan's results at instants of shape (N,).

        Raises:
            OutsideMotion: an instant outside the chain, or not a number.
        """
        outside = ~((instants >= self.start) & (instants <= self.chain.stop))
        if outside.any():
            raise OutsideMotion(float(instants[outside][0]), self.start, self.chain.stop)
        plan, topology = self.readout.plan, self.readout.mechanism.topology
        moving = [*topology.moving, *topology.carried]
        states: list[dict[str, Array]] = [{} for _ in range(plan.derivative + 1)]
        for order, shift in enumerate(self._chassis(instants, plan.derivative_of_points)):
            states[order] |= {name: shift[name] for name in topology.chassis}
        for names, derivatives in self._requests(moving):
            columns = [np.concatenate([series[n] for n in names], axis=-1) for series in self._point_series]
            values = evaluate(self.chain, columns, instants, derivatives)
            for order in range(derivatives + 1):
                for i, name in enumerate(names):
                    states[order][name] = values[..., order, :, 3 * i : 3 * i + 3]
        ordered = [{name: state[name] for name in topology.points if name in state} for state in states]
        return self.readout.samples(instants, ordered)

    @property
    def work(self) -> Work:
        """What evaluating costs per instant."""
        topology = self.readout.mechanism.topology
        requests = self._requests([*topology.moving, *topology.carried])
        return Work(
            derivatives_evaluated=self.readout.plan.derivative + 1,
            coordinates_evaluated=sum(3 * len(names) * (derivatives + 1) for names, derivatives in requests),
        )

    def _requests(self, moving: list[str]) -> list[tuple[list[str], int]]:
        """Which points to evaluate to which derivative."""
        plan, topology = self.readout.plan, self.readout.mechanism.topology
        requests = [(moving, plan.derivative_of_points)]
        if plan.derivative > plan.derivative_of_points:
            body_points = {point for body in topology.bodies.values() for point in body}
            requests.append(([name for name in moving if name in body_points], plan.derivative))
        return requests

    @cached_property
    def _point_series(self) -> list[dict[str, Array]]:
        """For each segment the series of every moving and carried point, (..., order + 1, 3)."""
        mechanism = self.readout.mechanism
        layout, topology = mechanism.layout, mechanism.topology
        result = []
        for segment in self.chain.segments:
            series = {name: segment.coefficients[..., list(layout.vector(name))] for name in topology.moving}
            for name, carriers in topology.carried.items():
                series[name] = carried_series(mechanism.carrier_weights[name], *(series[c] for c in carriers))
            result.append(series)
        return result

    def _chassis(self, instants: Array, derivatives: int) -> list[dict[str, Array]]:
        """States of the chassis points, straight from the inputs that move the chassis."""
        mechanism = self.readout.mechanism
        topology = mechanism.topology
        inputs = {
            name: f.series(instants, derivatives)
            for name, f in self.functions.items()
            if name in topology.chassis_motion
        }
        shift = mechanism.chassis_shift(inputs)
        if shift is None:
            shift = np.zeros((len(instants), derivatives + 1, 3))
        return [
            {
                name: shift[..., order, :] * max(order, 1)
                + (mechanism.drawing.vectors[name][..., None, :] if order == 0 else 0.0)
                for name in topology.chassis
            }
            for order in range(derivatives + 1)
        ]


def _motion(
    samples: Samples, method: Method, pose: Pose, work: Work, resample: Callable[[Array], Samples] | None
) -> Motion:
    notes = []
    for channel in (samples.angular_velocity, samples.angular_acceleration):
        for body in channel:
            bad = int(np.count_nonzero(~np.isfinite(channel[body]).all(axis=-1)))
            if bad:
                notes.append(
                    f"{channel.quantity} of {body} is not a number at {bad} of {len(samples.times)} instants: "
                    "the printed quotient divides by zero there"
                )
    fields = {name: getattr(samples, name) for name in samples.__dataclass_fields__}
    return Motion(**fields, method=method, start=pose, work=work, notes=tuple(notes), resample=resample)
