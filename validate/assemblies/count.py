r"""How many assemblies a knuckle on its legs has, each certified, and which of them is the drawing's.

Ends of paths are candidates. Of each, in balls of many digits, Newton's method finds the solution in the
chart where its largest number is 1, and Krawczyk's operator (see `reference.krawczyk`) proves that a box
around it holds one solution of the forms' real and imaginary parts and no other:

    x . Q x - y . Q y = 0,      2 x . Q y = 0.

Two boxes are two solutions where x_i y_j - x_j y_i is not zero for some i, j. A box about a real middle is
its own mirror image, and so is its one solution: it is real. That there are no other assemblies is not
proven: it rests on the paths, which are followed again from other starts until two runs have found all.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from validate.assemblies.homotopy import solve_quadratic
from validate.assemblies.legs import forms
from validate.extras import not_there

try:
    from flint import acb, acb_mat, arb, ctx

    from validate.reference import krawczyk
    from validate.reference.errors import NotDecidedError
    from validate.reference.vectors import Scalar
except ImportError as error:
    raise not_there("validate.assemblies", error) from None

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

BITS = 300
# Radii of discs: those that Newton's method in so many bits ends far inside, and one that holds the pose
# as drawn too, which solves the forms to the rounding of their entries.
NARROW, WIDE = "1e-40", "1e-9"
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


@dataclass
class Counted:
    """What was found.

    Attributes:
        paths: how many were followed in each run, from other starts.
        candidates: by run, how many paths ended at a regular solution that is a pose.
        certified: by run, how many of these are proven.
        assemblies: distinct ones of all runs.
    """

    paths: int
    candidates: list[int] = field(default_factory=list)
    certified: list[int] = field(default_factory=list)
    assemblies: list[Assembly] = field(default_factory=list)

    @property
    def real(self) -> int:
        """How many are proven to be real."""
        return sum(one.real for one in self.assemblies)

    @property
    def agreed(self) -> bool:
        """Whether each of two runs has found all that is known, without a path that is not certified."""
        runs = zip(self.candidates, self.certified, strict=True)
        return sum(found == proven == len(self.assemblies) for found, proven in runs) >= RUNS

    @property
    def drawn(self) -> bool:
        """Whether the pose as drawn is among them."""
        return any(one.drawn for one in self.assemblies)


def count_assemblies(mechanism: Mapping[str, Any], places: Mapping[str, Array]) -> Counted:
    """Count the assemblies of a mechanism's knuckle with its inputs held.

    Args:
        mechanism: as plain data. places: of every point at an assembled pose, mm.
    Raises:
        NoAnswer: the knuckle is not held by six conditions that are known.
    """
    quadratic = forms(mechanism, places)
    found = Counted(2 ** len(quadratic))
    with ctx.workprec(BITS):
        matrices = [acb_mat([[float(x) for x in row] for row in form]) for form in quadratic]
        while not found.agreed and len(found.candidates) < MOST_RUNS:
            ends = solve_quadratic(quadratic, len(found.candidates))
            # Of a pose <e, e> is not zero.
            ends = ends[np.abs((ends[:, :4] ** 2).sum(axis=1)) > NO_TURN]
            proven = [one for one in (_certified(matrices, end) for end in ends) if one is not None]
            found.candidates.append(len(ends))
            found.certified.append(len(proven))
            for one in proven:
                if all(_apart(one.box, other.box) for other in found.assemblies):
                    found.assemblies.append(one)
    return found


@dataclass(frozen=True)
class _Forms(krawczyk.Curve):
    """The forms of homogeneous numbers, of which one is 1; x are the others. There is no t."""

    matrices: Sequence[acb_mat]
    chart: int

    def whole(self, x: Sequence[acb], one: int = 1) -> list[acb]:
        """All numbers."""
        return [*x[: self.chart], acb(one), *x[self.chart :]]

    def rows(self, x: Sequence[acb], t: Scalar) -> list[acb]:
        """x^T Q x."""
        z = krawczyk.column(self.whole(x))
        return [(z.transpose() * (matrix * z))[0, 0] for matrix in self.matrices]

    def entries(self, x: Sequence[acb], t: Scalar, one: int = 1) -> list[tuple[int, int, acb]]:
        """2 Q x."""
        z = krawczyk.column(self.whole(x, one))
        slopes = [(matrix * z).entries() for matrix in self.matrices]
        for slope in slopes:
            del slope[self.chart]
        return [(i, j, 2 * entry) for i, slope in enumerate(slopes) for j, entry in enumerate(slope)]

    def bend(self, change: Sequence[acb]) -> krawczyk.Matrix:
        """The same without what the number 1 makes of it."""
        return krawczyk.matrix_of(len(change), self.entries(change, 0, 0))

    def holds_one(self, centre: Sequence[acb], radius: str) -> bool:
        """Whether discs are proven to hold one solution and no other."""
        width, inverse = [arb(radius)] * len(centre), krawczyk.middle_inverse(self.matrix(centre, 0))
        return krawczyk.less(krawczyk.Contraction.at(self, centre, 0, inverse).image(width), width)


def _certified(matrices: Sequence[acb_mat], end: Complex) -> Assembly | None:
    """The assembly near an end of a path; None where nothing is proven."""
    chart = int(np.argmax(np.abs(end)))
    forms, near = _Forms(matrices, chart), np.delete(end / end[chart], chart)
    narrow, wide = ([arb(radius)] * len(near) for radius in (NARROW, WIDE))
    try:
        centre, _ = krawczyk.newton(forms, [acb(complex(number)) for number in near], 0)
        middle = [acb(x.real) for x in centre]
        real = krawczyk.within(centre, middle, narrow) and forms.holds_one(middle, NARROW)
        centre = middle if real else centre
        if not (real or forms.holds_one(centre, NARROW)):
            return None
        at_drawing = chart == 0 and krawczyk.less([x.abs_upper() for x in centre], wide)
        drawn = at_drawing and forms.holds_one(centre, WIDE)
    except NotDecidedError:
        return None
    ball = arb(0, arb(NARROW))
    return Assembly(tuple(forms.whole([x + acb(ball, ball) for x in centre])), real, drawn)


def _apart(one: Sequence[acb], other: Sequence[acb]) -> bool:
    """Whether two boxes of homogeneous numbers hold no common point."""
    return any(
        not (one[i] * other[j] - one[j] * other[i]).contains(0) for i, j in combinations(range(len(one)), 2)
    )
