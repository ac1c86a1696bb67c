"""What a suspension's points, inputs and types are called is known to its own file alone."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

import pointcoord
from pointcoord.suspensions import SUSPENSIONS

PACKAGE = Path(pointcoord.__file__).parent
MODULES = [path for path in sorted(PACKAGE.rglob("*.py")) if "suspensions" not in path.parts]
TOPOLOGIES = [topology for suspension in SUSPENSIONS.values() for topology in suspension.closures.values()]
POINTS = {name for topology in TOPOLOGIES for name in topology.points}
EXACT = {*SUSPENSIONS, *(name for topology in TOPOLOGIES for name in topology.inputs)}


def said(module: ast.Module) -> Iterator[tuple[int, str]]:
    """Line and text of every string that is no docstring."""
    prose = {
        id(node.value) for node in ast.walk(module) if isinstance(node, ast.Expr)
    }  # strings that stand alone
    for node in ast.walk(module):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in prose:
            yield node.lineno, node.value


@pytest.mark.parametrize("path", MODULES, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_no_module_outside_says_the_name_of_a_point_an_input_or_a_type(path: Path) -> None:
    found = [
        (line, text)
        for line, text in said(ast.parse(path.read_text()))
        if text in EXACT or POINTS & set(re.findall(r"\w+", text))
    ]
    assert not found


def test_the_names_are_found_where_they_are() -> None:
    strings = [text for _, text in said(ast.parse((PACKAGE / "suspensions" / "macpherson.py").read_text()))]
    assert {"strut_top", "arm_angle", "heave", "macpherson"} <= set(strings)
