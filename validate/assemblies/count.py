r"""Counts the assemblies of a knuckle, certifies each, and finds which one is drawn.

Each end of a path is a candidate. Newton's method finds its solution in balls of many digits, in the chart
where its largest number is 1. Krawczyk's operator (see `reference.krawczyk`) then proves that a box around it
holds exactly one solution of the real and imaginary parts of the forms:

    x . Q x - y . Q y = 0,      2 x . Q y = 0.

Two boxes hold different solutions if x_i y_j - x_j y_i is not zero for some i, j. A box about a real middle
is its own mirror image, and so is its solution, which is therefore real. It is not proven that there are no
further assemblies: the paths are followed from other starts until two runs have found every known one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np

from validate.arrays import Array
from validate.assemblies.homotopy import Complex, solve_quadratic
from validate.assemblies.legs import forms
from validate.extras import needing

with needing("validate.assemblies"):
    from flint import acb, acb_mat, arb, ctx

    from validate.reference import krawczyk
    from validate.reference.errors import NotDecidedError
    from validate.reference.vectors import Scalar

BITS = 300
# Radii of discs. Newton's method with BITS bits ends far inside the narrow one. The wide one also contains
# the drawn pose, which solves the forms to the rounding of their entries.
NARROW, WIDE = "1e-40", "1e-9"
# Number of runs, each from other starts, that must find the same, and the largest number of runs.
RUNS, MOST_RUNS = 2, 5
# A solution, a unit vector, is not a pose if its <e, e> is below this, which is the level of rounding.
NO_TURN = 1e-9


@dataclass(frozen=True)
class Assembly:
    """A certified pose of the knuckle.

    Attributes:
        box: balls that contain its Study parameters, scaled so that the largest is 1.
        real: whether it is proven to be real. Otherwise it is complex, or nothing is proven.
        drawn: whether it is the drawn assembly.
    """

    box: tuple[acb, ...]
    real: bool
    drawn: bool

    def differs(self, other: Assembly) -> bool:
        """Whether the two boxes of homogeneous coordinates have no common point."""
        x, y = self.box, other.box
        return any(not (x[i] * y[j] - x[j] * y[i]).contains(0) for i, j in combinations(range(len(x)), 2))


def count_assemblies(mechanism: Mapping[str, Any], places: Mapping[str, Array]) -> dict[str, Any]:
    """Count the assemblies of a mechanism's knuckle with its inputs held.

    Args:
        mechanism: as plain data.
        places: position of every point at an assembled pose, mm.
    Returns:
        paths: number of paths of each run.
        candidates: of each run, the number of paths that end at a regular solution that is a pose.
        certified: of each run, the number of candidates that are proven.
        distinct, real: number of different assemblies of all runs; of those that are proven to be real.
        drawn: whether the drawn assembly was found.
        agreed: whether two runs have each found every known assembly, and certified every candidate.
    Raises:
        NoAnswer: the knuckle is not held by six conditions of the known kinds.
    """
    quadratic = forms(mechanism, places)
    candidates, certified = list[int](), list[int]()
    known, agreed = list[Assembly](), False
    with ctx.workprec(BITS):
        matrices = [acb_mat([[float(x) for x in row] for row in form]) for form in quadratic]
        while not agreed and len(candidates) < MOST_RUNS:
            ends = solve_quadratic(quadratic, seed=len(candidates))
            ends = ends[np.abs((ends[:, :4] ** 2).sum(axis=1)) > NO_TURN]
            proven = [one for end in ends if (one := certify(matrices, end)) is not None]
            for one in proven:
                if all(one.differs(other) for other in known):
                    known.append(one)
            candidates.append(len(ends))
            certified.append(len(proven))
            runs = zip(candidates, certified, strict=True)
            agreed = sum(found == right == len(known) for found, right in runs) >= RUNS
    return {
        "paths": 2 ** len(quadratic),
        "candidates": candidates,
        "certified": certified,
        "distinct": len(known),
        "real": sum(one.real for one in known),
        "drawn": any(one.drawn for one in known),
        "agreed": agreed,
    }


@dataclass(frozen=True)
class Forms(krawczyk.Curve):
    """The forms as functions of x, the homogeneous coordinates without the one that is 1. There is no t."""

    matrices: Sequence[acb_mat]
    chart: int

    def whole(self, x: Sequence[acb]) -> list[acb]:
        """All homogeneous coordinates."""
        return [*x[: self.chart], acb(1), *x[self.chart :]]

    def rows(self, x: Sequence[acb], t: Scalar) -> list[acb]:
        """x^T Q x."""
        z = krawczyk.column(self.whole(x))
        return [(z.transpose() * (matrix * z))[0, 0] for matrix in self.matrices]

    def entries(self, x: Sequence[acb], t: Scalar) -> list[tuple[int, int, acb]]:
        """2 Q x."""
        z = krawczyk.column(self.whole(x))
        slopes = [(matrix * z).entries() for matrix in self.matrices]
        for slope in slopes:
            del slope[self.chart]
        return [(i, j, 2 * entry) for i, slope in enumerate(slopes) for j, entry in enumerate(slope)]

    def holds_one(self, centre: Sequence[acb], radius: str) -> bool:
        """Whether discs of this radius are proven to contain exactly one solution."""
        width, inverse = [arb(radius)] * len(centre), krawczyk.middle_inverse(self.matrix(centre, 0))
        return krawczyk.less(krawczyk.Contraction.at(self, centre, 0, inverse).image(width), width)


def certify(matrices: Sequence[acb_mat], end: Complex) -> Assembly | None:
    """The assembly near the end of a path; None if nothing can be proven."""
    chart = int(np.argmax(np.abs(end)))
    forms, near = Forms(matrices, chart), np.delete(end / end[chart], chart)
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
