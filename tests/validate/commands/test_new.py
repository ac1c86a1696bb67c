"""What `pointcoord new` writes is read as the scene that it is a copy of, wherever it stands."""

from pathlib import Path

import pytest

from pointcoord import Scene, built_in_scenes
from validate.cli import main


def copied(scene: str, target: Path) -> tuple[Scene, Scene]:
    """A scene, and the copy that the command made of it."""
    assert main(["new", str(target), "--from", scene]) == 0
    return Scene.load(scene), Scene.load(target.with_suffix(".toml"))


def same(one: Scene, other: Scene) -> bool:
    """Whether two scenes are the same mechanism, drawn and driven alike."""
    plain = [{**s.mechanism.plain(tuple(s.inputs)), "name": ""} for s in (one, other)]
    return plain[0] == plain[1] and one.inputs == other.inputs and one.time == other.time


@pytest.mark.parametrize("scene", built_in_scenes())
def test_a_copy_of_a_built_in_scene_is_that_scene_and_says_of_which(
    scene: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A name is no kind of suspension: `new five_link` alone is no five-link."""
    assert same(*copied(scene, tmp_path / "mine"))
    said = capsys.readouterr().out
    assert f"copied from {scene}" in said
    assert "--from SCENE" in said


CORNER = """
[bodies]
chassis = ["a", "b"]
arm = ["a", "b", "c"]
[inputs]
turn = { angle = "arm", from = "drawing" }
"""
SCENE = """
[mechanism]
type = "car.toml"
[mechanism.points]
a = [0, 100, 0]
b = [300, 100, 0]
c = [0, 500, 0]
[inputs]
"left.turn" = { table = "bump.csv" }
"right.turn" = { sweep = [0.0, 0.2] }
"""


def test_a_copy_in_another_folder_finds_the_files_of_parts_and_tables(tmp_path: Path) -> None:
    for name, text in {
        "corner.toml": CORNER,
        "car.toml": '[parts]\nleft = { mechanism = "corner.toml", mirrored = true }\n'
        'right = { mechanism = "corner.toml", side = "right" }\n',
        "scene.toml": SCENE,
        "bump.csv": "0.0,0.0\n0.5,0.1\n0.8,0.15\n1.0,0.2\n",
    }.items():
        (tmp_path / name).write_text(text)
    (tmp_path / "elsewhere").mkdir()
    assert same(*copied(str(tmp_path / "scene.toml"), tmp_path / "elsewhere" / "mine"))
