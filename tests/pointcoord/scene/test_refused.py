"""Every fault of a scene or mechanism file is one line with file, key, value and what is allowed."""

from pathlib import Path

import pytest
from changed_scenes import change, content_of, scene_with
from mechanism_files import mechanism_file

from pointcoord import PointcoordError, Scene, SceneError, simulate, standing
from validate.toml_written import written

LINES = Path(__file__).with_name("refused.txt").read_text(encoding="utf-8").splitlines()
CASES = [[part.strip() for part in line.split(" | ")] for line in LINES if " | " in line and line[0] != "#"]


def written_file(path: Path, content: dict[str, object]) -> str:
    path.write_text("\n".join(written(content)), encoding="utf-8")
    return str(path)


@pytest.mark.parametrize(("base", "changes", "key", "words"), CASES)
def test_a_fault_names_the_file_the_key_and_what_is_meant(
    tmp_path: Path, base: str, changes: str, key: str, words: str
) -> None:
    source = str(tmp_path / "mine.toml")
    kind, _, mechanism = base.partition(" ")
    if mechanism:
        content = content_of("double-wishbone", {"type": source})
        tables = change(mechanism_file(mechanism), changes)
        if kind == "file":
            written_file(tmp_path / "mine.toml", tables)
        else:
            content["mechanism"] = {k: v for k, v in content["mechanism"].items() if k != "type"} | tables
    else:
        content = change(content_of(base, title=source), changes)
    with pytest.raises(SceneError) as caught:
        simulate(Scene.from_mapping(content, source))
    told = str(caught.value)
    assert caught.value.source == source
    assert key in caught.value.key
    assert source in told
    assert "\n" not in told
    assert [word for word in words.split(" & ") if word not in told.replace(source, "")] == [], told


@pytest.mark.parametrize(
    "content", [b"title = ", b"\xff\xfe", b"a = " + b"[" * 5000], ids=["cut", "bytes", "deep"]
)
def test_a_file_that_is_not_toml_is_refused(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "broken.toml"
    path.write_bytes(content)
    with pytest.raises(SceneError, match="not TOML") as caught:
        Scene.load(path)
    assert caught.value.source == str(path)


def test_a_type_that_is_no_file_is_refused() -> None:
    with pytest.raises(SceneError, match=r"cannot be read.*as type in .mechanism."):
        scene_with("double-wishbone", {"type": "none.toml"})


@pytest.mark.parametrize("name", ["bounse", "", "no/such/file.toml", "a\0b", None, 3, b"bounce"])
def test_what_names_no_scene_is_answered_with_the_built_in_ones(name: object) -> None:
    with pytest.raises(SceneError, match="bounce, bounce-and-steer"):
        Scene.load(name)


@pytest.mark.parametrize("given", [7, "bounce"])
def test_what_is_no_scene_is_refused(given: object) -> None:
    with pytest.raises(
        SceneError, match=rf"is of type {type(given).__name__}, not a scene; allowed: a Scene"
    ):
        standing(given)


@pytest.mark.parametrize(
    "changes",
    [
        "inputs.rack = { polynomial = [0.0, 1e308] }",
        "inputs.rack = { polynomial = [0.0, 1e200] }",
        "inputs.rack = { sine = { amplitude = 1.0, angular_frequency = 1e17 } }",
        "inputs.rack = { sine = { amplitude = 1e308, angular_frequency = 1.0 } }",
        f"inputs.rack = {{ constant = 1{400 * '0'} }}",
    ],
)
def test_numbers_too_large_for_the_arithmetic_end_in_an_error_of_this_package(changes: str) -> None:
    with pytest.raises(PointcoordError):
        simulate(Scene.from_mapping(change(content_of("bounce"), changes)))
