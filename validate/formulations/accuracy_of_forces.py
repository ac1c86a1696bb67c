"""Error bounds of forces from a stated accuracy of points (see `stated_accuracy`)."""

from __future__ import annotations

import numpy as np

from pointcoord import PointcoordError, Scene, simulate
from pointcoord.effects.registry import EFFECTS
from pointcoord.numerics.rounding import EPS
from pointcoord.results.proof import ROUNDINGS, prove
from validate.arrays import Array
from validate.formulations.asked_numbers import asked_numbers, is_force
from validate.formulations.protocol import NOTHING, Numbers, largest_at


def claims_of_forces(scene: Scene, off: Array, condition: Array) -> dict[str, dict[str, Array]]:
    """Error bounds of forces at the first instants of a scene, by quantity and name, (N,).

    A bound has two parts. The first is the effect of the error of the points: the bound that pointcoord
    expects for poses left unsolved by this error, less its bound for solved poses. The second is the rounding
    of solving for forces, by any method: ROUNDINGS EPS times the condition number times the largest force.

    Args:
        off: error of the points, (N,), mm. condition: condition number of the pose, (N,).
    """
    forces = {q: names for q, names in asked_numbers(scene).items() if is_force(q)}
    effects = tuple(e for e in scene.effects if any(is_force(q.name) for q in EFFECTS[e].quantities))
    try:
        motion = simulate(scene.model_copy(update={"effects": effects}))
    except PointcoordError:
        return {}
    count, solved = len(off), motion.solved
    if len(motion.times) < count:
        return {}
    readout, samples = solved.readout, motion.part(0, count)

    def expected(left: Array) -> Numbers:
        return prove(solved, samples, rates=True, left=left).expected

    # Each coordinate of a point may be off, and each half of a joint by itself.
    with_it, without = expected(2.0 * off / motion.unit), expected(np.zeros(count))
    numbers = {q: {n: motion.numbers[q][n][:count] for n in names} for q, names in forces.items()}
    sizes = [largest_at(np.abs(one)) for of in numbers.values() for one in of.values()]
    applied = [
        np.abs(force).max() + np.abs(moment).max() / motion.unit
        for force, moment in readout.axes.loads.values()
    ]
    rounded = ROUNDINGS * EPS * condition * np.max(sizes, axis=0, initial=max(applied, default=0.0))
    return {
        q: {
            n: _more(with_it[q][n], without[q][n]) + rounded.reshape(-1, *(1,) * (one.ndim - 1))
            for n, one in of.items()
        }
        for q, of in numbers.items()
    }


def _more(one: Array, other: Array) -> Array:
    """The difference of two bounds; NOTHING where the first is not finite."""
    return np.subtract(one, other, out=np.full_like(one, NOTHING), where=np.isfinite(one))
