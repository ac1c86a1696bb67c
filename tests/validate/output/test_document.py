"""The JSON of every command keeps to the JSON Schema that is shipped, and says where it comes from."""

import json
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest
from counted_study import worked_out
from program import document

from validate.cli import main
from validate.commands.schema import schema_text
from validate.exit_status import ExitStatus
from validate.output.console import Console
from validate.output.document import SCHEMA_VERSION, Head, Journal, json_text
from validate.studies.bounds import bounds
from validate.studies.hard_cases import hard
from validate.studies.random_cars import random_cars
from validate.studies.study import Study

SCHEMA = json.loads(schema_text())


def test_the_schema_is_one_and_is_printed(capsys: pytest.CaptureFixture[str]) -> None:
    jsonschema.Draft202012Validator.check_schema(SCHEMA)
    assert main(["--schema"]) == 0
    assert json.loads(capsys.readouterr().out) == SCHEMA
    assert SCHEMA["properties"]["schema_version"]["const"] == SCHEMA_VERSION
    assert set(SCHEMA["$defs"]["status"]["enum"]) == set(ExitStatus)
    assert set(SCHEMA["$defs"]["verdict"]["enum"]) == {
        "nothing compared",
        *(status.verdict for status in ExitStatus),
    }


def test_a_document_says_what_was_run_where_and_when(capsys: pytest.CaptureFixture[str]) -> None:
    before = datetime.now(UTC).replace(microsecond=0)
    words = ["validate", "steer", "--timings", "--json", "-", "--quiet"]
    assert main(words) == 0
    out, err = capsys.readouterr()
    data = document(out)
    assert err == ""
    assert (data["schema_version"], data["kind"], data["complete"]) == (SCHEMA_VERSION, "validate", True)
    assert (data["exit_status"], data["verdict"]) == (0, "agree")
    assert data["program"] == {"name": "pointcoord", "version": metadata.version("pointcoord")}
    assert data["command"] == ["pointcoord", *words]
    assert data["command_line"] == " ".join(data["command"])
    assert before <= datetime.fromisoformat(data["started"]) <= datetime.fromisoformat(data["written"])
    packages = data["machine"]["packages"]
    assert (packages["numpy"], packages["pin"]) == (np.__version__, metadata.version("pin"))
    assert "OMP_NUM_THREADS" in data["machine"]["threads"]
    # The steering scene's printed omega is 0/0: JSON has no such number.
    assert data["printed_formulas"][0]["worst"]["difference"] is None


def test_numbers_that_do_not_exist_and_bytes_that_are_no_text_have_a_place_in_json() -> None:
    text = json_text({"a": [float("nan"), float("inf"), 1.0], "b": ({"c": -float("inf")},), "d": "\udcff"})
    assert "NaN" not in text
    assert "Infinity" not in text
    assert json.loads(text) == {"a": [None, None, 1.0], "b": [{"c": None}], "d": "\\udcff"}


@pytest.mark.parametrize("study", [random_cars(1), bounds(1), hard(["link-twice"])], ids=lambda one: one.name)
def test_what_studies_find_keeps_to_the_schema(study: Study) -> None:
    findings = study.summary(worked_out(study))
    text = json_text(Head.of(study.name, ("pointcoord",)).document(findings.data, findings.status, True))
    assert document(text)["kind"] == study.name


def test_writing_on_the_way_takes_a_small_part_of_the_time(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A clock that each writing moves by 1 s and each part by 0.5 s: of 100 parts some 8 are written."""
    clock = [0.0]
    monkeypatch.setattr("validate.output.document.time.monotonic", lambda: clock[0])
    target = tmp_path / "x.json"
    written = []

    def results() -> dict[str, Any]:
        written.append(clock[0])
        clock[0] += 1.0
        return {"cases": []}

    head = Head.of("hard-list", ["pointcoord"])
    with Journal(str(target), head, Console(), results, lambda: "some") as journal:
        for _ in range(100):
            clock[0] += 0.5
            journal.keep()
        assert document(target)["complete"] is False
    assert written[0] == 0.5
    assert len(written) <= 0.1 * clock[0] + 2
    assert max(np.diff(written)) <= 11.0
    assert document(target)["complete"] is True
