"""What is compared, written and printed is named in pointcoord's registries and nowhere else."""

import ast
from functools import cache
from pathlib import Path

import pytest

import validate
from pointcoord.effects.registry import EFFECTS, QUANTITIES
from pointcoord.mechanism import mechanism_file, shipped
from pointcoord.mechanism.structure import PAIR_ROLES

ROOT = Path(validate.__file__).parent
# The paper's tables are about the paper's car; cars and hard cases are about hardpoints.
ROOMS = ("formulations", "comparison", "diagnosis", "output", "ci", "commands", "hardpoint_files", "html")
STRUCTURES = [one for name in shipped() for one in mechanism_file(name).structures.values()]
NAMES = {
    # A role may be called as an effect of it is, a text is read by json.loads, and a list pops.
    "effect": {*EFFECTS} - {*PAIR_ROLES, "loads", "pop"},
    "quantity": {*QUANTITIES} - {"pop"},
    "angle": {name for effect in EFFECTS.values() for name in effect.own_names},
    "mechanism": {*shipped()},
    # The letters by which a published linkage calls its pins are in use as metavars too.
    "hardpoint": {point for one in STRUCTURES for point in one.points if len(point) > 1},
    "body": {body for one in STRUCTURES for body in one.bodies if body != "chassis"},
    "input": {name for one in STRUCTURES for name in one.inputs},
}


def named(text: str) -> set[str]:
    """Strings and names of attributes in a program, without its docstrings."""
    tree = ast.parse(text)
    texts = {n.value for n in ast.walk(tree) if isinstance(n, ast.Constant) and isinstance(n.value, str)}
    return texts | {n.attr for n in ast.walk(tree) if isinstance(n, ast.Attribute)}


@cache
def named_in(path: Path) -> set[str]:
    return named(path.read_text(encoding="utf-8"))


def files() -> list[Path]:
    return [*ROOT.glob("*.py"), *(path for room in ROOMS for path in (ROOT / room).rglob("*.py"))]


@pytest.mark.parametrize("kind", NAMES)
def test_no_program_that_compares_writes_or_prints_names_one(kind: str) -> None:
    # The absolute model moves positions back to the user's origin, bounds from a stated accuracy are taken at
    # the positions that a model found, and the printed rows of the paper have a wheel centre; a sweep and an
    # import ask the topology which point its wheel centre is. The static angles of a wheel whose spin axis
    # another program's file lacks are two options of the import, and `axle` is which of the axles in such a
    # file. A turn is one of the chassis. A MuJoCo model says its roles by their names, of which one is of a
    # body, and the inputs of its slides and of its wheel are written as ours are.
    # The reference as a solution has the positions and rates of points by these
    # names, and a plan asks whether there is one wheel by the role of its body.
    allowed = {
        "absolute_coordinates.py": {"position"},
        "modelled.py": {"position"},
        "reference_solution.py": {
            "position",
            "velocity",
            "acceleration",
            "angular_velocity",
            "angular_acceleration",
        },
        "scenes.py": {"knuckle"},
        "report.py": {"wheel_centre"},
        "printed.py": {"wheel_centre"},
        "sweep.py": {"wheel_centre"},
        "written_scene.py": {"wheel_centre"},
        "one_wheel.py": {"wheel_centre", "camber", "toe", "axle"},
        "hardpoints.py": {"camber", "toe"},
        "mjcf.py": {"knuckle", "travel", "wheel_travel"},
        "motion.py": {"wheel_centre"},
    }
    assert NAMES[kind]
    for path in files():
        found = named_in(path) & NAMES[kind]
        assert found <= allowed.get(path.name, set()), path


def test_a_name_in_a_program_is_seen() -> None:
    assert named('x = numbers["camber"]\ny = motion.velocity') >= {"camber", "velocity"}
    assert len(files()) > 30
