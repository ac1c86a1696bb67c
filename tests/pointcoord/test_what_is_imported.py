"""What is imported only where it is needed."""

import subprocess
import sys
from pathlib import Path

SOLVED = (
    "import sys, pointcoord\n"
    "pointcoord.simulate('bounce-on-a-heaving-chassis').proof(rates=True)\n"
    "print(*sorted({name.partition('.')[0] for name in sys.modules}))\n"
)


def test_a_scene_without_a_table_is_solved_and_proven_without_scipy() -> None:
    command = [sys.executable, "-c", SOLVED]
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=Path(__file__).parents[2])
    found = set(done.stdout.split())
    assert {"numpy", "pointcoord"} <= found
    assert not {"scipy", "matplotlib", "pyarrow", "pinocchio", "absolute", "validate"} & found
