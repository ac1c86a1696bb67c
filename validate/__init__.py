"""Runs the formulations on the same scenes and says how far they agree.

from validate import compare
outcome = compare(Scene.load("bounce"), "pointcoord", "absolute")
"""

from validate.comparison.compare import Comparison, Outcome, compare
from validate.formulations.protocol import Accuracy, Formulation, FormulationError, Solution
from validate.running import check_what_is_run
from validate.solvers.check import check

__all__ = [
    "Accuracy",
    "Comparison",
    "Formulation",
    "FormulationError",
    "Outcome",
    "Solution",
    "check",
    "compare",
]

DISTRIBUTION = "pointcoord"  # tells this package from others of its name

check_what_is_run()
