"""Runs the formulations on the same scenes and says how far they agree.

from validate import compare
outcome = compare(Scene.load("bounce"), "pointcoord", "absolute")

Names are imported when they are first used, so that a part of the package costs no more than itself.
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

# Where names are that are no part of the protocol of formulations.
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
