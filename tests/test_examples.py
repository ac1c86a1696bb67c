"""Examples in docstrings do what they show."""

import doctest
import importlib
import pkgutil

import pytest

PACKAGES = ("pointcoord", "absolute", "validate")
# What a newcomer calls first has an example.
SHOWN = {
    "absolute.solve",
    "pointcoord.drawing_stands",
    "pointcoord.numerics.double_double",
    "pointcoord.simulation",
    "pointcoord.time_functions",
    "validate.comparison.compare",
    "validate.reference.solve",
}


def modules() -> list[str]:
    """Every module of the packages but programs."""
    packages = [importlib.import_module(name) for name in PACKAGES]
    found = (m.name for p in packages for m in pkgutil.walk_packages(p.__path__, f"{p.__name__}."))
    return [name for name in found if not name.endswith("__main__")]


def examples(name: str) -> list[doctest.DocTest]:
    """The examples of a module that have something to show."""
    return [test for test in doctest.DocTestFinder().find(importlib.import_module(name)) if test.examples]


WITH_EXAMPLES = [name for name in modules() if examples(name)]


def test_what_a_newcomer_calls_first_has_an_example() -> None:
    assert set(WITH_EXAMPLES) >= SHOWN


@pytest.mark.parametrize("name", WITH_EXAMPLES)
def test_an_example_prints_what_it_shows(name: str) -> None:
    for test in examples(name):
        outcome = doctest.DocTestRunner().run(test)
        assert outcome.attempted > 0
        assert outcome.failed == 0, test.name
