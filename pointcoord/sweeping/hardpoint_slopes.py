r"""Exact derivatives of the numbers of a solved scene by its hardpoint coordinates.

A hardpoint coordinate x changes the known coordinates w: positions of points of the chassis, and dimensions
taken from the drawing, such as lengths and positions of points in their bodies. The inputs keep their values
unless changes of them are given. The derivatives of the poses y(t, x) of order d in t and order 1 in x follow
from C(y) = 0,

    C_u u_x^(d) = -( C_w w_x^(d) + sum_{0 < i <= d} binomial(d, i) 2 B(y^(i), y_x^(d-i)) ).

The derivatives along a way (see `linkage.slopes`) follow likewise, with the way in place of t and d = 1. The
formulas of the effects are then evaluated with dual numbers of these derivatives.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import factorial
from typing import Any

import numpy as np

from pointcoord.effects.arithmetic import Dual
from pointcoord.effects.effect import Poses
from pointcoord.linkage.chassis import ChassisMotion
from pointcoord.linkage.hardpoints import hardpoints_moved
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.linkage.slopes import (
    GAP,
    Way,
    known_slopes,
    point_series,
    point_slopes,
    shifted,
    way_slopes,
)
from pointcoord.numerics.arrays import Array
from pointcoord.numerics.counters import Work
from pointcoord.numerics.infinitesimal import slope_of, with_slope
from pointcoord.numerics.linear import factorise
from pointcoord.numerics.newton import implicit_rate, implicit_slopes, newton_refine
from pointcoord.poses import PoseSolver
from pointcoord.results.readout import Laws, Readout, alone
from pointcoord.results.solved_scene import SolvedScene
from pointcoord.scene.scene_file import Scene
from pointcoord.solve.pointwise import square_velocity_term, with_rates
from pointcoord.sweeping.designs import AXES, designs_of

# Most numbers in the coordinates, time derivatives and slopes of the poses of one block: 30 MB.
ROOM = 4e6
# Largest change of a left-out equation, between coordinates below 1, if a hardpoint moves by the mechanism's
# size and the equation still follows from the others. Such an equation changes by rounding only, 5e-16 in
# bricard; any other changes by 0.1 and more.
HELD = 1e-9
LOCKS = (
    "as drawn, the equation {} follows from the others; with this coordinate changed it does not, and the "
    "mechanism locks"
)


@dataclass(frozen=True, eq=False)
class DualPoses(Poses):
    """Poses in dual numbers. The slopes have one more dimension in front, of K parameters.

    The mechanism has slopes of every dimension taken from the drawing.
    """

    def constant(self, number: Array) -> Dual[Array]:
        return Dual(number, np.zeros_like(number))

    @cached_property
    def drawn(self) -> Mapping[str, Dual[Array]]:
        return _duals(self.mechanism.drawn_places)


@dataclass(frozen=True, eq=False)
class MovedPoses:
    """Coordinates of poses with slopes by K parameters (see `infinitesimal`).

    Attributes:
        laws: laws of the inputs that move the chassis.
        states: y and its time derivatives, (K, N, size).
        ways: derivative of y along each way, per rad, mm or unit, (K, N, size).
        violated: change of the left-out rows, which follow from the others as drawn, if a hardpoint moves by
            the mechanism's unit, (K, N, rows).
    """

    laws: Laws
    states: Sequence[Array]
    ways: Mapping[Way, Array]
    violated: Array


@dataclass(frozen=True, eq=False)
class ByHardpoints:
    """Derivatives of a car's numbers by K parameters that move its hardpoints.

    Attributes:
        readout: the requested numbers of the car.
        moves: derivative of every hardpoint's drawn position by each parameter, by hardpoint, (K, 3), mm.
    """

    readout: Readout
    moves: Mapping[str, Array]

    @cached_property
    def moved(self) -> Mechanism:
        """The mechanism with slopes of every dimension taken from the drawing."""
        return hardpoints_moved(self.readout.mechanism, self.moves)

    @cached_property
    def drawn_inputs(self) -> dict[str, Array]:
        """The inputs of the drawing, with their slopes, (K, 1), rad or mm.

        An input q drives coordinates with w(q, x) = w_drawn(x), so that q_x = (w_drawn - w)_x / w_q. An angle
        drives two coordinates; its q_x is the least squares solution.
        """
        mechanism, moved = self.readout.mechanism, self.moved
        values = mechanism.drawn_inputs
        along, square = (dict.fromkeys(values, np.zeros((1, 1))) for _ in range(2))
        for drive, place in zip(mechanism.topology.drives, mechanism.topology.driven, strict=True):
            series = np.array([values[drive.input], 1.0])
            rate = drive.series(series, mechanism.drawing)[1]
            gap = moved.drawn[..., place] - drive.series(series, moved.drawing)[..., 0]
            along[drive.input] = along[drive.input] + rate * slope_of(gap)
            square[drive.input] = square[drive.input] + rate**2
        with np.errstate(divide="ignore", invalid="ignore"):
            return {name: with_slope(value, along[name] / square[name]) for name, value in values.items()}

    def along(self, solved: SolvedScene, times: Array) -> MovedPoses:
        """Poses of a motion at instants, (N,), s."""
        mechanism, highest = self.readout.mechanism, self.readout.plan.derivative
        system = mechanism.map
        laws = {name: law.series(times, highest) for name, law in solved.functions.items()}
        known = mechanism.known_series(laws)
        y = solved.coordinates(times, 0)[0].copy()
        y[:, system.unknowns :] = known[:, 0]
        # The motion is exact to its tolerance only; derivatives shall be exact to rounding.
        y = newton_refine(system, y).y
        states = with_rates(system, y, known, times, highest, square_velocity_term, Work()).states
        return self._moved(states, laws, self.readout.laws(times))

    def at(self, y: Array, inputs: Mapping[str, Array], laws: Laws) -> MovedPoses:
        """Poses y, (N, size), at given inputs.

        Args:
            y: coordinates of the poses.
            inputs: values of the inputs that drive the linkage, (N,), or with slopes (K, N), rad or mm.
            laws: values of the inputs that move the chassis.
        """
        return self._moved([y], {name: value[..., None] for name, value in inputs.items()}, laws)

    def _moved(self, states: Sequence[Array], driven: Mapping[str, Array], laws: Laws) -> MovedPoses:
        """Poses and their time derivatives, from the series of the inputs that drive the linkage."""
        mechanism, y = self.readout.mechanism, states[0]
        system, topology = mechanism.map, mechanism.topology
        by_x = slope_of(self.moved.known_series(driven))
        factors = factorise(system.jacobian(y))
        slopes = implicit_slopes(
            system, factors, states, [factorial(d) * by_x[..., d, :] for d in range(len(states))]
        )
        inputs, found = {name: series[..., 0] for name, series in driven.items()}, {}
        ways = self.readout.plan.ways(topology)
        for way, rate in zip(ways, way_slopes(mechanism, y, ways), strict=True):
            gap, rows = shifted(topology, way)
            more = 2.0 * (system.polar(rate, slopes[0]) + rows * system.polar(slopes[0], gap))
            own = slope_of(known_slopes(self.moved, inputs, way))
            found[way] = with_slope(rate, implicit_rate(system, factors, y, own, more))
        violated = np.zeros((*slopes[0].shape[:-1], 0))
        if topology.left_out:
            violated = 2.0 * float(mechanism.unit) * topology.left_map.polar(y, slopes[0])
        return MovedPoses(laws, list(map(with_slope, states, slopes)), found, violated)

    def numbers(self, at: MovedPoses) -> dict[str, dict[str, Array]]:
        """Slopes of every number by quantity and name, (K, N) of the car, (K, N, 3) of points and bodies."""
        readout, moved, laws = self.readout, self.moved, at.laws
        orders = [factorial(d) for d in range(len(at.states))]
        series = np.stack([state / n for state, n in zip(at.states, orders, strict=True)], axis=-2)
        of_points = point_series(moved, series).items()
        in_chassis = [{name: n * each[..., d, :] for name, each in of_points} for d, n in enumerate(orders)]
        centres = {name: centre[:, 0] for name, centre in ChassisMotion.of(moved, {}).centres.items()}
        chassis = replace(readout.chassis, centres=centres)
        ways = {}
        for way, rate in at.ways.items():
            along = point_slopes(moved, at.states[0], rate, way)
            places = {GAP: np.zeros_like(along[GAP])} if GAP in along else {}
            turned = chassis.turned_by(alone(laws, way), [in_chassis[0] | places, along])
            ways[way] = _duals(turned[1]), _duals(along)
        poses = DualPoses(
            moved,
            readout.axes,
            list(map(_duals, chassis.turned_by(laws, in_chassis))),
            list(map(_duals, in_chassis)),
            ways,
        )
        found: dict[str, dict[str, Array]] = {}
        for effect in readout.plan.computed:
            evaluated: Mapping[str, Mapping[str, Any]] = effect.evaluate(poses)
            for quantity, numbers in evaluated.items():
                for name, number in numbers.items():
                    slope = np.broadcast_to(number.slope, (len(series), *number.value.shape))
                    found.setdefault(quantity, {})[name] = slope
        return found


@dataclass(frozen=True)
class Slopes:
    """Derivatives of every number by hardpoint coordinates.

    Attributes:
        numbers: derivatives by quantity and name, (coordinates, N) of the car and (coordinates, N, 3) of
            points and bodies, in the number's unit per mm; NaN where there is no derivative.
        failures: why there is no derivative, by coordinate.
    """

    numbers: Mapping[str, Mapping[str, Array]]
    failures: Mapping[str, str]


def slopes_of_motion(scene: Scene, solved: SolvedScene, times: Array, coordinates: Sequence[str]) -> Slopes:
    """Derivatives of the numbers of a scene's motion at instants, (N,), s; the inputs keep their values."""
    by_hardpoints = ByHardpoints(solved.readout, moves_of(scene, coordinates))

    def poses(some: slice) -> MovedPoses:
        return by_hardpoints.along(solved, times[some])

    return _slopes(by_hardpoints, coordinates, len(times), poses)


def slopes_of_poses(
    solver: PoseSolver,
    inputs: Mapping[str, Array],
    coordinates: Sequence[str],
    drawn: Collection[str] = (),
    changes: Mapping[str, Array] | None = None,
) -> Slopes:
    """Derivatives of the numbers of poses at given inputs.

    Args:
        inputs: values of every input, each (N,), rad or mm.
        drawn: inputs that keep their drawn position, so that their values change with the drawing.
        changes: derivatives of other inputs that drive the linkage by each coordinate, (coordinates,), rad or
            mm per mm. All further inputs keep their values.
    Raises:
        AssemblyError: a pose cannot be reached from the drawing on a straight path.
    """
    by_hardpoints = ByHardpoints(solver.readout, moves_of(solver.scene, coordinates))
    driving = {name: inputs[name] for name in solver.mechanism.topology.required_inputs}
    y, laws = solver.coordinates(driving), solver.laws(inputs)
    moving = {name: slope_of(by_hardpoints.drawn_inputs[name]) for name in drawn}
    moving |= {name: change[:, None] for name, change in (changes or {}).items()}

    def poses(some: slice) -> MovedPoses:
        here = {name: value[some] for name, value in driving.items()}
        here |= {name: with_slope(here[name], change) for name, change in moving.items()}
        return by_hardpoints.at(y[some], here, {name: [law[0][some]] for name, law in laws.items()})

    return _slopes(by_hardpoints, coordinates, len(y), poses)


def moves_of(scene: Scene, coordinates: Sequence[str]) -> dict[str, Array]:
    """Derivative of every hardpoint's position by each coordinate, by hardpoint, (K, 3).

    Points that move with another hardpoint (see `Designs.following`) have the derivatives of that hardpoint.
    """
    points = scene.mechanism.points
    found = {name: np.zeros((len(coordinates), 3)) for name in points}
    for i, coordinate in enumerate(coordinates):
        point, _, axis = coordinate.rpartition(".")
        found[point][i, AXES.index(axis)] = 1.0
    following = designs_of(scene, offsets=dict.fromkeys(coordinates, 0.0)).following
    return found | {name: found[other] for name, other in following.items()}


def _slopes(
    by_hardpoints: ByHardpoints,
    coordinates: Sequence[str],
    count: int,
    poses: Callable[[slice], MovedPoses],
) -> Slopes:
    """Derivatives of the numbers of `count` poses, computed in blocks that fit into ROOM."""
    plan, topology = by_hardpoints.readout.plan, by_hardpoints.readout.mechanism.topology
    each = len(coordinates) * topology.layout.size * (plan.derivative + 1 + 2 * len(plan.ways(topology)))
    together = max(int(ROOM // each), 1)
    parts, violated = [], np.zeros((len(coordinates), len(topology.left_out)))
    for low in range(0, count, together):
        here = poses(slice(low, low + together))
        parts.append(by_hardpoints.numbers(here))
        violated = np.maximum(violated, np.abs(here.violated).max(axis=1))
    found = {
        quantity: {name: np.concatenate([part[quantity][name] for part in parts], axis=1) for name in of}
        for quantity, of in parts[0].items()
    }
    worst = {i: int(np.argmax(rows)) for i, rows in enumerate(violated) if (rows > HELD).any()}
    for array in (array for numbers in found.values() for array in numbers.values()):
        array[[*worst]] = np.nan
    failures = {coordinates[i]: LOCKS.format(topology.left_labels[row]) for i, row in worst.items()}
    return Slopes(found, failures)


def _duals(points: Mapping[str, Array]) -> dict[str, Dual[Array]]:
    """Dual numbers of values, (N, 3), which do not depend on the parameter, and slopes, (K, N, 3)."""
    return {name: Dual(point.real[0], slope_of(point)) for name, point in points.items()}
