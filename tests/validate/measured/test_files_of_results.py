"""`pointcoord validate --data` as its users meet it; first with the table that Lotus' program printed."""

import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from case_lines import cases
from changed_scenes import scene_with
from curve_files import compared, disagreeing, table, verdicts
from lotus_front import BUMP, ROLLING_RADIUS
from program import document

from pointcoord import Scene, simulate, solve_poses, standing
from pointcoord.numerics.arrays import Array
from validate.cli import main
from validate.fitting.problem import Problem
from validate.measured.comparing import DataOutcome
from validate.measured.mapping import understood
from validate.measured.poses import Driven
from validate.measured.reading import columns_of_text

HERE, ROOT = Path(__file__).parent, Path(__file__).parents[3]
STEER, WISHBONE = Scene.load("steer"), Scene.load("double-wishbone")
MOTION = simulate(STEER)
PLACE = "position.wheel_centre.x"
ANGLES = ("camber", "toe", "caster", "kingpin")
LOTUS = (ROOT / "tests" / "oracle" / "given" / "results" / "lotus-bump.csv").read_text(encoding="utf-8")
(README,) = (
    block
    for block in re.findall(
        r"```toml\n(.*?)```", (ROOT / "validate" / "measured" / "README.md").read_text(encoding="utf-8"), re.S
    )
    if "travel.contact" in block
)
EXACT = {"is": "travel.contact", "printed": 0}


def text_of(file: str) -> str:
    return (HERE / "files" / file).read_text(encoding="utf-8")


def tolerances(found: DataOutcome) -> Mapping[str, Array]:
    """The tolerance of each number of a file."""
    return {held.series.meaning.words: held.tolerance for held in found.columns}


def centre_at(*times: float) -> Array:
    return MOTION.at(np.array(times)).position["wheel_centre"][:, 0]


@pytest.mark.parametrize(
    "content",
    [
        tomllib.loads(README),
        # Columns that a map does not name are taken by their names, and the scene's wheel is the car's.
        {"rolling_radius": ROLLING_RADIUS, "columns": {"bump": EXACT}},
        {"columns": {"bump": EXACT}},
    ],
)
def test_the_printed_bump_table_agrees_to_its_four_digits(content: Mapping[str, Any]) -> None:
    car = scene_with("double-wishbone", {"wheel_radius": ROLLING_RADIUS})
    found = compared(LOTUS, content, car)
    assert found.outcome.agreed
    assert verdicts(found) == dict.fromkeys(ANGLES, "agrees")
    for row in found.outcome.rows:
        # Half of the last digit; the rest is rounding in double precision and the map's bound.
        assert np.degrees(row.tolerance) == pytest.approx(0.5e-4, rel=1e-5)
    # What the map says goes before what the scene says.
    other = scene_with("double-wishbone", {"wheel_radius": ROLLING_RADIUS + 30.0})
    assert ("wheel.camber" in disagreeing(LOTUS, content, other)) == ("rolling_radius" not in content)


def test_a_column_without_a_unit_of_no_number_or_of_one_that_is_given_elsewhere_is_ignored_and_named() -> (
    None
):
    text = LOTUS.replace("kingpin [deg]", "w" * 10_000).replace("toe [deg]", "vorspur [deg]")
    text = text.replace("camber [deg]", "caster_deg", 1).replace("caster [deg]", "camber [deg]")
    content = {"rolling_radius": ROLLING_RADIUS, "columns": {"bump": EXACT, "camber": {"is": "caster"}}}
    found = compared(text, content, WISHBONE)
    assert verdicts(found) == {"caster": "agrees"}
    (note,) = (note for note in found.outcome.notes if note.startswith("ignored"))
    assert "caster_deg, vorspur, www" in note
    assert len(note) < 300


def test_sign_offset_and_unit_of_a_column_are_undone() -> None:
    bump, camber = (np.array([row[i] for row in BUMP]) for i in (0, 1))
    text = table({"bump [mm]": bump, "camber [mrad]": 5.0 - 1000.0 * np.radians(camber)}, 3)
    # The printed degrees are rounded before they are turned into mrad: 0.5e-4 degrees more.
    column = {"sign": -1, "offset": 5.0, "accuracy": 1000.0 * np.radians(0.5e-4)}
    content = {"rolling_radius": ROLLING_RADIUS, "columns": {"bump": EXACT, "camber": column}}
    assert disagreeing(text, content, WISHBONE) == []
    column["offset"] = -5.0
    assert disagreeing(text, content, WISHBONE) == ["wheel.camber"]


@pytest.mark.parametrize(
    ("scene", "ending"), [("double-wishbone", "csv"), ("bounce-on-a-heaving-chassis", "parquet")]
)
def test_what_simulate_writes_agrees_within_its_tolerance_and_a_changed_number_does_not(
    scene: str, ending: str, tmp_path: Path
) -> None:
    data, report = str(tmp_path / f"x.{ending}"), tmp_path / "x.json"
    assert main(["simulate", scene, "-o", data, "--quiet"]) == 0
    assert main(["validate", "--data", data, scene, "--json", str(report)]) == 0
    (comparison,) = document(report)["scenes"][0]["comparisons"]
    assert {row["verdict"] for row in comparison["rows"]} == {"agrees"}
    tolerances = [row["tolerance"] for row in comparison["rows"]]
    # 1e-9 mm of every point, as no accuracy is given, through rates of some 10 / s; never nothing at all.
    assert min(tolerances) > 0.0
    assert max(tolerances) < 1e-5
    (note,) = comparison["notes"]
    assert "within 1e-09 mm" in note
    assert "in full digits and no --accuracy is given" in note
    if ending == "csv":
        lines = Path(data).read_text().splitlines()
        cells = lines[5].split(",")
        cells[-1] = repr(float(cells[-1]) + 2e-5)
        changed = "\n".join([*lines[:5], ",".join(cells), *lines[6:]])
        assert [f"{one} [" in lines[0] for one in disagreeing(changed, {}, WISHBONE)] == [True]


def test_digits_in_full_are_held_to_what_points_off_by_the_tolerance_make_of_them() -> None:
    x, camber = MOTION.position["wheel_centre"][:, 0], np.degrees(MOTION.wheel["camber"])
    text = f"time [s],{PLACE} [mm],camber [deg]"
    for row in np.stack([MOTION.times, x, camber], axis=-1).tolist():
        text += "\n" + ",".join(map(repr, row))

    def held_to(tolerance: float, accuracy: float | None = None) -> tuple[Array, Array]:
        car = STEER.model_copy(update={"tolerance": tolerance})
        claims = tolerances(compared(text, {}, car, accuracy=accuracy))
        return claims[PLACE], claims["wheel.camber"]

    place, angle = held_to(1e-9)
    for fine, coarse in zip((place, angle), held_to(1e-7), strict=True):
        # Beside rounding and our own bound, which are far below.
        assert coarse == pytest.approx(100.0 * fine, rel=0.02)
    # The centre itself is off by e, and no car of this size makes a hundred times that of it.
    assert ((place >= 1e-9) & (place < 1e-7)).all()
    # An axis of some 100 mm turns by e / 100 mm at least.
    assert ((angle > 1e-12) & (angle < 1e-9)).all()
    assert held_to(1e-9, 1e-3)[0] == pytest.approx(1e-3, rel=1e-6)


def test_times_that_are_rounded_widen_by_what_the_motion_does_meanwhile() -> None:
    times = np.array([0.1, 0.3])
    x = centre_at(*times)
    found = compared(table({"time [s]": times, f"{PLACE} [mm]": x}, 6), {}, STEER)
    change = [np.abs(centre_at(*(times + side)) - x) for side in (-0.05, 0.05)]
    assert tolerances(found)[PLACE] == pytest.approx(np.max(change, axis=0) + 0.5e-6, abs=1e-9)


def test_each_file_has_its_verdict_and_what_cannot_be_compared_is_said() -> None:
    for line, (verdict, parts) in cases(__file__, "verdicts.txt"):
        words, map = line.split(" |")
        scene, file = words.split()
        outcome = compared(text_of(file), tomllib.loads(map.replace("\\n", "\n")), Scene.load(scene)).outcome
        (row,) = outcome.rows
        assert verdict.startswith(row.verdict), line
        assert outcome.passed == (row.verdict == "agrees"), line
        if tolerance := verdict.removeprefix(row.verdict):
            assert np.degrees(row.tolerance) == pytest.approx(float(tolerance), rel=1e-3), line
        stated = " / ".join([*outcome.notes, row.why])
        wanted = [part for part in parts.split(" & ") if part]
        for part in wanted:
            there = part.removeprefix("not: ")
            assert (there in stated) == (there == part), (line, stated)
            assert row.why.count(there) <= 1, (line, row.why)


@pytest.mark.parametrize("racks", [(0.0,), (0.0, 4.0), (0.0, 4.0, 11.0)])
def test_few_rows_in_full_digits_and_uneven_steps_can_be_compared(racks: tuple[float, ...]) -> None:
    drawn = standing(WISHBONE).inputs["arm_angle"]
    poses = solve_poses(WISHBONE, {"arm_angle": np.full(len(racks), drawn), "rack": np.array(racks)})
    x, y, _ = (poses.position["wheel_centre"] - poses.position["wheel_axis_inner"]).T
    toes = -np.degrees(np.arctan2(x, y))
    rows = (f"{rack:.0f},{toe:.16f}" for rack, toe in zip(racks, toes, strict=True))
    assert compared("\n".join(["rack [mm],toe [deg]", *rows]), {}, WISHBONE).outcome.agreed


@pytest.mark.parametrize("command", ["validate", "fit"])
def test_a_map_that_is_not_there_is_written_to_be_filled_in(
    command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    data, map = tmp_path / "x.csv", tmp_path / "map.toml"
    data.write_text(text_of("rack-in-fives.csv").replace("rack [mm]", "Lenkung"))
    free = ["--free", "tie_rod_outer.z"] if command == "fit" else []
    words = [command, "double-wishbone", "--data", str(data), "--map", str(map), "--quiet", *free]
    words += ["--json", str(tmp_path / "x.json")]
    assert main(words) == 2
    assert "map.toml did not exist, so a form is written" in capsys.readouterr().err
    text = map.read_text()
    assert '\ntoe = { is = "wheel.toe", unit = "deg" }' in text
    line = '# Lenkung = { is = "", unit = "" }'
    assert line in text
    map.write_text(text.replace(line, 'Lenkung = { is = "input.rack", unit = "mm" }'))
    assert main(words) == 0


def test_a_disagreement_is_explained_and_stands_in_every_file_with_its_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("map.toml").write_text("columns.toe.sign = -1", encoding="utf-8")
    Path("steer.csv").write_text(text_of("rack-in-fives.csv"), encoding="utf-8")
    files = ["--json", "x.json", "--junit", "x.xml", "--summary", "x.md"]
    assert main(["validate", "--data", "steer.csv", "--map", "map.toml", "double-wishbone", *files]) == 1
    assert "possible explanation: toe: the other sign" in capsys.readouterr().out
    (comparison,) = document(Path("x.json"))["scenes"][0]["comparisons"]
    assert comparison["explanations"][0]["words"].startswith("toe: the other sign")
    (wrong,) = comparison["rows"]
    assert wrong["place"].startswith("line ")
    for file in ("x.xml", "x.md"):
        assert f" at {wrong['place']}; at most " in Path(file).read_text()


@pytest.mark.parametrize("point", ["wheel_centre", "contact"])
@pytest.mark.parametrize("fitted", [False, True])
def test_a_travel_counts_from_the_closed_drawing_and_the_rack_as_drawn(point: str, fitted: bool) -> None:
    """The paper's strut closes 9 mm higher than its wheel is drawn; the travel 0 is there, at rack 0."""
    car, radius, racks = Scene.load("bounce"), 300.0, np.array([0.0, 0.0, 10.0, 10.0])
    angles = standing(car).inputs["arm_angle"] + np.array([0.0, 0.1, -0.1, 0.0])
    place = solve_poses(car, {"arm_angle": angles, "rack": racks}).position
    spin, x = place["wheel_centre"] - place["strut_lower"], place["wheel_centre"][:, 0]
    lean = spin[:, 2] / np.linalg.norm(spin, axis=-1)
    height = place["wheel_centre"][:, 2] - (point == "contact") * radius * np.sqrt(1.0 - lean**2)
    text = table({"travel.b [mm]": height - height[0], "input.rack [mm]": racks, f"{PLACE} [mm]": x}, 12)
    content = {"rolling_radius": radius, "columns": {"travel.b": {"is": f"travel.{point}"}, "input.rack": {}}}
    measured = understood(columns_of_text(text, "mine.csv"), content, car, "map.toml")
    if fitted:
        there = Problem.of(car, measured, ("wheel_centre.x",)).solved(np.zeros(1))
    else:
        there = Driven.of(car, measured).at()
    # Heights have twelve digits, and poses are solved to 1e-12 mm.
    np.testing.assert_allclose(there.numbers["position"]["wheel_centre"][:, 0], x, rtol=0, atol=1e-10)
