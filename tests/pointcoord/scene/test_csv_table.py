"""A table of an input in a file of its own is the table in the scene."""

from importlib import resources
from pathlib import Path

import numpy as np
import pytest

from pointcoord import Scene, SceneError, simulate

TRAVEL = "wheel_travel = { polynomial = [-50.0, 100.0] }"
TIMES = np.linspace(0.0, 1.0, 6)
VALUES = np.array([-50.0, -32.0, -7.5, 8.25, 31.0, 50.0])


def written(folder: Path, law: str) -> Path:
    text = resources.files("pointcoord").joinpath("scenes", "wheel-travel.toml").read_text("utf-8")
    assert TRAVEL in text
    path = folder / "car.toml"
    path.write_text(text.replace(TRAVEL, f"wheel_travel = {law}"))
    return path


@pytest.mark.parametrize("head", ["", "time [s],travel [mm]\n", "\n"])
def test_a_table_beside_the_scene_is_the_one_in_it(tmp_path: Path, head: str) -> None:
    lines = [f"{t!r},{v!r}\n" for t, v in zip(TIMES.tolist(), VALUES.tolist(), strict=True)]
    (tmp_path / "bump.csv").write_text(head + "".join(lines))
    beside = written(tmp_path, '{ table = "bump.csv" }')
    other = tmp_path / "inside"
    other.mkdir()
    inside = written(other, f"{{ table = {{ times = {TIMES.tolist()}, values = {VALUES.tolist()} }} }}")
    assert Scene.load(beside).inputs == Scene.load(inside).inputs
    found, wanted = simulate(beside), simulate(inside)
    assert np.array_equal(found.wheel["camber"], wanted.wheel["camber"])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("t,z\n0,1\n1\n", "bump.csv: line 3: is '1'; allowed: two columns of numbers"),
        ("0,down\n1,2\n", "bump.csv: line 1: is '0,down'; allowed"),
        ("0,1\n0.5,up\n", "bump.csv: line 2: is '0.5,up'; allowed"),
        ("", "inputs.wheel_travel.table.times: "),
        ("0,1\n1,2\n", "inputs.wheel_travel.table.times: "),
        (None, "bump.csv: cannot be read (No such file or directory)"),
    ],
)
def test_what_is_no_table_is_refused_with_its_place(tmp_path: Path, text: str | None, words: str) -> None:
    if text is not None:
        (tmp_path / "bump.csv").write_text(text)
    with pytest.raises(SceneError) as caught:
        Scene.load(written(tmp_path, '{ table = "bump.csv" }'))
    assert words in str(caught.value)
