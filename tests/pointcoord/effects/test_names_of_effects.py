"""What effects and their numbers are called is known to their own files, the registry and the page alone."""

import ast
from collections.abc import Iterator
from pathlib import Path

from every_effect import OF_A_WHEEL

import pointcoord
from pointcoord.effects import registry
from pointcoord.effects.registry import EFFECTS, NUMBERS_OF_THE_CAR
from pointcoord.mechanism.structure import PAIR_ROLES

PACKAGE = Path(pointcoord.__file__).parent
PAGE = (PACKAGE / "effects" / "README.md").read_text(encoding="utf-8")
WAYS = ("_by_travel", "_by_rack", "_by_time")


def own_files() -> dict[Path, list[str]]:
    """The files of effects, as the registry imports them, with the names of their effects."""
    found: dict[Path, list[str]] = {}
    for node in ast.parse(Path(registry.__file__).read_text(encoding="utf-8")).body:
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("pointcoord.effects."):
            for alias in node.names:
                for effect in EFFECTS.values():
                    if getattr(registry, alias.name) is effect:
                        path = PACKAGE.parent / Path(*node.module.split(".")).with_suffix(".py")
                        found.setdefault(path, []).append(effect.name)
    return found


OWN = own_files()
# Kinds of effects may name the quantity that all of their kind give; conventions are about names.
KINDS = {
    PACKAGE / "effects" / f"{name}.py"
    for name in ("gradients", "angle", "car_number", "conventions", "point_states", "registry")
}
NAMES = {
    *EFFECTS,
    *(quantity.name for effect in EFFECTS.values() for quantity in effect.quantities),
    *(name for effect in EFFECTS.values() for name in effect.own_names),
} - {
    *PAIR_ROLES,
    "travel",
    "axle",
    "loads",
    "pop",
}  # what a mechanism calls its parts, effects of them may be called too; a list pops


def named(text: str) -> Iterator[str]:
    """Wherever code, not prose, speaks of an effect, a quantity or an angle."""
    tree = ast.parse(text)
    prose = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    modules = {f"pointcoord.effects.{own.stem}" for own in OWN}
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and id(node) not in prose and node.value in NAMES:
            yield str(node.value)
        elif isinstance(node, ast.Attribute) and node.attr in NAMES:
            yield node.attr
        elif isinstance(node, ast.ImportFrom) and node.module in modules:
            yield str(node.module)


def test_every_effect_is_in_one_file_but_gradients_and_states_of_points() -> None:
    alone = (name for name, effect in EFFECTS.items() if not (effect.base or effect.reports_states))
    assert sorted(name for names in OWN.values() for name in names) == sorted(alone)


def test_no_other_file_names_an_effect_or_what_it_gives() -> None:
    assert sorted(named("def f(x):\n    'toe'\n    return x.wheel, 'camber'")) == ["camber", "wheel"]
    for path in sorted(set(PACKAGE.rglob("*.py")) - KINDS):
        own: set[str] = set()
        if path in OWN:
            for mine in map(EFFECTS.__getitem__, OWN[path]):
                own |= {mine.name, *(quantity.name for quantity in mine.quantities), *mine.own_names}
            # It may be made of what another gives.
            own |= {f"pointcoord.effects.{other.stem}" for other in OWN}
        assert set(named(path.read_text(encoding="utf-8"))) <= own, path


def test_the_page_of_effects_says_what_each_is() -> None:
    names = (name for name in (*EFFECTS, *NUMBERS_OF_THE_CAR) if not name.endswith(WAYS))
    assert [name for name in names if f"`{name}`" not in PAGE] == []


def test_every_effect_of_positions_of_the_car_has_gradients_along_every_way() -> None:
    effects = [EFFECTS[name] for name in OF_A_WHEEL]
    plain = {n for one in effects if not (one.way or one.base) for n in one.own_names}
    assert {n + way for n in plain for way in WAYS} <= NUMBERS_OF_THE_CAR.keys()
