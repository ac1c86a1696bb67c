"""Names of mechanisms are said in mechanism files alone, those of effects in their files, tables and page."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

from every_number import OF_A_WHEEL
from table_of_effects import rows, table

import pointcoord
from pointcoord.effects import registry
from pointcoord.effects.numbers import CAR_NUMBERS, FILES
from pointcoord.effects.point_states import FIRST_NUMBERED, STATES
from pointcoord.effects.registry import EFFECTS, NUMBERS_OF_THE_CAR
from pointcoord.mechanism import mechanism_file, shipped
from pointcoord.mechanism.inputs import KINDS
from pointcoord.mechanism.structure import PAIR_ROLES
from pointcoord.scene.mechanism_part import CarPart
from pointcoord.scene.scene_file import TURNS

PACKAGE = Path(pointcoord.__file__).parent
TREES = {path: ast.parse(path.read_text(encoding="utf-8")) for path in sorted(PACKAGE.rglob("*.py"))}
PAGE = (PACKAGE / "effects" / "README.md").read_text(encoding="utf-8")
WAYS = ("_by_travel", "_by_rack", "_by_roll", "_by_time")


def said(tree: ast.Module) -> Iterator[str]:
    """Every string that is no docstring."""
    prose = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in prose:
            yield node.value


# ------------------------------------------------------------------------------------------- mechanisms

POINTS = {point for name in shipped() for point in mechanism_file(name).points}
INPUTS = {name for one in shipped() for name in mechanism_file(one).structures["drawn"].inputs}
# A file may call an input as the format calls its kind, such as `turn`, or as an effect calls what it drives.
# A type may be called as what a scene says of its car, and an error tells how to write inputs of some names.
ELSEWHERE = {*KINDS, *EFFECTS, *NUMBERS_OF_THE_CAR, *TURNS}
EXACT = {*shipped()} - CarPart.model_fields.keys() | (INPUTS - ELSEWHERE)


def test_no_program_says_the_name_of_a_point_an_input_or_a_type() -> None:
    assert {"strut_top", "toe_inner", "pivot_outer"} <= POINTS
    assert {"arm_angle", "heave", "macpherson", "five_link"} <= EXACT
    found = [
        (str(path), text)
        for path, tree in TREES.items()
        for text in said(tree)
        # A role may be called as a point is.
        if text in EXACT or (POINTS - {"wheel_centre"}) & set(re.findall(r"\w+", text))
    ]
    assert not found


# ---------------------------------------------------------------------------------------------- effects


def own_files() -> dict[Path, list[str]]:
    """The files of effects and of their formulas, with the effects that are named in them, not in a table."""
    found: dict[Path, list[str]] = {Path(file.__file__ or ""): [] for file in FILES.values()}
    for node in TREES[Path(registry.__file__)].body:
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("pointcoord.effects."):
            path = PACKAGE.parent / Path(*(node.module or "").split(".")).with_suffix(".py")
            for alias in node.names:
                names = [e.name for e in EFFECTS.values() if getattr(registry, alias.name) is e]
                if names:
                    found.setdefault(path, []).extend(names)
    return found


OWN = own_files()
# Kinds of effects may name the quantity that all of their kind give; conventions are about names.
OF_KINDS = {
    PACKAGE / "effects" / f"{name}.py" for name in ("car_number", "numbers", "point_states", "registry")
}
# What a mechanism calls its parts, effects of them may be called too; a list pops.
NAMES = {
    name
    for effect in EFFECTS.values()
    for name in (effect.name, *(quantity.name for quantity in effect.quantities), *effect.own_names)
} - {*PAIR_ROLES, "travel", "axle", "loads", "pop"}


def named(tree: ast.Module) -> set[str]:
    """The effects, quantities and numbers that code speaks of, and the files of effects that it imports."""
    modules = {f"pointcoord.effects.{own.stem}" for own in OWN}
    attributes = {node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute)}
    imported = {node.module or "" for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    return ({*said(tree)} | attributes) & NAMES | imported & modules


def test_no_file_names_an_effect_or_what_it_gives_but_its_own() -> None:
    assert named(ast.parse("def f(x):\n    'toe'\n    return x.wheel, 'camber'")) == {"camber", "wheel"}
    # Gradients and states of points are made, each from one class.
    alone = (name for name, effect in EFFECTS.items() if not (effect.base or effect.reports_states))
    assert sorted([*CAR_NUMBERS, *(name for names in OWN.values() for name in names)]) == sorted(alone)
    for path in TREES.keys() - OF_KINDS:
        own: set[str] = set()
        if path in OWN:
            for mine in map(EFFECTS.__getitem__, OWN[path]):
                own |= {mine.name, *(quantity.name for quantity in mine.quantities), *mine.own_names}
            # It may be made of what another gives.
            own |= {f"pointcoord.effects.{other.stem}" for other in OWN}
        assert named(TREES[path]) <= own, path


def test_every_effect_of_positions_of_the_car_has_gradients_along_every_way() -> None:
    effects = [EFFECTS[name] for name in OF_A_WHEEL]
    plain = {n for one in effects if not (one.way or one.base) for n in one.own_names}
    assert {n + way for n in plain for way in WAYS} <= NUMBERS_OF_THE_CAR.keys()


def test_the_table_of_the_page_is_what_the_effects_say_of_themselves() -> None:
    (shown,) = re.findall(r"<!-- figure effects -->\n.*?\n\n(.*?)\n\n<!-- end -->", PAGE, flags=re.S)
    assert shown == table(), "python tests/figures.py effects"
    # Between the first and the last the derivatives by number are not listed.
    assert all(f"`{name}`" in PAGE for name in (FIRST_NUMBERED, STATES[-1]))


def test_each_number_has_a_definition_in_the_table_and_a_unit() -> None:
    assert [row for row in rows() if row[2].endswith(": ") or not (row[1] and row[4])] == []
    assert [row for row in rows() if "|" in "".join(row)] == []
