"""One file for all models means one wrong file for all: closed forms and printed tables notice it.

A fault is planted in the tables of a shipped file. It is refused, as a mechanism or by the reference, or the
poses that this finds are far from what is right.
"""

from pathlib import Path

import pytest
from changed_scenes import change
from mechanism_checks import PRINTED, closed_form_check
from mechanism_files import MECHANISMS, Tables

from pointcoord.mechanism.faults import TableFault
from validate.reference import NoReferenceError

LINES = Path(__file__).with_name("faults.txt").read_text(encoding="utf-8").splitlines()
FAULTS = [line.split(" | ") for line in LINES if line[0] != "#"]


@pytest.mark.parametrize(("mechanism", "what", "changes", "held_to", "notice"), FAULTS)
def test_a_fault_in_a_mechanism_file_is_noticed(
    mechanism: str, what: str, changes: str, held_to: str, notice: str
) -> None:
    check = PRINTED[mechanism]() if held_to == "printed" else closed_form_check(held_to)
    assert check.type == mechanism

    def plant(tables: Tables, drawing: Tables) -> None:
        change({**tables, "drawing": drawing}, changes)

    quantity, _, least = notice.rpartition(" ")
    if quantity in check.limits:
        found = check.deviations_of(check.plain(plant))
        assert found[quantity] > max(float(least), 10 * check.limits[quantity])
    else:
        with pytest.raises((TableFault, NoReferenceError), match=notice):
            check.deviations_of(check.plain(plant))


def test_faults_are_planted_in_every_shipped_mechanism() -> None:
    assert {mechanism for mechanism, *_ in FAULTS} == set(MECHANISMS)


def test_a_rod_that_is_written_twice_changes_nothing() -> None:
    check = closed_form_check("hmmwv-front")
    twice = check.plain(lambda tables, _: tables["rods"].update(twice=tables["rods"]["tie_rod"][:]))
    assert check.deviations_of(twice)["position"] <= check.limits["position"]
