"""Names mean what Adams/Car, OptimumK and Lotus mean by them where a table, a scene or a map says so."""

import csv
import tomllib
from pathlib import Path

import numpy as np
import pytest
from curve_files import compared, verdicts

from pointcoord import Scene, simulate
from pointcoord.scene.scene_file import SCENES
from validate.cli import main
from validate.curves.numbers import asking_for, numbers_chosen

TEXT = (SCENES / "double-wishbone.toml").read_text("utf-8").replace("samples = 101", "samples = 11")
CAR = Scene.from_mapping(tomllib.loads(TEXT))
MOTION = simulate(CAR)
ENDS = "wheel_centre", "wheel_axis_inner"
SPIN = np.subtract(*(MOTION.position[end] for end in ENDS))
DRAWN = np.subtract(*(CAR.mechanism.points[end] for end in ENDS))
# Components of unit vectors along the spin axis, now and as drawn; x points rearward.
FORWARD, OUTBOARD, UP = SPIN.T / np.linalg.norm(SPIN, axis=1)
FORWARD_DRAWN = DRAWN[0] / np.linalg.norm(DRAWN)

CAMBER_OF_ADAMS = -np.degrees(np.arcsin(UP))
# + out: minus the arcsine of what points forward.
TOE_OF_OPTIMUMK = np.degrees(np.arcsin(FORWARD))
# Its toe less the static setting, which is that of the drawing.
STEER_ANGLE_OF_OPTIMUMK = TOE_OF_OPTIMUMK - np.degrees(np.arcsin(FORWARD_DRAWN))
# Of a right wheel: + where what points outboard points forward too, projected into the road.
STEER_ANGLE_OF_ISO = np.degrees(np.arctan2(-FORWARD, OUTBOARD))


@pytest.mark.parametrize(
    ("convention", "number", "heading", "defined"),
    [
        ("adams", "camber", "camber_by_arcsine [deg]", CAMBER_OF_ADAMS),
        ("optimumk", "toe", "-toe_by_arcsine [deg]", TOE_OF_OPTIMUMK),
        ("optimumk", "steer_angle", "-toe_change_by_arcsine [deg]", STEER_ANGLE_OF_OPTIMUMK),
        ("lotus", "steer_angle", "steer_angle [deg]", STEER_ANGLE_OF_ISO),
    ],
)
def test_a_table_has_the_number_that_a_program_means(
    convention: str, number: str, heading: str, defined: np.ndarray, tmp_path: Path
) -> None:
    path = tmp_path / "car.csv"
    words = f"table double-wishbone --number {number} --convention {convention} --rows 11 -q"
    assert main([*words.split(), "-o", str(path)]) == 0
    found = [float(row[heading]) for row in csv.DictReader(path.read_text().splitlines())]
    # Both from the same points, in degrees: some roundings of 57.
    np.testing.assert_allclose(found, defined, rtol=0, atol=1e-12)


@pytest.mark.parametrize(
    ("convention", "column", "defined"),
    [("adams", "camber", CAMBER_OF_ADAMS), ("optimumk", "toe", TOE_OF_OPTIMUMK)],
)
def test_a_column_is_read_as_its_map_or_scene_says(convention: str, column: str, defined: np.ndarray) -> None:
    rows = zip(MOTION.times.tolist(), defined.tolist(), strict=True)
    text = "\n".join([f"time [s],{column} [deg]", *(f"{t!r},{value:.6f}" for t, value in rows), ""])
    theirs = CAR.model_copy(update={"convention": convention})
    said = {"convention": convention}
    # Without it the column means ours, from which it is hundredths of a degree away, or a sign. What is said
    # of the column goes before, a sign or a whole name of ours; and the map goes before the scene.
    sign = {"columns": {column: {"sign": -1 if convention == "adams" else 1}}}
    name = {"columns": {column: {"is": f"wheel.{column}"}}}
    for of_map, scene, verdict in (
        (said, CAR, "agrees"),
        ({}, theirs, "agrees"),
        ({}, CAR, "disagrees"),
        (said | sign, CAR, "disagrees"),
        (said | name, CAR, "disagrees"),
        ({"convention": "iso"}, theirs, "disagrees"),
    ):
        assert {*verdicts(compared(text, of_map, scene)).values()} == {verdict}
    # No number of the scene is another.
    named = simulate(theirs)
    assert all(np.array_equal(named.wheel[name], angle) for name, angle in MOTION.wheel.items())


def test_a_scene_says_what_names_mean_in_its_sensitivities_and_pictures(tmp_path: Path) -> None:
    found = {}
    for convention, number in (("optimumk", "toe"), ("iso", "toe_by_arcsine")):
        scene, path = tmp_path / f"{convention}.toml", tmp_path / f"{convention}.csv"
        scene.write_text(TEXT.replace("effects =", f'convention = "{convention}"\neffects ='))
        words = f"sensitivity {scene} --number {number} --point tie_rod_outer.x -q -o {path}"
        assert main(words.split()) == 0
        found[convention] = float(path.read_text().splitlines()[1].split(",")[1])
    assert found["optimumk"] == -found["iso"] != 0.0
    file, picture = str(tmp_path / "optimumk.toml"), tmp_path / "car.svg"
    assert main(["plot", file, "-o", str(picture), "--quiet"]) == 0
    assert "minus toe by arcsine" in picture.read_text()
    (toe,) = numbers_chosen(["toe"], Scene.load(file), "")
    motion = simulate(asking_for(Scene.load(file), [toe]))
    np.testing.assert_allclose(toe.shown(motion, motion), TOE_OF_OPTIMUMK, rtol=0, atol=1e-12)
