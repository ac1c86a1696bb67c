"""Files as spreadsheets and loggers leave them: read as they are meant, and what is left out is told."""

from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest

import pointcoord
from pointcoord import Scene
from validate.ci.junit import junit
from validate.ci.record import Record
from validate.comparison.examined import Examined
from validate.exit_status import ExitStatus
from validate.measured.comparing import DataOutcome, compare_results
from validate.measured.mapping import read_results
from validate.tables.errors import FileError

CAR = Scene.load("double-wishbone")
TIDY = "rack [mm],camber [deg]\n-5.0,0.3\n0.0,0.0\n5.0,-0.4\n"


def read(folder: Path, data: bytes, map: str = "") -> Any:
    file = folder / "mine.csv"
    file.write_bytes(data)
    (folder / "map.toml").write_text(map)
    return read_results(str(file), str(folder / "map.toml") if map else None, CAR)


@pytest.mark.parametrize(
    "data",
    [
        "\ufeffrack;camber\r\nmm;deg\r\n-5,0;0,3\r\n0,0;0,0\r\n5,0;-0,4\r\n".encode(),
        TIDY.replace("rack", "Rack").replace("camber", "Camber").encode(),
        b",rack [mm],camber [deg]\n0,-5.0,0.3\n1,0.0,0.0\n2,5.0,-0.4\n",
        b"rack [mm],,camber [deg],\n-5.0,,0.3,\n0.0,,0.0,\n5.0,,-0.4,\n",
        b"rack [mm],who,camber [deg]\n-5.0,rig,0.3\n0.0,rig,0.0\n5.0,me,-0.4\n",
        TIDY.encode("utf-16"),
    ],
    ids=["european", "capitals", "index", "blank columns", "words", "utf-16"],
)
def test_the_same_table_is_read_from_any_of_its_ways_to_be_written(data: bytes, tmp_path: Path) -> None:
    found = read(tmp_path, data)
    (rack,), (camber,) = found.independent, found.numbers
    assert rack.values.tolist() == [-5.0, 0.0, 5.0]
    assert np.degrees(camber.values) == pytest.approx([0.3, 0.0, -0.4])
    # To the last digit as written.
    assert np.degrees(camber.off) == pytest.approx([0.05] * 3)
    assert any("ignored: who" in note for note in found.notes) == (b"who" in data)


def test_a_column_of_words_that_a_map_wants_is_refused_with_what_it_holds(tmp_path: Path) -> None:
    data = b"rack [mm],toe,camber [deg]\n0,rig,0\n5,rig,1\n"
    map = 'columns.rack = {}\ncolumns.camber = {}\ncolumns.toe = { unit = "deg" }\n'
    with pytest.raises(FileError, match=r"'toe': holds 'rig' and the like; allowed: columns of numbers"):
        read(tmp_path, data, map)
    assert len(read(tmp_path, data, map.replace('unit = "deg"', 'is = "ignore"')).numbers) == 1


def compared(folder: Path, text: str) -> DataOutcome:
    return compare_results(read(folder, text.encode()), CAR, "car")


def test_a_file_of_which_most_rows_cannot_be_compared_has_no_verdict_and_says_what_would_reach_them(
    tmp_path: Path,
) -> None:
    """Milliseconds titled [s]: all but t = 0 are outside the scene's time, and t = 0 agrees with anything."""
    camber = pointcoord.simulate(CAR).wheel["camber"]
    rows = zip(1000.0 * CAR.instants, np.degrees(camber), strict=True)
    found = compared(tmp_path, "time [s],camber [deg]\n" + "".join(f"{t:.3f},{c:.4f}\n" for t, c in rows))
    count = len(CAR.instants)
    assert [row.verdict for row in found.outcome.rows] == ["not tested"]
    (fault,) = found.outcome.faults
    assert fault.startswith(f"only 1 of {count} rows that hold numbers can be compared")
    assert fault.endswith("nearly all can if time is in ms, not in s")
    record = Record(["car"])
    record.add(Examined("car", outcomes=(found.outcome,), solved=("pointcoord",)), None)
    assert record.status is ExitStatus.NO_VERDICT
    suite = ElementTree.fromstring(junit(record))[0]
    assert suite.get("errors") == "1"
    told = {one.get("name"): one.get("value") for one in suite.iter("property")}
    assert told["instants"] == "1"


@pytest.mark.parametrize(("lost", "verdict"), [(2, "agrees"), (3, "not tested")])
def test_more_than_half_of_the_rows_have_to_be_left_out_for_that(
    lost: int, verdict: str, tmp_path: Path
) -> None:
    """Rows without numbers count for nothing."""
    camber = np.degrees(pointcoord.simulate(CAR).wheel["camber"])
    told = "".join(f"{t!r},{camber[i]:.4f}\n" for i, t in enumerate(CAR.instants[:2].tolist()))
    late = "".join(f"{1e3 * k},0\n" for k in range(1, lost + 1))
    found = compared(tmp_path, f"time [s],camber [deg]\n{told}{late}5e6,\n6e6,\n7e6,\n")
    assert [row.verdict for row in found.outcome.rows] == [verdict]
