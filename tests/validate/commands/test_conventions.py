"""Names mean what Adams/Car, OptimumK and Lotus mean by them where a table or a map says so."""

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


@pytest.mark.parametrize(
    ("convention", "column", "defined"),
    [("adams", "camber", camber_of_adams), ("optimumk", "toe", toe_of_optimumk)],
)
def test_a_map_reads_a_column_as_its_program_means_it(
    convention: str, column: str, defined: Callable[[], Array]
) -> None:
    times, _ = spin_axis()
    rows = [f"{time!r},{value:.6f}" for time, value in zip(times.tolist(), defined().tolist(), strict=True)]
    text = "\n".join([f"time [s],{column} [deg]", *rows, ""])
    as_said = verdicts(compared(text, {"convention": convention}, CAR))
    assert set(as_said.values()) == {"agrees"}
    # Without it the column means ours, from which it is hundredths of a degree away, or a sign.
    assert set(verdicts(compared(text, {}, CAR)).values()) == {"disagrees"}
    # What is said of the column goes before: a sign, or a whole name of ours.
    for part in ({"sign": -1 if convention == "adams" else 1}, {"is": f"wheel.{column}"}):
        said = {"convention": convention, "columns": {column: part}}
        assert set(verdicts(compared(text, said, CAR)).values()) == {"disagrees"}


def test_lotus_means_the_contact_point_by_travel_and_the_offset_by_scrub_radius(tmp_path: Path) -> None:
    path = tmp_path / "car.csv"
    assert main(["table", "double-wishbone", "--convention", "lotus", "-o", str(path), "--quiet"]) == 0
    names = path.read_text().splitlines()[0]
    assert "contact_travel [mm]" in names
    assert ",travel [mm]" not in names
    assert names.count("kingpin_offset [mm]") == 1
    assert "scrub_radius" not in names


def test_a_scene_says_what_names_mean_in_its_tables_sensitivities_pictures_and_files(tmp_path: Path) -> None:
    text = TEXT.replace("effects =", 'convention = "optimumk"\neffects =')
    (tmp_path / "car.toml").write_text(text)
    scene = Scene.load(tmp_path / "car.toml")
    said = (str(tmp_path / "car.toml"), "--number", "toe", "-o")
    assert main(["table", *said, str(tmp_path / "table.csv"), "--quiet"]) == 0
    assert "-toe_by_arcsine [deg]" in (tmp_path / "table.csv").read_text().splitlines()[0]
    assert main(["table", *said, str(tmp_path / "table.md"), "--quiet"]) == 0
    assert "- -toe_by_arcsine: positive not where the front edge" in (tmp_path / "table.md").read_text()
    # What the command line says goes before.
    assert main(["table", *said, str(tmp_path / "ours.csv"), "--convention", "iso", "--quiet"]) == 0
    assert ",toe [deg]" in (tmp_path / "ours.csv").read_text().splitlines()[0]
    for convention in ("optimumk", "iso"):
        path = tmp_path / f"{convention}.csv"
        (tmp_path / "one.toml").write_text(text.replace("optimumk", convention))
        one = ("--number", "toe_by_arcsine" if convention == "iso" else "toe", "--point", "tie_rod_outer.x")
        assert main(["sensitivity", str(tmp_path / "one.toml"), *one, "-o", str(path), "--quiet"]) == 0
    theirs, ours = (
        float((tmp_path / f"{convention}.csv").read_text().splitlines()[1].split(",")[1])
        for convention in ("optimumk", "iso")
    )
    assert theirs == -ours != 0.0
    assert main(["plot", str(tmp_path / "car.toml"), "-o", str(tmp_path / "car.svg"), "--quiet"]) == 0
    assert "minus toe by arcsine" in (tmp_path / "car.svg").read_text()
    (toe,) = numbers_called("toe", scene)
    motion = simulate(asking_for(scene, [toe]))
    np.testing.assert_allclose(toe.shown(motion, motion), toe_of_optimumk(), rtol=0, atol=1e-12)
    rows = [f"{t!r},{v:.6f}" for t, v in zip(motion.times.tolist(), toe_of_optimumk().tolist(), strict=True)]
    told = "\n".join(["time [s],toe [deg]", *rows, ""])
    assert set(verdicts(compared(told, {}, scene)).values()) == {"agrees"}
    assert set(verdicts(compared(told, {"convention": "iso"}, scene)).values()) == {"disagrees"}


def test_a_convention_changes_no_number_of_a_scene() -> None:
    plain, theirs = simulate(CAR), simulate(CAR.model_copy(update={"convention": "adams"}))
    assert all(np.array_equal(theirs.wheel[name], angle) for name, angle in plain.wheel.items())
