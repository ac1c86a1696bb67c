"""A frozen number or verdict that is another one is named; `.ci/run` compares all that was frozen."""

import importlib
from dataclasses import replace
from pathlib import Path

import pytest

ORACLE = Path(__file__).parent / "oracle"


def test_a_number_and_a_verdict_that_were_others_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ORACLE))
    record, difference = map(importlib.import_module, ("record", "difference"))
    now = record.read_record(ORACLE / "frozen", "scenes").only({"bounce by absolute", "steer"})
    numbers = now.numbers.copy()
    car = (numbers["case"] == "steer") & (numbers["formulation"] == "absolute")
    place = car & (numbers["quantity"] == "position") & (numbers["name"] == "wheel_centre")
    numbers.loc[numbers.index[place][-1], "value"] += 1e-9
    verdict = {**now.facts["bounce by absolute"], "exit status": 3}
    frozen = replace(now, facts={**now.facts, "bounce by absolute": verdict}, numbers=numbers)
    found = difference.compared("scenes", frozen, now)
    told, number = map(str, found.differences)
    assert told.startswith("scenes | bounce by absolute | exit status | frozen 3 | now 0")
    assert number.startswith("scenes | steer | absolute: position wheel_centre.z, instant number ")
    assert str(found).startswith("2 differences in ")
