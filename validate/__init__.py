"""Runs the formulations on the same scenes and reports how far they agree.

from validate import compare
outcome = compare(Scene.load("bounce"), "pointcoord", "absolute")

Each name is imported at its first use, so that importing one part of the package does not load the others.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from validate.comparison.compare import Comparison, Outcome, compare
    from validate.formulations.protocol import Accuracy, Formulation, FormulationError, Solution
    from validate.solvers.check import check
    from validate.testing.assertion import NotTested, assert_agrees, assert_refuses

__all__ = [
    "Accuracy",
    "Comparison",
    "Formulation",
    "FormulationError",
    "NotTested",
    "Outcome",
    "Solution",
    "assert_agrees",
    "assert_refuses",
    "check",
    "compare",
]

DISTRIBUTION = "pointcoord"  # tells this package from others of its name

# The modules of the names that are not in `formulations.protocol`.
_MODULES = {
    "Comparison": "comparison.compare",
    "NotTested": "testing.assertion",
    "Outcome": "comparison.compare",
    "assert_agrees": "testing.assertion",
    "assert_refuses": "testing.assertion",
    "check": "solvers.check",
    "compare": "comparison.compare",
}


def __getattr__(name: str) -> object:
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f"{__name__}.{_MODULES.get(name, 'formulations.protocol')}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
