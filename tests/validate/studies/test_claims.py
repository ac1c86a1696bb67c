"""What pointcoord claims of every number holds against the reference, up to singular poses."""

import pytest
from counted_study import worked_out

from validate.cars.base_cars import variants
from validate.exit_status import ExitStatus
from validate.output.table import text_of
from validate.studies.claims import claims, scene_rows
from validate.studies.study import Row, Task

# Random scenes, the last one driven up to a fold; those of other models are in formulations/.
NUMBERS = (0, 5, 71)


@pytest.mark.parametrize("number", NUMBERS)
def test_no_number_is_off_by_more_than_is_claimed(number: int) -> None:
    rows = scene_rows(Task("scenes", number), "pointcoord")
    assert {row["kind"] for row in rows} == {"near an end" if number in NUMBERS[2:] else "regular"}
    for row in rows:
        assert row["error"] <= row["claim"], row


def test_a_claim_below_the_error_is_found_and_ends_with_status_1() -> None:
    study = claims(1)
    rows = worked_out(study)
    honest = study.summary(rows)
    assert honest.status == ExitStatus.AGREE
    assert "acceleration" in text_of(honest.parts)
    broken: Row = {"suspension": variants()[0].words, "kind": "regular", "quantity": "velocity"}
    findings = study.summary([*rows, {"number": 7, **broken, "error": 2.0, "claim": 1.0}])
    assert findings.status == ExitStatus.DISAGREE
    assert "7 (regular)" in text_of(findings.parts)
    assert 2.0 in [one["largest_error_over_claim"] for one in findings.data["quantities"]]
