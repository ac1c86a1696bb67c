"""Examples in docstrings do what they show."""

import doctest
import importlib
import pkgutil

# What a newcomer calls first has an example.
SHOWN = {
    "absolute.solve",
    "pointcoord.drawing_stands",
    "pointcoord.numerics.double_double",
    "pointcoord.simulation",
    "pointcoord.time_functions",
    "validate.comparison.compare",
    "validate.reference.instant",
}


def test_an_example_prints_what_it_shows_and_what_a_newcomer_calls_first_has_one() -> None:
    tried = set()
    for package in map(importlib.import_module, ("pointcoord", "absolute", "validate")):
        for found in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
            if not found.name.endswith("__main__"):
                outcome = doctest.testmod(importlib.import_module(found.name))
                assert outcome.failed == 0, found.name
                tried |= {found.name} if outcome.attempted else set()
    assert tried >= SHOWN
