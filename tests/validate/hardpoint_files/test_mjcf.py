"""A car as a MuJoCo model, read by MuJoCo, by Pinocchio and by our own import; and models of others."""

import json
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pinocchio
import pytest
from changed_scenes import scene_with
from foreign_files import FOUR_BAR, WELDED, imported

from pointcoord import Scene, simulate
from pointcoord.mechanism.file import MechanismFile
from pointcoord.numerics.arrays import Array
from validate import compare
from validate.cli import main
from validate.closed_drawing import closed_drawing
from validate.hardpoint_files.contents import OUR_AXES
from validate.hardpoint_files.importing import import_hardpoints
from validate.hardpoint_files.mjcf import mechanism_of
from validate.hardpoint_files.written_scene import Drawing
from validate.peers.mjcf import mjcf_of

EPSILON = float(np.finfo(float).eps)
# mm: what simulate may leave out of a place, of every scene here.
TOLERANCE = 1e-9
CARS = ("bounce", "five-link", "pushrod")
LINKAGES = ("slider-crank", "andrews-squeezer", "bricard")


def exported(name: str, folder: Path) -> Path:
    path = folder / f"{name}.xml"
    assert main(["export", name, "--mjcf", str(path)]) == 0
    return path


def rounding(places: Mapping[str, Array]) -> float:
    """mm: seven bodies at most lie one on another; each turn has four roundings and each sum one, of numbers
    as large as the largest coordinate, and so has the way there when it is written.
    """
    return 2 * 7 * 5 * EPSILON * max(float(np.abs(place).max()) for place in places.values())


def assert_placed_by_mujoco(model: mujoco.MjModel, drawn: Mapping[str, Array]) -> None:
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    for point, place in drawn.items():
        assert np.linalg.norm(1e3 * data.site(point).xpos - place) <= rounding(drawn), point
    # Loops are closed there, and nothing sets the car in motion.
    assert np.abs(data.efc_pos).max(initial=0.0) <= 1e-3 * rounding(drawn)


@pytest.mark.parametrize("name", [*CARS, *LINKAGES, "axle-steer"])
def test_mujoco_and_pinocchio_place_the_exported_points_where_they_are_drawn(
    name: str, tmp_path: Path
) -> None:
    path, drawn = exported(name, tmp_path), closed_drawing(Scene.load(name)).places
    model = mujoco.MjModel.from_xml_path(str(path))
    assert_placed_by_mujoco(model, drawn)
    # Pinocchio reads no sites of the world's own body.
    other = pinocchio.buildModelFromMJCF(str(path))
    found = other.createData()
    pinocchio.framesForwardKinematics(other, found, pinocchio.neutral(other))
    frames = {frame.name: number for number, frame in enumerate(other.frames)}
    moving = [point for point in drawn if model.site(point).bodyid != model.body("chassis").id]
    assert moving
    for point in moving:
        place = 1e3 * found.oMf[frames[point]].translation
        assert np.linalg.norm(place - drawn[point]) <= rounding(drawn), point


def test_a_car_in_other_axes_is_the_same_model() -> None:
    scene = Scene.load("double-wishbone")
    points = {name: (-x, -y, z) for name, (x, y, z) in scene.mechanism.points.items()}
    turned = scene_with("double-wishbone", {"points": points, "right": (0.0, -1.0, 0.0)})
    first, second = (mjcf_of(one.mechanism.plain(tuple(one.inputs)), "car") for one in (scene, turned))
    assert first == second


def test_a_car_far_from_the_origin_of_its_coordinates_is_exported_where_it_is() -> None:
    scene = Scene.load("double-wishbone")
    plain = scene.mechanism.plain(tuple(scene.inputs))
    plain["points"] = {name: [x + 40000.0, y, z] for name, (x, y, z) in plain["points"].items()}
    places = {name: np.array(place) for name, place in plain["points"].items()}
    assert_placed_by_mujoco(mujoco.MjModel.from_xml_string(mjcf_of(plain, "car")), places)


def same_way(scene: Scene, back: Scene) -> None:
    """Drawings differ by rounding, which a motion near its ends makes a thousand times as large: 1e-10 mm."""
    first, second = (simulate(one).position for one in (scene, back))
    for point, way in first.items():
        assert np.abs(way - second[point]).max() <= 2.1 * TOLERANCE, point


@pytest.mark.parametrize("name", [*CARS, *LINKAGES])
def test_what_is_exported_comes_back_with_its_motion_and_its_wheel(name: str, tmp_path: Path) -> None:
    back, scene = import_hardpoints(exported(name, tmp_path)).scene, Scene.load(name)
    assert compare(back, "pointcoord", "absolute").agreed
    assert back.mechanism.topology.wheel_axis == scene.mechanism.topology.wheel_axis
    # Travel is counted from the drawing, and only the closed one is exported.
    points = {point: place.tolist() for point, place in closed_drawing(scene).places.items()}
    laws: dict[str, Any] = {"wheel_travel": {"sweep": [-40.0, 40.0]}} if name in CARS else dict(scene.inputs)
    laws |= {"rack": {"constant": 0.0}} if "rack" in scene.inputs else {}
    changes = {"inputs": laws, "effects": [], "time": scene.time}
    first, second = (one.model_dump(exclude_none=True) for one in (scene, back))
    first["mechanism"]["points"] = points
    same_way(*(Scene.from_mapping(one | changes) for one in (first, second)))


def test_points_named_in_any_letters_come_back_with_the_roles_of_the_wheel(tmp_path: Path) -> None:
    plain = Scene.load("double-wishbone").mechanism.plain(("wheel_travel", "rack"))
    content = json.dumps(plain)
    for name in plain["points"]:
        content = content.replace(f'"{name}"', json.dumps(f"Länge \"{name}' <1> & /"))
    text = mjcf_of(json.loads(content), "car")
    mujoco.MjModel.from_xml_string(text)
    roles = imported(tmp_path, text, "car.xml").scene.mechanism.roles
    assert roles["wheel_axis"] == ["Länge_wheel_axis_inner_1", "Länge_wheel_centre_1"]
    assert roles["steering_axis"] == ["Länge_lower_ball_joint_1", "Länge_upper_ball_joint_1"]


def test_an_axle_comes_back_as_one_mechanism_and_neither_wheel_is_doubted(tmp_path: Path) -> None:
    back = import_hardpoints(exported("axle-roll", tmp_path)).scene
    assert back.mechanism.doubts == ()
    assert compare(back, "pointcoord", "absolute").agreed


def test_a_live_axle_comes_back_with_the_travel_of_both_wheels(tmp_path: Path) -> None:
    scene = Scene.load(Path(__file__).with_name("live-axle.toml"))
    back = imported(tmp_path, mjcf_of(scene.mechanism.plain(tuple(scene.inputs)), "axle"), "axle.xml").scene
    assert {*back.inputs} == {"left_wheel_travel", "right_wheel_travel"}
    same_way(scene.model_copy(update={"time": back.time}), back)


def test_a_text_that_gives_no_role_says_so(tmp_path: Path) -> None:
    text = exported("five-link", tmp_path).read_text(encoding="utf-8")
    wrong = {
        "wheel_axis_inner wheel_centre": "wheel_axs wheel_centre",
        'data="knuckle"': 'data="chassis knuckle"',
    }
    for right, other in wrong.items():
        text = text.replace(right, other)
    drawing = made(text, tmp_path)
    assert "text wheel_axis is ignored: no site is called 'wheel_axs'" in drawing.facts
    assert "text knuckle is ignored: it has 2 names; allowed: 1" in drawing.facts


def made(text: str, folder: Path) -> Drawing:
    """The mechanism of a model."""
    path = folder / "model.xml"
    path.write_text(text, encoding="utf-8")
    return mechanism_of(str(path), OUR_AXES)


@pytest.mark.parametrize("text", [FOUR_BAR, WELDED], ids=["connect", "weld"])
def test_a_four_bar_of_somebody_else_moves_as_its_closed_form(text: str, tmp_path: Path) -> None:
    found = imported(tmp_path, text, "four_bar.xml").scene
    assert list(found.inputs) == ["motor"]
    motion = simulate(found.model_copy(update={"inputs": {"motor": {"sweep": [-0.5, 2.0]}}}))
    turn = np.linspace(-0.5, 2.0, len(motion.times))
    # A joint turns right-handed about y, which leads z to x; the crank is drawn 60 deg above x.
    pin, ground = 100.0 * np.exp(1j * (np.radians(60.0) - turn)), 350.0
    rocker = abs(100.0 * np.exp(1j * np.pi / 3) + 300.0 * np.exp(1j * np.radians(20.0)) - ground)
    # Where the circles about both pins meet, on the side of the drawing.
    across = ground - pin
    along = (300.0**2 - rocker**2 + abs(across) ** 2) / (2.0 * abs(across))
    end = pin + (along + 1j * np.sqrt(300.0**2 - along**2)) * across / abs(across)
    place = motion.position["end"]
    assert np.ptp(place[:, 2]) > 30.0
    # Rounding of the closed form: some ten operations on 350 mm.
    assert np.abs(place[:, 0] + 1j * place[:, 2] - end).max() <= TOLERANCE + 40 * EPSILON * 350.0
    assert np.abs(place[:, 1]).max() <= TOLERANCE


def test_axes_turn_what_mujoco_placed(tmp_path: Path) -> None:
    plain = imported(tmp_path, FOUR_BAR, "model.xml")
    turned = imported(tmp_path, FOUR_BAR, "model.xml", axes="left,rearward,up")
    for one, other in zip(plain.drawing.points, turned.drawing.points, strict=True):
        x, y, z = one.place
        assert (other.name, other.place) == (one.name, (y, -x, z))


@pytest.mark.parametrize(
    "joints",
    [
        '<joint axis="1 0 0"/>',
        '<joint axis="1 0 0"/><joint axis="0 1 0"/>',
        '<joint type="slide" axis="0 0 1"/><joint axis="0 0 1"/>',
        '<joint type="ball"/>',
        '<joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/>',
    ],
)
def test_a_body_has_the_freedoms_that_mujoco_counts(joints: str, tmp_path: Path) -> None:
    sites = "".join(f'<site name="s{k}" pos="{0.3 * k} {0.1 * k * k} {0.2 - 0.1 * k}"/>' for k in range(3))
    body = f'<body name="b" pos="0 0 0.4">{joints}{sites}<geom size="0.1"/></body>'
    text = f"<mujoco><worldbody>{body}</worldbody></mujoco>"
    model = mujoco.MjModel.from_xml_string(text)
    found = made(text, tmp_path)
    points = {point.name: tuple(map(float, point.place)) for point in found.points}
    assert MechanismFile.of(found.tables or {}, "b").freedoms(points=points) == model.nv


def test_what_has_no_meaning_for_a_mechanism_is_ignored_and_named(tmp_path: Path) -> None:
    """Ranges of joints, tendons, soft equalities, bodies that hold nothing."""
    strap = '<tendon><fixed name="strap"><joint joint="knee" coef="1"/></fixed></tendon><equality>'
    tyre = '<body name="tyre"><joint/><geom size="1"/></body>'
    end = '<site name="end" pos="0.3 0 0"/>'
    text = FOUR_BAR.replace("<equality>", strap).replace(
        'body2="rocker"', 'body2="rocker" name="end" solref="0.1 1"'
    )
    text = text.replace(end, f'{end}<body name="hub"><joint/><geom size="1"/>{tyre}</body>')
    text = text.replace('name="knee"', 'name="knee" limited="true" range="-1 1"')
    plain, found = made(FOUR_BAR, tmp_path), made(text, tmp_path)
    assert plain.facts == ()
    told = " / ".join(found.facts)
    for name in ("joint 'knee'", "tendon 'strap'", "solref of 'end'", "body hub", "body tyre"):
        assert name in told
    assert len(found.facts) == 5
    assert [*(found.tables or {})["bodies"]] == [*(plain.tables or {})["bodies"]]


def test_without_mujoco_its_models_are_asked_for_the_package(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "model.xml"
    path.write_text(FOUR_BAR, encoding="utf-8")
    monkeypatch.setitem(sys.modules, "mujoco", None)
    assert main(["import", str(path)]) == 2
    assert "'import' needs the package 'mujoco'" in capsys.readouterr().err
