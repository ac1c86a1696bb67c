r"""A file's numbers beside those of a car whose hardpoints move, and how these change with each of them.

Positions and angles are read off poses that are solved one by one, and rates off the motion. An input that
the file gives is the same in every design, a travel counting from the design's own drawing; one that it does
not give is as drawn, and the drawing changes. What the numbers change by with each coordinate are exact
derivatives at the solved design, of one solve (see `hardpoint_slopes`).

A number rounded to its last digit is evenly spread over its half unit h_i, and has the standard deviation
h_i / sqrt(3); so has what the rounding of the independent columns does to it, and the accuracy that the user
states:

    s_i = (h_i + S_i + a_i) / sqrt(3), and at least LEAST.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene, designs_of
from pointcoord.sweeping.designs import coordinates_of
from validate.errors import UsageError
from validate.measured.mapping import Measured
from validate.measured.poses import Driven, Found, at_either_end, ours_of
from validate.measured.tolerances import out_of_reach
from validate.tables.errors import FileError

Array = NDArray[np.float64]
Bools = NDArray[np.bool_]

BOUNDS = 25.0  # mm, that no hardpoint of a drawing of this car is off by
# Then they are five standard deviations out, which of 1e6 coordinates less than one is beyond. A wider prior
# lets rounding of digits move hardpoints along what the file hardly sees: with 100 mm by 24 mm together where
# one is off by 5, in a table of four decimals.
PRIOR = BOUNDS / 5.0
# What a number is known to at best, however many digits it has: 0.1 um, and what that is on a wheel.
LEAST = {"mm": 1e-4, "rad": 3e-7}
OTHERS = 1e-4  # N or %
TIGHT = 1e-12  # mm, of poses


@dataclass(frozen=True)
class Design:
    """A car at the rows of a file.

    Attributes:
        numbers: every column one after the other, (columns * rows,); NaN where there is no pose.
    """

    driven: Driven
    found: Found
    numbers: Array

    @classmethod
    def of(cls, driven: Driven, measured: Measured, values: Sequence[Array]) -> Design:
        """A car at values of the independent columns, each (rows,).

        Raises:
            PointcoordError: the car cannot be solved.
        """
        found = driven.at(values, TIGHT, bounded=False)
        columns = [ours_of(s, found.numbers) for s in measured.numbers]
        nothing = np.full(len(found.reached), np.nan)
        return cls(driven, found, np.concatenate([nothing if c is None else c for c in columns]))


@dataclass(frozen=True)
class Problem:
    """A file and the designs of a scene.

    Attributes:
        scene: as drawn.
        free: the coordinates that vary, such as lower_ball_joint.z.
        bounds: that corrections keep, mm. prior: how far off hardpoints are thought to be, likewise.
        start: the car as drawn.
        used: which of its numbers the file has too, (columns * rows,). spread: s_i of the used ones.
    """

    scene: Scene
    measured: Measured
    free: tuple[str, ...]
    bounds: float
    prior: float
    start: Design
    used: Bools
    spread: Array

    @classmethod
    def of(
        cls,
        scene: Scene,
        measured: Measured,
        free: Sequence[str] = (),
        bounds: float = BOUNDS,
        prior: float = PRIOR,
        accuracy: float = 0.0,
    ) -> Problem:
        """The problem of a scene and a file.

        Args:
            free: coordinates such as lower_ball_joint.z, or points for all three; empty: of every point.
            bounds, prior: mm, above 0.
            accuracy: how far off the file's numbers may be beside their digits, each in its own unit.
        Raises:
            UnknownName: no point or axis is called so.
            UsageError: a coordinate is there twice, or bounds, prior or accuracy are none.
            FileError: no number of the file can be used, or a travel cannot be followed.
            PointcoordError: the scene as drawn cannot be solved.
        """
        for name, value in (("bounds", bounds), ("prior", prior), ("accuracy", accuracy)):
            zero = name == "accuracy"
            if not (math.isfinite(value) and (value > 0.0 or (zero and value == 0.0))):
                allowed = f"a finite number {'from 0 up' if zero else 'above 0'}"
                raise UsageError(f"--{name} is {value:g}; allowed: {allowed}")
        # Nothing is computed but what the file has.
        driven = Driven.of(scene.model_copy(update={"effects": ()}), measured)
        coordinates = coordinates_of(scene, free)
        twice = next((name for name in coordinates if coordinates.count(name) > 1), "")
        if twice:
            raise UsageError(f"--free: {twice} is there twice; allowed: each coordinate once")
        values, offs = [s.values for s in measured.independent], [s.off for s in measured.independent]
        start = Design.of(driven, measured, values)
        first, theirs = start.numbers, np.concatenate([s.values for s in measured.numbers])
        used: Bools = np.isfinite(first) & np.isfinite(theirs)
        if not used.any():
            why = next(iter(start.found.reasons.values()), "no number is both there and ours")
            allowed = "rows that the scene's car can have"
            raise FileError(measured.source, "", f"no row can be used ({why})", allowed)
        swing = np.zeros(len(first))
        for _, ends in at_either_end(values, offs):
            beside = (Design.of(driven, measured, end).numbers for end in ends)
            swing += np.max([np.nan_to_num(np.abs(numbers - first)) for numbers in beside], axis=0)
        off = np.concatenate([s.off + s.accuracy_or(accuracy) for s in measured.numbers])
        least = [LEAST.get(s.meaning.unit.partition("/")[0], OTHERS) for s in measured.numbers]
        spread = np.maximum((off + swing) / math.sqrt(3.0), np.repeat(least, len(measured.rows)))[used]
        return cls(scene, measured, coordinates, bounds, prior, start, used, spread)

    def among(self, free: Sequence[str]) -> Problem:
        """The same with fewer free coordinates: the car as drawn is solved already."""
        return replace(self, free=tuple(free))

    @property
    def notes(self) -> tuple[str, ...]:
        """What was taken without being told, and rows that were left out."""
        return (*self.start.driven.notes, *out_of_reach(self.measured, self.start.found))

    def corrected(self, amounts: Array) -> Scene:
        """The scene with its free coordinates moved, (free,), mm.

        Raises:
            SceneError: the hardpoints make no mechanism.
        """
        return designs_of(self.scene, offsets=self._offsets(amounts)).design(0)

    def solved(self, amounts: Array) -> Design:
        """A design at the rows of the file.

        Raises:
            PointcoordError: the design cannot be solved.
        """
        driven = self.start.driven.redrawn(self._offsets(amounts))
        return Design.of(driven, self.measured, [s.values for s in self.measured.independent])

    def _offsets(self, amounts: Array) -> dict[str, float]:
        return dict(zip(self.free, amounts.tolist(), strict=True))

    def misfit(self, design: Design) -> Array:
        """Ours less theirs, (used,), in standard deviations; whole turns apart is the same angle."""
        series = self.measured.numbers
        columns = zip(series, design.numbers.reshape(len(series), -1), strict=True)
        apart = np.concatenate([s.apart(own, s.values) for s, own in columns])
        return np.asarray(apart[self.used] / self.spread)

    def slopes(self, design: Design) -> Array:
        """How the misfit changes with each coordinate, (used, free), 1/mm.

        Raises:
            FileError: a number of the design has no slope.
            AssemblyError: a pose cannot be reached on a straight path (see `slopes_of_poses`).
        """
        slopes = design.driven.slopes(design.found, self.free)
        columns = [ours_of(s, slopes) for s in self.measured.numbers]
        nothing = np.full((len(self.free), len(self.measured.rows)), np.nan)
        found = np.concatenate([nothing if c is None else c for c in columns], axis=1)[:, self.used].T
        if not np.isfinite(found).all():
            lost = int(np.flatnonzero(self.used)[int(np.argmin(np.isfinite(found).all(axis=1)))])
            problem = "the car's numbers have no slope there: its pose is next to a singular one"
            row = self.measured.rows[lost % len(self.measured.rows)]
            raise FileError(self.measured.source, row, problem, "rows away from where the car jams")
        return found / self.spread[:, None]
