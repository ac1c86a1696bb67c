"""A solver held to what it claims, from Python."""

from __future__ import annotations

import math
from dataclasses import replace

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
    """Hold a solver to a formulation, within what its stated accuracy makes of every number.

    Args:
        solver: a function of one mapping, or an object or class with a method `solve` (see `solvers.plain`).
        scene: or the name or path of one.
        accuracy: how exactly it places every point, mm, as it says itself.
        against: the name of a formulation, or one.
    Returns:
        The comparison, with what would explain that it disagrees in `explanations`.
    Raises:
        UsageError: `solver` is none, or `accuracy` is no length above 0.
        FormulationError: the solver raises an error, or the other formulation refuses the scene.
        SceneError: there is no such scene, or it is wrong.

    >>> def knows_camber(given):
    ...     return {"camber": [0.0 for _ in given["instants"]]}
    >>> check(knows_camber, "bounce").disagreements[0].name
    'camber'
    """
    function = as_function(solver, "the solver")
    taken = Scene.load(scene) if isinstance(scene, str) else scene
    one = PlainSolver(_name_of(solver), function, required_accuracy(accuracy))
    outcome = compare(taken, one, against)
    if not outcome.disagreements:
        return outcome
    # Imported here: most runs have nothing to explain.
    from validate.diagnosis import explain_outcome

    return replace(outcome, explanations=explain_outcome(taken, outcome))


def required_accuracy(accuracy: float) -> float:
    """An accuracy as it is.

    Raises:
        UsageError: it is no length above 0.
    """
    if not (math.isfinite(accuracy) and accuracy > 0.0):
        raise UsageError(f"an accuracy of {accuracy!r} mm is none; give a length above 0, such as 1e-6")
    return float(accuracy)


def _name_of(solver: object) -> str:
    return str(getattr(solver, "__name__", type(solver).__name__))
