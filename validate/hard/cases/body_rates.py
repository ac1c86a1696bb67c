"""Rates of the knuckle where the paper's formula is 0/0, and rates that are exactly zero.

The paper prints omega = v65 x v75 / (v65 . r75). As v = omega x r, the divisor is omega . (r65 x r75). It is
zero whenever omega lies in the plane of the knuckle's three points: while the arm is held, and at one angle
of the turning arm. pointcoord divides by the square of the vector product of the two edges
instead.
"""

from __future__ import annotations

from functools import partial

from validate.hard.case import Case, family, values_of
from validate.hard.subjects import NAMED, PAPER, SQUARE, SUBJECTS, Content, Subject, hyphens, scene_content

VALUES = (1e-1, 1e-7, 0.0)
RACK_RATE = 150.0  # mm/s, the paper's steering scene
PLANE_ANGLE = 1.760964175417552  # rad: arm angle at which omega lies in the knuckle's plane
CASES: list[Case] = []
_rates = partial(family, CASES, "Body rates")


@_rates("rate of the arm while the rack is driven, rad/s; then the arm is held", VALUES, subjects=[PAPER])
def arm_all_but_held(_: Subject, value: float) -> Content:
    """Two points of the knuckle hardly move while the rack moves: the paper's formula is nearly 0/0."""
    return scene_content(PAPER.car, [SQUARE, value], [0.0, RACK_RATE, 25.0], stop=0.4)


@_rates(
    "distance of the turning arm from the angle at which it does, rad; then at it", VALUES, subjects=[PAPER]
)
def omega_in_the_knuckle_plane(_: Subject, value: float) -> Content:
    """Omega lies in the plane of the knuckle's points: the divisor of the paper's formula is zero."""
    return scene_content(PAPER.car, [PLANE_ANGLE + value, 1.0])


def hardly_moves(driven: str, subject: Subject, value: float) -> Content:
    """One input moves at this rate, all others are at rest."""
    return subject.absolute({**subject.home, driven: [subject.home[driven], value]})


for name, unit in {name: unit for one in SUBJECTS for name, unit in one.units.items()}.items():
    label = name.removesuffix("_angle")
    _rates(
        f"rate of the {label}, {unit}/s; then at rest",
        lambda one: values_of(one, (1e-25, 1e-175, 0.0)),
        subjects=[one for one in SUBJECTS if name in one.driven],
        name=f"{hyphens(label)}-hardly-moves",
        why=f"Only the {label} moves, very slowly: rates must keep their relative accuracy down to zero.",
    )(partial(hardly_moves, name))


@_rates("arm angle from a right angle, rad; then at it", VALUES)
def at_rest(subject: Subject, value: float) -> Content:
    """All inputs are at rest, so every rate is zero: rounding must not produce a motion."""
    still = [value, 0.0, 0.0], [20.0 if subject.level else value, 0.0], 0.0 if subject.heaves else None
    # The strut is turned about an oblique axis.
    return subject.content(*still, car=NAMED["other"].car if subject is PAPER else None, stop=1.0)
