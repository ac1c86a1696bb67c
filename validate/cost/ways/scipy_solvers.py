"""What a user would write: a solver of SciPy on pointcoord's equations, at each instant from the one before.

It is a method of `simulate` of one's own: the drawing and the start, the rates (two linear solves with the
Jacobian, eqs. 19 and 22 of the paper) and what is read off the coordinates are as in every other.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares, root

from pointcoord import Scene
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.method import Method
from pointcoord.numerics.counters import Work
from pointcoord.solve.assembly import Pose
from pointcoord.solve.pointwise import Solved, SquareVelocityTerm, with_rates
from pointcoord.time_functions import TimeFunction
from validate.cost.way import Solve, Way
from validate.cost.ways.point_coordinates import by_method
from validate.errors import NoAnswer

Array = NDArray[np.float64]

# Of the equations, whose terms are up to 1: a thousand times what differences for a Jacobian leave.
NOISE = 1e-9
TOLERANCE = 1e-9  # mm, of the start, which is assembled before


def in_scipy(
    solver: str,
    with_jacobian: bool,
    size: float,
    mechanism: Mechanism,
    functions: Mapping[str, TimeFunction],
    pose: Pose,
    times: Array,
    derivative: int,
    term: SquareVelocityTerm,
    tolerance: float,
    /,
) -> Solved:
    """Poses and their rates, the first pose being given; what is proven of them is nothing.

    Args:
        solver: `root`, by Powell's hybrid method, or `least_squares`, by a trust region.
        with_jacobian: whether it is given the Jacobian, or takes differences of the equations for it.
        size: its relative tolerance; of least_squares all three.
    Raises:
        NoAnswer: it ends without success, or came to another assembly: the sign of the Jacobian's
            determinant changes where two of them meet.
    """
    system, n = mechanism.map, mechanism.map.unknowns
    known = mechanism.known_series({name: f.series(times, derivative) for name, f in functions.items()})
    y, here, residuals, jacobians = np.empty((len(times), system.size)), pose.y.copy(), 0, 0

    def at(u: Array) -> Array:
        here[:n] = u
        return here

    slope: Any = (lambda u: system.jacobian(at(u))) if with_jacobian else None
    if solver == "root":
        solve = partial(root, jac=slope, method="hybr", options={"xtol": size})
    else:
        solve = partial(least_squares, jac=slope or "2-point", xtol=size, ftol=size, gtol=size)
    y[0] = here
    for i, instant in enumerate(times.tolist()[1:], 1):
        here[n:] = known[i, 0]
        found = solve(lambda u: system.residual(at(u)), here[:n].copy())
        left = float(np.abs(found.fun).max())
        # A least sum of squares may be none of the equations' roots.
        if not (found.success and left <= 10.0 * size + NOISE):
            words = f"leaves the equations at {left:.3g}"
            if not found.success:
                words = f"gives up: {' '.join(str(found.message).split())}"
            who = f"scipy.optimize.{solver} at t = {instant:.6g} s"
            raise NoAnswer(who, words, f"an end with the equations below {10.0 * size + NOISE:.3g}")
        y[i] = at(found.x)
        residuals, jacobians = residuals + int(found.nfev), jacobians + int(found.get("njev") or 0)
    signs = np.linalg.slogdet(system.jacobian(y))[0]
    for instant in times[signs != signs[0]][:1]:
        who, allowed = f"scipy.optimize.{solver} at t = {instant:.6g} s", "the one that is drawn"
        raise NoAnswer(who, "comes to another assembly than is drawn", allowed)
    work = Work(residuals=residuals, factorisations=jacobians)
    return with_rates(system, y, known, times, derivative, term, work, np.full(len(times), np.inf))


def by_scipy(solver: str, with_jacobian: bool, scene: Scene, size: float) -> Solve:
    """The equations solved by SciPy."""
    method = Method("scipy", at_instants=partial(in_scipy, solver, with_jacobian, size))
    return by_method(method, scene, TOLERANCE)


WAYS = tuple(
    Way(
        name + ("-jac" if with_jacobian else ""),
        f"scipy.optimize.{solver} on pointcoord's equations, "
        f"{'with their Jacobian' if with_jacobian else 'with differences for their Jacobian'}",
        partial(by_scipy, solver, with_jacobian),
        setting="xtol {}" if solver == "root" else "xtol, ftol, gtol {}",
    )
    for name, solver in (("scipy-root", "root"), ("least-squares", "least_squares"))
    for with_jacobian in (False, True)
)
