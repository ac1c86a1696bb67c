"""What `pointcoord new` writes is read as the scene that it is a copy of, wherever it stands."""

import shlex
from pathlib import Path

import pytest

from pointcoord import Scene, built_in_scenes
from validate.cli import main

NAMES = ('my "car"', "back\\1slash", "#5", "it's")


def plain(scene: Scene) -> object:
    """The mechanism and what drives it, without the name."""
    return {**scene.mechanism.plain(tuple(scene.inputs)), "name": ""}, scene.inputs, scene.time


@pytest.mark.parametrize(
    ("scene", "name"),
    [*((scene, "mine") for scene in built_in_scenes()), *(("five-link", name) for name in NAMES)],
)
def test_a_copy_is_that_scene_says_of_which_and_the_hint_can_be_typed(
    scene: str, name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A name is no kind of suspension: `new five_link` alone is no five-link."""
    assert main(["new", str(tmp_path / name), "--from", scene]) == 0
    source, copy = Scene.load(scene), Scene.load(tmp_path / f"{name}.toml")
    assert plain(source) == plain(copy)
    # What the scene names by its type is a file of its own now.
    assert (source.mechanism.type is not None) == (tmp_path / f"{name}-mechanism.toml").exists()
    assert copy.mechanism.type is None
    said = capsys.readouterr().out
    assert f"copied from {scene}" in said
    assert "--from SCENE" in said
    typed = shlex.split(said.rpartition("try: ")[2], comments=True)
    assert typed == ["pointcoord", "plan", str(tmp_path / f"{name}.toml")]
