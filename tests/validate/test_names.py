"""What is compared, written and printed is named in pointcoord's registries and nowhere else."""

import ast
from pathlib import Path

import pytest

import validate
from pointcoord.effects.registry import ALWAYS, EFFECTS, QUANTITIES
from pointcoord.suspensions import SUSPENSIONS

ROOT = Path(validate.__file__).parent
# The paper's tables are about the paper's car; cars and hard cases are about hardpoints.
ROOMS = ("formulations", "comparison", "diagnosis", "output", "ci", "commands", "hardpoint_files", "html")
TOPOLOGIES = [topology for kind in SUSPENSIONS.values() for topology in kind.closures.values()]
NAMES = {
    "effect": {*EFFECTS},
    "quantity": {*QUANTITIES},
    "angle": {
        name
        for e in (*ALWAYS, *EFFECTS.values())
        for names in e.gives_numbers.values()
        for name in names or ()
    },
    "suspension": {*SUSPENSIONS},
    "hardpoint": {point for topology in TOPOLOGIES for point in topology.points},
    "body": {body for topology in TOPOLOGIES for body in topology.bodies},
    "input": {name for topology in TOPOLOGIES for name in topology.inputs},
}


def named(text: str) -> set[str]:
    """Strings and names of attributes in a program, without its docstrings."""
    tree = ast.parse(text)
    texts = {n.value for n in ast.walk(tree) if isinstance(n, ast.Constant) and isinstance(n.value, str)}
    return texts | {n.attr for n in ast.walk(tree) if isinstance(n, ast.Attribute)}


def files() -> list[Path]:
    return [*ROOT.glob("*.py"), *(path for room in ROOMS for path in (ROOT / room).rglob("*.py"))]


@pytest.mark.parametrize("kind", NAMES)
def test_no_program_that_compares_writes_or_prints_names_one(kind: str) -> None:
    # The absolute model moves positions back to the user's origin, and the printed rows of the paper have
    # a wheel centre; a sweep and an import ask the topology which point its wheel centre is. The static
    # angles of a wheel whose spin axis another program's file lacks are two options of the import.
    allowed = {
        "absolute_coordinates.py": {"position"},
        "report.py": {"wheel_centre"},
        "printed_tables.py": {"wheel_centre"},
        "sweep.py": {"wheel_centre"},
        "importing.py": {"wheel_centre", "camber", "toe"},
        "hardpoints.py": {"camber", "toe"},
    }
    assert NAMES[kind]
    for path in files():
        found = named(path.read_text(encoding="utf-8")) & NAMES[kind]
        assert found <= allowed.get(path.name, set()), path


def test_a_name_in_a_program_is_seen() -> None:
    assert named('x = numbers["camber"]\ny = motion.velocity') >= {"camber", "velocity"}
    assert len(files()) > 30
