r"""A chassis that turns: what was solved in its frame, as it is seen from the ground.

A turn by the angle t(t) about the unit axis u through the fixed point P, with U v = u x v, takes a place x to

    P + R (x - P),    R = I + sin t U + (1 - cos t) U U        (Rodrigues)

and with w = t' u, a = t'' u any vector s that is solved in the chassis' frame has, seen from the ground,

    (R s)'  = R s' + w x R s
    (R s)'' = R s'' + 2 w x R s' + a x R s + w x (w x R s):

rate and acceleration of a point with s = x - P (the term with 2 w is Coriolis'), and of a body, whose rates
are s and s', angular velocity w + R s and angular acceleration a + (R s)'. Of several turns the next
one takes what the one before has made. A displacement is added last.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from absolute.description import Model, unit_of, vector_of
from absolute.input_arrays import turn_series
from absolute.mapping import ReadOnly
from absolute.precision import EPS
from absolute.rounding import spread
from absolute.solution import Array, Solution
from absolute.vectors import cross

U = 0.5 * EPS
# Of R s, in parts of |s|: two sums in each entry of R, the product with s.
PRODUCT = spread(2 + 3)
# An axis is the vector product (3) of two directions that were normalized twice (5 each).
AXIS = 3 + 4 * 5
# What a turn changes of s: sine (2) and 1 - cos = 2 sin(t/2)^2 (6, of 2 at most) with U and U U (3), and the
# axis in both. The angle itself is rounded as it is told.
ANGLE = 2.0 * spread(2 + 6 + 3 + AXIS)
# w and a: their numbers as told, the axis, their product; a product with them and its sum (6).
TURNED = spread(1 + AXIS + 1 + 6)


@dataclass(frozen=True)
class Turning:
    """A turn of the chassis at N instants.

    Attributes:
        about: P, (3,), mm. axis: u, (3,). angle: t, t', t'', (N, 3), rad and s.
    """

    about: Array
    axis: Array
    angle: Array

    def first(self, count: int) -> "Turning":
        """At the first instants alone."""
        return replace(self, angle=self.angle[:count])

    @property
    def rotation(self) -> Array:
        """R, (N, 3, 3)."""
        t = self.angle[:, 0, None, None]
        # A row v of this product is u x e_i: the transpose of U.
        across = np.cross(self.axis, np.eye(3)).T
        once, twice = np.sin(t) * across, 2.0 * np.sin(0.5 * t) ** 2 * (across @ across)
        return np.asarray(np.eye(3) + once + twice)

    @property
    def rates(self) -> Array:
        """w and a, (2, N, 3), rad/s and rad/s^2."""
        return np.asarray(self.angle.T[1:, :, None] * self.axis)

    def seen(self, vector: Array) -> Array:
        """R s and as many of its rates as there are of s, (orders, N, 3)."""
        turned: Array = np.matvec(self.rotation, vector)
        w, a = self.rates
        seen = turned.copy()
        if len(seen) > 1:
            seen[1] += cross(w, turned[0])
        if len(seen) > 2:
            seen[2] += 2.0 * cross(w, turned[1]) + cross(a, turned[0]) + cross(w, cross(w, turned[0]))
        return seen

    def error(self, vector: Array, off: Array) -> Array:
        """How far `seen` may be off where s and its rates are by `off`, (orders, N, 3)."""
        angle = np.abs(self.angle.T)
        size = np.linalg.norm(vector, axis=-1)
        turned = PRODUCT + ANGLE * np.minimum(angle[0], 1.0) + U * angle[0]
        w, a = np.abs(self.rates)
        speed, second = TURNED * angle[1:]
        with np.errstate(invalid="ignore"):  # nothing times what may be anything
            error: Array = np.matvec(np.abs(self.rotation), off) + (turned * size)[..., None]
            seen = error.copy()
            if len(seen) > 1:
                seen[1] += _product(w, error[0]) + (speed * size[0])[:, None]
            if len(seen) > 2:
                seen[2] += 2.0 * _product(w, error[1]) + _product(a, error[0])
                seen[2] += _product(w, _product(w, error[0]))
                seen[2] += (2.0 * speed * (size[1] + angle[1] * size[0]) + second * size[0])[:, None]
        return np.where(np.isnan(seen), np.inf, seen)


def _product(a: Array, b: Array) -> Array:
    """|a| x |b| with all terms added: no component of a x b is larger."""
    return np.asarray(np.roll(a, -1, -1) * np.roll(b, -2, -1) + np.roll(a, -2, -1) * np.roll(b, -1, -1))


def turnings(model: Model, inputs: Mapping[str, Array], count: int) -> tuple[Turning, ...]:
    """The turns of a model that are told, in its order.

    Args:
        inputs: name -> (N, 3) angle, rate and acceleration of some of them, among others. count: N.
    Raises:
        InputError: one is of another length, not finite, or too fast.
    """
    return tuple(
        Turning(
            np.array(model.points[model.turns[name].through]),
            unit_of(name, vector_of(name, name, model.turns[name].toward)),
            angle,
        )
        for name, angle in turn_series(tuple(model.turns), inputs, count).items()
    )


def carried(solved: Solution, turns: Sequence[Turning], shift: Array) -> Solution:
    """What was solved in the chassis' frame as it is seen from the ground.

    Args:
        turns: one after the other.
        shift: (N, 3, 3) displacement, velocity and acceleration, mm, added last.
    """
    shifts = shift.swapaxes(0, 1)

    def of_point(state: Array, off: Array | None) -> tuple[Array, Array | None]:
        for turn in turns:
            arm = state.copy()
            arm[0] -= turn.about
            state = turn.seen(arm)
            if off is not None:
                off[0] += U * np.abs(arm[0])
                off = turn.error(arm, off) + U * np.abs(state)
            state[0] += turn.about
            if off is not None:
                off[0] += U * np.abs(state[0])
        state = state + shifts[: len(state)]
        return state, None if off is None else off + U * np.abs(state)

    def of_body(state: Array, off: Array | None) -> tuple[Array, Array | None]:
        for turn in turns:
            if off is not None:
                own = TURNED * np.abs(turn.angle.T[1:])
                off = turn.error(state, off) + own[..., None]
            state = turn.seen(state) + turn.rates
            if off is not None:
                off += U * np.abs(state)
        return state, off

    kinds: tuple[tuple[tuple[str, ...], Callable[[Array, Array | None], tuple[Array, Array | None]]], ...] = (
        (("position", "velocity", "acceleration"), of_point),
        (("angular_velocity", "angular_acceleration"), of_body),
    )
    told: dict[str, dict[str, Array]] = {}
    for quantities, way in kinds:
        # Without rates, and without errors, there are fewer.
        numbers = [getattr(solved, quantity) for quantity in quantities]
        errors = [getattr(solved, f"{quantity}_error") for quantity in quantities]
        for name in numbers[0]:
            state = np.array([of[name] for of in numbers if of])
            known = np.array([of[name] for of in errors if of]) if errors[0] else None
            state, known = way(state, known)
            for quantity, value in zip(quantities, state, strict=False):
                told.setdefault(quantity, {})[name] = value
            for quantity, value in zip(quantities, () if known is None else known, strict=False):
                told.setdefault(f"{quantity}_error", {})[name] = value
    rotations = {name: off[None] for name, off in solved.rotation_error.items()}
    for turn in turns:
        # A body is off by what it was, turned, and by what the turn is off for a vector of length 1.
        rotations = {
            name: turn.error(np.broadcast_to(turn.axis, off.shape), off) for name, off in rotations.items()
        }
    told["rotation_error"] = {name: off[0] for name, off in rotations.items()}
    for arrays in told.values():
        for array in arrays.values():
            array.setflags(write=False)
    changed: dict[str, Any] = {quantity: ReadOnly(arrays) for quantity, arrays in told.items()}
    return replace(solved, **changed)
