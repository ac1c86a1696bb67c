"""What is imported only where it is needed."""

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
SOLVED = (
    "import sys, pointcoord\n"
    "scene = pointcoord.Scene.load({name!r})\n"
    "{change}"
    "motion = pointcoord.simulate(scene)\n"
    "motion.proof(rates=True)\n"
    "print(*sorted({{name.partition('.')[0] for name in sys.modules}}))\n"
)
TABLE = (
    "table = dict(times=[0.0, 1.0, 2.0, 3.0], values=[0.0, 1.0, 0.0, 1.0])\n"
    "scene = scene.model_copy(update={'inputs': {**scene.inputs, 'rack': {'table': table}}})\n"
)


def imported(name: str, change: str = "") -> set[str]:
    """The packages that a new Python has imported once it has solved and proven a scene."""
    program = SOLVED.format(name=name, change=change)
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True, cwd=ROOT
    )
    return set(done.stdout.split())


def test_a_scene_without_a_table_is_solved_and_proven_without_scipy() -> None:
    found = imported("bounce-on-a-heaving-chassis")
    assert {"numpy", "pointcoord"} <= found
    assert not {"scipy", "matplotlib", "pyarrow", "pinocchio", "absolute", "validate"} & found


def test_a_table_is_read_with_scipy() -> None:
    assert "scipy" in imported("bounce", TABLE)
