r"""A file's numbers beside those of a car whose hardpoints move, and how these change with each of them.

Positions and angles are read off poses that are solved one by one, and rates off the motion. An input that
the file gives is the same in every design, a travel counting from the design's own drawing; one that it does
not give is as drawn, and the drawing changes. A number q at a row changes with a coordinate p by

    dq/dp = (q(p + s) - q(p - s)) / 2 s.

Central differences of solved designs lack s^2 / 6 of the third derivative: with s = STEP and points some
100 mm apart a part of 1e-8 of a slope; poses that are solved to 1e-12 mm make it off by 1e-10. The search
ends at 1e-9 of the sum of squares, where a part of 1e-5 of a slope would matter.

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

from pointcoord import PointcoordError, Scene, designs_of
from pointcoord.sweeping.designs import coordinates_named
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
STEP = 0.02  # mm, of differences by coordinates


@dataclass(frozen=True)
class Problem:
    """A file and the designs of a scene.

    Attributes:
        scene: as drawn. driven: the same by what the file's rows are taken by.
        free: the coordinates that vary, such as lower_ball_joint.z.
        bounds: that corrections keep, mm. prior: how far off hardpoints are thought to be, likewise.
        start: the car as drawn. first: its numbers, every column one after the other, (columns * rows,).
        used: which of these the file has too, likewise. spread: s_i of the used ones.
    """

    scene: Scene
    measured: Measured
    driven: Driven
    free: tuple[str, ...]
    bounds: float
    prior: float
    start: Found
    first: Array
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
        coordinates, driven = free_coordinates(scene, free), Driven.of(scene, measured)
        values, offs = [s.values for s in measured.independent], [s.off for s in measured.independent]
        start = driven.at(values, TIGHT, bounded=False)
        first, theirs = _numbers(measured, start), np.concatenate([s.values for s in measured.numbers])
        used: Bools = np.isfinite(first) & np.isfinite(theirs)
        if not used.any():
            why = next(iter(start.reasons.values()), "no number is both there and ours")
            allowed = "rows that the scene's car can have"
            raise FileError(measured.source, "", f"no row can be used ({why})", allowed)
        swing = np.zeros(len(first))
        for _, ends in at_either_end(values, offs):
            beside = (_numbers(measured, driven.at(end, TIGHT, bounded=False)) for end in ends)
            swing += np.max([np.nan_to_num(np.abs(numbers - first)) for numbers in beside], axis=0)
        off = np.concatenate([s.off + s.accuracy_or(accuracy) for s in measured.numbers])
        least = [LEAST.get(s.meaning.unit.partition("/")[0], OTHERS) for s in measured.numbers]
        spread = np.maximum((off + swing) / math.sqrt(3.0), np.repeat(least, len(measured.rows)))[used]
        return cls(scene, measured, driven, coordinates, bounds, prior, start, first, used, spread)

    def among(self, free: Sequence[str]) -> Problem:
        """The same with fewer free coordinates: the car as drawn is solved already."""
        return replace(self, free=tuple(free))

    @property
    def notes(self) -> tuple[str, ...]:
        """What was taken without being told, and rows that were left out."""
        return (*self.driven.notes, *out_of_reach(self.measured, self.start))

    def design(self, amounts: Array, scene: Scene | None = None) -> Scene:
        """The scene with its free coordinates moved, (free,), mm.

        Raises:
            SceneError: the hardpoints make no mechanism.
        """
        offsets = dict(zip(self.free, amounts.tolist(), strict=True))
        return designs_of(self.scene if scene is None else scene, offsets=offsets).design(0)

    def solved(self, amounts: Array) -> Found:
        """A design at the rows of the file.

        Raises:
            PointcoordError: the design cannot be solved.
        """
        driven = self.driven.redrawn(self.design(amounts), self.design(amounts, self.driven.scene))
        return driven.at([s.values for s in self.measured.independent], TIGHT, bounded=False)

    def numbers(self, found: Found) -> Array:
        """The numbers of a design, as `first` those of the car as drawn; NaN where there is no pose."""
        return _numbers(self.measured, found)

    def misfit(self, numbers: Array) -> Array:
        """Ours less theirs, (used,), in standard deviations; whole turns apart is the same angle."""
        series = self.measured.numbers
        columns = zip(series, numbers.reshape(len(series), -1), strict=True)
        apart = np.concatenate([s.apart(own, s.values) for s, own in columns])
        return np.asarray(apart[self.used] / self.spread)

    def slopes(self, amounts: Array) -> Array:
        """How the misfit changes with each coordinate, (used, free), 1/mm.

        Raises:
            FileError: a design beside it has no pose there.
        """
        found = np.empty((len(self.spread), len(self.free)))
        for i, moved in enumerate(STEP * np.eye(len(self.free))):
            ahead, behind = self._near(amounts + moved), self._near(amounts - moved)
            found[:, i] = (ahead - behind)[self.used] / (2.0 * STEP)
        if not np.isfinite(found).all():
            lost = int(np.flatnonzero(self.used)[int(np.argmin(np.isfinite(found).all(axis=1)))])
            problem = "the car's numbers have no slope there: its pose is next to a singular one"
            row = self.measured.rows[lost % len(self.measured.rows)]
            raise FileError(self.measured.source, row, problem, "rows away from where the car jams")
        return found / self.spread[:, None]

    def _near(self, amounts: Array) -> Array:
        """The numbers of a design; NaN throughout where it cannot be solved."""
        try:
            return self.numbers(self.solved(amounts))
        except PointcoordError:
            return np.full(len(self.first), np.nan)


def _numbers(measured: Measured, found: Found) -> Array:
    nothing = np.full(len(found.reached), np.nan)
    columns = [ours_of(s, found)[0] for s in measured.numbers]
    return np.concatenate([nothing if c is None else c for c in columns])


def free_coordinates(scene: Scene, free: Sequence[str]) -> tuple[str, ...]:
    """Coordinates by their names; a point is all three of its own; none: all that a drawing is free to have.

    A rack that goes along with the end of its tie rod is not free.

    Raises:
        UnknownName: no point or axis is called so.
        UsageError: one is there twice.
    """
    topology, drawn = scene.mechanism.topology, scene.mechanism.points
    if not free:
        every = {f"{name}.{axis}": 0.0 for name in topology.required_points for axis in "xyz"}
        going = designs_of(scene, offsets=every).following
        free = [name for name in drawn if name not in going]
    found = [coordinate for name in free for coordinate in coordinates_named(name, drawn)]
    twice = next((name for name in found if found.count(name) > 1), "")
    if twice:
        raise UsageError(f"--free: {twice} is there twice; allowed: each coordinate once")
    return tuple(found)
