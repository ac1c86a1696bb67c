"""Every error class can be met, says what is wrong, where and what to try, and carries the data it speaks of.

A class without a recipe fails the first test here: whoever adds an error shows how to meet it.
"""

import importlib
import inspect
import pickle
import pkgutil
from pathlib import Path

import pytest
from error_recipes import RECIPES

PACKAGES = ("pointcoord", "absolute", "validate")
# Families, which are caught and never raised themselves.
BASES = {
    "pointcoord.errors.PointcoordError",
    "absolute.errors.AbsoluteError",
    "absolute.errors.PoseError",
}
# Says inside the solver that members take another form, or what is wrong with a mechanism's tables, of which
# the scene's error then says in which file; both are caught there.
# SIGTERM ends the program as Ctrl-C does, which `tests/validate/commands/test_door.py` tries.
CAUGHT = {"pointcoord.mechanism.faults.TableFault", "validate.exit_status.Terminated"}


def every_error_class() -> dict[str, type[BaseException]]:
    """All exception classes that the three packages define, by module and name."""
    classes: dict[str, type[BaseException]] = {}
    for package in map(importlib.import_module, PACKAGES):
        for found in pkgutil.walk_packages(package.__path__, package.__name__ + "."):
            for _, member in inspect.getmembers(importlib.import_module(found.name), inspect.isclass):
                if issubclass(member, BaseException) and member.__module__ == found.name:
                    classes[f"{found.name}.{member.__name__}"] = member
    return classes


CLASSES = every_error_class()


def class_of(recipe: str) -> str:
    """The name of a recipe's class; where several lead to one, what is at fault is named behind it."""
    return recipe.partition(": ")[0]


def test_every_error_class_has_a_recipe_and_every_recipe_a_class() -> None:
    assert set(CLASSES) - BASES - CAUGHT == set(map(class_of, RECIPES))


@pytest.mark.parametrize("name", RECIPES)
def test_error_can_be_met_speaks_clearly_carries_its_data_and_comes_back_from_another_process(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    recipe = RECIPES[name]
    kind = CLASSES[class_of(name)]
    with pytest.raises(kind) as caught:
        recipe.cook(tmp_path, monkeypatch)
    error, message = caught.value, str(caught.value)
    assert type(error) is kind
    assert "\n" not in message
    assert [word for word in recipe.words if word not in message] == [], message
    for attribute, expected in recipe.data.items():
        value = getattr(error, attribute)
        assert expected(value) if callable(expected) else value == expected, (attribute, value)
    if not name.startswith("pointcoord."):
        return
    again = pickle.loads(pickle.dumps(error))
    assert type(again) is type(error)
    assert (str(again), again.args) == (message, error.args)
    # A motion is another object with the same arrays.
    assert {key: repr(value) for key, value in vars(again).items()} == (
        {key: repr(value) for key, value in vars(error).items()}
    )


@pytest.mark.parametrize("name", sorted(BASES))
def test_families_hold_all_errors_of_their_package_and_are_never_raised(name: str) -> None:
    family = CLASSES[name]
    assert family.__subclasses__()
    for path in Path(inspect.getfile(family)).parent.rglob("*.py"):
        assert f"raise {family.__name__}(" not in path.read_text(encoding="utf-8"), path
