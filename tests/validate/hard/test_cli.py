"""`pointcoord hard` as its users meet it: text, JSON, exit status, and one line for every mistake."""

from dataclasses import replace
from pathlib import Path

import pytest
from made_cases import made_case
from program import document

from validate.cli import main
from validate.hard import catalogue
from validate.hard.answer import Answer


def test_json_goes_alone_to_standard_output_and_holds_every_trial(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (at_rest,) = catalogue.chosen(["at-rest"])
    monkeypatch.setattr(catalogue, "CASES", (replace(at_rest, values=(1e-1, 1e-6, 0.0)),))
    assert main(["hard", "at-rest", "--json", "-"]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    data = document(out)
    assert (data["kind"], data["verdict"], data["as_expected"]) == ("hard", "agree", True)
    (case,) = data["cases"]
    assert case["name"] == "at-rest"
    assert len(case["trials"]) == len(case["values"]) == 3
    # The map is tried at two of the values.
    answers = [[answer["formulation"] for answer in trial["answers"]] for trial in case["trials"]]
    assert [len(each) - ("pointcoord-map" in each) for each in answers] == [4] * 3
    assert sum("pointcoord-map" in each for each in answers) == 2
    assert data["counts"]["absolute"] == {"right": 3}


def test_a_wrong_number_without_a_warning_ends_with_1_and_the_page_holds_the_cases(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    cases = [
        made_case({1.0: Answer(of, "wrong", "far off")}, name=name, of=of)
        for name, of in (("ours-fails", "pointcoord"), ("quiet", "absolute"))
    ]
    monkeypatch.setattr(catalogue, "CASES", cases)
    assert main(["hard", "--report", str(tmp_path / "page")]) == 1
    out, _ = capsys.readouterr()
    assert "NOT AS EXPECTED: pointcoord is wrong at 1: far off" in out
    assert "NOT as expected: 2 answers, 2 wrong without a warning, in ours-fails, quiet." in out
    assert out.count("== 0. Made") == 1
    data = document(tmp_path / "page" / "results.json")
    assert [case["name"] for case in data["cases"]] == ["ours-fails", "quiet"]
    page = (tmp_path / "page" / "index.html").read_text()
    assert "2 hard cases compared with the many-digit reference: disagrees" in page
    assert main(["hard", "--list", "--report", str(tmp_path / "other")]) == 2


def test_the_list_is_json_as_well(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["hard", "--list", "--json", "-"]) == 0
    data = document(capsys.readouterr().out)
    assert (data["kind"], data["verdict"]) == ("hard-list", "nothing compared")
    listed = data["cases"]
    assert [case["name"] for case in listed] == [case.name for case in catalogue.CASES]
    assert all(case["why"] and case["values"] and case["expected"] for case in listed)
    assert main(["hard", "at-rest", "--list"]) == 0
    assert "  at-rest: " in capsys.readouterr().out


def test_an_interrupted_run_leaves_the_cases_that_are_finished(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    right = {1.0: Answer("absolute", "right")}
    cases = [made_case(right, name=f"done-{i}") for i in range(3)]
    monkeypatch.setattr(catalogue, "CASES", [*cases, made_case({1.0: KeyboardInterrupt()}, name="stop")])
    target = tmp_path / "hard.json"
    assert main(["hard", "--json", str(target)]) == 130
    (line,) = capsys.readouterr().err.splitlines()
    assert line == f"pointcoord: interrupted; {target} holds 3 of 4 cases"
    data = document(target)
    assert (data["complete"], data["exit_status"]) == (False, 130)
    assert [one["name"] for one in data["cases"]] == ["done-0", "done-1", "done-2"]
