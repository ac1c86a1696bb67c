"""What a mechanism's points, inputs and types are called is said in mechanism files and in no program."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pointcoord
from pointcoord.effects.registry import EFFECTS, NUMBERS_OF_THE_CAR
from pointcoord.mechanism import mechanism_file, shipped
from pointcoord.mechanism.inputs import KINDS
from pointcoord.scene.scene_file import MOVES, CarPart

PACKAGE = Path(pointcoord.__file__).parent
POINTS = {point for name in shipped() for point in mechanism_file(name).points}
INPUTS = {name for one in shipped() for name in mechanism_file(one).inputs}
# A file may call an input as the format calls its kind, such as `turn`, or as an effect calls what it drives.
# A type may be called as what a scene says of its car, and an error tells how to write inputs of some names.
ELSEWHERE = {*KINDS, *EFFECTS, *NUMBERS_OF_THE_CAR, *MOVES}
EXACT = {*shipped()} - CarPart.model_fields.keys() | (INPUTS - ELSEWHERE)


def said(module: ast.Module) -> Iterator[tuple[int, str]]:
    """Line and text of every string that is no docstring."""
    prose = {id(node.value) for node in ast.walk(module) if isinstance(node, ast.Expr)}
    for node in ast.walk(module):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in prose:
            yield node.lineno, node.value


def test_no_program_says_the_name_of_a_point_an_input_or_a_type() -> None:
    found = [
        (str(path), line, text)
        for path in sorted(PACKAGE.rglob("*.py"))
        for line, text in said(ast.parse(path.read_text()))
        # A role may be called as a point is.
        if text in EXACT or (POINTS - {"wheel_centre"}) & set(re.findall(r"\w+", text))
    ]
    assert not found


def test_the_names_are_those_of_the_files() -> None:
    assert {"strut_top", "toe_inner", "pivot_outer"} <= POINTS
    assert {"arm_angle", "heave", "macpherson", "five_link"} <= EXACT
