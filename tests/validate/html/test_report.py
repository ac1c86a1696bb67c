"""`pointcoord report`: one page that says what the data beside it say, and takes all text as text."""

import csv
import json
import sys
from base64 import b64encode
from contextlib import suppress
from dataclasses import replace
from hashlib import sha256
from html import unescape
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from page_read import Read
from page_runs import run_of

from pointcoord import Scene, simulate
from validate.cli import main
from validate.comparison.examined import Examined, examine
from validate.html.page import page
from validate.html.plot import fewer
from validate.html.run import Drawn
from validate.html.sections import sections
from validate.output.document import schema_text
from validate.output.report import worst_rows
from validate.paper.scenes import DEFAULT_SCENES
from validate.paper.tables import TABLE_2, TABLE_3

BOUNCE = Path(__file__).parents[3] / "pointcoord" / "scenes" / "bounce.toml"
FILES = {"results.json": "the run", "comparisons.csv": "its lines"}


def told(name: str, scene: Scene, factor: float = 1.0) -> Drawn:
    examined = examine(name, scene, (("pointcoord", "absolute"),), False, factor)
    return Drawn(examined, scene, simulate(scene))


@pytest.fixture(scope="module")
def bounce() -> Drawn:
    return told("bounce", Scene.load("bounce"))


def spoiled(one: Drawn) -> Drawn:
    """The same with one comparison that disagrees."""
    outcome = one.examined.outcomes[0]
    rows = (replace(outcome.rows[0], share=7.0, verdict="disagrees"), *outcome.rows[1:])
    return replace(one, examined=replace(one.examined, outcomes=(replace(outcome, rows=rows),)))


def test_a_scene_called_script_shows_as_text(tmp_path: Path) -> None:
    name = "<script>alert('x')&lt;.toml"
    file = tmp_path / name
    text = BOUNCE.read_text(encoding="utf-8")
    lines = [line for line in text.splitlines() if not line.startswith("title")]
    file.write_text("\n".join(["title = '</title></script><img src=x onerror=alert(1)>'", *lines]))
    assert main(["report", str(tmp_path / "out"), str(file)]) == 0
    read = Read((tmp_path / "out" / "index.html").read_text(encoding="utf-8"))
    assert not [given for _, given in read.tags if "src" in given or "onerror" in given]
    assert [row[0] for row in read.cells if name in row[0]]
    assert "img" not in {tag for tag, _ in read.tags}
    assert len(read.scripts) == 4  # plotly and three of our own
    assert any(cell.startswith("</title></script>") for row in read.cells for cell in row)
    assert "alert('x')" not in (tmp_path / "out" / "index.html").read_text(encoding="utf-8")


def test_the_page_says_of_every_quantity_what_the_data_say(tmp_path: Path) -> None:
    assert main(["report", "-q", str(tmp_path), "steer", "double-wishbone"]) == 0
    document = json.loads((tmp_path / "results.json").read_text())
    jsonschema.validate(document, json.loads(schema_text()))
    rows = [row for scene in document["scenes"] for one in scene["comparisons"] for row in one["rows"]]
    with (tmp_path / "comparisons.csv").open(newline="") as stream:
        lines = list(csv.DictReader(stream))
    assert len(lines) == len(rows) > 100
    for line, row in zip(lines, rows, strict=True):
        assert (line["scene"], line["name"], line["verdict"]) == (row["scene"], row["name"], row["verdict"])
        assert float(line["difference"]) == row["difference"]
    read = Read((tmp_path / "index.html").read_text(encoding="utf-8"))
    assert read.verdict[1] == "2 of 2 scenes agree."
    shown = [row for row in read.cells if len(row) > 3 and row[1].endswith(" and absolute")]
    assert len(shown) == 4
    for row in shown:
        assert all(cell.startswith(("agrees", "not asked for")) for cell in row[2:])


def test_one_disagreement_is_in_the_sentence_in_a_colour_and_in_a_word(bounce: Drawn) -> None:
    run = run_of(spoiled(bounce), replace(bounce, examined=replace(bounce.examined, name="other")))
    read = Read(page(run, FILES))
    assert read.verdict[1] == run.sentence == "1 of 2 scenes agree; disagrees: bounce."
    coloured = [given for tag, given in read.tags if tag == "td" and given.get("class") == "disagrees"]
    # The quantity's own cell, and that of the scene.
    assert len(coloured) == 2
    assert sum(cell.startswith("disagrees") for row in read.cells for cell in row) == 2
    assert run.document["verdict"] == "disagree"


def test_a_scene_that_cannot_be_read_is_no_agreement() -> None:
    run = run_of(Drawn(Examined(name="no such", problem="no such: is no scene"), None))
    read = Read(page(run, FILES))
    assert read.verdict[1] == "0 of 1 scene agrees; not tested (wrong input): no such."
    assert run.status == 2


def test_a_wider_tolerance_is_said_in_the_verdict(bounce: Drawn) -> None:
    assert "2.0 times" in run_of(bounce, factor=2.0).sentence
    assert "times" not in run_of(bounce).sentence


def test_the_page_loads_nothing_and_forbids_to(bounce: Drawn) -> None:
    read = Read(page(run_of(bounce), FILES))
    policies = [
        given["content"] or "" for tag, given in read.tags if given.get("http-equiv", "") and tag == "meta"
    ]
    assert len(policies) == 1
    assert policies[0].startswith("default-src 'none';")
    assert "http" not in policies[0]
    hashes = [b64encode(sha256(script.encode()).digest()).decode() for script in read.scripts]
    assert policies[0].endswith("script-src " + " ".join(f"'sha256-{one}'" for one in hashes))
    assert "unsafe-eval" not in policies[0]
    for tag, given in read.tags:
        assert tag not in ("link", "iframe", "object", "embed", "base")
        assert "src" not in given
        assert tag != "a" or (given["href"] or "").startswith("#") or given["href"] in FILES


def test_every_section_has_a_name_of_its_own_and_a_heading(bounce: Drawn) -> None:
    read = Read(page(run_of(bounce), FILES))
    ids = [given["id"] for _, given in read.tags if "id" in given]
    assert len(set(ids)) == len(ids)
    assert {section.name for section in sections() if section.blocks(run_of(bounce))} <= set(ids)
    assert len({section.place for section in sections()}) == len(sections())


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([""], "names no folder"),
        (["FILE", "steer"], "is a file; allowed: a folder"),
        (["FOREIGN", "steer"], "is no report of this program"),
        (["NEW", "-", "-"], "more than once"),
    ],
)
def test_what_cannot_be_done_is_said_in_a_line_and_nothing_is_touched(
    words: list[str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "FILE").write_text("mine")
    (tmp_path / "FOREIGN").mkdir()
    (tmp_path / "FOREIGN" / "index.html").write_text("<p>mine</p>")
    first = str(tmp_path / words[0]) if words[0] else ""
    assert main(["report", first, *words[1:]]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert len(error.splitlines()) == 1
    assert (tmp_path / "FILE").read_text() == "mine"
    assert [file.name for file in (tmp_path / "FOREIGN").iterdir()] == ["index.html"]
    assert not (tmp_path / "NEW").exists()


def test_a_report_is_written_again_over_its_own(tmp_path: Path) -> None:
    assert main(["report", "-q", str(tmp_path), "steer"]) == 0
    assert main(["report", "-q", str(tmp_path), "bounce"]) == 0
    assert "steer" not in (tmp_path / "comparisons.csv").read_text()


def test_without_its_packages_the_extra_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "jinja2", None)
    assert main(["report", str(tmp_path / "out"), "steer"]) == 2
    assert "pip install 'pointcoord[report]'" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_plot_of_differences_shows_the_largest_share_of_the_table(bounce: Drawn) -> None:
    run = run_of(bounce)
    shown = [(words, one) for words, one in Read(page(run, FILES)).plots if "of its tolerance" in words]
    worst = worst_rows(bounce.examined.outcomes[0])
    assert len(shown) == len(worst) > 5
    for row, (_, one) in zip(worst, shown, strict=True):
        held, gap = (np.array(trace["y"], dtype=float) for trace in one["data"])
        assert np.nanmax(gap / held) == pytest.approx(row.share, rel=2e-3, abs=1e-300)
        assert one["layout"]["yaxis"]["type"] == "log"
        assert row.unit in one["layout"]["yaxis"]["title"]["text"]


def test_travel_of_the_wheel_goes_upward_and_both_models_are_on_the_curve(bounce: Drawn) -> None:
    shown = [(w, one) for w, one in Read(page(run_of(bounce), FILES)).plots if w.startswith("wheel travel")]
    assert len(shown) >= 2
    for _, one in shown:
        line, dots = one["data"]
        assert set(zip(dots["x"], dots["y"], strict=True)) <= set(zip(line["x"], line["y"], strict=True))
        assert max(line["y"]) - min(line["y"]) > 10.0


def test_of_very_many_instants_the_worst_is_drawn() -> None:
    weight = np.zeros(100_000)
    weight[[123, 77_777]] = 1.0, 2.0
    places = fewer(weight, 600)
    assert len(places) <= 600
    assert {0, 123, 77_777, 99_999} <= set(places)


@pytest.fixture(scope="module")
def built_in(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The report of all built-in scenes."""
    folder = tmp_path_factory.mktemp("report")
    assert main(["report", "-q", str(folder)]) == 0
    return folder


def test_a_page_of_all_built_in_scenes_is_below_eight_megabytes(built_in: Path) -> None:
    assert 4e6 < (built_in / "index.html").stat().st_size < 8e6


def test_every_printed_row_of_the_paper_is_on_the_page_beside_ours(built_in: Path) -> None:
    read = Read((built_in / "index.html").read_text(encoding="utf-8"))
    shown = [one for words, one in read.plots if words == "wheel centre, z, over time"]
    assert len(shown) == 2
    for one, table in zip(shown, (TABLE_2, TABLE_3), strict=True):
        printed, computed = one["data"]
        assert list(zip(printed["x"], printed["y"], strict=True)) == [
            (row.time, row.wheel_centre[2]) for row in table
        ]
        assert len(computed["y"]) == len(table)
        assert computed["y"] != printed["y"]


def test_the_errata_are_those_of_the_data_each_with_its_number(built_in: Path) -> None:
    read = Read((built_in / "index.html").read_text(encoding="utf-8"))
    wrong = json.loads((built_in / "results.json").read_text())["printed_formulas"]
    assert wrong
    for finding in wrong:
        line = [row for row in read.cells if row[0] == finding["scene"] and row[-1] == finding["erratum"]]
        size, unit = finding["worst"]["difference"], finding["worst"]["unit"]
        number = "not a number" if size is None else f"{size:.1e} {unit}"
        assert any(row[2].startswith(number) for row in line), finding


def test_the_drawing_that_moves_has_the_places_of_both_models_and_those_drawn(bounce: Drawn) -> None:
    read = Read(page(run_of(bounce), FILES))
    (shown,) = read.motions
    first, second = bounce.examined.outcomes[0].solutions
    for solution, model in zip((first, second), shown["models"], strict=True):
        assert model["name"] == solution.formulation
        for name, places in solution.position.items():
            i = shown["points"].index(name)
            got = np.array([frame[i] for frame in model["frames"]])
            at = [int(np.argmin(np.abs(solution.times - time))) for time in shown["times"]]
            assert np.abs(got - places[at]).max() < 0.006
    drawn = dict(zip(shown["points"], shown["drawn"], strict=True))
    scene = bounce.scene
    assert scene is not None
    for name, place in scene.mechanism.points.items():
        assert drawn[name] == pytest.approx(list(place), abs=0.006)
    assert {shown["points"][i] for i in shown["chassis"]} == set(scene.mechanism.topology.chassis)


def test_a_report_of_all_that_is_built_in_has_every_section_and_the_data_that_it_names(
    built_in: Path,
) -> None:
    read = Read((built_in / "index.html").read_text(encoding="utf-8"))
    there = [given["id"] for tag, given in read.tags if tag == "section"]
    opening = ["verdict", "agreement", "motion", "cost"]
    details = ["scenes", "differences", "paper", "hard", "published", "left-out", "machine"]
    assert there == [*opening, *details]
    assert [section.name for section in sections() if section.folded] == details
    # That of a file of results has nothing to say here.
    assert there == [section.name for section in sections() if section.name != "file"]
    links = [given["href"] or "" for tag, given in read.tags if tag == "a"]
    files = {link for link in links if not link.startswith("#")}
    assert files == {file.name for file in built_in.iterdir()} - {"index.html"}
    document = json.loads((built_in / "results.json").read_text())
    jsonschema.validate(document, json.loads(schema_text()))
    jsonschema.validate(json.loads((built_in / "hard.json").read_text()), json.loads(schema_text()))
    assert document["exit_status"] == 0
    assert read.verdict[1].startswith(f"{len(DEFAULT_SCENES)} of {len(DEFAULT_SCENES)} scenes agree; ")
    assert read.verdict[1].endswith("all as expected.")
    text = (built_in / "index.html").read_text(encoding="utf-8")
    for name in DEFAULT_SCENES:
        assert f">{Scene.load(name).title}</td>" in unescape(text)
    # A line for each printed number: 11 rows of 4 angles, 21 of 2.
    with (built_in / "published.csv").open(newline="") as stream:
        assert len(list(csv.DictReader(stream))) == 11 * (5 + 5) + 21 * 6 + 10 + (11 + 17) * 3


def test_how_far_each_point_moves_until_the_drawing_closes_is_on_the_page(bounce: Drawn) -> None:
    closing = bounce.examined.closing
    assert closing is not None
    read = Read(page(run_of(bounce), FILES))
    (shown,) = read.motions
    drawn, closed = (dict(zip(shown["points"], shown[key], strict=True)) for key in ("drawn", "closed"))
    rows = [row for row in read.cells if row[0] == "bounce"]
    assert closing["largest"] == pytest.approx(16.8, abs=0.05)  # of Table 1
    for name, movement in closing["movements"].items():
        moved = np.linalg.norm(np.subtract(closed[name], drawn[name]))
        assert moved == pytest.approx(movement, abs=0.02)
        told = f"{movement:.3g}" if movement > 1e-6 else "rounding"
        assert any(told in row for row in rows)


def test_a_run_that_is_stopped_leaves_no_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def stopped(*words: object, **more: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("validate.commands.comparison.examine", stopped)
    kept = tmp_path / "kept"
    kept.mkdir()
    for folder in (tmp_path / "new" / "report", kept):
        with suppress(KeyboardInterrupt):
            assert main(["report", str(folder), "bounce"]) not in (0, 1)
    # What was there before stays.
    assert [one.name for one in tmp_path.iterdir()] == ["kept"]
