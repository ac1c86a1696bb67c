"""The summary in Markdown: what it says, and that nothing in it acts."""

import html
import re
from dataclasses import replace

import pytest

from pointcoord import Scene
from validate import Outcome, compare
from validate.ci import summary as module
from validate.ci.record import Record
from validate.ci.summary import markdown, summary
from validate.comparison.compare import compare_solutions
from validate.comparison.examined import Examined

SCENE = Scene.load("steer")
RIGHT = compare(SCENE, "pointcoord", "absolute", "steer")
NASTY = "a|b<script>"


def planted(error: float) -> Outcome:
    """The comparison again, the speed of the wheel centre off at the instant number 17."""
    one, two = RIGHT.solutions
    numbers = {name: array.copy() for name, array in one.numbers["velocity"].items()}
    numbers["wheel_centre"][17] += error
    return compare_solutions(SCENE, one.with_numbers({"velocity": numbers}), two, "steer")


def text_of(*scenes: Examined, more: tuple[str, ...] = ()) -> str:
    record = Record([*(scene.name for scene in scenes), *more])
    for scene in scenes:
        record.add(scene, None)
    return summary(record, record.status)


def table(text: str) -> list[dict[str, str]]:
    """The first table, by the names of its columns."""
    rows = [line for line in text.splitlines() if line.startswith("|")]
    cells = [[cell.strip() for cell in row.strip("|").split(" | ")] for row in rows]
    return [dict(zip(cells[0], row, strict=True)) for row in cells[2:]]


def test_the_verdict_is_the_first_sentence_and_each_scene_has_a_row_of_quantities() -> None:
    text = text_of(Examined(name="one", outcomes=(RIGHT,)), Examined(name="two", outcomes=(planted(1e-3),)))
    lines = text.splitlines()
    assert lines[2].startswith("**Disagree**: 1 of 2 scenes agree; disagrees: two (exit status 1: ")
    one, two = table(text)
    quantities = {"position", "velocity", "acceleration", "angular velocity", "wheel angle"}
    assert quantities <= one.keys()
    assert {one[quantity] for quantity in quantities} == {"agrees"}
    assert {two[quantity] for quantity in quantities - {"velocity"}} == {"agrees"}
    assert re.fullmatch(r"\*\*disagrees, \d.\de&#43;\d\d times its tolerance\*\*", two["velocity"])
    (told,) = (line for line in lines if line.startswith("- two: "))
    assert "velocity of wheel_centre: difference 0.001 mm/s, tolerance " in html.unescape(told)
    assert f" at {SCENE.instants[17]:.9g} s; " in html.unescape(told)


@pytest.mark.parametrize(
    "text",
    [
        NASTY,
        "`x` *y* __z__ ~~w~~ [a](b) ![c](d) <!-- e --> &lt; \\| # $m$ :tada: @someone",
        "- 1. not a list",
        "1. <img src=x onerror=alert(1)>",
        "https://example.org www.example.org",
        "_under_ wheel_centre_",
        "new\nline | row \x00 \u202e",
    ],
)
def test_nothing_in_a_name_acts_and_all_of_it_is_shown(text: str) -> None:
    told = markdown(text)
    shown = "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)
    assert html.unescape(told) == shown
    bare = re.sub(r"&#\d+;", "", told)
    assert not set(bare) & set("|<>`*~[]!#&\\$@\n+")
    assert "://" not in bare
    assert not re.search(r"(^|\W)_|_(\W|$)", bare)


def test_a_long_run_stays_below_what_a_service_shows(monkeypatch: pytest.MonkeyPatch) -> None:
    wrong = replace(RIGHT, rows=tuple(replace(row, verdict="disagrees", share=2.0) for row in RIGHT.rows))
    scenes = [
        Examined(name=f"a folder of mine/and its name {i}.toml", outcomes=(wrong, wrong)) for i in range(1000)
    ]
    text = text_of(*scenes)
    assert len(text.encode()) < 2**20
    rows = 2 * len(scenes)
    assert f"and {rows - module.ROWS} rows more: " in text
    assert len(text.splitlines()) < 2 * module.ROWS
