r"""How many assemblies a knuckle on its legs has, each certified, and which of them is the drawing's.

Ends of paths are candidates. Of each, in balls of many digits, Newton's method finds the solution x + i y in
the chart where its largest number is 1, and Krawczyk's operator (see `reference.krawczyk`) proves that a box
around it holds one solution of the forms' real and imaginary parts and no other:

    x . Q x - y . Q y = 0,      2 x . Q y = 0.

Two boxes are two solutions where x_i y_j - x_j y_i is not zero for some i, j. A box about a real middle is
its own mirror image, and so is its one solution: it is real. That there are no other assemblies is not
proven: it rests on the paths, which are followed again from other starts until two runs have found all.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from validate.assemblies.homotopy import solve_quadratic
from validate.assemblies.legs import forms
from validate.extras import MissingPackage

try:
    from flint import acb, arb, arb_mat, ctx

    from validate.reference.errors import NotDecidedError
    from validate.reference.krawczyk import Contraction, System, column, less, middle_inverse, newton, within
except ImportError as error:
    raise MissingPackage("validate.assemblies", error) from None

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

BITS = 300
# Half widths of boxes: one that Newton's method in so many bits ends far inside, and one that holds the pose
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
        matrices = [arb_mat([[float(x) for x in row] for row in form]) for form in quadratic]
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


def _certified(matrices: Sequence[arb_mat], end: Complex) -> Assembly | None:
    """The assembly near an end of a path; None where nothing is proven."""
    chart, size = int(np.argmax(np.abs(end))), len(matrices)
    parts, near = _parts(matrices, chart), np.delete(end / end[chart], chart)
    try:
        centre, _ = newton(parts, [arb(float(number)) for number in (*near.real, *near.imag)])
        mirrored = [*centre[:size], *[arb(0)] * size]
        real = within(centre, mirrored, [arb(NARROW)] * 2 * size) and _holds_one(parts, mirrored, NARROW)
        centre = mirrored if real else centre
        if not (real or _holds_one(parts, centre, NARROW)):
            return None
        at_drawing = chart == 0 and less([abs(x) for x in centre], [arb(WIDE)] * 2 * size)
        drawn = at_drawing and _holds_one(parts, centre, WIDE)
    except NotDecidedError:
        return None
    balls = [x + arb(0, arb(NARROW)) for x in centre]
    box = [acb(x, y) for x, y in zip(balls[:size], balls[size:], strict=True)]
    return Assembly((*box[:chart], acb(1), *box[chart:]), real, drawn)


def _parts(matrices: Sequence[arb_mat], chart: int) -> System:
    """The parts of the forms, in those x and then y of all numbers but the chart's, which is 1."""

    def halves(values: Sequence[arb], one: int) -> Iterator[tuple[arb_mat, arb_mat, arb_mat, arb_mat]]:
        x, y = list(values[: len(matrices)]), list(values[len(matrices) :])
        x.insert(chart, arb(one))
        y.insert(chart, arb(0))
        for matrix in matrices:
            yield column(x), column(y), matrix * column(x), matrix * column(y)

    def residual(values: Sequence[arb]) -> list[arb]:
        found = [
            ((x.transpose() * p - y.transpose() * q)[0, 0], 2 * (x.transpose() * q)[0, 0])
            for x, y, p, q in halves(values, 1)
        ]
        return [*(real for real, _ in found), *(imaginary for _, imaginary in found)]

    def derivative(values: Sequence[arb], one: int = 1) -> arb_mat:
        rows: tuple[list[list[arb]], list[list[arb]]] = ([], [])
        for _, _, p, q in halves(values, one):
            a, b = ([2 * x for i, x in enumerate(half.entries()) if i != chart] for half in (p, q))
            rows[0].append([*a, *(-x for x in b)])
            rows[1].append([*b, *a])
        return arb_mat([*rows[0], *rows[1]])

    return System(residual, derivative, lambda change: derivative(change, 0))


def _holds_one(parts: System, centre: Sequence[arb], radius: str) -> bool:
    """Whether a box is proven to hold one solution and no other."""
    width = [arb(radius)] * len(centre)
    return less(Contraction.at(parts, centre, middle_inverse(parts.matrix(centre))).image(width), width)


def _apart(one: Sequence[acb], other: Sequence[acb]) -> bool:
    """Whether two boxes of homogeneous numbers hold no common point."""
    return any(
        not (one[i] * other[j] - one[j] * other[i]).contains(0) for i, j in combinations(range(len(one)), 2)
    )
