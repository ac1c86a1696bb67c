"""The package's names are found when they are first used, by whatever looks for them."""

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]


def test_names_are_there_for_a_star_for_dir_and_for_pickle_and_cost_nothing_before() -> None:
    program = """
import sys
import validate
loaded = {name.partition(".")[0] for name in sys.modules}
assert not {"numpy", "scipy", "flint", "pinocchio", "pydantic_core"} & loaded, loaded
assert set(validate.__all__) <= set(dir(validate))
assert not hasattr(validate, "compares")
import pickle
from validate import *
for name in validate.__all__:
    found = globals()[name]
    assert found is getattr(validate, name)
    assert found.__name__ == name, name
    assert pickle.loads(pickle.dumps(found)) is found
outcome = compare(__import__("pointcoord").Scene.load("steer"), "pointcoord", "pointcoord")
assert pickle.loads(pickle.dumps(outcome.rows)) == outcome.rows
error = NotTested("steer", 1.0, ["camber"], 3)
again = pickle.loads(pickle.dumps(error))
assert (type(again), str(again), vars(again)) == (type(error), str(error), vars(error))
"""
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", program], capture_output=True, text=True, check=False, cwd=ROOT
    )
    assert done.returncode == 0, done.stderr
