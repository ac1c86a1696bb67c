"""`pointcoord validate --data` as its users meet it."""

import json
from pathlib import Path

import jsonschema
import numpy as np
import pytest

from pointcoord import Scene, simulate
from validate.cli import main
from validate.measured.comparing import as_solution, compare_results
from validate.measured.errors import ResultsError
from validate.measured.mapping import understood
from validate.measured.reading import columns_of_text
from validate.output.document import schema_text
from validate.paper.tables import TABLE_2, TABLE_3, PrintedRow, compare_with_paper

STEER = Scene.load("steer")


@pytest.mark.parametrize("ending", ["csv", "parquet"])
@pytest.mark.parametrize("scene", ["double-wishbone", "bounce-on-a-heaving-chassis"])
def test_what_simulate_writes_agrees_to_rounding_and_a_changed_number_does_not(
    scene: str, ending: str, tmp_path: Path
) -> None:
    data, report = str(tmp_path / f"x.{ending}"), tmp_path / "x.json"
    assert main(["simulate", scene, "-o", data, "--quiet"]) == 0
    assert main(["validate", "--data", data, scene, "--json", str(report)]) == 0
    content = json.loads(report.read_text())
    jsonschema.validate(content, json.loads(schema_text()))
    (comparison,) = content["scenes"][0]["comparisons"]
    assert {row["verdict"] for row in comparison["rows"]} == {"agrees"}
    # Numbers up to 1e4 in units of ours: some hundred roundings of these at most.
    assert max(row["tolerance"] for row in comparison["rows"]) < 1e-8
    if ending == "csv":
        lines = Path(data).read_text().splitlines()
        cells = lines[5].split(",")
        cells[-1] = repr(float(cells[-1]) + 1e-9)
        Path(data).write_text("\n".join([*lines[:5], ",".join(cells), *lines[6:]]))
        assert main(["validate", "--data", data, scene, "--quiet"]) == 1


def paper_file(table: tuple[PrintedRow, ...]) -> str:
    lines = ["time [s],wheel_centre.x [mm],wheel_centre.y [mm],wheel_centre.z [mm]"]
    for row in table:
        lines.append(",".join([f"{row.time:g}", *(f"{place:g}" for place in row.wheel_centre)]))
    return "\n".join(lines)


@pytest.mark.parametrize(("scene", "table"), [("bounce", TABLE_2), ("steer", TABLE_3)])
def test_the_papers_tables_do_not_come_from_its_hardpoints(scene: str, table: tuple[PrintedRow, ...]) -> None:
    car = Scene.load(scene)
    columns = columns_of_text(paper_file(table), "paper.csv")
    parts = {f"wheel_centre.{axis}": {"is": f"position.wheel_centre.{axis}"} for axis in "xyz"}
    content = {"columns": {"time": {"printed": 0}, **parts}}
    measured = understood(columns, content, car, "map.toml")
    found = compare_results(measured, car, scene)
    (row,) = found.outcome.disagreements
    # The paper's own comparison goes another way to the same numbers: the motion at the printed times.
    rows = [row for row in compare_with_paper() if row.printed in table]
    apart = np.abs([np.subtract(row.wheel_centre, row.printed.wheel_centre) for row in rows]).max()
    assert row.difference == pytest.approx(apart, rel=1e-12)
    assert row.difference > 10.0
    assert row.tolerance < 0.51


def test_times_that_are_rounded_widen_by_what_the_motion_does_meanwhile() -> None:
    motion = simulate(STEER)
    times = np.array([0.1, 0.2, 0.3])
    at = motion.at(times)
    x = at.position["wheel_centre"][:, 0]
    text = "time [s],position.wheel_centre.x [mm]\n" + "".join(
        f"{t:.1f},{place:.6f}\n" for t, place in zip(times, x, strict=True)
    )
    solution = as_solution(understood(columns_of_text(text, "x"), {}, STEER, "x"), STEER)
    claims = solution.accuracy.claims["position"]["wheel_centre"][:, 0]
    change = [np.abs(motion.at(times + side).position["wheel_centre"][:, 0] - x) for side in (-0.05, 0.05)]
    assert claims == pytest.approx(np.max(change, axis=0) + 0.5e-6, abs=1e-9)


def test_a_time_too_coarse_to_tell_anything_tests_nothing() -> None:
    text = "time [s],position.wheel_centre.x [mm]\n0.1,400.0\n0.2,400.0\n"
    content = {"columns": {"time": {"printed": 0.3}, "position.wheel_centre.x": {"printed": 0.1}}}
    found = compare_results(understood(columns_of_text(text, "x"), content, STEER, "map"), STEER, "steer")
    (row,) = found.outcome.rows
    assert row.verdict in ("not tested", "disagrees")
    x = simulate(STEER).at(np.array([0.1, 0.2])).position["wheel_centre"][:, 0]
    right = f"time [s],position.wheel_centre.x [mm]\n0.1,{x[0]:.1f}\n0.2,{x[1]:.1f}\n"
    found = compare_results(understood(columns_of_text(right, "x"), content, STEER, "map"), STEER, "steer")
    assert found.outcome.rows[0].verdict == "not tested"


def test_numbers_that_are_none_and_rows_outside_the_time_are_counted_and_the_others_go_on() -> None:
    x = simulate(STEER).at(np.array([0.1])).position["wheel_centre"][0, 0]
    text = f"time [s],position.wheel_centre.x [mm]\n0.1,{x:.3f}\n0.15,\n77.0,1.0\n"
    content = {"columns": {"time": {"printed": 0}, "position.wheel_centre.x": {}}}
    found = compare_results(understood(columns_of_text(text, "x"), content, STEER, "map"), STEER, "steer")
    assert found.outcome.agreed
    notes = " / ".join(found.outcome.notes)
    assert "no number in 1 of 3 rows" in notes
    assert "line 4 is left out: t = 77 s is outside the scene's time" in notes
    assert found.absent[0] == "velocity"


BUMP = "bump [mm],camber [deg]\n"
CONTACT, CENTRE = (
    {"columns": {"bump": {"is": f"travel.{point}"}, "camber": {}}} for point in ("contact", "wheel_centre")
)
TEXT = "time [s],camber [deg]\n0.1,1.0\n0.2,1.1\n"


@pytest.mark.parametrize(
    ("text", "content", "words"),
    [
        (TEXT, {"colums": {}}, ("'colums'", "did you mean 'columns'?")),
        (TEXT, {"columns": {"cambr": {}}}, ("'cambr'", "did you mean 'camber'?")),
        (TEXT, {"columns": {"camber": {"is": "wheel.cambre"}}}, ("did you mean 'wheel.camber'?",)),
        (TEXT, {"columns": {"camber": {"unit": "mm"}}}, ("'mm' is no unit of wheel.camber", "deg")),
        (TEXT, {"columns": {"camber": {"sign": 2}, "time": {}}}, ("columns.camber.sign", "1 or -1")),
        (TEXT, {"independent": "camber"}, ("'camber' is wheel.camber", "a time, an input or a travel")),
        (TEXT.replace(" [deg]", ""), {}, ("column 'camber'", "unit is not said", "deg")),
        (TEXT.replace("time [s]", "tyme [s]"), {}, ("no column says at which pose",)),
        (TEXT.replace("camber", "cmaber").replace("time", "tim"), {}, ("none of tim, cmaber",)),
        (TEXT.replace("camber", "cmaber"), {}, ("nothing to compare",)),
        (TEXT + "0.10,1.3\n", {}, ("line 4", "time = 0.1 s as line 2 is", "one row for each pose")),
        (BUMP + "0,1\n", CONTACT, ("rolling_radius",)),
        (BUMP + "900,1\n", CENTRE, ("line 2", "none of its 1 rows can be reached", "out of reach")),
    ],
)
def test_a_wrong_map_or_file_is_refused_with_its_place(
    text: str, content: dict[str, object], words: tuple[str, ...]
) -> None:
    with pytest.raises(ResultsError) as caught:
        compare_results(understood(columns_of_text(text, "mine.csv"), content, STEER, "map.toml"), STEER, "x")
    assert [word for word in words if word not in str(caught.value)] == [], caught.value


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--data", "none.csv", "steer"], "none.csv: cannot be read"),
        (["--data", "none.csv"], "no scene is given with --data"),
        (["--data", "none.csv", "steer", "--first", "absolute"], "leave --first and --second out"),
        (["--data", "none.csv", "steer", "--junit", "x.xml"], "--junit is about scenes"),
        (["--map", "none.toml", "steer"], "give it with --data FILE"),
    ],
)
def test_a_wrong_command_is_one_line(words: list[str], told: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["validate", *words]) == 2
    err = capsys.readouterr().err
    assert told in err
    assert len(err.splitlines()) == 1
