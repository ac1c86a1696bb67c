r"""How many assemblies a knuckle on its legs has, each certified, and which of them is the drawing's.

Ends of paths are candidates. Of each, in balls of many digits, Newton's method finds the solution z in the
chart where its largest number is 1, and Krawczyk's operator (see `reference.krawczyk`) proves that a box of
complex numbers around it holds one solution and no other:

    |A F(z)| + |I - A F'(box)| r < r.

Two boxes are two solutions where x_i y_j - x_j y_i is not zero for some i, j. A box about a real middle is
its own mirror image, and so is its one solution: it is real. That there are no other assemblies is not
proven: it rests on the paths, which are followed again from other starts until two runs have found all.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from validate.assemblies.homotopy import solve_quadratic
from validate.assemblies.legs import forms
from validate.extras import MissingPackage

try:
    from flint import acb, acb_mat, arb, ctx
except ImportError as error:
    raise MissingPackage("validate.assemblies", error) from None

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

BITS = 300
# Half widths of boxes: one that Newton's method in so many bits ends far inside, and one that holds the pose
# as drawn too, which solves the forms to the rounding of their entries.
NARROW, WIDE = "1e-40", "1e-9"
STEPS = 8  # of Newton's method; from 1e-11 four would do
# Runs from other starts that must find the same, and how many are tried.
RUNS, MOST_RUNS = 2, 5
# <e, e> of a solution that is no pose is at rounding level; of a unit vector.
NO_TURN = 1e-9


@dataclass(frozen=True)
class Assembly:
    """A certified pose of the knuckle.

    Attributes:
        box: balls that hold its Study numbers, the largest of which is 1.
        real: whether it is proven to be real; otherwise it is proven not to be, or open.
        drawn: whether it is the drawing's.
    """

    box: tuple[acb, ...]
    real: bool
    drawn: bool


@dataclass(frozen=True)
class Counted:
    """What was found.

    Attributes:
        paths: how many were followed in each run, from other starts.
        candidates: by run, how many paths ended at a regular solution that is a pose.
        certified: by run, how many of these are proven.
        assemblies: distinct ones of all runs.
    """

    paths: int
    candidates: tuple[int, ...]
    certified: tuple[int, ...]
    assemblies: tuple[Assembly, ...]

    @property
    def real(self) -> int:
        """How many are proven to be real."""
        return sum(one.real for one in self.assemblies)

    @property
    def agreed(self) -> bool:
        """Whether each of two runs has found all that is known, without a path that is not certified."""
        whole = [
            found == proven == len(self.assemblies)
            for found, proven in zip(self.candidates, self.certified, strict=True)
        ]
        return sum(whole) >= RUNS

    @property
    def drawn(self) -> bool:
        """Whether the pose as drawn is among them."""
        return any(one.drawn for one in self.assemblies)


def count_assemblies(mechanism: Mapping[str, Any], places: Mapping[str, Array]) -> Counted:
    """Count the assemblies of a mechanism's knuckle with its inputs held.

    Args:
        mechanism: as plain data. places: of every point at an assembled pose, mm.
    Raises:
        NotOnLegsError: the knuckle is not held by six conditions that are known.
    """
    quadratic = forms(mechanism, places)
    found = Counted(0, (), (), ())
    with ctx.workprec(BITS):
        matrices = [acb_mat([[acb(float(x)) for x in row] for row in form]) for form in quadratic]
        while not found.agreed and len(found.candidates) < MOST_RUNS:
            ends = _poses(solve_quadratic(quadratic, len(found.candidates)))
            proven = [one for one in (_certified(matrices, end) for end in ends) if one is not None]
            distinct = list(found.assemblies)
            for one in proven:
                if all(_apart(one.box, other.box) for other in distinct):
                    distinct.append(one)
            found = Counted(
                2 ** len(quadratic),
                (*found.candidates, len(ends)),
                (*found.certified, len(proven)),
                tuple(distinct),
            )
    return found


def _poses(ends: Complex) -> Complex:
    """Solutions that turn: of a pose <e, e> is not zero."""
    return np.asarray(ends[np.abs((ends[:, :4] ** 2).sum(axis=1)) > NO_TURN])


def _certified(matrices: Sequence[acb_mat], end: Complex) -> Assembly | None:
    """The assembly near an end of a path; None where nothing is proven."""
    chart = int(np.argmax(np.abs(end)))
    z = [acb(complex(number)) for number in end / end[chart]]
    z[chart] = acb(1)
    try:
        for _ in range(STEPS):
            z = _stepped(matrices, z, chart)
        mirrored = [acb(number.real) for number in z]
        real = all(abs(number.imag) < arb(NARROW) for number in z) and _holds_one(
            matrices, mirrored, chart, NARROW
        )
        centre = mirrored if real else z
        if not (real or _holds_one(matrices, centre, chart, NARROW)):
            return None
        box = _box(centre, chart, NARROW)
        near = all(abs(number - (1 if i == 0 else 0)) < arb(WIDE) for i, number in enumerate(box))
        drawn = chart == 0 and near and _holds_one(matrices, centre, chart, WIDE)
    except ZeroDivisionError:
        return None
    return Assembly(tuple(box), real, drawn)


def _stepped(matrices: Sequence[acb_mat], z: Sequence[acb], chart: int) -> list[acb]:
    """A step of Newton's method in a chart, of middles."""
    values, rows = _at(matrices, z, chart)
    change = rows.solve(values).entries()
    change.insert(chart, acb(0))
    return [(number - part).mid() for number, part in zip(z, change, strict=True)]


def _at(matrices: Sequence[acb_mat], z: Sequence[acb], chart: int) -> tuple[acb_mat, acb_mat]:
    """The forms, a column, and their derivatives by all numbers but the chart's."""
    column = acb_mat([[number] for number in z])
    halves = [(matrix * column).entries() for matrix in matrices]
    values = [[sum((a * b for a, b in zip(z, half, strict=True)), acb(0))] for half in halves]
    rows = [[2 * number for i, number in enumerate(half) if i != chart] for half in halves]
    return acb_mat(values), acb_mat(rows)


def _box(centre: Sequence[acb], chart: int, radius: str) -> list[acb]:
    side = arb(0, arb(radius))
    return [number if i == chart else number + acb(side, side) for i, number in enumerate(centre)]


def _holds_one(matrices: Sequence[acb_mat], centre: Sequence[acb], chart: int, radius: str) -> bool:
    """Whether a box is proven to hold one solution and no other."""
    values, rows = _at(matrices, centre, chart)
    inverse = acb_mat([[entry.mid() for entry in line] for line in rows.inv().tolist()])
    _, around = _at(matrices, _box(centre, chart, radius), chart)
    size = len(matrices)
    unit = acb_mat([[int(i == j) for j in range(size)] for i in range(size)])
    missed = (inverse * values).entries()
    defect = (unit - inverse * around).tolist()
    # A box has sides of this radius in both parts: its numbers are within the root of 2 of its centre.
    width = arb(radius)
    reach = 2 ** arb(0.5) * width
    return all(
        abs(miss).upper() + sum((abs(entry).upper() for entry in line), arb(0)) * reach < width
        for miss, line in zip(missed, defect, strict=True)
    )


def _apart(one: Sequence[acb], other: Sequence[acb]) -> bool:
    """Whether two boxes of homogeneous numbers hold no common point."""
    return any(
        not (one[i] * other[j] - one[j] * other[i]).contains(0) for i, j in combinations(range(len(one)), 2)
    )
