"""The absolute-coordinate model, without its claims: of short motions they take several times as long.

The set-up describes the bodies and their rows and assembles the drawing. The model refines many instants at
once and solves for their rates with the factors that the last correction leaves, so its rates are part of
`solve`, some tenth of it; `output` reads points from the bodies and puts them where the chassis is.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene
from pointcoord.effects.plan import plan_effects
from pointcoord.effects.registry import QUANTITIES
from validate.cost.way import Ready, Setting
from validate.cost.ways.inputs import chassis_motion, laws_at
from validate.formulations.asked_numbers import asked_numbers
from validate.formulations.protocol import Numbers

if TYPE_CHECKING:
    from absolute.mechanism import Mechanism
    from absolute.results import Record
    from absolute.tracking import Tracking

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Absolute:
    """Poses of rigid bodies in Pinocchio."""

    name: str = "absolute"
    words: str = "poses of rigid bodies (absolute coordinates), with Pinocchio"
    package: str | None = "pinocchio"
    settings: tuple[Setting, ...] = (Setting(),)
    dense: bool = False

    def prepare(self, scene: Scene, setting: Setting) -> Ready:
        """Describe the model and assemble its drawing.

        Raises:
            AbsoluteError: the model refuses the drawing.
        """
        import absolute
        from absolute.mechanism import Mechanism
        from absolute.tracking import Tracking
        from validate.formulations.absolute_coordinates import near_origin

        part, origin = scene.mechanism, near_origin(scene.mechanism)
        near = {name: (np.array(point) - origin).tolist() for name, point in part.points.items()}
        model = absolute.suspension_of(part.type)(
            near, up=part.up, right=part.right, side=part.side, closure=part.closure
        )
        mechanism = Mechanism(model)
        return _Ready(scene, origin, mechanism, Tracking(mechanism))


@dataclass(frozen=True)
class _Ready:
    scene: Scene
    origin: Array
    mechanism: Mechanism
    tracking: Tracking
    asked: Mapping[str, tuple[str, ...]] = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "asked", asked_numbers(self.scene))

    def solve(self, instants: Array) -> Record:
        """Find the poses, and the rates if any are asked for."""
        from absolute.effects import effects_of
        from absolute.input_arrays import chassis_series, input_series
        from absolute.results import Asked, Record
        from absolute.solve import solve_instants

        laws = laws_at(self.scene, instants)
        chassis = chassis_motion(self.scene, laws)
        moves = self.scene.mechanism.topology.chassis_motion
        series = input_series(
            tuple(self.mechanism.model.inputs), {name: law for name, law in laws.items() if name not in moves}
        )
        wanted = [n for q, names in self.asked.items() if QUANTITIES[q].of == "car" for n in names]
        rates = plan_effects(self.scene.effects).derivative > 0
        asked = Asked(rates, conditions=False, doubts=None, effects=effects_of(wanted))
        record = Record(self.mechanism, series, chassis_series(chassis, len(instants)), asked)
        solve_instants(self.tracking, series, rates, record)
        return record

    def rates(self, solved: Record) -> Record:
        """Nothing: `solve` found them."""
        return solved

    def output(self, solved: Record) -> Numbers:
        """Points in the user's axes, from his origin."""
        solution = solved.solution()
        numbers: dict[str, Mapping[str, Array]] = {}
        for quantity in self.asked:
            if QUANTITIES[quantity].of == "car":
                numbers[quantity] = solution.effects
            elif quantity == "position":
                numbers[quantity] = {name: place + self.origin for name, place in solution.position.items()}
            else:
                numbers[quantity] = getattr(solution, quantity)
        return numbers

    def counts(self, solved: Record) -> Mapping[str, int]:
        """Newton's corrections, each with a Jacobian and its factors."""
        steps = int(solved.solution().iterations.sum())
        return {"newton_steps": steps, "jacobians": steps, "factorisations": steps}


WAYS = (Absolute(),)
