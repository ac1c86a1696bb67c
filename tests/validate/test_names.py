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


# The absolute model moves positions back to the user's origin, bounds from a stated accuracy are taken at the
# positions that a model found, and the reference as a solution has positions and rates of points. A plan asks
# whether there is one wheel by the role of its body; the printed rows of the paper have a wheel centre; a
# sweep, an import and a MuJoCo model ask the topology for it. `axle` is one of the axles in another program's
# file, and the static angles of a wheel whose spin axis a file lacks are options of the import.
STATES = {"position", "velocity", "acceleration", "angular_velocity", "angular_acceleration"}
ALLOWED = {
    "absolute_coordinates.py": {"position"},
    "modelled.py": {"position"},
    "reference_solution.py": STATES,
    "scenes.py": {"knuckle"},
    **{f"{name}.py": {"wheel_centre"} for name in ("report", "printed", "sweep", "written_scene", "motion")},
    "one_wheel.py": {"camber", "toe"},
    "identified.py": {"axle"},
    "hardpoints.py": {"camber", "toe"},
    "mjcf.py": {"knuckle", "travel", "wheel_travel"},
}


@cache
def named(text: str) -> set[str]:
    """Strings and names of attributes in a program, without its docstrings."""
    nodes = [*ast.walk(ast.parse(text))]
    texts = {n.value for n in nodes if isinstance(n, ast.Constant) and isinstance(n.value, str)}
    return texts | {n.attr for n in nodes if isinstance(n, ast.Attribute)}


@pytest.mark.parametrize("kind", NAMES)
def test_no_program_that_compares_writes_or_prints_names_one(kind: str) -> None:
    assert named('x = numbers["camber"]\ny = motion.velocity') >= {"camber", "velocity"}
    files = [*ROOT.glob("*.py"), *(path for room in ROOMS for path in (ROOT / room).rglob("*.py"))]
    assert min(len(NAMES[kind]), len(files) - 30) > 0
    for path in files:
        found = named(path.read_text(encoding="utf-8")) & NAMES[kind]
        assert found <= ALLOWED.get(path.name, set()), path
