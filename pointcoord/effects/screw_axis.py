r"""The screw axis of the knuckle as the rack moves and all else is held: the axis that it is steered about.

A mechanism without a steering axis, such as five links, has this one too ("virtual kingpin"). With w the turn
of the knuckle and v the displacement of the wheel centre W per mm of rack, its direction is w, upward, and

    W + w x v / |w|^2

is a point of it; w . v / |w|^2 is how far the knuckle goes along it per radian. The lengths and angles are
those of the steering axis, of this one (suspension-explorer; Altair holds the spring's travel).
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from pointcoord.effects.angle import WHEEL
from pointcoord.effects.arithmetic import Dual, angle, cross, dot, ratio, reciprocal, sign_of, times
from pointcoord.effects.car_number import BY_RACK, DIMENSION, CarNumbers, Number
from pointcoord.effects.corner import Corner
from pointcoord.effects.effect import Quantity
from pointcoord.effects.knuckle import angular_velocity, at_rest, component
from pointcoord.effects.steering_axis import LENGTHS, Axis
from pointcoord.effects.wheel_angles import KINGPIN, LEAN_REARWARD

PITCH = Quantity("screw_pitch", "pitch of the screw axis", "mm/rad", "car")
# Turns per rack travel of one radius of the wheel that rounding does not tell from none.
LEAST = 1e-9


def screw_axis(corner: Corner[Dual[Any]]) -> Axis[Any]:
    """That axis, from W."""
    view, (turn, moved) = at_rest(corner.seen), _twist(corner)
    beside = times(reciprocal(dot(turn, turn)), cross(turn, moved))
    return Axis(view, times(sign_of(view.along(turn, "up")), turn), beside)


def pitch(corner: Corner[Dual[Any]]) -> Any:
    """W . v / |w|^2."""
    turn, moved = _twist(corner)
    return ratio(dot(turn, moved), dot(turn, turn))


def _twist(corner: Corner[Dual[Any]]) -> tuple[Any, Any]:
    """Turn and displacement; no number where the knuckle does not turn, or about no line that leads up."""
    turn, moved = angular_velocity(corner), corner.seen.points[corner.seen.of.centre].slope
    if isinstance(turn, np.ndarray):
        rise = component(corner.seen, turn, "up")
        turn = np.where((np.abs(rise) * corner.seen.radius.value > LEAST)[..., None], turn, np.nan)
    return turn, moved


def _length(formula: Callable[[Axis[Any]], Any], corner: Corner[Dual[Any]]) -> Any:
    return formula(screw_axis(corner))


def _lean(sine: Any, cosine: Any, corner: Corner[Dual[Any]]) -> Any:
    axis = screw_axis(corner)
    return angle(axis.view.along(axis.direction, sine), axis.view.along(axis.direction, cosine))


def _number(name: str, words: str, sign: str, formula: Any, quantity: Quantity, power: int) -> Number:
    roles = ("wheel_axis", "knuckle")
    return Number(
        f"screw_{name}",
        f"{words} of the screw axis",
        sign,
        formula,
        roles,
        True,
        quantity,
        (),
        BY_RACK,
        power,
    )


SCREW_AXIS = CarNumbers.of(
    "screw_axis",
    "the knuckle's screw axis as the rack moves: angles, offsets, trails and pitch",
    *(
        _number(one.name, one.words, one.sign, partial(_lean, one.sine, one.cosine), WHEEL, 0)
        for one in (KINGPIN, LEAN_REARWARD)
    ),
    *(
        _number(name, words, sign, partial(_length, formula), DIMENSION, 1)
        for name, words, sign, formula in LENGTHS
    ),
    _number("pitch", "pitch", "where it is a right-handed screw", pitch, PITCH, 1),
    nowhere="the wheel does not turn as the rack moves",
)
