"""Test results as JUnit has them and the summary in Markdown: what they say, and names that stay text."""

import html
import json
import re
from dataclasses import replace
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np
import pytest
from junit_schema import checked
from program import PAST_ITS_END, short_scene

from pointcoord import Scene
from validate import Accuracy, Outcome, Solution, compare
from validate.ci import summary as module
from validate.ci.junit import junit
from validate.ci.record import Record
from validate.ci.summary import markdown, summary
from validate.cli import main
from validate.comparison.compare import compare_solutions
from validate.comparison.examined import Examined

SCENE = Scene.load("steer")
RIGHT = compare(SCENE, "pointcoord", "absolute", "steer")
ROWS = {(row.quantity, row.name): row for row in RIGHT.rows}
NASTY = "a|b<script>&\"'\x00\x1b[31m\x85\u2028\ufffe\udc80]]>"


def planted(quantity: str, name: str, error: float, instant: int) -> Outcome:
    """The comparison again, one number of pointcoord off by an error at an instant."""
    one, two = RIGHT.solutions
    numbers = {name: array.copy() for name, array in one.numbers[quantity].items()}
    numbers[name][instant] += error
    return compare_solutions(SCENE, one.with_numbers({quantity: numbers}), two, "steer")


def record_of(*scenes: Examined) -> Record:
    record = Record([scene.name for scene in scenes])
    for scene in scenes:
        record.add(scene)
    return record


def document(*outcomes: Outcome, name: str = "steer") -> Element:
    return checked(junit(record_of(Examined(name=name, outcomes=outcomes))))


def cases(root: Element) -> dict[str, Element]:
    return {case.get("name", ""): case for case in root.iter("testcase")}


def lines(case: Element) -> dict[str, str]:
    pairs = (line.partition(": ") for line in (case.findtext("system-out") or "").splitlines())
    return {key: value for key, _, value in pairs}


def test_every_scene_and_quantity_is_a_case_that_says_difference_tolerance_and_instant() -> None:
    found = cases(document(RIGHT))
    assert len(found) == len(RIGHT.rows)
    for (quantity, name), row in ROWS.items():
        case = found[name if quantity == "wheel" else f"{quantity.replace('_', ' ')} of {name}"]
        said = lines(case)
        assert said["difference"] == f"{row.difference:.6g} {row.unit}"
        assert said["tolerance"] == f"{row.tolerance:.6g} {row.unit}"
        assert said["instant"] == f"{row.instant:.9g} s"
        assert float(said["difference / tolerance"]) == pytest.approx(row.share, rel=1e-5)
        assert not {child.tag for child in case} - {"system-out"}


def test_a_planted_disagreement_is_the_one_failure_with_its_size_and_its_instant() -> None:
    outcome = planted("velocity", "wheel_centre", 1e-3, 17)
    (row,), root = outcome.disagreements, document(outcome)
    assert (root.get("failures"), root.get("errors")) == ("1", "0")
    (failure,) = cases(root)["velocity of wheel_centre"].iter("failure")
    assert failure.get("type") == "disagrees"
    assert failure.get("message", "").endswith(
        f"velocity of wheel_centre: difference 0.001 mm/s, tolerance {row.tolerance:.3g} mm/s at "
        f"{SCENE.instants[17]:.9g} s; at most {row.share:.1e} times its tolerance"
    )


def test_what_is_not_given_or_not_tested_is_skipped_with_the_reason() -> None:
    one, two = RIGHT.solutions
    gives = {name: two.numbers[name] for name in ("velocity", "acceleration")}
    gives["position"] = {"wheel_centre": two.numbers["position"]["wheel_centre"]}
    claims = {name: of for name, of in two.accuracy.claims.items() if name != "acceleration"}
    claims["velocity"] = {name: np.ones(claim.shape) for name, claim in claims["velocity"].items()}
    mine = Solution("mine", two.times, gives, Accuracy(two.accuracy.condition, claims))
    found = cases(document(compare_solutions(SCENE, one, mine, "steer")))
    for name, said in (
        ("position of wheel_centre", ""),
        ("position of strut_top", "not given: mine gives no position of lower_arm_front, "),
        ("camber", "not given: mine gives no wheel angle"),
        ("velocity of wheel_centre", "not tested: the tolerance is limited by the error bound of mine; "),
        ("acceleration of wheel_centre", "not tested: mine: acceleration of wheel_centre: its accuracy "),
    ):
        child, *_ = found[name]
        assert (child.get("message") or "").startswith(said), name
        assert child.tag == ("skipped" if said else "system-out"), name


def test_names_and_messages_stay_text_whatever_is_in_them() -> None:
    row = replace(RIGHT.rows[0], name=NASTY, verdict="disagrees", second=NASTY)
    root = document(replace(RIGHT, rows=(row,)), name=NASTY)
    broken = checked(junit(record_of(Examined(name=NASTY, problem=f"{NASTY}: no\nscene"))))
    told = "a|b<script>&\"'\\x00\\x1b[31m\\x85\\u2028\\ufffe\\udc80]]>"
    assert root[0].get("name") == f"{told}: pointcoord and absolute"
    assert root[0].find("testcase").get("name") == f"position of {told}"
    (error,) = broken.iter("error")
    assert error.get("message") == f"{told}: no\\nscene"


def test_a_scene_that_is_refused_or_cannot_be_read_is_an_error_and_the_others_go_on(tmp_path: Path) -> None:
    good, bad = short_scene(tmp_path, "good.toml"), short_scene(tmp_path, "bad.toml", samples="0")
    past = short_scene(tmp_path, "past.toml", samples="27", **PAST_ITS_END)
    target, data = tmp_path / "out.xml", tmp_path / "out.json"
    words = ["validate", past, bad, good, "--second", "absolute", "-q"]
    assert main([*words, "--junit", str(target), "--json", str(data)]) == 2
    suites = {suite.get("name", ""): [*suite.iter("error")] for suite in checked(target.read_bytes())}
    assert {*suites} == {past, bad, f"{good}: pointcoord and absolute"}
    assert [error.get("type") for error in suites[past]] == ["AssemblyError", "PoseError"]
    refusals = json.loads(data.read_text())["scenes"][0]["refusals"]
    assert [error.get("message") for error in suites[past]] == [one["message"] for one in refusals]
    (error,) = suites[bad]
    assert error.get("type") == "SceneError"
    assert "samples" in error.get("message", "")
    assert suites[f"{good}: pointcoord and absolute"] == []


def text_of(*scenes: Examined) -> str:
    record = record_of(*scenes)
    return summary(record, record.status)


def table(text: str) -> list[dict[str, str]]:
    """The first table, by the names of its columns."""
    rows = [line for line in text.splitlines() if line.startswith("|")]
    cells = [[cell.strip() for cell in row.strip("|").split(" | ")] for row in rows]
    return [dict(zip(cells[0], row, strict=True)) for row in cells[2:]]


def test_the_verdict_is_the_first_sentence_and_each_scene_has_a_row_of_quantities() -> None:
    text = text_of(
        Examined(name="one", outcomes=(RIGHT,)),
        Examined(name="two", outcomes=(planted("velocity", "wheel_centre", 1e-3, 17),)),
    )
    lines = text.splitlines()
    assert lines[2].startswith("**Disagree**: 1 of 2 scenes agree; disagrees: two (exit status 1: ")
    two, one = table(text)
    told = "largest share of a tolerance, and where"
    assert (one["scene"], one["verdict"]) == ("one", "agrees")
    assert re.fullmatch(r"\d+% .* at .* s", html.unescape(one[told]))
    assert (two["scene"], two["verdict"]) == ("two", "**disagrees**")
    assert re.fullmatch(r"[\d.,e+]+ times +velocity of wheel_centre at .* s", html.unescape(two[told]))
    (told,) = (line for line in lines if line.startswith("- two: "))
    assert "velocity of wheel_centre: difference 0.001 mm/s, tolerance " in html.unescape(told)
    assert f" at {SCENE.instants[17]:.9g} s; " in html.unescape(told)


@pytest.mark.parametrize(
    "text",
    [
        "a|b<script>",
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
    assert f"and {len(scenes) - module.ROWS} more scenes: " in text
    assert len(text.splitlines()) < 2 * module.ROWS
