"""A SciPy solver on pointcoord's equations, as a user would write it: at each instant, from the one before.

It replaces only the position solver of `simulate`. The drawing, the start, the rates (two linear solves with
the Jacobian, eqs. 19 and 22 of the paper) and the effects are computed as by the other methods.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np
from scipy.optimize import least_squares, root

from pointcoord import Scene
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.method import Method
from pointcoord.numerics.counters import Work
from pointcoord.solve.assembly import Pose
from pointcoord.solve.pointwise import Solved, SquareVelocityTerm, with_rates
from pointcoord.time_functions import TimeFunction
from validate.arrays import Array
from validate.cost.way import Solve, Way
from validate.cost.ways.point_coordinates import by_method
from validate.errors import NoAnswer

# Residual of the equations, whose terms are up to 1: a thousand times the residual with a difference
# Jacobian.
NOISE = 1e-9
TOLERANCE = 1e-9  # mm, of the start, which pointcoord assembles


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
    """Poses and their rates, without error bounds; the first pose is given.

    Args:
        solver: `root`, Powell's hybrid method, or `least_squares`, a trust-region method.
        with_jacobian: whether the solver gets the Jacobian, or approximates it by differences.
        size: relative tolerance of the solver; for least_squares all three tolerances.
    Raises:
        NoAnswer: the solver fails, or converges to another assembly mode: the sign of the Jacobian's
            determinant changes where two modes meet.
    """
    system, n = mechanism.map, mechanism.map.unknowns
    known = mechanism.known_series({name: f.series(times, derivative) for name, f in functions.items()})
    y, here = np.empty((len(times), system.size)), pose.y.copy()

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
        # A minimum of the sum of squares may not be a root of the equations.
        if not (found.success and left <= 10.0 * size + NOISE):
            words = f"ends with a residual of {left:.3g}"
            if not found.success:
                words = f"fails: {' '.join(str(found.message).split())}"
            who = f"scipy.optimize.{solver} at t = {instant:.6g} s"
            raise NoAnswer(who, words, f"a residual below {10.0 * size + NOISE:.3g}")
        y[i] = at(found.x)
    signs = np.linalg.slogdet(system.jacobian(y))[0]
    for instant in times[signs != signs[0]][:1]:
        who, allowed = f"scipy.optimize.{solver} at t = {instant:.6g} s", "the assembly mode of the drawing"
        raise NoAnswer(who, "converges to another assembly mode", allowed)
    return with_rates(system, y, known, times, derivative, term, Work(), np.full(len(times), np.inf))


def by_scipy(solver: str, with_jacobian: bool, scene: Scene, size: float) -> Solve:
    """Solve pointcoord's equations by SciPy."""
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
