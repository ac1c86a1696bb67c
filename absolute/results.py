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
        # [origin, angular] of each body; the chassis, and all without rates, stay at zero.
        self._velocity, self._acceleration = np.zeros((2, count, bodies, 2, 3))
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
            bodies = self._velocity[part, 1:]
            bodies[...] = refined.velocity[:count].reshape(bodies.shape)
            self._acceleration[part, 1:] = refined.acceleration[:count].reshape(bodies.shape)
        self._iterations[part] = refined.corrections[:count]
        self._residual[part] = refined.residual[:count]
        if len(self._left):
            self._left[part] = refined.left[:count]
        self.written += count

    def solution(self) -> Solution:
        """The instants solved so far in mm, carried by the chassis' motion."""
        count, drawing, model = self.written, self._mechanism.drawing, self._mechanism.model
        bodies = {body: drawing.bodies[body] for body in model.moving if body not in model.aids}
        points = {name: self._point(name) for name in model.reported}
        orders = range(3 if self._rates else 1)
        numbers = {
            kind: {name: state[order] for name, state in points.items()} if order in orders else {}
            for order, kind in enumerate(("position", "velocity", "acceleration"))
        }
        for kind, rates in (
            ("angular_velocity", self._velocity),
            ("angular_acceleration", self._acceleration),
        ):
            numbers[kind] = {body: rates[:count, i, 1].copy() for body, i in bodies.items() if self._rates}
        errors, condition = self._estimates(count)
        for kind, found in errors._asdict().items():
            numbers[f"{kind}_error"] = {name: found[name] for name in (*points, *bodies) if name in found}
        of_car = [turn.first(count) for turn in self._turns]
        lines = SolvedLines(self._mechanism, self._rotation[:count], self._origin[:count], errors, of_car)
        effects = self._asked.effects
        numbers["effects"] = {effect.name: effect.value(lines) for effect in effects}
        numbers["effect_errors"] = {
            effect.name: effect.error(lines) for effect in effects if self._asked.errors
        }
        iterations = self._iterations[:count].copy()
        iterations.setflags(write=False)
        solved = Solution(
            iterations=iterations,
            residual=_locked(self._residual[:count] * drawing.size),
            condition=None if condition is None else _locked(condition),
            **{kind: ReadOnly({n: _locked(a) for n, a in of.items()}) for kind, of in numbers.items()},
        )
        return carried(solved, of_car, self._shift[:count]) if of_car else solved

    def _point(self, name: str) -> Array:
        """(orders, N, 3) a point and its rates, mm and s."""
        drawing, model, count = self._mechanism.drawing, self._mechanism.model, self.written
        body, index = next(of for of in drawing.bodies.items() if name in model.bodies[of[0]])
        state = np.zeros((3, count, 3))
        if index:
            arm = self._rotation[:count, index] @ drawing.arm(body, name)
            speed, spin = self._velocity[:count, index].swapaxes(0, 1)
            second, spin1 = self._acceleration[:count, index].swapaxes(0, 1)
            # p' = o' + w x r,  p'' = o'' + w' x r + w x (w x r)
            turning = cross(spin, arm)
            state[0] = (self._origin[:count, index] + arm) * drawing.size + drawing.middle
            state[1] = (speed + turning) * drawing.size
            state[2] = (second + cross(spin1, arm) + cross(spin, turning)) * drawing.size
        else:
            state[0] = model.points[name]
        return state + self._chassis[:count].swapaxes(0, 1)

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
            motion = BodyMotion(self._rotation[part], origin, self._velocity[part], self._acceleration[part])
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
