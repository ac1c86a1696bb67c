"""The page of a run says what the data beside it say, takes all text as text, and loads nothing."""

import csv
import json
from base64 import b64encode
from contextlib import suppress
from dataclasses import replace
from hashlib import sha256
from html import unescape
from pathlib import Path
from typing import Any

import made_rows
import numpy as np
import pytest
from changed_scenes import scene_with
from page_read import Read
from program import PAST_ITS_END, short_scene
from program import document as checked

import validate.published
from pointcoord import Scene, simulate
from validate.ci.record import Record
from validate.cli import main
from validate.comparison.examined import Examined, examine
from validate.cost.report import Report
from validate.cost.ways.registry import WAYS
from validate.html.data import data_files
from validate.html.hard_cases import HardCases
from validate.html.page import page
from validate.html.run import FIRST, FURTHER, Drawings, Drawn, Run
from validate.html.sections import SECTIONS
from validate.output.document import Head
from validate.output.report import worst_rows
from validate.paper.scenes import PAPER_SCENES
from validate.paper.tables import TABLE_2, TABLE_3
from validate.published.tables import compare_published

NASTY = "<script>alert('x')</script><b onload=alert(1)>"
FILES = {"results.json": "the run", "comparisons.csv": "its lines"}
# The scenes of the paper and one of each other kind.
FEW = (*PAPER_SCENES, "five-link", "slider-crank")


def head(kind: str = "validate") -> Head:
    return Head.of(kind, ("pointcoord", kind))


def run_of(one: Drawn) -> Run:
    """A run of one scene."""
    record = Record([one.examined.name])
    record.add(one.examined, scene=one.scene)
    return Run(head(), record, [one])


def read(run: Run) -> Read:
    return Read(page(run, FILES))


def read_file(folder: Path) -> Read:
    return Read((folder / "index.html").read_text(encoding="utf-8"))


def lines_of(file: Path) -> list[dict[str, str]]:
    with file.open(newline="") as stream:
        return [*csv.DictReader(stream)]


@pytest.fixture(scope="module")
def bounce() -> Drawn:
    scene = Scene.load("bounce")
    return Drawn(examine("bounce", scene, (("pointcoord", "absolute"),), False), scene, simulate(scene))


@pytest.fixture(scope="module")
def built_in(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The report of built-in scenes, and of hard cases and times of earlier runs."""
    folder, earlier = tmp_path_factory.mktemp("report"), tmp_path_factory.mktemp("earlier")
    cost, hard = made_rows.kept(earlier / "rows.parquet", made_rows.study()), earlier / "hard.json"
    hard.write_text(json.dumps(hard_document()))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("validate.commands.comparison.DEFAULT_SCENES", FEW)
        assert main(["report", "-q", str(folder), "--cost", cost, "--hard", str(hard)]) == 0
    return folder


def test_a_report_has_every_section_and_the_data_that_it_names(built_in: Path) -> None:
    shown, document = read_file(built_in), checked(built_in / "results.json")
    checked(built_in / "hard.json")
    assert 4e6 < (built_in / "index.html").stat().st_size < 8e6
    # The section of a file of results would be empty here.
    details = ["differences", "paper", "hard", "published", "machine"]
    there = [given["id"] for tag, given in shown.tags if tag == "section"]
    assert there == ["verdict", "agreement", "motion", "cost", *details]
    assert [section.name for section in SECTIONS if section.folded] == details
    links = [given["href"] or "" for tag, given in shown.tags if tag == "a"]
    files = {link for link in links if not link.startswith("#")}
    assert files == {file.name for file in built_in.iterdir()} - {"index.html"}
    assert document["exit_status"] == 0
    assert shown.verdict[1].startswith(f"{len(FEW)} of {len(FEW)} scenes agree; ")
    assert shown.verdict[1].endswith("all as expected.")
    text = unescape((built_in / "index.html").read_text(encoding="utf-8"))
    assert all(f"{Scene.load(name).title}. " in text for name in FEW)
    for finding in document["printed_formulas"]:
        size, unit = finding["worst"]["difference"], finding["worst"]["unit"]
        number = "not a number" if size is None else f"{size:.1e} {unit}"
        lines = [r for r in shown.cells if r[0] == finding["scene"] and r[-1] == finding["erratum"]]
        assert any(row[2].startswith(number) for row in lines), finding


def test_the_page_and_the_table_beside_it_have_every_comparison_of_the_data(built_in: Path) -> None:
    scenes = checked(built_in / "results.json")["scenes"]
    rows = [row for scene in scenes for one in scene["comparisons"] for row in one["rows"]]
    lines = lines_of(built_in / "comparisons.csv")
    assert len(lines) == len(rows) > 100
    for line, row in zip(lines, rows, strict=True):
        assert (line["scene"], line["name"], line["verdict"]) == (row["scene"], row["name"], row["verdict"])
        assert float(line["difference"]) == row["difference"]
    cells = [row for row in read_file(built_in).cells if len(row) > 3 and row[0] in FEW and " and " in row[1]]
    pairs = {(line["scene"], f"{line['first']} and {line['second']}") for line in lines}
    assert {(row[0], row[1]) for row in cells} == pairs
    assert all(row[-1] == "agrees" for row in cells)


def test_the_paper_s_figures_rows_and_errata_are_on_the_page(built_in: Path) -> None:
    shown = read_file(built_in)
    by_number = {words.partition(":")[0]: plot["data"] for words, plot in shown.plots}
    for number, printed in ((6, TABLE_2), (8, TABLE_3)):
        _, crosses = by_number[f"Figure {number}"]
        wanted = [(row.time, row.wheel_centre[2]) for row in printed]
        assert list(zip(crosses["x"], crosses["y"], strict=True)) == wanted
        angles = by_number[f"Figure {number - 1}"]
        assert [one["name"] for one in angles] == ["kingpin", "camber"]
        assert np.abs(np.diff(angles[0]["y"])).max() < 5.0  # degrees: a smooth curve
        for row in printed:
            x, _, z = row.wheel_centre
            (cells,) = (one for one in shown.cells if f"{row.time:.2f}" == one[0] and f"({x:g}, " in one[3])
            assert f", {z:g})" in cells[3]
            # The tables differ from what Table 1 gives by up to some 13 mm.
            assert 0.0 < float(cells[5]) < 25.0
    place = next(i for i, row in enumerate(shown.cells) if row[0] == "no.")
    assert [row[0] for row in shown.cells[place + 1 : place + 10]] == [str(i) for i in range(1, 10)]


SOLVER = """
import numpy as np
from pointcoord import Scene, simulate
def off_by_a_bit(given):
    x, y, z = given["points"]["rack_centre"]
    inner = np.array([[x, y - s, z] for s in given["inputs"]["rack"]["position"]])
    inner[3, 1] += 1e-3
    camber = simulate(Scene.load("steer")).wheel["camber"] + 0.5
    return {"position": {"tie_rod_inner": inner}, "camber": camber}
"""


def test_a_solver_that_is_wrong_is_red_and_drawn_as_it_is_in_page_data_and_status(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "made_solver.py").write_text(SOLVER)
    monkeypatch.syspath_prepend(str(tmp_path))
    name, out, run = "made_solver:off_by_a_bit", tmp_path / "out", tmp_path / "run.json"
    words = ["validate", "-q", "--solver", name, "--in-process", "steer", "--report", str(out)]
    assert main([*words, "--json", str(run)]) == 1
    document, shown = checked(out / "results.json"), read_file(out)
    assert (document["exit_status"], document["verdict"]) == (1, "disagree")
    assert checked(run) | {"written": None} == document | {"written": None}
    said = "0 of 1 scene agrees; disagrees: steer; 2 of 34 numbers compared, 32 not given."
    assert shown.verdict == ("verdict disagrees", said)
    assert ("disagrees", "DISAGREES") in [(kind, text[:9]) for kind, text in shown.of("steer")[0]]
    assert "position of tie_rod_inner: difference 0.001 mm, tolerance " in shown.text
    plots = shown.by_words
    assert [words for words in plots if words.startswith("position of tie_rod_inner: disagrees")]
    line, dots = plots["camber over rack"]["data"]
    assert (line["name"], dots["name"]) == (name, "pointcoord")
    at = dict(zip(line["x"], line["y"], strict=True))
    apart = [at[x] - y for x, y in zip(dots["x"], dots["y"], strict=True)]
    assert apart == pytest.approx([np.degrees(0.5)] * len(apart), abs=1e-3)
    # The solver gives no kingpin angle, and pointcoord's is not drawn in its place.
    assert "kingpin angle over rack" not in plots


def test_scenes_that_are_refused_or_broken_have_their_reason_beside_them(tmp_path: Path) -> None:
    short_scene(tmp_path, "too far.toml", samples="131", **PAST_ITS_END)
    (tmp_path / "broken.toml").write_text("no scene")
    assert main(["report", "-q", str(tmp_path / "out"), "--scenes-dir", str(tmp_path)]) == 2
    shown = read_file(tmp_path / "out")
    assert shown.verdict[0] == "verdict not-tested"
    assert "Exit status 2: wrong input" in shown.text
    for name, why, said in (
        ("too far.toml", "(refused)", "cannot pass a singular pose"),
        ("broken.toml", "(wrong input)", "is not TOML"),
    ):
        assert name in shown.verdict[1].partition(why)[2].partition(";")[0]
        row = next(row for row in shown.rows if row and name in row[0][1])
        assert row[-1][0] == "not-tested"
        assert said in row[-1][1]
    assert lines_of(tmp_path / "out" / "comparisons.csv") == []


def test_of_many_scenes_all_are_listed_some_are_drawn_and_the_page_stays_small() -> None:
    effects = ["velocity", "acceleration", "knuckle_rates", "wheel_angles", "toe", "caster"]
    scene, count = scene_with("double-wishbone", effects=effects, samples=61), 100
    wide = examine("wide", scene, (("pointcoord", "absolute"), ("pointcoord-newton", "absolute")), False)
    wrong = tuple(
        replace(one, rows=(replace(one.rows[0], share=7.0, verdict="disagrees"), *one.rows[1:]))
        for one in wide.outcomes
    )
    names = [f"a folder of mine/with a long name of a scene {i:03d}.toml" for i in range(count)]
    record, drawings = Record(names), Drawings(count)
    for i, name in enumerate(names):
        examined = replace(wide, name=name, outcomes=wrong if i % 5 == 4 else wide.outcomes)
        if broken := i % 25 == 20:
            examined = Examined(name=name, problem=f"{name}: is broken at line {i}")
        there = None if broken else scene
        record.add(examined, scene=there)
        drawings.add(examined, there)
    run = Run(head(), record, drawings.kept)
    text = page(run, {})
    assert len(text.encode()) < 8e6
    drawn = [int(one.examined.name[-8:-5]) for one in run.drawn]
    assert drawn == [*range(FIRST), *range(9, 9 + 5 * FURTHER, 5)]
    # The numbers of the others are let go: hundreds of scenes fit into memory.
    assert not any(solution.numbers for outcome in record.outcomes for solution in outcome.solutions)
    shown = Read(text)
    assert f"{FIRST + FURTHER} of {count - 4} scenes are drawn" in shown.text
    assert len(shown.motions) == FIRST + FURTHER
    assert "more rows are in the data files of this page" in shown.text
    # What does not agree has its row and its reason, however far down it stands.
    for i in (9, 99):
        rows = shown.of(names[i])
        assert [cell for row in rows for cell in row if cell[0] == "disagrees" and "DISAGREES" in cell[1]]
    (broken_row,) = shown.of(names[95])
    assert broken_row[-1][0] == "not-tested"
    assert "is broken at line 95" in broken_row[-1][1]
    assert shown.verdict == ("verdict disagrees", run.sentence)
    assert "and 10 more" in run.sentence
    assert len(run.document["scenes"]) == count
    assert len(data_files(run)["comparisons.csv"].splitlines()) > count


def test_a_plot_of_differences_shows_the_largest_share_of_the_table(bounce: Drawn) -> None:
    shown = [one for words, one in read(run_of(bounce)).plots if "of its tolerance" in words]
    worst = worst_rows(bounce.examined.outcomes[0])
    assert len(shown) == len(worst) > 5
    for row, one in zip(worst, shown, strict=True):
        held, gap = (np.array(trace["y"], dtype=float) for trace in one["data"])
        assert np.nanmax(gap / held) == pytest.approx(row.share, rel=2e-3, abs=1e-300)
        assert one["layout"]["yaxis"]["type"] == "log"
        assert row.unit in one["layout"]["yaxis"]["title"]["text"]


def test_the_drawing_that_moves_has_the_places_of_both_models_those_drawn_and_those_closed(
    bounce: Drawn,
) -> None:
    read_page, closing = read(run_of(bounce)), bounce.examined.closing
    assert closing is not None
    (shown,) = read_page.motions
    for solution, model in zip(bounce.examined.outcomes[0].solutions, shown["models"], strict=True):
        assert model["name"] == solution.formulation
        at = [int(np.argmin(np.abs(solution.times - time))) for time in shown["times"]]
        for name, places in solution.position.items():
            got = np.array([frame[shown["points"].index(name)] for frame in model["frames"]])
            assert np.abs(got - places[at]).max() < 0.006
    drawn, closed = (dict(zip(shown["points"], shown[key], strict=True)) for key in ("drawn", "closed"))
    for name, place in bounce.scene.mechanism.points.items():
        assert drawn[name] == pytest.approx(list(place), abs=0.006)
    assert {shown["points"][i] for i in shown["chassis"]} == set(bounce.scene.mechanism.topology.chassis)
    assert closing["largest"] == pytest.approx(16.8, abs=0.05)  # of Table 1
    for name, movement in closing["movements"].items():
        assert np.linalg.norm(np.subtract(closed[name], drawn[name])) == pytest.approx(movement, abs=0.02)
    assert "closing the drawing moves wheel_centre by 16.8 mm" in read_page.text


def answer(outcome: str, error: float | None, value: float, name: str = "pointcoord") -> dict[str, Any]:
    given = {"formulation": name, "outcome": outcome, "reason": "why", "error": error, "bound": 1e-9}
    return given | {"share": None, "condition": None, "value": value}


def hard_document(*more: dict[str, Any]) -> dict[str, Any]:
    """A case with a right answer and more, of which those that are not right are unexpected."""
    answers = [answer("right", 1e-12, 1e-1), *more]
    unexpected = [one for one in more if one["outcome"] != "right"]
    case = {
        **{"name": "near-a-fold", "group": NASTY, "why": NASTY, "parameter": NASTY, "unit": f"mm{NASTY}"},
        **{"values": [one["value"] for one in answers], "behaviour": "right", "expected": {}, "seconds": 1.0},
        "trials": [{"value": one["value"], "answers": [one], "facts": {}} for one in answers],
        "unexpected": unexpected,
    }
    counts = {"pointcoord": {one["outcome"]: 1 for one in answers}}
    results = {"as_expected": not unexpected, "counts": counts, "cases": [case]}
    return head("hard").document(results, None, complete=True)


def test_hard_cases_of_an_earlier_run_say_so_and_decide_with_the_scenes(tmp_path: Path) -> None:
    file, out = tmp_path / "hard.json", tmp_path / "out"
    # The second report is written over the first.
    for more, status in (([], 0), ([answer("wrong", 0.5, 1e-7)], 1)):
        file.write_text(json.dumps(hard_document(*more)))
        assert main(["report", "-q", str(out), "steer", "--hard", str(file)]) == status
        shown = read_file(out)
        assert "Run by `pointcoord hard`. 1 hard case" in shown.text
        assert shown.verdict[0] == ("verdict disagrees" if status else "verdict agrees")
        assert ("near-a-fold" in shown.verdict[1]) == bool(status)
        reasons = [row[-1][1] for row in shown.of("near-a-fold")]
        assert any("wrong at 1e-07" in text for text in reasons) == bool(status)
        assert not [given for _, given in shown.tags if "onload" in given]
        assert json.loads((out / "results.json").read_text())["exit_status"] == status
        assert json.loads((out / "hard.json").read_text()) == json.loads(file.read_text())


def test_hard_cases_are_drawn_as_errors_over_the_distance() -> None:
    right = [answer("right", 1e-12 / value, value) for value in (1e-2, 1e-3, 1e-5)]
    document = hard_document(*right, answer("wrong", 0.5, 1e-7), answer("refused", None, 1e-9, "absolute"))
    ((words, plot),) = read(Run(head("report"), hard=HardCases(document))).plots
    assert words.startswith("near-a-fold, over ")
    points = {one["name"]: list(zip(one["x"], one["y"], strict=True)) for one in plot["data"]}
    assert points == {
        "pointcoord: right": [(1e-1, 1e-12), (1e-2, 1e-10), (1e-3, 1e-9), (1e-5, 1e-7)],
        "pointcoord: wrong": [(1e-7, 0.5)],
        "absolute: refused": [(1e-9, 1e-13)],  # below the least error
    }
    assert {plot["layout"][name]["type"] for name in ("xaxis", "yaxis")} == {"log"}
    # Plotly reads marks in its labels.
    assert "<" not in json.dumps(plot)


def test_accuracy_against_time_has_a_point_for_each_setting() -> None:
    rows = [
        row
        for k, way in enumerate(WAYS)
        for setting, error, solve in (("a", 10.0**-k, 1e-5), ("b", 10.0 ** (-k - 1), 5e-5))
        for row in made_rows.measured(
            "bounce", way.name, setting, {"position": error}, solve, dense=way.dense
        )
    ]
    rows += made_rows.measured("bounce", f"mine{NASTY}", "a", {"position": 1e-6}, 2e-4)
    shown = read(Run(head("cost"), cost=Report("rows", "pointcoord cost", tuple(rows))))
    ((_, plot),) = shown.by_words.items()
    assert "<" not in json.dumps(plot)
    *ways, mine = plot["data"]
    assert (mine["y"], len(ways)) == ([1e-6], len(WAYS))
    for k, (way, one) in enumerate(zip(WAYS, ways, strict=True)):
        assert one["x"] == pytest.approx([10.0, 50.0])  # us
        assert one["y"] == pytest.approx([10.0**-k, 10.0 ** (-k - 1)])
        assert one["name"] == way.name + "*" * way.dense
        assert one["marker"]["symbol"].endswith("-open") != way.dense
    # Times are neither right nor wrong.
    assert shown.verdict[0] == "verdict measured"
    assert "Exit status 0: nothing compared" in shown.text
    assert shown.of("command")[0][1][1] == "pointcoord cost"


def test_every_printed_number_of_another_program_is_on_the_page_and_a_wrong_one_disagrees() -> None:
    tables = compare_published()
    shown = read(Run(head(), published=tables))
    for one in tables:
        assert one.table.source in shown.text
        text = (Path(validate.published.__file__).parent / f"{one.table.name}.csv").read_text()
        for line in text.splitlines()[1:]:
            at, *numbers = (f"{float(cell) + 0.0:.9g}" for cell in line.split(","))
            rows = [[words for _, words in row[1:]] for row in shown.of(f"{float(at):g}")]
            assert any(all(map(str.startswith, row, numbers)) for row in rows), line
    bump = tables[0]
    wrong = (replace(bump.columns[0].rows[0], share=3.0, verdict="disagrees"), *bump.columns[0].rows[1:])
    columns = (replace(bump.columns[0], rows=wrong), *bump.columns[1:])
    outcomes = (replace(bump.outcomes[0], rows=wrong), *bump.outcomes[1:])
    run = Run(head(), published=(replace(bump, columns=columns, outcomes=outcomes),))
    assert run.status == 1
    assert bump.table.title in run.sentence
    assert ("disagrees", "disagrees") in [(k, t[:9]) for row in read(run).of("verdict") for k, t in row]


def test_the_page_loads_nothing_and_forbids_to_and_takes_names_as_text(bounce: Drawn) -> None:
    name = "<script>alert('x')&lt;.toml"
    title = "</title></script><img src=x onerror=alert(1)>"
    examined = replace(bounce.examined, name=name, title=title)
    text = page(run_of(replace(bounce, examined=examined)), FILES)
    assert "alert('x')" not in text
    shown = Read(text)
    assert any(row[0] == name for row in shown.cells)
    assert title in shown.text
    (policy,) = [given["content"] or "" for tag, given in shown.tags if given.get("http-equiv", "")]
    assert policy.startswith("default-src 'none';")
    assert "http" not in policy
    assert "unsafe-eval" not in policy
    assert len(shown.scripts) == 4  # plotly and three of our own
    hashes = [b64encode(sha256(script.encode()).digest()).decode() for script in shown.scripts]
    assert policy.endswith("script-src " + " ".join(f"'sha256-{one}'" for one in hashes))
    for tag, given in shown.tags:
        assert tag not in ("link", "iframe", "object", "embed", "base", "img")
        assert not {"src", "onerror"} & given.keys()
        assert tag != "a" or (given["href"] or "").startswith("#") or given["href"] in FILES
    ids = [given["id"] for _, given in shown.tags if "id" in given]
    assert len(set(ids)) == len(ids)


def test_a_run_that_is_stopped_leaves_no_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def stopped(*words: object, **more: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("validate.commands.comparison.examine", stopped)
    (tmp_path / "kept").mkdir()
    for folder in (tmp_path / "new" / "report", tmp_path / "kept"):
        with suppress(KeyboardInterrupt):
            assert main(["report", str(folder), "bounce"]) not in (0, 1)
    # A folder that was there stays.
    assert [*tmp_path.rglob("*")] == [tmp_path / "kept"]
