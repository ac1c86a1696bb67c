"""Compares a user's solver with a formulation, from Python."""

from __future__ import annotations

import math
from dataclasses import replace
from numbers import Real

from pointcoord import Scene
from validate.comparison.compare import Outcome, compare
from validate.errors import UsageError
from validate.formulations.protocol import Formulation
from validate.solvers.plain import PlainSolver, as_function

ACCURACY = 1e-6
AGAINST = "pointcoord"


def check(
    solver: object, scene: Scene | str, accuracy: float = ACCURACY, against: str | Formulation = AGAINST
) -> Outcome:
    """Compare a solver with a formulation; the tolerance of each number follows from the stated accuracy.

    Args:
        solver: a function of one mapping, or an object or class with a method `solve` (see `solvers.plain`).
        scene: a scene, or its name or path.
        accuracy: accuracy of every point as the solver states it, mm.
        against: a formulation, or its name.
    Returns:
        The comparison; possible explanations of a disagreement are in `explanations`.
    Raises:
        UsageError: `solver` is not a solver, or `accuracy` is not a length above 0.
        FormulationError: the solver raises an error, or the other formulation refuses the scene.
        SceneError: the scene does not exist or is wrong.

    >>> def knows_camber(given):
    ...     return {"camber": [0.0 for _ in given["instants"]]}
    >>> check(knows_camber, "bounce").disagreements[0].name
    'camber'
    """
    function = as_function(solver, "the solver")
    taken = Scene.load(scene) if isinstance(scene, str) else scene
    name = str(getattr(solver, "__name__", type(solver).__name__))
    one = PlainSolver(name, function, required_accuracy(accuracy))
    outcome = compare(taken, one, against)
    if not outcome.disagreements:
        return outcome
    # Imported here: most runs have no disagreement.
    from validate.diagnosis import explain_outcome

    return replace(outcome, explanations=explain_outcome(taken, outcome))


def required_accuracy(accuracy: float) -> float:
    """The accuracy as a float.

    Raises:
        UsageError: it is not a length above 0.
    """
    if not (isinstance(accuracy, Real) and 0.0 < accuracy < math.inf):
        raise UsageError(f"the accuracy is {accuracy!r} mm; give a length above 0, such as 1e-6")
    return float(accuracy)
