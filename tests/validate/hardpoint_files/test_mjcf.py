"""A car as a MuJoCo model, read by MuJoCo, by Pinocchio and by our own import; and models of others."""

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pinocchio
import pytest
from changed_scenes import scene_with
from foreign_files import FOUR_BAR, imported

from pointcoord import Scene, simulate
from pointcoord.mechanism.file import MechanismFile
from pointcoord.numerics.arrays import Array
from validate import compare
from validate.cli import main
from validate.closed_drawing import closed_drawing
from validate.hardpoint_files.contents import OUR_AXES
from validate.hardpoint_files.importing import import_hardpoints
from validate.hardpoint_files.mjcf import drawing_of
from validate.hardpoint_files.written_scene import Drawing
from validate.peers.mjcf import mjcf_of
from validate.tables.errors import FileError

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
    first, second = (simulate(Scene.from_mapping(one | changes)).position for one in (first, second))
    for point, path in first.items():
        # Drawings differ by rounding, which a motion near its ends makes a thousand times as large: 1e-10 mm.
        assert np.abs(path - second[point]).max() <= 2.1 * TOLERANCE, point


def test_points_named_in_any_letters_come_back_with_the_roles_of_the_wheel(tmp_path: Path) -> None:
    plain = Scene.load("double-wishbone").mechanism.plain(("wheel_travel", "rack"))
    text = mjcf_of(_renamed(plain, "Länge \"{}' <1> & /"), "car")
    mujoco.MjModel.from_xml_string(text)
    path = tmp_path / "car.xml"
    path.write_text(text, encoding="utf-8")
    roles = import_hardpoints(path).scene.mechanism.roles
    assert roles["wheel_axis"] == ("Länge_wheel_axis_inner_1", "Länge_wheel_centre_1")
    assert roles["steering_axis"] == ("Länge_lower_ball_joint_1", "Länge_upper_ball_joint_1")


def _renamed(plain: Any, form: str) -> Any:
    """Plain data with every name of a point in another form."""
    names = {name: form.format(name) for name in plain["points"]}

    def changed(one: Any) -> Any:
        if isinstance(one, dict):
            return {names.get(key, key): changed(value) for key, value in one.items()}
        if isinstance(one, list | tuple):
            return [changed(value) for value in one]
        return names.get(one, one) if isinstance(one, str) else one

    return changed(plain)


def test_an_axle_comes_back_as_one_mechanism_and_neither_wheel_is_doubted(tmp_path: Path) -> None:
    back = import_hardpoints(exported("axle-roll", tmp_path)).scene
    assert back.mechanism.doubts == ()
    assert compare(back, "pointcoord", "absolute").agreed


LIVE_AXLE: dict[str, Any] = {
    "bodies": {
        "chassis": ["top_front", "left_front", "right_front", "bar_left"],
        "axle": ["top", "left", "right", "bar_right", "hub_l", "centre_l", "hub_r", "centre_r"],
    },
    "rods": {
        "top_link": ["top_front", "top"],
        "left_link": ["left_front", "left"],
        "right_link": ["right_front", "right"],
        "panhard": ["bar_left", "bar_right"],
    },
    "parts": {"left": {"side": "left"}, "right": {"side": "right"}},
    "inputs": {"left.travel": {"height": "centre_l"}, "right.travel": {"height": "centre_r"}},
    "roles": {
        "left.knuckle": "axle",
        "left.wheel_axis": ["hub_l", "centre_l"],
        "right.knuckle": "axle",
        "right.wheel_axis": ["hub_r", "centre_r"],
    },
    "points": {
        "top_front": [-450, 20, 480],
        "top": [-30, 15, 470],
        "left_front": [-600, -480, 330],
        "left": [-20, -520, 230],
        "right_front": [-600, 480, 330],
        "right": [-20, 520, 230],
        "bar_left": [110, -500, 330],
        "bar_right": [100, 480, 320],
        "hub_l": [0, -700, 300],
        "centre_l": [0, -760, 301],
        "hub_r": [0, 700, 300],
        "centre_r": [0, 760, 301],
    },
}


def test_a_live_axle_comes_back_with_the_travel_of_both_wheels(tmp_path: Path) -> None:
    laws = {"left.travel": {"sweep": [-30.0, 30.0]}, "right.travel": {"sweep": [-30.0, 30.0]}}
    scene = Scene.from_mapping({"mechanism": LIVE_AXLE, "inputs": laws})
    path = tmp_path / "axle.xml"
    path.write_text(mjcf_of(scene.mechanism.plain(tuple(laws)), "axle"), encoding="utf-8")
    back = import_hardpoints(path).scene
    assert {*back.inputs} == {"left_wheel_travel", "right_wheel_travel"}
    first, second = (simulate(one.model_copy(update={"time": back.time})) for one in (scene, back))
    for point, way in first.position.items():
        assert np.abs(way - second.position[point]).max() <= 2.1 * TOLERANCE, point


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
    return drawing_of(str(path), OUR_AXES)


# The same with a body more, on the rocker's end: the coupler and it are one.
WELDED = FOUR_BAR.replace(
    '<joint class="pin"/><geom size="0.1"/>',
    '<joint class="pin"/><geom size="0.1"/><body name="tip" '
    'pos="-0.018092213764227 0 0.189208583376144"><joint class="pin"/><geom size="0.1"/></body>',
).replace('<connect body1="coupler" body2="rocker" anchor="0.3 0 0"/>', '<weld body1="coupler" body2="tip"/>')


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
    points = {point.name: point.coordinates for point in found.points}
    assert MechanismFile.of(found.tables or {}, "b").freedoms(points=points) == model.nv


def broken(old: str, new: str) -> str:
    assert old in FOUR_BAR
    return FOUR_BAR.replace(old, new)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("<mujoco><worldbody></mujoco>", ("MISMATCHED_ELEMENT", "number=1")),
        (broken('childclass="pin"', 'childclass="nut"'), ("unknown default childclass", "line 8")),
        (broken('body2="rocker"', 'body2="roker"'), ("unknown element 'roker'", "line 19")),
        (
            broken('"crank" childclass="pin" euler="0 -60 0"', '"crank" mocap="true"'),
            ("is refused by MuJoCo", "mocap"),
        ),
        (
            broken("<worldbody>", '<worldbody><body name="hand" mocap="true"/>'),
            ("body 'hand': is a mocap body",),
        ),
        (broken("<equality>", '<equality><joint name="gear" joint1="knee"/>'), ("equality 'gear'",)),
        (WELDED.replace('"tip"/>', '"tip" name="w" relpose="0 0 0.1 1 0 0 0"/>'), ("weld 'w': does not",)),
        (WELDED.replace('"tip"/>', '"tip" name="w" torquescale="0"/>'), ("weld 'w': does not hold",)),
        (
            broken('<joint class="pin"/>', '<joint class="pin"/><site name="tip" pos="0 0 0.2"/>').replace(
                'body1="coupler" body2="rocker" anchor="0.3 0 0"', 'site1="end" site2="tip"'
            ),
            ("connect end: joins positions that are 21.07 mm apart",),
        ),
        (
            "<mujoco><worldbody>" + 100 * "<body><geom size='1'/></body>" + "</worldbody></mujoco>",
            ("has 100 bodies",),
        ),
    ],
)
def test_what_is_not_known_is_refused_by_its_name(text: str, words: tuple[str, ...], tmp_path: Path) -> None:
    with pytest.raises(FileError) as caught:
        imported(tmp_path, text, "model.xml", format="mjcf")
    assert [word for word in ("model.xml", *words) if word not in str(caught.value)] == [], caught.value


def test_what_has_no_meaning_for_a_mechanism_is_ignored_and_named(tmp_path: Path) -> None:
    """Ranges of joints, tendons, soft equalities, bodies that hold nothing."""
    strap = '<tendon><fixed name="strap"><joint joint="knee" coef="1"/></fixed></tendon><equality>'
    tyre = '<body name="tyre"><joint/><geom size="1"/></body>'
    end = '<site name="end" pos="0.3 0 0"/>'
    text = broken("<equality>", strap).replace('body2="rocker"', 'body2="rocker" name="end" solref="0.1 1"')
    text = text.replace(end, f'{end}<body name="hub"><joint/><geom size="1"/>{tyre}</body>')
    text = text.replace('name="knee"', 'name="knee" limited="true" range="-1 1"')
    plain, found = made(FOUR_BAR, tmp_path), made(text, tmp_path)
    assert plain.facts == ()
    told = " / ".join(found.facts)
    for name in ("joint 'knee'", "tendon 'strap'", "solref of 'end'", "body hub", "body tyre"):
        assert name in told
    assert len(found.facts) == 5
    assert [*(found.tables or {})["bodies"]] == [*(plain.tables or {})["bodies"]]


def test_what_means_nothing_for_a_model_is_refused(tmp_path: Path) -> None:
    with pytest.raises(FileError, match="is a whole mechanism, for which --side has no meaning"):
        imported(tmp_path, FOUR_BAR, "model.xml", side="left")
    names = str(tmp_path / "names.toml")
    assert main(["import", str(tmp_path / "model.xml"), "--names", names]) == 2


def test_without_mujoco_its_models_are_asked_for_the_package(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "model.xml"
    path.write_text(FOUR_BAR, encoding="utf-8")
    monkeypatch.setitem(sys.modules, "mujoco", None)
    assert main(["import", str(path)]) == 2
    assert "'import' needs the package 'mujoco'" in capsys.readouterr().err
