"""The record of a motion while it is solved, and the points and bodies read from it."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from absolute.effects.effect import Effect
from absolute.estimate import BodyMotion, Errors, named
from absolute.lines import SolvedLines
from absolute.mapping import ReadOnly
from absolute.mechanism import Mechanism
from absolute.refine import Refined
from absolute.sampled_estimate import sampled
from absolute.solution import Array, Solution
from absolute.turning import Turning, carried
from absolute.vectors import cross

# Jacobians at once when condition numbers or errors are asked for: what stays in fast memory.
BATCH = 32
# Instants among which errors are interpolated: coefficients of an eighth of them at most are held, 20 MB.
STRETCH = 4096


class Asked(NamedTuple):
    """What shall be told of each instant beside the poses.

    Attributes:
        rates: velocities and accelerations. conditions: condition numbers. errors: how far these may be off.
        effects: those whose values are told.
    """

    rates: bool
    conditions: bool
    errors: bool
    effects: tuple[Effect, ...]


class Record:
    """Body poses and rates of the instants solved so far, in units of size."""

    def __init__(
        self,
        mechanism: Mechanism,
        series: Array,
        chassis: Array,
        asked: Asked,
        turns: Sequence[Turning] = (),
    ) -> None:
        count, rates = len(series), asked.rates
        bodies = len(mechanism.drawing.bodies)
        self._mechanism = mechanism
        # A chassis that turns is displaced after that.
        self._series, self._chassis = series, np.zeros_like(chassis) if turns else chassis
        self._turns, self._shift = turns, chassis
        self._asked = asked
        self._rates = rates
        self._rotation = np.zeros((count, bodies, 3, 3))
        self._origin = np.zeros((count, bodies, 3))
        # [origin, angular] of each body; the chassis stays at zero.
        self._velocity = np.zeros((count if rates else 0, bodies, 2, 3))
        self._acceleration = np.zeros((count if rates else 0, bodies, 2, 3))
        self._iterations = np.zeros(count, dtype=np.int64)
        self._residual = np.zeros(count)
        self._left = np.zeros((count if asked.errors else 0, 3, mechanism.stack.count))
        self.written = 0

    def store(self, refined: Refined, count: int) -> None:
        """Keep the first `count` of some refined instants, after those kept before."""
        part = slice(self.written, self.written + count)
        self._rotation[part] = refined.rotation[:count]
        self._origin[part] = refined.origin[:count]
        if self._rates:
            self._velocity[part, 1:] = refined.velocity[:count].reshape(self._velocity[part, 1:].shape)
            self._acceleration[part, 1:] = refined.acceleration[:count].reshape(
                self._velocity[part, 1:].shape
            )
        self._iterations[part] = refined.corrections[:count]
        self._residual[part] = refined.residual[:count]
        if len(self._left):
            self._left[part] = refined.left[:count]
        self.written += count

    def solution(self) -> Solution:
        """The instants solved so far in mm, carried by the chassis' motion."""
        count, chassis = self.written, self._chassis
        drawing, model = self._mechanism.drawing, self._mechanism.model
        position: dict[str, Array] = {}
        velocity: dict[str, Array] = {}
        acceleration: dict[str, Array] = {}
        for body, index in drawing.bodies.items():
            for point in model.bodies[body]:
                if point in position or point in model.aids:
                    continue
                if index == 0:
                    position[point] = np.array(model.points[point]) + chassis[:count, 0]
                    if self._rates:
                        velocity[point] = chassis[:count, 1].copy()
                        acceleration[point] = chassis[:count, 2].copy()
                    continue
                arm = self._rotation[:count, index] @ drawing.arm(body, point)
                position[point] = (
                    (self._origin[:count, index] + arm) * drawing.size + drawing.middle + chassis[:count, 0]
                )
                if self._rates:
                    # p' = o' + w x r,  p'' = o'' + w' x r + w x (w x r)
                    speed, spin = self._velocity[:count, index, 0], self._velocity[:count, index, 1]
                    second, spin1 = self._acceleration[:count, index, 0], self._acceleration[:count, index, 1]
                    turning = cross(spin, arm)
                    velocity[point] = (speed + turning) * drawing.size + chassis[:count, 1]
                    acceleration[point] = (
                        second + cross(spin1, arm) + cross(spin, turning)
                    ) * drawing.size + chassis[:count, 2]
        turns = {body: i for body, i in drawing.bodies.items() if self._rates and body not in model.aids}
        bodies = tuple(body for body in model.moving if body not in model.aids)
        spins = {body: self._velocity[:count, i, 1].copy() for body, i in turns.items() if i}
        spins1 = {body: self._acceleration[:count, i, 1].copy() for body, i in turns.items() if i}
        iterations = self._iterations[:count].copy()
        iterations.setflags(write=False)
        errors, condition = self._estimates(count)
        effects = self._asked.effects
        told = effects if self._asked.errors else ()
        of_car = [turn.first(count) for turn in self._turns]
        lines = SolvedLines(self._mechanism, self._rotation[:count], self._origin[:count], errors, of_car)
        in_order = {name: position[name] for name in model.reported}
        solved = Solution(
            position=_fixed(in_order),
            velocity=_fixed({name: velocity[name] for name in model.reported} if self._rates else {}),
            acceleration=_fixed({name: acceleration[name] for name in model.reported} if self._rates else {}),
            angular_velocity=_fixed(spins),
            angular_acceleration=_fixed(spins1),
            iterations=iterations,
            residual=_locked(self._residual[:count] * drawing.size),
            condition=None if condition is None else _locked(condition),
            position_error=_told(errors.position, model.reported),
            velocity_error=_told(errors.velocity, model.reported),
            acceleration_error=_told(errors.acceleration, model.reported),
            rotation_error=_told(errors.rotation, bodies),
            angular_velocity_error=_told(errors.angular_velocity, bodies),
            angular_acceleration_error=_told(errors.angular_acceleration, bodies),
            effects=_fixed({effect.name: effect.value(lines) for effect in effects}),
            effect_errors=_fixed({effect.name: effect.error(lines) for effect in told}),
        )
        return carried(solved, of_car, self._shift[:count]) if of_car else solved

    def _estimates(self, count: int) -> tuple[Errors, Array | None]:
        """Errors and condition numbers of the first `count` instants; nothing where none were asked for."""
        model, conditions = self._mechanism.model, self._asked.conditions
        if not self._asked.errors:
            return Errors({}, {}, {}, {}, {}, {}), self._condition_numbers(count) if conditions else None
        points, bodies = (
            {name: np.empty((count, 3)) for name in names} for names in (model.points, model.moving)
        )
        kinds = (points, points, points, bodies, bodies, bodies)
        whole = Errors(*({name: array.copy() for name, array in kind.items()} for kind in kinds))
        numbers = np.empty(count)
        for start in range(0, count, STRETCH):
            part = slice(start, min(start + STRETCH, count))
            origin, series = self._origin[part], self._series[part]
            still = np.zeros((*origin.shape[:2], 2, 3))
            rates = (self._velocity[part], self._acceleration[part]) if self._rates else (still, still)
            motion = BodyMotion(self._rotation[part], origin, *rates)
            if not self._rates:
                series = series * np.array([1.0, 0.0, 0.0])[:, None]
            found, numbers[part] = sampled(self._mechanism, motion, series, self._left[part], conditions)
            told = named(self._mechanism, motion, self._chassis[part], found)
            for kept, added in zip(whole, told, strict=True):
                for name, values in added.items():
                    kept[name][part] = values
        if not self._rates:
            whole = Errors(whole.position, {}, {}, whole.rotation, {}, {})
        return whole, numbers if conditions else None

    def _condition_numbers(self, count: int) -> Array:
        stack = self._mechanism.stack
        numbers = np.zeros(count)
        for start in range(0, count, BATCH):
            part = slice(start, min(start + BATCH, count))
            numbers[part] = np.linalg.cond(
                stack.jacobian(stack.place(self._rotation[part], self._origin[part]))
            )
        return numbers


def _locked(array: Array) -> Array:
    array.setflags(write=False)
    return array


def _fixed(arrays: dict[str, Array]) -> ReadOnly[Array]:
    return ReadOnly({name: _locked(array) for name, array in arrays.items()})


def _told(arrays: dict[str, Array], names: tuple[str, ...]) -> ReadOnly[Array]:
    return _fixed({name: arrays[name] for name in names} if arrays else {})
