"""Names mean what Adams/Car, OptimumK and Lotus mean by them where a table, a scene or a map says so."""

import csv
import tomllib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from curve_files import compared, verdicts

from pointcoord import Scene, simulate
from pointcoord.numerics.arrays import Array
from pointcoord.scene.scene_file import SCENES
from validate.cli import main
from validate.curves.numbers import asking_for, numbers_called

TEXT = (SCENES / "double-wishbone.toml").read_text("utf-8").replace("samples = 101", "samples = 11")
CAR = Scene.from_mapping(tomllib.loads(TEXT))
UP, OUTBOARD, FORWARD = 2, 1, 0  # of its axes; x points rearward


def spin_axis() -> tuple[Array, Array]:
    """Times and the unit vector from the inner point to the wheel centre."""
    motion = simulate(CAR)
    n = motion.position["wheel_centre"] - motion.position["wheel_axis_inner"]
    return motion.times, n / np.linalg.norm(n, axis=1)[:, None]


def camber_of_adams() -> Array:
    return -np.degrees(np.arcsin(spin_axis()[1][:, UP]))


def toe_of_optimumk() -> Array:
    """+ out: minus the arcsine of what points forward."""
    return np.degrees(np.arcsin(spin_axis()[1][:, FORWARD]))


def steer_angle_of_optimumk() -> Array:
    """Its toe less the static setting, which is that of the drawing."""
    n = np.subtract(*(CAR.mechanism.points[name] for name in ("wheel_centre", "wheel_axis_inner")))
    return toe_of_optimumk() - np.degrees(np.arcsin(n[FORWARD] / np.linalg.norm(n)))


def steer_angle_of_iso() -> Array:
    """Of a right wheel: + where what points outboard points forward too, projected into the road."""
    _, n = spin_axis()
    return np.degrees(np.arctan2(-n[:, FORWARD], n[:, OUTBOARD]))


@pytest.mark.parametrize(
    ("convention", "number", "heading", "defined"),
    [
        ("adams", "camber", "camber_by_arcsine [deg]", camber_of_adams),
        ("optimumk", "toe", "-toe_by_arcsine [deg]", toe_of_optimumk),
        ("optimumk", "steer_angle", "-toe_change_by_arcsine [deg]", steer_angle_of_optimumk),
        ("lotus", "steer_angle", "steer_angle [deg]", steer_angle_of_iso),
    ],
)
def test_a_table_has_the_number_that_a_program_means(
    convention: str, number: str, heading: str, defined: Callable[[], Array], tmp_path: Path
) -> None:
    path = tmp_path / "car.csv"
    rows = ("--rows", str(len(CAR.instants)))
    said = ("--number", number, "--convention", convention)
    assert main(["table", "double-wishbone", *said, *rows, "-o", str(path), "--quiet"]) == 0
    found = [float(row[heading]) for row in csv.DictReader(path.read_text().splitlines())]
    # Both from the same points, in degrees: some roundings of 57.
    np.testing.assert_allclose(found, defined(), rtol=0, atol=1e-12)


def file_of(column: str, values: Array) -> str:
    """A file of results with this column over time."""
    rows = zip(simulate(CAR).times.tolist(), values.tolist(), strict=True)
    return "\n".join([f"time [s],{column} [deg]", *(f"{t!r},{value:.6f}" for t, value in rows), ""])


@pytest.mark.parametrize(
    ("convention", "column", "defined"),
    [("adams", "camber", camber_of_adams), ("optimumk", "toe", toe_of_optimumk)],
)
def test_a_column_is_read_as_its_map_or_scene_says(
    convention: str, column: str, defined: Callable[[], Array]
) -> None:
    text = file_of(column, defined())
    theirs = CAR.model_copy(update={"convention": convention})
    said = {"convention": convention}
    for of_map, scene in ((said, CAR), ({}, theirs)):
        assert {*verdicts(compared(text, of_map, scene)).values()} == {"agrees"}
    # Without it the column means ours, from which it is hundredths of a degree away, or a sign. What is said
    # of the column goes before, a sign or a whole name of ours; and the map goes before the scene.
    sign = {"columns": {column: {"sign": -1 if convention == "adams" else 1}}}
    name = {"columns": {column: {"is": f"wheel.{column}"}}}
    others = (({}, CAR), (said | sign, CAR), (said | name, CAR), ({"convention": "iso"}, theirs))
    for of_map, scene in others:
        assert {*verdicts(compared(text, of_map, scene)).values()} == {"disagrees"}
    # No number of the scene is another.
    plain, named = simulate(CAR), simulate(theirs)
    assert all(np.array_equal(named.wheel[name], angle) for name, angle in plain.wheel.items())


def test_a_scene_says_what_names_mean_in_its_sensitivities_and_pictures(tmp_path: Path) -> None:
    found = {}
    for convention, number in (("optimumk", "toe"), ("iso", "toe_by_arcsine")):
        scene, path = tmp_path / f"{convention}.toml", tmp_path / f"{convention}.csv"
        scene.write_text(TEXT.replace("effects =", f'convention = "{convention}"\neffects ='))
        words = ("--number", number, "--point", "tie_rod_outer.x", "-o", str(path))
        assert main(["sensitivity", str(scene), *words, "--quiet"]) == 0
        found[convention] = float(path.read_text().splitlines()[1].split(",")[1])
    assert found["optimumk"] == -found["iso"] != 0.0
    file, picture = str(tmp_path / "optimumk.toml"), tmp_path / "car.svg"
    assert main(["plot", file, "-o", str(picture), "--quiet"]) == 0
    assert "minus toe by arcsine" in picture.read_text()
    (toe,) = numbers_called("toe", Scene.load(file))
    motion = simulate(asking_for(Scene.load(file), [toe]))
    np.testing.assert_allclose(toe.shown(motion, motion), toe_of_optimumk(), rtol=0, atol=1e-12)
