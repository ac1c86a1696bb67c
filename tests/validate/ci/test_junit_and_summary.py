"""Test results as JUnit has them and the summary in Markdown: what they say, and names that stay text."""

import html
import re
from dataclasses import replace
from xml.etree.ElementTree import Element

import numpy as np
import pytest
from junit_schema import checked

from pointcoord import Scene
from validate import Accuracy, Outcome, Solution, compare
from validate.ci import summary as module
from validate.ci.junit import junit
from validate.ci.record import Record
from validate.ci.summary import markdown, summary
from validate.comparison.compare import compare_solutions
from validate.comparison.examined import Examined

SCENE = Scene.load("steer")
RIGHT = compare(SCENE, "pointcoord", "absolute", "steer")
NASTY = "a|b<script>&\"'\x00\x1b[31m\x85\u2028\ufffe\udc80]]>"


def record_of(*scenes: Examined) -> Record:
    record = Record([scene.name for scene in scenes])
    for scene in scenes:
        record.add(scene)
    return record


def document(*outcomes: Outcome, name: str = "steer") -> Element:
    return checked(junit(record_of(Examined(name=name, outcomes=outcomes))))


def cases(root: Element) -> dict[str, Element]:
    return {case.get("name", ""): case for case in root.iter("testcase")}


@pytest.fixture(scope="module")
def wrong() -> Outcome:
    """The comparison with one number of pointcoord off at an instant."""
    one, two = RIGHT.solutions
    numbers = {name: array.copy() for name, array in one.numbers["velocity"].items()}
    numbers["wheel_centre"][17] += 1e-3
    return compare_solutions(SCENE, one.with_numbers({"velocity": numbers}), two, "steer")


def test_every_quantity_is_a_case_that_says_difference_tolerance_and_instant_and_a_wrong_one_the_failure(
    wrong: Outcome,
) -> None:
    root = document(wrong)
    found = cases(root)
    assert len(found) == len(wrong.rows)
    for row in wrong.rows:
        case = found[
            row.name if row.quantity == "wheel" else f"{row.quantity.replace('_', ' ')} of {row.name}"
        ]
        lines = (line.partition(": ") for line in (case.findtext("system-out") or "").splitlines())
        said = {key: value for key, _, value in lines}
        assert said["difference"] == f"{row.difference:.6g} {row.unit}"
        assert said["tolerance"] == f"{row.tolerance:.6g} {row.unit}"
        assert said["instant"] == f"{row.instant:.9g} s"
        assert float(said["difference / tolerance"]) == pytest.approx(row.share, rel=1e-5)
        assert {child.tag for child in case} <= {"system-out", "failure"}
    (row,) = wrong.disagreements
    assert (root.get("failures"), root.get("errors")) == ("1", "0")
    (failure,) = found["velocity of wheel_centre"].iter("failure")
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
    shown = "a|b<script>&\"'\\x00\\x1b[31m\\x85\\u2028\\ufffe\\udc80]]>"
    assert root[0].get("name") == f"{shown}: pointcoord and absolute"
    assert root[0].find("testcase").get("name") == f"position of {shown}"
    (error,) = broken.iter("error")
    assert error.get("message") == f"{shown}: no\\nscene"


def text_of(*scenes: Examined) -> str:
    record = record_of(*scenes)
    return summary(record, record.status)


def test_the_verdict_is_the_first_sentence_and_each_scene_has_a_row_of_quantities(wrong: Outcome) -> None:
    text = text_of(Examined(name="one", outcomes=(RIGHT,)), Examined(name="two", outcomes=(wrong,)))
    lines = html.unescape(text).splitlines()
    assert lines[2].startswith("**Disagree**: 1 of 2 scenes agree; disagrees: two (exit status 1: ")
    head, _, two, one = (
        [cell.strip() for cell in line.strip("|").split(" | ")] for line in lines if line.startswith("|")
    )
    assert head == ["scene", "verdict", "largest share of a tolerance, and where"]
    assert one[:2] == ["one", "agrees"]
    assert re.fullmatch(r"\d+% .* at .* s", one[2])
    assert two[:2] == ["two", "**disagrees**"]
    assert re.fullmatch(r"[\d.,e+]+ times +velocity of wheel_centre at .* s", two[2])
    (said,) = (line for line in lines if line.startswith("- two: "))
    assert "velocity of wheel_centre: difference 0.001 mm/s, tolerance " in said
    assert f" at {SCENE.instants[17]:.9g} s; " in said


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
    written = markdown(text)
    shown = "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)
    assert html.unescape(written) == shown
    bare = re.sub(r"&#\d+;", "", written)
    assert not set(bare) & set("|<>`*~[]!#&\\$@\n+")
    assert "://" not in bare
    assert not re.search(r"(^|\W)_|_(\W|$)", bare)


def test_a_long_run_stays_below_what_a_service_shows() -> None:
    wrong = replace(RIGHT, rows=tuple(replace(row, verdict="disagrees", share=2.0) for row in RIGHT.rows))
    names = [f"a folder of mine/and its name {i}.toml" for i in range(1000)]
    text = text_of(*(Examined(name=name, outcomes=(wrong, wrong)) for name in names))
    assert len(text.encode()) < 2**20
    assert f"and {len(names) - module.ROWS} more scenes: " in text
    assert len(text.splitlines()) < 2 * module.ROWS
