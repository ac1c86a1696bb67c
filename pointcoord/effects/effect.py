"""What a scene may ask for beside positions, and what each effect needs to be computed."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from pointcoord.errors import UnknownName


@dataclass(frozen=True)
class Effect:
    """An effect, in words and in what it needs.

    Attributes:
        gives: what a user gets.
        derivative: highest time derivative of positions that it needs.
        every_point: whether it needs that derivative of every point, or of the knuckle's only.
    """

    name: str
    gives: str
    derivative: int
    every_point: bool


EFFECTS = {
    effect.name: effect
    for effect in (
        Effect("velocity", "velocity of every point, mm/s", 1, True),
        Effect("acceleration", "acceleration of every point, mm/s^2", 2, True),
        Effect("knuckle_rates", "angular velocity and acceleration of the knuckle, rad/s, rad/s^2", 2, False),
        Effect("wheel_angles", "camber and kingpin angle, rad", 0, False),
    )
}


@dataclass(frozen=True)
class Plan:
    """What the effects of a scene make the solver do, and what they leave out.

    Attributes:
        effects: as asked for.
        derivative: highest derivative that is solved for, of any point.
        derivative_of_points: highest derivative that is evaluated for every point.
        derivative_of_knuckle: highest derivative that is evaluated for the knuckle's points.
    """

    effects: tuple[str, ...]
    derivative: int
    derivative_of_points: int
    derivative_of_knuckle: int

    @property
    def left_out(self) -> tuple[str, ...]:
        """Effects that are not computed."""
        return tuple(name for name in EFFECTS if name not in self.effects)


def plan_effects(effects: Iterable[str]) -> Plan:
    """The plan for a list of effects.

    Raises:
        UnknownName: an effect that does not exist.
    """
    asked = tuple(effects)
    for name in asked:
        if name not in EFFECTS:
            raise UnknownName("effect", name, EFFECTS)
    needs = [EFFECTS[name] for name in EFFECTS if name in asked]
    everything = max((e.derivative for e in needs if e.every_point), default=0)
    knuckle = max((e.derivative for e in needs), default=0)
    return Plan(tuple(e.name for e in needs), max(everything, knuckle), everything, max(everything, knuckle))
