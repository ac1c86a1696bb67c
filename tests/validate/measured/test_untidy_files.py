"""Files as spreadsheets and loggers leave them: read as they are meant, and what is left out is told."""

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from pointcoord import Scene
from validate.measured.comparing import DataOutcome, compare_results
from validate.measured.errors import ResultsError
from validate.measured.mapping import read_results

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
    told = " / ".join(found.notes)
    assert ("who, which holds 'rig' and the like and no numbers" in told) == (b"who" in data)
    assert ("column 1" in told) == data.startswith(b",")


def test_a_column_of_words_that_a_map_wants_is_refused_with_what_it_holds(tmp_path: Path) -> None:
    data = b"rack [mm],toe,camber [deg]\n0,rig,0\n5,rig,1\n"
    map = 'columns.rack = {}\ncolumns.camber = {}\ncolumns.toe = { unit = "deg" }\n'
    with pytest.raises(
        ResultsError, match=r"'toe' of .* holds 'rig' and the like; allowed: columns of numbers"
    ):
        read(tmp_path, data, map)
    assert len(read(tmp_path, data, map.replace('unit = "deg"', 'is = "ignore"')).numbers) == 1


def test_parquet_with_an_index_and_words_gives_its_numbers(tmp_path: Path) -> None:
    table = pd.DataFrame(
        {"camber [deg]": [0.0, None], "who": ["a", "b"]}, index=pd.Index([0.0, 5.0], name="rack [mm]")
    )
    table.to_parquet(tmp_path / "x.parquet")
    found = read_results(str(tmp_path / "x.parquet"), None, CAR)
    assert found.independent[0].values.tolist() == [0.0, 5.0]
    assert any("who, which holds object and no numbers" in note for note in found.notes)


def compared(folder: Path, text: str) -> DataOutcome:
    return compare_results(read(folder, text.encode()), CAR, "car")


def test_a_file_of_which_few_rows_are_compared_says_so(tmp_path: Path) -> None:
    found = compared(tmp_path, "time [s],camber [deg]\n0.000,0\n10.000,0\n20.000,0\n")
    assert "only 1 of 3 rows are compared" in found.outcome.notes


def test_a_loop_is_refused_with_what_to_do(tmp_path: Path) -> None:
    with pytest.raises(ResultsError, match="of a loop its two ways in files of their own"):
        compared(tmp_path, TIDY + "0.0,0.9\n")
