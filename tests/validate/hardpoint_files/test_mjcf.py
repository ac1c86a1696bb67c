"""A car as a MuJoCo model, read by MuJoCo, by Pinocchio and by our own import; and models of others."""

import sys
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
from validate.closed_drawing import closed_drawing, closed_mechanism
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


def rounding(places: dict[str, Array]) -> float:
    """mm: seven bodies at most lie one on another; each turn has four roundings and each sum one, of numbers
    as large as the largest coordinate, and so has the way there when it is written.
    """
    return 2 * 7 * 5 * EPSILON * max(float(np.abs(place).max()) for place in places.values())


@pytest.mark.parametrize("name", [*CARS, *LINKAGES, "axle-steer"])
def test_mujoco_and_pinocchio_place_the_exported_points_where_they_are_drawn(
    name: str, tmp_path: Path
) -> None:
    path, drawn = exported(name, tmp_path), dict(closed_drawing(Scene.load(name)).places)
    near = rounding(drawn)
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    for point, place in drawn.items():
        assert np.linalg.norm(1e3 * data.site(point).xpos - place) <= near, point
    # Loops are closed there, and nothing sets the car in motion.
    assert np.abs(data.efc_pos).max(initial=0.0) <= 1e-3 * near

    # Pinocchio reads no sites of the world's own body.
    other = pinocchio.buildModelFromMJCF(str(path))
    found = other.createData()
    pinocchio.framesForwardKinematics(other, found, pinocchio.neutral(other))
    frames = {frame.name: number for number, frame in enumerate(other.frames)}
    moving = [point for point in drawn if model.site(point).bodyid != model.body("chassis").id]
    assert moving
    for point in moving:
        assert np.linalg.norm(1e3 * found.oMf[frames[point]].translation - drawn[point]) <= near, point


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
    model = mujoco.MjModel.from_xml_string(mjcf_of(plain, "car"))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    places = {name: np.array(place) for name, place in plain["points"].items()}
    for name, place in places.items():
        assert np.linalg.norm(1e3 * data.site(name).xpos - place) <= rounding(places), name


@pytest.mark.parametrize("name", [*CARS, *LINKAGES])
def test_what_is_exported_comes_back_with_its_motion_and_the_camber_of_its_wheel(
    name: str, tmp_path: Path
) -> None:
    back = import_hardpoints(exported(name, tmp_path)).scene
    assert compare(back, "pointcoord", "absolute").agreed
    scene = Scene.load(name)
    # Travel is counted from the drawing, and only the closed one is exported.
    places = closed_drawing(scene).places
    closed = {"points": {name: place.tolist() for name, place in places.items()}}
    is_car = name in CARS
    laws: dict[str, Any] = {"wheel_travel": {"sweep": [-40.0, 40.0]}} if is_car else dict(scene.inputs)
    laws |= {"rack": {"constant": 0.0}} if "rack" in scene.inputs else {}
    changes = {"inputs": laws, "effects": ["camber"] if is_car else [], "time": scene.time}
    first, second = (
        simulate(Scene.from_mapping(one.model_dump(exclude_none=True) | {"mechanism": mechanism} | changes))
        for one, mechanism in (
            (scene, scene.mechanism.model_dump(exclude_none=True) | closed),
            (back, back.mechanism.model_dump(exclude_none=True)),
        )
    )
    for point, path in first.position.items():
        # Drawings differ by rounding, which a motion near its ends makes a thousand times as large: 1e-10 mm.
        assert np.abs(path - second.position[point]).max() <= 2.1 * TOLERANCE, point
    if is_car:
        inner, centre = scene.mechanism.topology.wheel_axis
        # Either end of either axis is off by the tolerance at most, which turns a line of that length by so
        # much. Drawings differ by rounding, a ten-thousandth of it.
        near = 4.001 * TOLERANCE / float(np.linalg.norm(places[centre] - places[inner]))
        assert np.ptp(first.wheel["camber"]) > 1e-3
        assert np.abs(first.wheel["camber"] - second.wheel["camber"]).max() <= near


def test_an_axle_comes_back_as_one_mechanism_and_neither_wheel_is_doubted(tmp_path: Path) -> None:
    back = import_hardpoints(exported("axle-roll", tmp_path)).scene
    assert back.mechanism.doubts == ()
    assert compare(back, "pointcoord", "absolute").agreed


def made(text: str, folder: Path) -> Drawing:
    """The mechanism of a model."""
    path = folder / "model.xml"
    path.write_text(text, encoding="utf-8")
    return drawing_of(str(path), OUR_AXES)


def sled(along: str, turns: bool) -> Scene:
    """A sled on a rail, drawn 1 mm off it, on which a rider slides along one direction of the car.

    Where the sled turns about its rail, the height of a point of it is driven.
    """
    points = {
        "rail": [0.0, 0.0, 0.0],
        "rear": [300.0, 30.0, 20.0],
        "front": [120.0, 12.0, 9.0],
        "above": [100.0, 40.0, 250.0],
        "guide": [150.0, 100.0, 60.0],
        "rider": [150.0, 180.0, 60.0] if along == "right" else [230.0, 100.0, 60.0],
        "stay": [-100.0, 300.0, 200.0],
    }
    slides = {
        "rail": {"points": ["front", "rear"], "through": "rail", "along": "rear", "turns": turns},
        "way": {"point": "rider", "body": "sled", "through": "guide", "along": along},
    }
    inputs = {"height": {"height": "rear"}} | (
        {"lean": {"height": "above", "along": "right"}} if turns else {}
    )
    return Scene.from_mapping(
        {
            "mechanism": {
                "points": points,
                "bodies": {"chassis": ["rail", "stay"], "sled": ["front", "rear", "above", "guide"]},
                **{"rods": {"stay": ["rider", "stay"]}, "slides": slides, "inputs": inputs},
                **{"up": [0, 0, 1], "right": [0, 1, 0], "side": "right"},
            },
            "inputs": {name: {"polynomial": [0.0, 0.5]} for name in inputs},
            "effects": [],
            "time": {"start": 0.0, "stop": 1.0, "samples": 3},
        }
    )


@pytest.mark.parametrize(("along", "turns"), [("right", False), ("rearward", True)])
def test_what_slides_comes_back_as_it_closes_whether_it_turns_or_not(
    along: str, turns: bool, tmp_path: Path
) -> None:
    scene = sled(along, turns)
    drawing = closed_drawing(scene)
    assert drawing.closing is not None
    assert drawing.closing.largest > 0.1
    model = made(mjcf_of(closed_mechanism(drawing), "sled"), tmp_path)
    back = {
        "mechanism": {
            **(model.tables or {}),
            # The same inputs; the joints of a model are free.
            "inputs": scene.model_dump(exclude_none=True)["mechanism"]["inputs"],
            "points": {point.name: point.coordinates for point in model.points},
            **{"up": [0, 0, 1], "right": [0, 1, 0], "side": "right"},
        }
    }
    # Heights are counted from the drawing, which is closed now.
    rise = {
        name: float(drawing.places[at][axis] - scene.mechanism.points[at][axis])
        for name, at, axis in (("height", "rear", 2), ("lean", "above", 1))
        if name in scene.inputs
    }
    laws = {name: {"polynomial": [-off, 0.5]} for name, off in rise.items()}
    same = {key: getattr(scene, key) for key in ("effects", "time")}
    first, second = simulate(scene), simulate(Scene.from_mapping({**same, **back, "inputs": laws}))
    for point, places in first.position.items():
        assert np.abs(places - second.position[point]).max() <= 2.1 * TOLERANCE, point


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
    angle = np.radians(60.0) - turn
    pin = 100.0 * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    ground = np.array([350.0, 0.0])
    drawn = 100.0 * np.array([np.cos(np.pi / 3), np.sin(np.pi / 3)])
    end = drawn + 300.0 * np.array([np.cos(np.radians(20.0)), np.sin(np.radians(20.0))])
    rocker = float(np.linalg.norm(end - ground))
    # Where the circles about both pins meet, on the side of the drawing.
    across = ground - pin
    size = np.linalg.norm(across, axis=-1)
    along = (300.0**2 - rocker**2 + size**2) / (2.0 * size)
    height = np.sqrt(300.0**2 - along**2)
    unit = across / size[:, None]
    exact = pin + along[:, None] * unit + height[:, None] * np.stack([-unit[:, 1], unit[:, 0]], axis=-1)
    place = motion.position["end"]
    assert np.ptp(place[:, 2]) > 30.0
    # Rounding of the closed form: some ten operations on 350 mm.
    assert np.abs(place[:, [0, 2]] - exact).max() <= TOLERANCE + 40 * EPSILON * 350.0
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
def test_what_is_not_known_is_refused_by_its_name(
    text: str, words: tuple[str, ...], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(FileError) as caught:
        imported(tmp_path, text, "model.xml", format="mjcf")
    assert [word for word in ("model.xml", *words) if word not in str(caught.value)] == [], caught.value
    assert "\n" not in str(caught.value)


def test_ranges_of_joints_are_ignored_and_named(tmp_path: Path) -> None:
    (fact,) = made(broken('name="knee"', 'name="knee" limited="true" range="-1 1"'), tmp_path).facts
    assert "range of joint 'knee' is ignored" in fact


def test_tendons_soft_equalities_and_bodies_that_hold_nothing_are_ignored_and_named(tmp_path: Path) -> None:
    strap = '<tendon><fixed name="strap"><joint joint="knee" coef="1"/></fixed></tendon><equality>'
    tyre = '<body name="tyre"><joint/><geom size="1"/></body>'
    end = '<site name="end" pos="0.3 0 0"/>'
    text = broken("<equality>", strap).replace('body2="rocker"', 'body2="rocker" name="end" solref="0.1 1"')
    text = text.replace(end, f'{end}<body name="hub"><joint/><geom size="1"/>{tyre}</body>')
    plain, found = made(FOUR_BAR, tmp_path), made(text, tmp_path)
    assert plain.facts == ()
    tendon, soft, hub, wheel = found.facts
    assert "tendon 'strap' is ignored" in tendon
    assert "solref of 'end' is ignored" in soft
    assert ("body hub has no site" in hub, "body tyre has no site" in wheel) == (True, True)
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
