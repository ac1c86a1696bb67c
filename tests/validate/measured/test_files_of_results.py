"""`pointcoord validate --data` as its users meet it."""

import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from curve_files import compared, disagreeing, table
from program import document

from pointcoord import Scene, simulate, solve_poses, standing
from pointcoord.numerics.arrays import Array
from validate.cli import main
from validate.fitting.problem import Problem
from validate.measured.comparing import DataOutcome
from validate.measured.mapping import understood
from validate.measured.poses import Driven
from validate.measured.reading import columns_of_text
from validate.tables.errors import FileError

STEER, WISHBONE = Scene.load("steer"), Scene.load("double-wishbone")


def tolerances(found: DataOutcome) -> Mapping[str, Mapping[str, Any]]:
    """What each number of a file is held to."""
    return found.outcome.solutions[0].accuracy.claims


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
    motion = simulate(STEER)
    x, camber = motion.position["wheel_centre"][:, 0], np.degrees(motion.wheel["camber"])
    text = "time [s],position.wheel_centre.x [mm],camber [deg]"
    for row in np.stack([motion.times, x, camber], axis=-1).tolist():
        text += "\n" + ",".join(map(repr, row))

    def held_to(tolerance: float, accuracy: float | None = None) -> tuple[Array, Array]:
        car = STEER.model_copy(update={"tolerance": tolerance})
        claims = tolerances(compared(text, {}, car, accuracy=accuracy))
        return claims["position"]["wheel_centre"][:, 0], claims["wheel"]["camber"]

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
    motion = simulate(STEER)
    times = np.array([0.1, 0.3])
    at = motion.at(times)
    x = at.position["wheel_centre"][:, 0]
    text = table({"time [s]": times, "position.wheel_centre.x [mm]": x}, 6)
    claims = tolerances(compared(text, {}, STEER))["position"]["wheel_centre"][:, 0]
    change = [np.abs(motion.at(times + side).position["wheel_centre"][:, 0] - x) for side in (-0.05, 0.05)]
    assert claims == pytest.approx(np.max(change, axis=0) + 0.5e-6, abs=1e-9)


def test_a_time_too_coarse_to_tell_anything_tests_nothing() -> None:
    content = {"columns": {"time": {"printed": 0.3}, "position.wheel_centre.x": {"printed": 0.1}}}
    x = simulate(STEER).at(np.array([0.1, 0.2])).position["wheel_centre"][:, 0]
    right = f"time [s],position.wheel_centre.x [mm]\n0.1,{x[0]:.1f}\n0.2,{x[1]:.1f}\n"
    found = compared(right, content, STEER)
    assert found.outcome.rows[0].verdict == "not tested"
    assert any("is not tested: the independent column is rounded so" in n for n in found.outcome.notes)


def test_numbers_that_are_none_and_rows_outside_the_time_are_counted_and_the_others_go_on() -> None:
    x = simulate(STEER).at(np.array([0.1])).position["wheel_centre"][0, 0]
    text = f"time [s],position.wheel_centre.x [mm]\n0.1,{x:.3f}\n0.15,\n77.0,1.0\n"
    found = compared(text, {"columns": {"time": {"printed": 0}, "position.wheel_centre.x": {}}}, STEER)
    assert found.outcome.agreed
    notes = " / ".join(found.outcome.notes)
    assert "no number in 1 of 3 rows" in notes
    assert "line 4 is left out: t = 77 s is outside the scene's time" in notes


def test_a_file_of_which_most_rows_cannot_be_compared_has_no_verdict_and_says_why() -> None:
    """Milliseconds titled [s]: all but t = 0 are outside the scene's time, and t = 0 agrees with anything."""
    camber = simulate(WISHBONE).wheel["camber"]
    text = table({"time [s]": 1000.0 * WISHBONE.instants, "camber [deg]": np.degrees(camber)}, 4)
    outcome = compared(text, {}, WISHBONE).outcome
    assert [row.verdict for row in outcome.rows] == ["not tested"]
    (fault,) = outcome.faults
    assert fault.startswith(f"only 1 of {len(WISHBONE.instants)} rows with numbers can be compared")
    assert any("s is outside the scene's time" in note for note in outcome.notes)
    assert outcome.compared == 1
    assert not outcome.passed


def steered(racks: Sequence[float], wrong: float = 0.0, digits: int = 2, form: str = ".0f") -> str:
    """Toe over the rack, deg and mm, wrong on purpose at one row; form: of the rack."""
    place = solve_poses(WISHBONE, {"arm_angle": np.full(len(racks), DRAWN), "rack": np.array(racks)}).position
    x, y, _ = (place["wheel_centre"] - place["wheel_axis_inner"]).T
    toe = -np.degrees(np.arctan2(x, y)) + wrong * (np.arange(len(racks)) == 3)
    rows = (f"{rack:{form}},{value:.{digits}f}" for rack, value in zip(racks, toe, strict=True))
    return "\n".join(["rack [mm],toe [deg]", *rows])


DRAWN = standing(WISHBONE).inputs["arm_angle"]
EVEN, UNEVEN = tuple(range(-30, 31, 5)), (-30.2, -23.7, -16.3, -9.6, 0.3, 7.8, 14.9, 22.4, 30.1)


@pytest.mark.parametrize(("racks", "form"), [(EVEN, ".0f"), (np.linspace(-30.0, 30.0, 19).tolist(), ".12g")])
def test_a_column_in_even_steps_is_set_and_not_rounded_though_zeros_are_left_off(
    racks: Sequence[float], form: str
) -> None:
    """The second one has twelve digits of thirds, of which -30 is written without decimals."""
    found = compared(steered(racks, form=form), {}, WISHBONE)
    (row,) = found.outcome.rows
    assert row.verdict == "agrees"
    assert np.degrees(row.tolerance) == pytest.approx(0.005, rel=1e-3)
    assert "rack: in even steps, taken as exact" in " / ".join(found.outcome.notes)
    assert disagreeing(steered(racks, wrong=0.02, form=form), {}, WISHBONE) == ["wheel.toe"]


def test_what_agrees_only_by_a_rounding_that_nobody_stated_is_not_tested_and_the_line_is_told() -> None:
    text = steered(UNEVEN)
    (row,) = compared(text, {}, WISHBONE).outcome.rows
    assert row.verdict == "not tested"
    line = "columns.rack.printed = 0"
    assert row.why.count(line) == 1
    (row,) = compared(text, {"columns": {"rack": {"printed": 1}}}, WISHBONE).outcome.rows
    assert row.verdict == "agrees"
    found = compared(text, tomllib.loads(line), WISHBONE)
    assert found.outcome.rows[0].verdict == "disagrees"
    # What has been followed is not advised again.
    assert not any("printed" in note for note in found.outcome.notes)


@pytest.mark.parametrize("command", ["validate", "fit"])
def test_a_map_that_is_not_there_is_written_to_be_filled_in(
    command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    data, map = tmp_path / "x.csv", tmp_path / "map.toml"
    data.write_text(steered(EVEN).replace("rack [mm]", "Lenkung"))
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


BUMP = "bump [mm],camber [deg]\n"
CONTACT, CENTRE = (
    {"columns": {"bump": {"is": f"travel.{point}"}, "camber": {}}} for point in ("contact", "wheel_centre")
)
TEXT = "time [s],camber [deg]\n0.1,1.0\n0.2,1.1\n"


@pytest.mark.parametrize(
    ("text", "content", "words"),
    [
        (TEXT + "0.3,1e308", {}, ("mine.csv: line 4, column 'camber': is 1e+308",)),
        (TEXT, {"colums": {}}, ("colums: there is no such key (did you mean 'columns'?)", "held")),
        (TEXT.replace("deg", "deg/mm"), {}, ("'deg/mm' is not a unit of wheel.camber",)),
        (TEXT, {"columns": {"camber": {"unit": ""}}}, ("columns.camber.unit", "its unit is not given")),
        (TEXT, {"columns": {"camber": {"sign": 2}, "time": {}}}, ("columns.camber.sign", "1 or -1")),
        (TEXT, {"held": {"rack": -1e308}}, ("held.rack: Input should be", "greater than")),
        (
            "a [mm],b [mm],camber [deg]\n1,1,1",
            {
                "columns": {
                    n: {"is": f"travel.{p}"} for n, p in (("a", "wheel_centre"), ("b", "lower_ball_joint"))
                }
            },
            ("each of a, b could give the pose", "ignore"),
        ),
        (TEXT.replace("time [s]", "tyme [s]"), {}, ("no column gives the pose of a row; ignored: tyme;",)),
        (TEXT.replace("camber", "cmaber"), {}, ("no numbers to compare; ignored: cmaber",)),
        (BUMP + "0,1\n", CONTACT, ("rolling_radius",)),
        (BUMP + "900,1\n", CENTRE, ("line 2", "none of its 1 rows can be reached", "out of reach")),
    ],
)
def test_a_wrong_map_or_file_is_refused_with_its_place(
    text: str, content: dict[str, object], words: tuple[str, ...]
) -> None:
    with pytest.raises(FileError) as caught:
        compared(text, content, STEER)
    assert [word for word in words if word not in str(caught.value)] == [], caught.value


def test_a_disagreement_is_explained_and_stands_in_every_file_with_its_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("map.toml").write_text("columns.toe.sign = -1", encoding="utf-8")
    Path("steer.csv").write_text(steered(EVEN, digits=5), encoding="utf-8")
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
    car = Scene.load("bounce")
    radius = 300.0
    angles = standing(car).inputs["arm_angle"] + np.array([0.0, 0.1, -0.1, 0.0])
    racks = np.array([0.0, 0.0, 10.0, 10.0])
    place = solve_poses(car, {"arm_angle": angles, "rack": racks}).position
    spin = place["wheel_centre"] - place["strut_lower"]
    lean = spin[:, 2] / np.linalg.norm(spin, axis=-1)
    height = place["wheel_centre"][:, 2] - (point == "contact") * radius * np.sqrt(1.0 - lean**2)
    x = place["wheel_centre"][:, 0]
    columns = {
        "travel.b [mm]": height - height[0],
        "input.rack [mm]": racks,
        "position.wheel_centre.x [mm]": x,
    }
    content = {"rolling_radius": radius, "columns": {"travel.b": {"is": f"travel.{point}"}, "input.rack": {}}}
    measured = understood(columns_of_text(table(columns, 12), "mine.csv"), content, car, "map.toml")
    if fitted:
        there = Problem.of(car, measured, ("wheel_centre.x",)).solved(np.zeros(1))
    else:
        there = Driven.of(car, measured).at([s.values for s in measured.independent])
    found = there.numbers["position"]["wheel_centre"][:, 0]
    # Heights have twelve digits, and poses are solved to 1e-12 mm.
    np.testing.assert_allclose(found, x, rtol=0, atol=1e-10)
