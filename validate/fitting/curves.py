r"""The numbers of a file's columns as a design gives them, and how they change with each hardpoint.

Positions and angles are read off poses that are solved one by one, and rates off the motion. An input that
the file gives is the same in every design, a travel counting from the design's own drawing; one that it does
not give is as drawn, and the drawing changes. A number q at a row changes with a coordinate p by

    dq/dp = (q(p + s) - q(p - s)) / 2 s.

Central differences of solved designs lack s^2 / 6 of the third derivative: with s = STEP and points some
100 mm apart a part of 1e-8 of a slope; poses that are solved to 1e-12 mm make it off by 1e-10. The search
ends at 1e-9 of the sum of squares, where a part of 1e-5 of a slope would matter.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pointcoord import PointcoordError, Scene, designs_of
from validate.measured.mapping import Measured
from validate.measured.poses import Driven, Found, ours_of
from validate.tables.errors import FileError

Array = NDArray[np.float64]
Bools = NDArray[np.bool_]

TIGHT = 1e-12  # mm, of poses
STEP = 0.02  # mm, of differences by coordinates


@dataclass(frozen=True)
class Curves:
    """The columns of a file over the designs of a scene.

    Attributes:
        scene: as drawn. free: the coordinates that vary, such as lower_ball_joint.z.
    """

    scene: Scene
    measured: Measured
    free: tuple[str, ...]

    @cached_property
    def driven(self) -> Driven:
        """The car as drawn, driven by what rows are taken by.

        Raises:
            FileError: a travel cannot be followed.
        """
        return Driven.of(self.scene, self.measured)

    def design(self, amounts: Array, scene: Scene | None = None) -> Scene:
        """The scene with its free coordinates moved, (free,), mm.

        Raises:
            SceneError: the hardpoints make no mechanism.
        """
        offsets = dict(zip(self.free, amounts.tolist(), strict=True))
        return designs_of(self.scene if scene is None else scene, offsets=offsets).design(0)

    def solved(self, amounts: Array, values: Sequence[Array] | None = None) -> Found:
        """A design at values of the independent columns, the file's own unless given.

        Raises:
            PointcoordError: the design cannot be solved.
        """
        driven = self.driven.redrawn(self.design(amounts), self.design(amounts, self.driven.scene))
        values = [s.values for s in self.measured.independent] if values is None else values
        return driven.at(values, TIGHT, bounded=False)

    def numbers(self, found: Found) -> Array:
        """Every column one after the other, (columns * rows,), in our units; NaN where there is no pose."""
        nothing = np.full(len(found.reached), np.nan)
        columns = [ours_of(s, found)[0] for s in self.measured.numbers]
        return np.concatenate([nothing if c is None else c for c in columns])

    def at(self, amounts: Array, values: Sequence[Array] | None = None) -> Array:
        """The numbers of a design; NaN throughout where it cannot be solved."""
        try:
            return self.numbers(self.solved(amounts, values))
        except PointcoordError:
            return np.full(len(self.measured.numbers) * len(self.measured.rows), np.nan)

    def slopes(self, amounts: Array, used: Bools) -> Array:
        """How the used numbers change with each coordinate, (used, free), in our units by mm.

        Raises:
            FileError: a design beside it has no pose there.
        """
        found = np.empty((int(used.sum()), len(self.free)))
        for i, moved in enumerate(STEP * np.eye(len(self.free))):
            found[:, i] = (self.at(amounts + moved) - self.at(amounts - moved))[used] / (2.0 * STEP)
        if not np.isfinite(found).all():
            lost = int(np.flatnonzero(used)[int(np.argmin(np.isfinite(found).all(axis=1)))])
            problem = "the car's numbers have no slope there: its pose is next to a singular one"
            row = self.measured.rows[lost % len(self.measured.rows)]
            raise FileError(self.measured.source, row, problem, "rows away from where the car jams")
        return found
