r"""The misfit of a file's numbers to a car whose hardpoints move, and its derivatives by the coordinates.

Over inputs and travels each row is a pose that is solved by itself; over time the rows are instants of the
motion. An input that the file gives has the same values in every design; a travel counts from the drawing of
the design. An input that the file does not give has its drawn value, which changes with the drawing. The
derivatives by coordinates are exact, from one solve of the design (see `hardpoint_slopes`).

A number rounded to its last digit has an error that is evenly distributed over +-h_i, half a unit of this
digit, with the standard deviation h_i / sqrt(3). The effect S_i of the rounding of the independent columns,
and the accuracy a_i that the user states, are treated in the same way:

    s_i = (h_i + S_i + a_i) / sqrt(3), and at least LEAST.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from pointcoord import Scene, designs_of
from pointcoord.sweeping.designs import coordinates_of
from validate.arrays import Array, Flags
from validate.errors import UsageError
from validate.measured.mapping import Measured
from validate.measured.poses import Driven, Found
from validate.tables.errors import FileError

BOUNDS = 25.0  # mm: no hardpoint in a drawing of this car has a larger error
# The bounds are then five standard deviations, which less than one of 1e6 coordinates exceeds. With a wider
# prior the rounding of digits moves hardpoints along combinations that the file hardly determines: with
# 100 mm, in a table of four decimals, by 24 mm in total where one coordinate is off by 5.
PRIOR = BOUNDS / 5.0
# Least standard deviation of a number, however many digits it has: 0.1 um, and the angle of that on a wheel.
LEAST = {"mm": 1e-4, "rad": 3e-7}
OTHERS = 1e-4  # N or %
TIGHT = 1e-12  # mm, tolerance of poses


@dataclass(frozen=True)
class Problem:
    """The fit of a scene's hardpoints to a file.

    Attributes:
        scene: the scene as drawn.
        free: the coordinates that vary, such as lower_ball_joint.z.
        bounds: largest correction of a coordinate, mm.
        prior: assumed standard deviation of a coordinate, mm.
        start: the car as drawn.
        used: which of its numbers exist and are in the file, (columns, rows).
        spread: s_i of the used numbers, (used,).
    """

    scene: Scene
    measured: Measured
    free: tuple[str, ...]
    bounds: float
    prior: float
    start: Found
    used: Flags
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
            free: coordinates such as lower_ball_joint.z, or points for all three axes; empty: all points.
            bounds, prior: mm, above 0.
            accuracy: error of the file's numbers in addition to their rounding, in the unit of each.
        Raises:
            UnknownName: a point or axis does not exist.
            UsageError: a coordinate is given twice, or the accuracy is out of range.
            FileError: no number of the file can be used, or a travel cannot be followed.
            PointcoordError: the scene as drawn cannot be solved.
        """
        if not 0.0 <= accuracy < math.inf:
            raise UsageError(f"--accuracy is {accuracy:g}; allowed: a finite number from 0 up")
        # Only the numbers that the file has are computed.
        driven = Driven.of(scene.model_copy(update={"effects": ()}), measured)
        coordinates = coordinates_of(scene, free)
        twice = next((name for name in coordinates if coordinates.count(name) > 1), "")
        if twice:
            raise UsageError(f"--free: {twice} is given twice; allowed: each coordinate once")
        start = driven.at(tolerance=TIGHT)
        first = start.columns(start.numbers)
        used: Flags = np.isfinite(first) & np.isfinite([s.values for s in measured.numbers])
        if not used.any():
            why = next(iter(start.reasons.values()), "no number is both in the file and computed")
            allowed = "rows that the scene's car can reach"
            raise FileError(measured.source, "", f"no row can be used ({why})", allowed)
        swing = driven.swings(first, [s.off for s in measured.independent], TIGHT).sum(axis=0)
        off = [s.off + s.accuracy_or(accuracy) for s in measured.numbers]
        least = [[LEAST.get(s.meaning.unit.partition("/")[0], OTHERS)] for s in measured.numbers]
        spread = np.maximum((off + swing) / math.sqrt(3.0), least)[used]
        return cls(scene, measured, coordinates, bounds, prior, start, used, spread)

    @property
    def notes(self) -> tuple[str, ...]:
        """What was assumed because it is not given, and rows that were left out."""
        return (*self.start.driven.notes, *self.start.left_out)

    def corrected(self, amounts: Iterable[float]) -> Scene:
        """The scene with its free coordinates moved by amounts, (free,), mm."""
        return designs_of(self.scene, offsets=dict(zip(self.free, amounts, strict=True))).design(0)

    def solved(self, amounts: Array) -> Found:
        """The car with free coordinates moved by amounts, (free,), mm, at the rows of the file.

        Raises:
            PointcoordError: the car cannot be solved.
        """
        driven = self.start.driven.redrawn(dict(zip(self.free, amounts.tolist(), strict=True)))
        return driven.at(tolerance=TIGHT)

    def numbers(self, car: Found) -> Array:
        """A car's numbers, (columns, rows); NaN at rows without a pose."""
        return car.columns(car.numbers)

    def missing(self, car: Found) -> Iterator[str]:
        """The first row of the file at which a car lacks a number, and why."""
        for _, row in np.argwhere(self.used & ~np.isfinite(self.numbers(car)))[:1].tolist():
            yield f"{self.measured.rows[row]}: {car.reasons.get(row, 'no number')}"

    def misfit(self, car: Found) -> Array:
        """Computed less measured, (used,), in standard deviations; whole turns are removed from angles."""
        columns = zip(self.measured.numbers, self.numbers(car), strict=True)
        apart = np.stack([s.apart(ours, s.values) for s, ours in columns])
        return np.asarray(apart[self.used] / self.spread)

    def slopes(self, car: Found) -> Array:
        """Derivatives of the misfit by each coordinate, (used, free), 1/mm.

        Raises:
            FileError: a number of the car has no derivative.
            AssemblyError: a pose cannot be reached on a straight path (see `slopes_of_poses`).
        """
        found = car.columns(car.driven.slopes(car, self.free), len(self.free))
        found = np.moveaxis(found, 1, -1)[self.used]
        if not np.isfinite(found).all():
            _, row = np.argwhere(self.used)[np.argmin(np.isfinite(found).all(axis=1))]
            problem = "the car's numbers have no derivative there: its pose is almost singular"
            raise FileError(
                self.measured.source, self.measured.rows[row], problem, "rows away from where the car jams"
            )
        return found / self.spread[:, None]
