"""A claim that does not hold is found; that claims hold says `formulations/test_stated_accuracy.py`."""

from counted_study import worked_out

from validate.cars.base_cars import variants
from validate.exit_status import ExitStatus
from validate.output.table import text_of
from validate.studies.claims import claims
from validate.studies.study import Row


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
