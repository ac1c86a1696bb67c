"""Every fault of a mechanism file is one line with the file, the key and what is allowed, and ends with 2."""

from pathlib import Path

import pytest

from pointcoord import Scene, SceneError
from pointcoord.mechanism.file import MECHANISMS
from validate.cli import main

WISHBONE = (MECHANISMS / "double_wishbone.toml").read_text()
SCENE = Scene.load("double-wishbone").model_dump(exclude_none=True)
# fmt: off
FAULTS = {
    "unknown table": ("[slides]", "[slide]", "slide", ("slides",)),
    "misspelt point of a slide": ('"rack_centre", along', '"rack_center", along', "slides.rack.through",
        ("rack_centre",)),
    "slide through another body's point": ('through = "rack_centre"', 'through = "lower_ball_joint"',
        "slides.rack.through", ("point of chassis",)),
    "unknown body": ('body = "chassis"', 'body = "chasis"', "slides.rack.body", ("did you mean 'chassis'",)),
    "unknown direction": ('from = "up"', 'from = "upp"', "inputs.arm_angle.from", ("did you mean 'up'",)),
    "line without a direction": ('along = "left"', 'along = "rack_centre"', "slides.rack.along",
        ("no direction",)),
    "unknown key of a slide": ('along = "left" }', 'alon = "left" }', "slides.rack.alon",
        ("did you mean 'along'",)),
    "rod of one point": ('["tie_rod_inner", "tie_rod_outer"]', '["tie_rod_inner", "tie_rod_inner"]',
        "rods.tie_rod", ("no length",)),
    "rod in a body": ('tie_rod = ["tie_rod_inner", "tie_rod_outer"]',
        'tie_rod = ["lower_ball_joint", "tie_rod_outer"]', "rods.tie_rod", ("knuckle",)),
    "rod that nothing holds": ('tie_rod = ["tie_rod_inner", "tie_rod_outer"]',
        'tie_rod = ["tie_rod_iner", "tie_rod_outer"]', "rods.tie_rod", ("did you mean 'tie_rod_inner'",)),
    "body of two points": ('["upper_arm_front", "upper_arm_rear", "upper_ball_joint"]',
        '["upper_arm_front", "upper_ball_joint"]', "bodies.upper_arm", ("[rods]",)),
    "three shared points": ('knuckle   = ["lower_ball_joint",',
        'knuckle   = ["lower_arm_front", "lower_arm_rear", "lower_ball_joint",', "bodies.knuckle",
        ("one body",)),
    "body that nothing holds": ("[rods] ", 'loose = ["a", "b", "c"]\n[rods] ', "bodies.loose",
        ("nothing holds",)),
    "no chassis": ("chassis   =", "ground   =", "bodies", ("chassis",)),
    "point twice": ('lower_arm = ["lower_arm_front", "lower_arm_rear"',
        'lower_arm = ["lower_arm_front", "lower_arm_front"', "bodies.lower_arm", ("twice",)),
    "input of no kind": ('{ height = "wheel_centre" }', '{ hight = "wheel_centre" }',
        "inputs.wheel_travel.hight", ("height",)),
    "travel of no slide": ('{ travel = "rack" }', '{ travel = "rak" }', "inputs.rack.travel",
        ("did you mean 'rack'",)),
    "height of no point": ('height = "wheel_centre"', 'height = "wheel_center"', "inputs.wheel_travel",
        ("did you mean",)),
    "hinge of one point": ("heave          =",
        'spin = { angle = "lower_arm", from = "drawing", on = "knuckle" }\nheave =', "inputs.spin",
        ("no hinge",)),
    "unknown role": ("knuckle       =", "nuckle       =", "roles.nuckle", ("did you mean 'knuckle'",)),
    "role of an unknown body": ('= "knuckle"', '= "upright"', "roles.knuckle", ("knuckle",)),
    "inboard point that moves": ('inboard       = "upper_arm_front"', 'inboard       = "lower_ball_joint"',
        "roles.inboard", ("chassis",)),
    "angle about a point of another body": ('about = "lower_arm_front"', 'about = "upper_arm_front"',
        "inputs.arm_angle.about", ("point of lower_arm",)),
    "wheel axis of two bodies": ('"wheel_centre"]\nsteering_axis', '"rack_centre"]\nsteering_axis',
        "roles.wheel_axis", ("knuckle, which carries the wheel",)),
    "contact of two bodies": ('contact = ["wheel_axis_inner"', 'contact = ["upper_arm_front"',
        "inputs.contact_travel", ("no one body",)),
    "stand-in that is not there": ('rack_centre = "tie_rod_inner"', 'rack_centre = "tie_rod_iner"',
        "stand_ins.rack_centre", ("did you mean 'tie_rod_inner'",)),
    "closure of an unknown table": ("[stand_ins]", "[closures.x]\nslide.a = 1\n[stand_ins]",
        "closures.x.slide", ("slides",)),
    "no TOML": ("[bodies]", "[bodies", "", ("TOML",)),
}
# fmt: on


def scene_beside(folder: Path, mechanism: str) -> Path:
    (folder / "mine.toml").write_text(mechanism)
    points = "\n".join(f"{n} = {list(p)}" for n, p in SCENE["mechanism"]["points"].items())
    path = folder / "scene.toml"
    path.write_text(
        f'[mechanism]\ntype = "mine.toml"\nside = "right"\n[mechanism.points]\n{points}\n[inputs]\n'
        "arm_angle = { constant = 1.51 }\nrack = { constant = 0.0 }\n"
        "[time]\nstart = 0.0\nstop = 0.0\nsamples = 1\n"
    )
    return path


def test_the_file_that_the_faults_are_planted_in_is_right(tmp_path: Path) -> None:
    scene = Scene.load(scene_beside(tmp_path, WISHBONE))
    assert (
        scene.mechanism.plain(scene.inputs)["bodies"]
        == Scene.load("double-wishbone").mechanism.plain([])["bodies"]
    )


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_names_the_file_the_key_and_what_is_meant(tmp_path: Path, fault: str) -> None:
    before, after, key, words = FAULTS[fault]
    assert WISHBONE.count(before) == 1, before
    path = scene_beside(tmp_path, WISHBONE.replace(before, after))
    with pytest.raises(SceneError) as caught:
        Scene.load(path)
    assert caught.value.source == str(tmp_path / "mine.toml")
    assert caught.value.key == key
    assert "\n" not in str(caught.value)
    assert all(word in str(caught.value) for word in words)


def test_a_fault_ends_a_command_in_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["plan", str(scene_beside(tmp_path, WISHBONE.replace("[bodies]", "[bodys]")))]) == 2
    assert capsys.readouterr().err.count("\n") == 1


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        ("tie_rod_outer = [-120.0, 650.0, 225.0]", "tie_rod_outer = [-10.0, 178.0, 154.0]",
         "mechanism.points: link tie_rod_inner - tie_rod_outer has no length"),
        ("upper_ball_joint = [9.0, 646.0, 315.0]", "upper_ball_joint = [9.0, 388.0, 255.0]",
         "mechanism.points: Double wishbone is not determined: free at the drawing"),
        ("rack = { constant = 0.0 }", "", "inputs: the Double wishbone has 2 freedoms, and 1 is driven"),
        ("rack = {", "rak = {", "inputs: no input is called 'rak' (did you mean 'rack'?)"),
        ('side = "right"', 'side = "left"', "mechanism: wheel_centre lies"),
    ],
)  # fmt: skip
def test_a_fault_of_a_scene_ends_in_one_line_with_file_and_key(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], before: str, after: str, words: str
) -> None:
    path = scene_beside(tmp_path, WISHBONE)
    written = path.read_text()
    assert written.count(before) == 1
    path.write_text(written.replace(before, after))
    assert main(["plan", str(path)]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"pointcoord: {path}: {words}")


def test_a_type_that_is_misspelt_names_the_one_that_is_near() -> None:
    content = {**SCENE, "mechanism": {**SCENE["mechanism"], "type": "double_wishbones"}}
    with pytest.raises(SceneError, match="did you mean 'double_wishbone'"):
        Scene.from_mapping(content)
    with pytest.raises(SceneError, match=r"cannot be read"):
        Scene.from_mapping({**SCENE, "mechanism": {**SCENE["mechanism"], "type": "none.toml"}})
    with pytest.raises(SceneError, match=r"mechanism\.type: this key is missing"):
        Scene.from_mapping({**SCENE, "mechanism": {"points": {}}})
    with pytest.raises(SceneError, match="there are roles beside type = 'double_wishbone'"):
        Scene.from_mapping({**SCENE, "mechanism": {**SCENE["mechanism"], "roles": {}}})


def test_a_fault_of_tables_in_a_scene_has_the_key_of_the_scene() -> None:
    import tomllib

    tables = tomllib.loads(WISHBONE)
    tables["slides"]["rack"]["along"] = "sideways"
    part = {**{n: v for n, v in SCENE["mechanism"].items() if n != "type"}, **tables}
    with pytest.raises(SceneError) as caught:
        Scene.from_mapping({**SCENE, "mechanism": part}, "here")
    assert caught.value.key == "mechanism.slides.rack.along"
