"""What the sections of a report say is what was computed, and what does not agree cannot be overlooked."""

import csv
import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import jsonschema
import made_rows
import numpy as np
import pytest
from page_read import Read
from page_runs import run_of

import validate.html
import validate.published
from pointcoord import Scene
from validate.ci.record import Record
from validate.cli import main
from validate.commands.reporting import Page
from validate.comparison.examined import Examined, examine
from validate.cost.report import Report
from validate.cost.ways.registry import WAYS
from validate.html.data import data_files
from validate.html.folder import PAGE
from validate.html.hard_cases import HardCases
from validate.html.page import page
from validate.html.plot import Plots
from validate.html.run import FIRST, FURTHER, Drawings, Drawn, Run
from validate.html.section import Paragraph
from validate.html.sections.motion import Spatial
from validate.output.console import Console
from validate.output.document import Head, schema_text
from validate.output.table import Table
from validate.paper.tables import TABLE_2, TABLE_3, compare_with_paper
from validate.published.tables import compare_published

SCENES = Path(__file__).parents[3] / "pointcoord" / "scenes"
NASTY = "<script>alert('x')</script><b onload=alert(1)>"


def head(kind: str = "validate") -> Head:
    return Head.of(kind, ("pointcoord", kind))


def read(run: Run) -> Read:
    return Read(page(run, {}))


ANGLES_AND_RATES = ("velocity", "acceleration", "knuckle_rates", "wheel_angles", "toe", "caster")


@pytest.fixture(scope="module")
def wide() -> Examined:
    """A scene of more instants than are drawn."""
    content = Scene.load("double-wishbone").model_dump(exclude_none=True)
    content["effects"] = ANGLES_AND_RATES
    content["time"] = content["time"] | {"samples": 301}
    scene = Scene.from_mapping(content)
    return examine("wide", scene, (("pointcoord", "absolute"), ("pointcoord-newton", "absolute")), False)


def spoiled(examined: Examined) -> Examined:
    outcomes = tuple(
        replace(one, rows=(replace(one.rows[0], share=7.0, verdict="disagrees"), *one.rows[1:]))
        for one in examined.outcomes
    )
    return replace(examined, outcomes=outcomes)


def test_of_hundreds_of_scenes_all_are_told_some_are_drawn_and_the_page_stays_small(wide: Examined) -> None:
    content = Scene.load("double-wishbone").model_dump(exclude_none=True)
    content["effects"] = [
        effect for effect in content["effects"] if effect not in ("wheel_travel", "steering_axis")
    ]
    content["time"] = content["time"] | {"samples": 301}
    scene, count = Scene.from_mapping(content), 400
    names = [f"a folder of mine/with a long name of a scene {i:03d}.toml" for i in range(count)]
    record, drawings = Record(names), Drawings(count)
    for i, name in enumerate(names):
        examined = replace(spoiled(wide) if i % 20 == 13 else wide, name=name)
        if broken := i % 50 == 20:
            examined = Examined(name=name, problem=f"{name}: is broken at line {i}")
        there = None if broken else scene
        record.add(examined, scene=there)
        drawings.add(examined, there)
    run = Run(head(), record, drawings.kept)
    text = page(run, {})
    assert len(text.encode()) < 8e6
    drawn = [int(one.examined.name[-8:-5]) for one in run.drawn]
    assert drawn == [*range(FIRST), *range(13, 13 + 20 * FURTHER, 20)]
    # The numbers of the others are let go: hundreds of scenes fit into memory.
    assert not any(solution.numbers for outcome in record.outcomes for solution in outcome.solutions)
    shown = Read(text)
    assert f"Drawn are {FIRST + FURTHER} of {count} scenes" in shown.text
    assert len(shown.motions) == FIRST + FURTHER
    # What does not agree has its row and its reason, however far down it stands.
    for i in (13, 393):
        rows = shown.of(f"a folder of mine/with a long name of a scene {i:03d}.toml")
        assert [cell for row in rows for cell in row if cell[0] == "disagrees" and "disagrees" in cell[1]]
    (broken,) = shown.of("a folder of mine/with a long name of a scene 370.toml")
    assert broken[2][0] == "not-tested"
    assert "is broken at line 370" in broken[2][1]
    assert all("not tested" in cell[1] for cell in broken[2:])
    assert shown.verdict[0] == "verdict disagrees"
    assert shown.verdict[1] == run.sentence
    assert "and 10 more" in run.sentence
    # The data have all of it.
    assert len(run.document["scenes"]) == count
    assert len(data_files(run)["comparisons.csv"].splitlines()) > count


def test_a_solver_that_is_wrong_is_red_and_named_in_page_data_and_status(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "off_by_a_bit.py").write_text(
        "import numpy as np\n"
        "def solve(given):\n"
        "    x, y, z = given['points']['rack_centre']\n"
        "    s = np.array(given['inputs']['rack']['position'])\n"
        "    inner = np.stack([x + 0 * s, y - s, z + 0 * s], axis=1)\n"
        "    inner[3, 1] += 1e-3\n"
        "    return {'position': {'tie_rod_inner': inner}}\n"
    )
    monkeypatch.syspath_prepend(str(tmp_path))
    out = tmp_path / "out"
    words = ["validate", "-q", "--solver", "off_by_a_bit:solve", "steer", "--report", str(out)]
    assert main([*words, "--json", str(tmp_path / "run.json")]) == 1
    document = json.loads((out / "results.json").read_text())
    jsonschema.validate(document, json.loads(schema_text()))
    assert (document["exit_status"], document["verdict"]) == (1, "disagree")
    same = json.loads((tmp_path / "run.json").read_text())
    assert {k: v for k, v in same.items() if k != "written"} == {
        k: v for k, v in document.items() if k != "written"
    }
    shown = Read((out / "index.html").read_text(encoding="utf-8"))
    assert shown.verdict == (
        "verdict disagrees",
        "0 of 1 scene agrees; disagrees: steer; 1 of 34 numbers compared, 33 not given.",
    )
    (row,) = shown.of("steer")[:1]
    assert ("disagrees", "disagrees") in [(kind, text[:9]) for kind, text in row]
    assert "position of tie_rod_inner: 1.00e-03 mm apart" in shown.text
    assert [words for words, _ in shown.plots if words.startswith("position of tie_rod_inner: disagrees")]


def test_a_scene_that_is_refused_has_its_reason_beside_it(tmp_path: Path) -> None:
    text = (SCENES / "steer.toml").read_text().replace("[0.0, 150.0, 25.0]", "[0.0, 1500.0, 25.0]")
    (tmp_path / "too far.toml").write_text(text)
    (tmp_path / "broken.toml").write_text("no scene")
    words = ["report", "-q", str(tmp_path / "out"), "--scenes-dir", str(tmp_path)]
    assert main(words) == 2
    shown = Read((tmp_path / "out" / "index.html").read_text(encoding="utf-8"))
    assert shown.verdict[0] == "verdict not-tested"
    refused, broken = shown.verdict[1].index("(refused)"), shown.verdict[1].index("(wrong input)")
    assert refused < shown.verdict[1].index("too far.toml")
    assert broken < shown.verdict[1].index("broken.toml")
    assert "Exit status 2: wrong input" in shown.text
    for name, said in (("too far.toml", "cannot pass a singular pose"), ("broken.toml", "is not TOML")):
        row = next(row for row in shown.rows if row and name in row[0][1])
        assert row[2][0] == "not-tested"
        assert said in row[2][1]
    with (tmp_path / "out" / "comparisons.csv").open(newline="") as stream:
        assert not list(csv.DictReader(stream))


def answer(outcome: str, error: float | None, value: float, name: str = "pointcoord") -> dict[str, Any]:
    given = {"formulation": name, "outcome": outcome, "reason": "why", "error": error, "bound": 1e-9}
    return given | {"share": None, "condition": None, "value": value}


def hard_document(*answers: dict[str, Any], unexpected: Sequence[dict[str, Any]] = ()) -> dict[str, Any]:
    values = [one["value"] for one in answers]
    case = {
        "name": "near-a-fold",
        "group": NASTY,
        "why": NASTY,
        "parameter": NASTY,
        "values": values,
        "unit": f"mm{NASTY}",
        "behaviour": "right",
        "expected": {},
        "seconds": 1.0,
        "trials": [{"value": one["value"], "answers": [one], "facts": {}} for one in answers],
        "unexpected": list(unexpected),
    }
    counts: dict[str, dict[str, int]] = {}
    for one in answers:
        of = counts.setdefault(one["formulation"], {})
        of[one["outcome"]] = of.get(one["outcome"], 0) + 1
    results = {"as_expected": not unexpected, "counts": counts, "cases": [case]}
    return head("hard").document(results, None, complete=True)


def test_hard_cases_are_drawn_as_errors_over_the_distance_and_a_wrong_one_is_told() -> None:
    given = [answer("right", 1e-12 / value, value) for value in (1e-1, 1e-3, 1e-5)]
    wrong = answer("wrong", 0.5, 1e-7)
    refused = answer("refused", None, 1e-9)
    document = hard_document(*given, wrong, refused, unexpected=[wrong])
    run = Run(head("hard"), hard=HardCases.of(document))
    assert run.status == 1
    shown = read(run)
    assert shown.verdict[0] == "verdict disagrees"
    assert "near-a-fold" in shown.verdict[1]
    assert any(
        "disagrees" in kind and "wrong at 1e-07" in text for _, _, (kind, text), _ in shown.of("near-a-fold")
    )
    ((_, plot),) = shown.by_words.items()
    right, crosses, rings = plot["data"]
    assert dict(zip(right["x"], right["y"], strict=True)) == {1e-1: 1e-11, 1e-3: 1e-9, 1e-5: 1e-7}
    assert (crosses["x"], rings["x"], rings["y"]) == ([1e-9], [1e-7], [0.5])
    assert crosses["y"][0] < 1e-11
    assert {plot["layout"][name]["type"] for name in ("xaxis", "yaxis")} == {"log"}
    # Plotly reads marks in its labels.
    assert "<" not in json.dumps(plot)
    assert not [given for _, given in shown.tags if "onload" in given]


def test_formulations_that_refuse_at_one_place_have_crosses_of_their_own_below_every_error() -> None:
    names = ("pointcoord", "absolute", "relative")
    refused = [answer("refused", None, 1e-9) | {"formulation": name} for name in names]
    right = [answer("right", 1e-12 / value, value) for value in (1e-1, 1e-3, 1e-5)]
    shown = read(Run(head("hard"), hard=HardCases.of(hard_document(*right, *refused))))
    ((_, plot),) = shown.by_words.items()
    crosses = {one["name"]: one["y"][0] for one in plot["data"] if one["name"].endswith("refuses")}
    assert list(crosses) == [f"{name} refuses" for name in names]
    heights = np.log10(sorted([*crosses.values(), 1e-11]))
    # A cross is 8 pixels high, and some 150 are as many decades as the errors take and half as many more.
    assert np.diff(heights).min() > 8 / 150 * 1.5 * 4


def test_hard_cases_of_an_earlier_run_say_so_and_decide_with_the_scenes(tmp_path: Path) -> None:
    wrong = answer("wrong", 0.5, 1e-7)
    for unexpected, status in (([], 0), ([wrong], 1)):
        file = tmp_path / "hard.json"
        file.write_text(json.dumps(hard_document(answer("right", 1e-12, 1e-1), unexpected=unexpected)))
        out = tmp_path / f"out {status}"
        assert main(["report", "-q", str(out), "steer", "--hard", str(file)]) == status
        shown = Read((out / "index.html").read_text(encoding="utf-8"))
        assert "Tried by `pointcoord hard`" in shown.text
        assert shown.verdict[0] == ("verdict disagrees" if status else "verdict agrees")
        assert json.loads((out / "results.json").read_text())["exit_status"] == status
        assert json.loads((out / "hard.json").read_text()) == json.loads(file.read_text())


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("{", "is no JSON"),
        ("[" * 100_000, "is no JSON"),
        ("[]", "holds no hard cases"),
        ('{"kind": "hard", "schema_version": 99}', "schema version 99"),
        ('{"kind": "hard", "schema_version": 2, "complete": false}', "did not come to its end"),
        ('{"kind": "hard", "schema_version": 2, "complete": true, "cases": [1]}', "is damaged"),
    ],
)
def test_a_file_that_holds_no_hard_cases_is_refused_in_a_line(
    text: str, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "hard.json").write_text(text)
    assert main(["report", str(tmp_path / "out"), "steer", "--hard", str(tmp_path / "hard.json")]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert len(error.splitlines()) == 1
    assert not (tmp_path / "out").exists()


def test_accuracy_against_time_has_a_point_for_each_setting_of_each_way() -> None:
    rows = tuple(
        row
        for way, setting, error, solve in (
            ("series", "a", 1e-3, 1e-5),
            ("series", "b", 1e-9, 5e-5),
            (f"mine{NASTY}", "a", 1e-6, 2e-4),
        )
        for row in made_rows.measured("bounce", way, setting, {"position": error}, solve)
    )
    report = Report("rows", "pointcoord cost", False, rows)
    shown = read(Run(head("cost"), cost=report))
    ((_, plot),) = shown.by_words.items()
    series, mine = plot["data"]
    # In us.
    assert series["x"] == pytest.approx([10.0, 50.0])
    assert series["y"] == [1e-3, 1e-9]
    assert mine["y"] == [1e-6]
    assert "<" not in json.dumps(plot)
    # Times are neither right nor wrong.
    assert shown.verdict[0] == "verdict measured"
    assert "Exit status 0: nothing compared" in shown.text
    assert shown.of("command")[0][1][1] == "pointcoord cost"


def test_every_way_of_a_page_is_told_from_every_other_by_its_line_and_by_its_mark() -> None:
    rows = tuple(
        row
        for k, way in enumerate(WAYS)
        for row in made_rows.measured("bounce", way.name, "a", {"position": 10.0**-k}, 1e-5, dense=way.dense)
    )
    ((_, plot),) = read(Run(head("cost"), cost=Report("rows", "", False, rows))).by_words.items()
    assert len(plot["data"]) == len(WAYS) > 12
    lines = {(one["line"]["color"], one["line"].get("dash")) for one in plot["data"]}
    symbols = {one["marker"]["symbol"].removesuffix("-open") for one in plot["data"]}
    assert len(lines) == len(symbols) == len(WAYS)
    dense = {way.name for way in WAYS if way.dense}
    assert {one["name"].removesuffix("*") for one in plot["data"] if one["name"].endswith("*")} == dense
    assert all(one["name"].endswith("*") != one["marker"]["symbol"].endswith("-open") for one in plot["data"])


def test_every_printed_number_of_another_program_stands_beside_ours_and_a_wrong_one_disagrees() -> None:
    tables = compare_published()
    run = Run(head(), published=tables)
    assert run.status == 0
    shown = read(run)
    for one in tables:
        for line in (
            (Path(validate.published.__file__).parent / f"{one.table.name}.csv").read_text().splitlines()[1:]
        ):
            at, *numbers = line.split(",")
            found = [_begins(row[1:], numbers) for row in shown.of(f"{float(at):g}")]
            assert any(found), line
        assert one.table.source in shown.text
    bump = tables[0]
    wrong = replace(bump, outcomes=(spoiled_outcome(bump.outcomes[0]), bump.outcomes[1]))
    spoilt = Run(head(), published=(wrong,))
    assert spoilt.status == 1
    assert bump.table.title in spoilt.sentence
    row = replace(bump.columns[0].rows[0], share=3.0, verdict="disagrees")
    column = replace(bump.columns[0], rows=(row, bump.columns[0].rows[1]))
    page = read(Run(head(), published=(replace(bump, columns=(column, *bump.columns[1:])),)))
    assert ("disagrees", "disagrees") in [(k, t[:9]) for row in page.of("verdict") for k, t in row]


def _begins(cells: Sequence[tuple[str, str]], numbers: Sequence[str]) -> bool:
    return all(text.startswith(f"{float(n) + 0.0:.9g}") for (_, text), n in zip(cells, numbers, strict=False))


def spoiled_outcome(outcome: Any) -> Any:
    return replace(
        outcome, rows=(replace(outcome.rows[0], share=3.0, verdict="disagrees"), *outcome.rows[1:])
    )


def test_the_figures_have_the_printed_rows_and_the_errata_their_numbers() -> None:
    shown = read(Run(head(), record=Record([], paper=compare_with_paper())))
    by_number = {words.partition(":")[0]: plot["data"] for words, plot in shown.plots}
    for number, table in ((6, TABLE_2), (8, TABLE_3)):
        curve, crosses = by_number[f"Figure {number}"]
        assert list(zip(crosses["x"], crosses["y"], strict=True)) == [
            (r.time, r.wheel_centre[2]) for r in table
        ]
        at = np.interp(crosses["x"], curve["x"], curve["y"])
        # The tables differ from what Table 1 gives by up to some 13 mm.
        assert 0.5 < np.abs(at - crosses["y"]).max() < 20.0
    for number in (5, 7):
        kingpin, camber = by_number[f"Figure {number}"]
        assert (kingpin["name"], camber["name"]) == ("kingpin", "camber")
        assert np.abs(np.diff(kingpin["y"])).max() < 5.0  # degrees, and smooth
    errata = {row[0][1]: row[-1][1] for row in shown.rows if len(row) == 4 and row[0][1].isdigit()}
    assert list(errata) == [str(i) for i in range(1, 10)]
    # Found by hand from the printed numbers.
    for number, said in (
        ("1", "7.94 degrees"),
        ("1", "16.8 mm"),
        ("2", "3.60 mm"),
        ("3", "6.1 degrees"),
        ("7", "computed from 1.46"),
        ("8", "rank 1, all three components rank 2"),
    ):
        assert said in errata[number]


def test_what_a_page_is_made_of_is_installed_with_it() -> None:
    templates = Path(validate.html.__file__).with_name("templates")
    needed = {"page.html", "page.css"}
    for block in (Table, Paragraph, Plots, Spatial):
        needed |= {block.template, *(name for name in block.scripts if name.endswith(".js"))}
    assert needed <= {file.name for file in templates.iterdir()}
    published = {file.suffix for file in Path(validate.published.__file__).parent.iterdir()}
    assert {".csv", ".toml"} <= published


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["report", "OUT", "steer", "--cost", "no such file"], "--cost no such file"),
        (["hard", "--list", "--report", "OUT"], "leave it out with --list"),
        (["validate", "steer", "--report", ""], "--report '' names no folder"),
        (["validate", "steer", "--solver", "pathlib:nope", "--report", "OUT"], "has no 'nope'"),
        (["cost", "--ways", "nope", "--report", "OUT"], "nope"),
    ],
)
def test_a_report_that_cannot_be_is_refused_in_a_line(
    words: list[str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    assert main([str(out) if word == "OUT" else word for word in words]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert len(error.splitlines()) == 1
    assert not out.exists()
    # A folder that is there is somebody's.
    out.mkdir()
    assert main([str(out) if word == "OUT" else word for word in words]) == 2
    assert list(out.iterdir()) == []


def test_what_a_page_of_validate_does_not_hold_is_named_with_the_command_that_adds_it(tmp_path: Path) -> None:
    assert main(["validate", "-q", "steer", "--report", str(tmp_path)]) == 0
    shown = Read((tmp_path / PAGE).read_text(encoding="utf-8"))
    ((place, _),) = [one for one in enumerate(shown.rows) if one[1] and one[1][0][1] == "not in this page"]
    told = {row[0][1]: row[1][1] for row in shown.rows[place + 1 : place + 5]}
    assert told == {
        "hard cases": "pointcoord hard --report DIR",
        "accuracy against time": "pointcoord cost --report DIR",
        "the paper's figures, tables and errata": "pointcoord report DIR",
        "other programs' tables": "pointcoord report DIR",
    }
    headings = {given.get("id") for tag, given in shown.tags if tag == "section"}
    assert not headings & {"hard", "cost", "published"}
    assert "Figures 5 to 8" not in shown.text
    for command in told.values():
        assert main([command.split()[1], "--help"]) == 0


def test_a_page_of_validate_that_holds_the_papers_tables_still_names_those_of_other_programs(
    tmp_path: Path,
) -> None:
    run = Page(str(tmp_path)).write(Run(head(), record=Record([], paper=compare_with_paper())), Console())
    assert [what for what, _ in run.left_out] == [
        "hard cases",
        "accuracy against time",
        "other programs' tables",
    ]


def test_hard_cases_that_are_tried_make_a_page_with_their_verdict_and_data(tmp_path: Path) -> None:
    assert main(["hard", "-q", "knuckle-in-line-wishbone", "--report", str(tmp_path)]) == 0
    document = json.loads((tmp_path / "results.json").read_text())
    jsonschema.validate(document, json.loads(schema_text()))
    assert (document["kind"], document["verdict"]) == ("hard", "agree")
    shown = Read((tmp_path / "index.html").read_text(encoding="utf-8"))
    assert shown.verdict[0] == "verdict agrees"
    assert shown.of("accuracy against time")[0][1][1] == "pointcoord cost --report DIR"
    assert not shown.of("hard cases")
    assert "1 hard case at " in shown.verdict[1]
    answers = [a for case in document["cases"] for trial in case["trials"] for a in trial["answers"]]
    with (tmp_path / "hard.csv").open(newline="") as stream:
        lines = list(csv.DictReader(stream))
    assert [(one["formulation"], one["outcome"]) for one in lines] == [
        (one["formulation"], one["outcome"]) for one in answers
    ]
    for line, one in zip(lines, answers, strict=True):
        assert line["error"] == ("" if one["error"] is None else repr(one["error"]))


SOLVER = """
from pointcoord import Scene, simulate
def rack_only(given):
    x, y, z = given["points"]["rack_centre"]
    return {"position": {"tie_rod_inner": [[x, y + s, z] for s in given["inputs"]["rack"]["position"]]}}
def tilted(given):
    return {"camber": simulate(Scene.load("steer")).wheel["camber"] + 0.5}
"""


@pytest.fixture
def solver(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "made_solver.py").write_text(SOLVER)
    monkeypatch.syspath_prepend(str(tmp_path))
    return tmp_path / "out"


def shown_of(*words: str, out: Path) -> Read:
    main(["report", "-q", *words])
    return Read((out / "index.html").read_text(encoding="utf-8"))


def test_the_line_of_a_curve_is_the_solver_that_was_given_and_the_dots_are_whom_it_is_held_to(
    solver: Path,
) -> None:
    shown = shown_of("--in-process", "--solver", "made_solver:tilted", str(solver), "steer", out=solver)
    line, dots = shown.by_words["camber over rack"]["data"]
    assert (line["name"], dots["name"]) == ("made_solver:tilted", "pointcoord")
    assert shown.by_words["camber over rack"]["layout"]["showlegend"]
    at = dict(zip(line["x"], line["y"], strict=True))
    apart = [at[x] - y for x, y in zip(dots["x"], dots["y"], strict=True)]
    assert apart == pytest.approx([np.degrees(0.5)] * len(apart), abs=1e-3)
    # Of the other angle it gives nothing, and pointcoord's is no line in its place.
    assert "kingpin angle over rack" not in shown.by_words


def test_what_a_solver_does_not_give_is_no_curve_of_it_and_does_not_empty_the_drawing(solver: Path) -> None:
    shown = shown_of("--in-process", "--solver", "made_solver:rack_only", str(solver), "steer", out=solver)
    assert "camber over rack" not in shown.by_words
    assert "no curves: made_solver:rack_only gives no camber and no kingpin angle" in shown.text
    (motion,) = shown.motions
    points = list(Scene.load("steer").mechanism.topology.points)
    assert motion["points"] == points
    assert all(len(place) == 3 for place in motion["drawn"])
    own, other = (model["frames"] for model in motion["models"])
    chassis = set(motion["chassis"]) | {points.index("tie_rod_inner")}
    assert all({i for i, place in enumerate(frame) if place} == chassis for frame in own)
    assert all(all(frame) for frame in other)


@pytest.mark.parametrize("words", [["report", "OUT"], ["validate", "--report", "OUT"]])
def test_a_refused_scene_is_drawn_as_far_as_it_goes_and_says_why_no_farther(
    words: list[str], tmp_path: Path
) -> None:
    text = (SCENES / "steer.toml").read_text().replace("[0.0, 150.0, 25.0]", "[0.0, 1500.0, 25.0]")
    (tmp_path / "far.toml").write_text(text)
    out = tmp_path / "out"
    main([str(out) if word == "OUT" else word for word in words] + [str(tmp_path / "far.toml"), "-q"])
    shown = Read((out / "index.html").read_text(encoding="utf-8"))
    assert "Stopped: the motion cannot pass a singular pose" in shown.text
    assert "Stopped: the motion cannot pass a singular pose" in shown.text
    (line,) = shown.by_words["camber over rack"]["data"]
    assert line["name"] == "pointcoord"
    # The rack cannot pass 130.10 mm.
    assert 100.0 < max(line["x"]) < 130.2
    (motion,) = shown.motions
    assert 0.05 < max(motion["times"]) < 0.0867


def test_options_may_stand_between_the_folder_and_the_scenes(solver: Path) -> None:
    file = solver.parent / "hard.json"
    file.write_text(json.dumps(hard_document(answer("right", 1e-12, 1e-1))))
    for words in (
        ["--solver", "made_solver:rack_only", "--in-process", "steer"],
        ["--hard", str(file), "steer", "--first", "pointcoord", "bounce"],
    ):
        main(["report", str(solver), *words, "-q"])
        document = json.loads((solver / "results.json").read_text())
        assert [one["scene"] for one in document["scenes"]] == [w for w in words if w in ("steer", "bounce")]


def test_hard_cases_that_note_no_time_are_told_without_one() -> None:
    document = hard_document(answer("right", 1e-12, 1e-1)) | {"started": None, "command_line": "mine"}
    text = read(Run(head(), hard=HardCases.of(document))).text
    assert "Tried by `mine`. 1 hard case" in text
    document["started"] = "2026-01-02T03:04:05Z"
    assert "Tried by `mine`, 2026-01-02T03:04:05Z. " in read(Run(head(), hard=HardCases.of(document))).text


@pytest.mark.parametrize("folder", ["steer", "mine.toml"])
def test_a_scene_in_the_place_of_the_folder_is_refused_and_makes_none(
    folder: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["report", folder, "double-wishbone"]) == 2
    assert "the folder of the report comes first" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())
    assert main(["report", "-q", f"./{folder}/", "steer"]) == 0
    assert (tmp_path / folder / "index.html").is_file()


def test_a_verdict_tells_disagreements_first_and_each_reason_once_with_its_scenes(solver: Path) -> None:
    words = ("--in-process", "--solver", "made_solver:rack_only", "steer", "double-wishbone", "bounce")
    main(["report", "-q", str(solver), *words])
    text = (solver / "index.html").read_text(encoding="utf-8")
    lines = [
        part.partition("</p>")[0]
        for part in text.partition('<section id="agreement"')[0].split("<p>")[1:]
        if "</p>" in part
    ]
    lines = [line for line in lines if "need JavaScript" not in line]
    assert "position of tie_rod_inner: 1.28e+02 mm apart" in lines[0]
    assert len({line.partition(": ")[2] for line in lines}) == len(lines)
    given = [line for line in lines if line.endswith("not given: made_solver:rack_only gives no velocity")]
    assert {name for line in given for name in line.partition(": ")[0].split(", ")} == {*words[3:]}
    (closing,) = [line for line in lines if "closing the drawing moves wheel_centre" in line]
    assert closing.startswith("steer, bounce: ")


def test_a_drawing_that_closes_to_rounding_is_told_so_and_no_number_of_rounding_is_shown(
    wide: Examined,
) -> None:
    assert wide.closing is not None
    assert 0.0 < wide.closing["largest"] < 1e-6
    text = read(run_of(Drawn(wide, Scene.load("double-wishbone")))).text
    assert "it closes, no point moves by more than rounding" in text
    assert "closing it moves" not in text
