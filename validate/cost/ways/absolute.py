"""The absolute-coordinate model, without its claims: of short motions they take several times as long.

The set-up describes the bodies and their rows and assembles the drawing.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene
from pointcoord.effects.plan import plan_effects
from pointcoord.effects.registry import QUANTITIES
from validate.cost.way import Answer, Solve, Way
from validate.cost.ways.inputs import laws_at
from validate.formulations.asked_numbers import asked_numbers

Array = NDArray[np.float64]


def in_bodies(scene: Scene, _: float | None) -> Solve:
    """Poses of rigid bodies in Pinocchio."""
    from absolute.effects import effects_of
    from absolute.input_arrays import chassis_series
    from absolute.mechanism import Mechanism
    from absolute.results import Asked, Record
    from absolute.solve import driven_series, solve_instants
    from absolute.tracking import Tracking
    from absolute.turning import turnings
    from validate.formulations.absolute_coordinates import chassis_motion, near_model, near_origin

    part, asked = scene.mechanism, asked_numbers(scene)
    origin = near_origin(part)
    mechanism = Mechanism(near_model(part, tuple(scene.inputs), origin))
    tracking = Tracking(mechanism)
    rates = plan_effects(scene.effects).derivative > 0
    wanted = [name for quantity in asked if QUANTITIES[quantity].of == "car" for name in asked[quantity]]
    told = Asked(rates, conditions=False, errors=False, effects=effects_of(wanted))

    def solve(instants: Array) -> Answer:
        laws = laws_at(scene, instants)
        chassis = chassis_series(chassis_motion(part, laws), len(instants))
        turns = turnings(mechanism.model, laws, len(instants))
        laws = {name: law for name, law in laws.items() if name not in part.topology.chassis_motion}
        series = driven_series(mechanism.model, laws)
        record = Record(mechanism, series, chassis, told, turns)
        solve_instants(tracking, series, rates, record)
        solved = record.solution()
        numbers: dict[str, Mapping[str, Array]] = {}
        for quantity in asked:
            of_car = QUANTITIES[quantity].of == "car"
            numbers[quantity] = solved.effects if of_car else getattr(solved, quantity)
        places = numbers["position"].items()
        numbers["position"] = {name: place + origin for name, place in places}
        return Answer(numbers, {"newton_steps": int(solved.iterations.sum())})

    return solve


WAYS = (
    Way(
        "absolute",
        "poses of rigid bodies (absolute coordinates), with Pinocchio",
        in_bodies,
        values=(None,),
        package="pinocchio",
    ),
)
