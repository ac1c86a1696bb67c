r"""The numbers of a file's columns as a design gives them, and how they change with each hardpoint.

Positions and angles over time or inputs are read off poses that are solved one by one; rates off the motion;
what is over a travel off the design's own map, for the input that reaches a travel is another one in every
design. The slope by a coordinate p is the central difference

    dq/dp = (q(p + h) - q(p - h)) / 2h + O(h^2 q'''),    h = STEP.

With numbers solved to 1e-9 mm and cars of some 100 mm, q''' is some q' / (100 mm)^2: truncation is
h^2 / 6 / 100^2 = 4e-8 of the slope and rounding 1e-9 / h = 2e-8. `slopes` by twice the step measures it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from pointcoord import PointcoordError, Scene, designs_of, solve_poses
from pointcoord.data_classes import dataclass
from pointcoord.effects.registry import ALWAYS
from pointcoord.linkage.car_axes import CarAxes
from pointcoord.simulation import scene_mechanism
from pointcoord.solve.assembly import close_drawing
from validate.fitting.errors import FitError
from validate.measured.comparing import ours_of
from validate.measured.mapping import INPUT, TIME, TRAVEL, Measured, angle_of
from validate.measured.poses import Found, poses_of

Array = NDArray[np.float64]
Bools = NDArray[np.bool_]

STEP = 0.05  # mm


@dataclass(frozen=True)
class Curves:
    """The columns of a file over the designs of a scene.

    Attributes:
        scene: as drawn. free: the coordinates that vary, such as lower_ball_joint.z.
    """

    scene: Scene
    measured: Measured
    free: tuple[str, ...]

    def design(self, amounts: Array) -> Scene:
        """The scene with its free coordinates moved, (free,), mm.

        Raises:
            SceneError: the hardpoints make no mechanism.
        """
        offsets = dict(zip(self.free, amounts.tolist(), strict=True))
        return designs_of(self.scene, offsets=offsets).design(0)

    def found(self, amounts: Array, values: Sequence[Array] | None = None) -> Found:
        """Numbers at values of the independent columns, the file's own unless given.

        Raises:
            PointcoordError: the design cannot be solved.
        """
        design = self.design(amounts)
        if values is None:
            values = [s.values for s in self.measured.independent]
        return self._by_poses(design, values) if self._alone else poses_of(design, self.measured).at(values)

    def at(self, amounts: Array, values: Sequence[Array] | None = None) -> Array:
        """Every column one after the other, (columns * rows,), in our units; NaN where there is no pose."""
        try:
            found = self.found(amounts, values)
        except PointcoordError:
            return np.full(len(self.measured.numbers) * len(self.measured.rows), np.nan)
        return self.read(found)

    def read(self, found: Found) -> Array:
        """The columns of what was found, likewise."""
        nothing = np.full(len(found.reached), np.nan)
        columns = [ours_of(s, found, self.scene)[0] for s in self.measured.numbers]
        return np.concatenate([nothing if c is None else c for c in columns])

    def slopes(self, amounts: Array, used: Bools, step: float = STEP) -> Array:
        """How the used numbers change with each coordinate, (used, free), in our units by mm.

        Raises:
            FitError: a design a step away cannot be solved.
        """
        found = np.empty((int(used.sum()), len(self.free)))
        for i, name in enumerate(self.free):
            move = step * np.eye(len(self.free))[i]
            more, less = self.at(amounts + move)[used], self.at(amounts - move)[used]
            found[:, i] = (more - less) / (2.0 * step)
            if not np.isfinite(found[:, i]).all():
                problem = f"moving it by {step:g} mm leaves a row of {self.measured.source} without a pose"
                raise FitError(name, problem, "rows inside of what the car can do, or other coordinates")
        return found

    @property
    def _alone(self) -> bool:
        """Whether every row's inputs are known in any design, and every number is one of its pose."""
        over = [s.meaning.kind for s in self.measured.independent]
        travels = TRAVEL in over or any(name.startswith(f"{TRAVEL}.") for name in self.measured.held)
        places = {quantity.name for effect in ALWAYS for quantity in effect.quantities}
        return not travels and all(
            s.meaning.quantity in places or angle_of(s.meaning) is not None for s in self.measured.numbers
        )

    def _by_poses(self, design: Scene, values: Sequence[Array]) -> Found:
        inputs: dict[str, Array] = {}
        count = len(values[0])
        for s, value in zip(self.measured.independent, values, strict=True):
            if s.meaning.kind == TIME:
                inputs |= {name: law.series(value, 0)[:, 0] for name, law in design.functions.items()}
            else:
                inputs[s.meaning.name] = value
        inputs |= {
            name.removeprefix(f"{INPUT}."): np.full(count, value)
            for name, value in self.measured.held.items()
        }
        drawn = _drawn(design) if set(design.mechanism.topology.required_inputs) - set(inputs) else {}
        inputs = {name: np.full(count, value) for name, value in drawn.items()} | inputs
        poses = solve_poses(design, inputs)
        reasons = {row: str(error) for row, error in poses.failures.items()}
        part = design.mechanism
        axes = CarAxes(np.array(part.up), np.array(part.right), part.outboard)
        (places,) = (quantity.name for effect in ALWAYS for quantity in effect.quantities)
        numbers: dict[str, dict[str, Array]] = {places: dict(poses.position)}
        for s in self.measured.numbers:
            angle = angle_of(s.meaning)
            if angle is not None:
                start, end = (poses.position[point] for point in angle.ends(part.topology))
                numbers.setdefault(s.meaning.quantity, {})[s.meaning.name] = angle.value(start, end, axes)
        bounds = {places: {name: np.zeros_like(place) for name, place in poses.position.items()}}
        return Found(numbers, bounds, poses.solved, reasons)


def _drawn(scene: Scene) -> Mapping[str, float]:
    """The inputs of a closed drawing."""
    mechanism = scene_mechanism(scene)
    y = close_drawing(mechanism).y
    read = mechanism.input_values(y[mechanism.map.unknowns :])
    return {name: float(np.ravel(read[name])[0]) for name in mechanism.topology.required_inputs}
