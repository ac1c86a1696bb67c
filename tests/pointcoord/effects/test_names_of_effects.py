"""What an effect and its numbers are called is known to its own file and to the registry alone."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

import pointcoord
from pointcoord.effects import registry
from pointcoord.effects.car_number import CarNumbers
from pointcoord.effects.effect import Effect
from pointcoord.effects.gradients import WAYS, gradients
from pointcoord.effects.registry import EFFECTS, NUMBERS_OF_THE_CAR
from pointcoord.mechanism.structure import PAIR_ROLES

PACKAGE = Path(pointcoord.__file__).parent
REGISTRY = Path(registry.__file__)


def is_base(effect: Effect) -> bool:
    return isinstance(effect, CarNumbers)


def own_files() -> dict[Path, str]:
    """The file of each effect, as the registry imports it, with the effect's name."""
    found = {}
    for node in ast.parse(REGISTRY.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("pointcoord.effects."):
            for alias in node.names:
                for effect in EFFECTS.values():
                    if getattr(registry, alias.name) is effect:
                        found[PACKAGE.parent / Path(*node.module.split(".")).with_suffix(".py")] = effect.name
    return found


OWN = own_files()
# A kind of effects, in a file of its own, may name the quantity that all of its kind give.
KINDS = {
    PACKAGE / "effects" / "gradients.py",
}
KINDS |= {
    PACKAGE.parent / Path(*kind.__module__.split(".")).with_suffix(".py")
    for one in (*EFFECTS.values(), *NUMBERS_OF_THE_CAR.values())
    for kind in type(one).__mro__
    if kind.__module__.startswith("pointcoord.")
}
NAMES = {
    *EFFECTS,
    *(quantity.name for effect in EFFECTS.values() for quantity in effect.quantities),
    *(name for effect in EFFECTS.values() for name in effect.names or ()),
} - {*PAIR_ROLES, "travel"}  # what a mechanism calls its parts, effects of them may be called too
MODULES = [path for path in sorted(PACKAGE.rglob("*.py")) if path not in {*OWN, *KINDS, REGISTRY}]


def named(path: Path) -> Iterator[tuple[int, str]]:
    """Line and name wherever code, not prose, speaks of an effect, a quantity or an angle."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    prose = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    modules = {f"pointcoord.effects.{own.stem}" for own in OWN}
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and id(node) not in prose and node.value in NAMES:
            yield node.lineno, str(node.value)
        elif isinstance(node, ast.Attribute) and node.attr in NAMES:
            yield node.lineno, node.attr
        elif isinstance(node, ast.ImportFrom) and node.module in modules:
            yield node.lineno, node.module


def test_every_effect_has_a_file_of_its_own() -> None:
    """But gradients, which one file makes of all that they are gradients of."""
    made = {gradients(effect, way).name for effect in EFFECTS.values() for way in WAYS if is_base(effect)}
    assert sorted(OWN.values()) == sorted(EFFECTS.keys() - made)
    assert len(OWN) == len(EFFECTS) - len(made)


@pytest.mark.parametrize("path", MODULES, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_no_other_file_names_an_effect_or_what_it_gives(path: Path) -> None:
    assert not list(named(path))


@pytest.mark.parametrize("path", OWN, ids=lambda path: path.stem)
def test_the_file_of_an_effect_names_no_other_effect(path: Path) -> None:
    mine = EFFECTS[OWN[path]]
    own = {mine.name, *(quantity.name for quantity in mine.quantities), *(mine.names or ())}
    # What another gives alone it may give among others.
    own |= {f"pointcoord.effects.{other.stem}" for other, name in OWN.items() if name in own}
    assert {name for _, name in named(path)} <= own


def test_names_are_found_where_they_are(tmp_path: Path) -> None:
    planted = tmp_path / "planted.py"
    planted.write_text(
        '"""velocity"""\n'
        "def f(samples):\n"
        '    """wheel_angles"""\n'
        "    velocity = samples.wheel\n"
        "    return samples.numbers['angular_velocity'], 'camber', velocity\n"
        "from pointcoord.effects.knuckle_rates import KNUCKLE_RATES\n"
    )
    assert [name for _, name in sorted(named(planted))] == [
        "wheel",
        "angular_velocity",
        "camber",
        "pointcoord.effects.knuckle_rates",
    ]
