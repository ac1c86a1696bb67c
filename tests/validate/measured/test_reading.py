"""Tables as programs and people write them: their numbers, how finely each is written, what is left out."""

from pathlib import Path

import numpy as np
import pyarrow
import pyarrow.parquet
import pytest

from pointcoord import Scene
from validate.measured.mapping import Measured, read_results
from validate.measured.reading import columns_of_text, read_columns
from validate.tables.errors import FileError

VALUES = [[0.0, 0.1, 0.25], [1.5, -2.75, 3e-3]]
TIDY = "time [s],camber [deg]\n0.0,1.5\n0.1,-2.75\n0.25,3e-3\n"
WRITTEN = {
    "commas": TIDY,
    "semicolons and decimal commas": "time;camber\ns;deg\n0,0;1,5\n0,1;-2,75\n0,25;3e-3\n",
    "tabs and a unit line in brackets": "time\tcamber\n[s]\t[deg]\n0.0\t1.5\n0.1\t-2.75\n0.25\t3e-3\n",
    "blanks and decimal commas": "time [s]  camber (deg)\n 0,0   1,5\n 0,1  -2,75\n 0,25 3e-3\n",
    "numpy's comment": "# time [s] camber [deg]\n0.0 1.5\n0.1 -2.75\n0.25 3e-3\n",
    "comments, a title and quotes": (
        'Run 7\n# a car\n"time [s]","camber [deg]"\n0.0,1.5\n% x\n0.1,-2.75\n\n0.25,3d-3\n'
    ),
    "a spreadsheet's title": "Run 7;\n;\ntime;camber\ns;deg\n0,0;1,5\n0,1;-2,75\n0,25;3e-3\n",
    "a delimiter at the end": "time [s],camber [deg],\n0.0,1.5,\n0.1,-2.75,\n0.25,3e-3,\n",
    "a byte order mark and a minus sign": "\ufeff" + TIDY.replace("-2", "\u22122").replace("\n", "\r\n"),
    "utf-16": TIDY,
    "an index": ",time [s],camber [deg]\n0,0.0,1.5\n1,0.1,-2.75\n2,0.25,3e-3\n",
    "blank columns": "time [s],,camber [deg],\n0.0,,1.5,\n0.1,,-2.75,\n0.25,,3e-3,\n",
    "words": "time [s],who,camber [deg]\n0.0,rig,1.5\n0.1,rig,-2.75\n0.25,me,3e-3\n",
}
CAR = Scene.load("double-wishbone")


def read(folder: Path, data: bytes, map: str = "") -> Measured:
    file = folder / "mine.csv"
    file.write_bytes(data)
    (folder / "map.toml").write_text(map)
    return read_results(str(file), str(folder / "map.toml") if map else None, CAR)


@pytest.mark.parametrize("how", WRITTEN)
def test_a_table_is_read_however_it_is_written(how: str, tmp_path: Path) -> None:
    found = read(tmp_path, WRITTEN[how].encode("utf-16" if how == "utf-16" else "utf-8"))
    (time,), (camber,) = found.independent, found.numbers
    assert [time.values.tolist(), np.degrees(camber.values).tolist()] == pytest.approx(np.array(VALUES))
    # Half a unit of the last digit as it is written.
    assert time.off == pytest.approx([0.05, 0.05, 0.005])
    assert np.degrees(camber.off) == pytest.approx([0.05, 0.005, 5e-4])
    assert any("ignored: who" in note for note in found.notes) == (how == "words")


def test_names_are_read_in_small_letters_with_underscores(tmp_path: Path) -> None:
    found = read(tmp_path, b"RACK [mm],Half-track change [mm]\n0,0.5\n")
    names = [one.meaning.name for one in (*found.independent, *found.numbers)]
    assert names == ["rack", "half_track_change"]


def test_a_coordinate_of_a_point_is_its_position(tmp_path: Path) -> None:
    found = read(tmp_path, b"rack [mm],wheel_centre.x [mm],Wheel_Centre.Z [m]\n0,0.5,0.2\n")
    words = [one.meaning.words for one in found.numbers]
    assert words == ["position.wheel_centre.x", "position.wheel_centre.z"]


def test_a_column_of_words_that_a_map_wants_is_refused_with_what_it_holds(tmp_path: Path) -> None:
    data = b"rack [mm],toe,camber [deg]\n0,rig,0\n5,rig,1\n"
    map = 'columns.rack = {}\ncolumns.camber = {}\ncolumns.toe = { unit = "deg" }\n'
    with pytest.raises(FileError, match=r"'toe': contains 'rig' and the like; allowed: columns of numbers"):
        read(tmp_path, data, map)
    assert len(read(tmp_path, data, map.replace('unit = "deg"', 'is = "ignore"')).numbers) == 1


def test_a_file_of_doubles_in_full_is_exact_where_zeros_are_left_off() -> None:
    found = columns_of_text("time,camber\n0.1,0.12345678901234567\n0.2,0.5\n", "mine")
    assert not found.steps.any()


def test_parquet_gives_the_numbers_themselves(tmp_path: Path) -> None:
    path = tmp_path / "table.parquet"
    single = np.array([1.5, 0.1], dtype=np.float32)
    pyarrow.parquet.write_table(pyarrow.table({"time [s]": [0.0, 0.1], "camber [deg]": single}), path)
    found = read_columns(str(path))
    assert (found.names, found.units) == (("time", "camber"), ("s", "deg"))
    assert found.values.tolist() == [[0.0, 0.1], single.astype(float).tolist()]
    assert found.steps[0].tolist() == [0.0, 0.0]
    # 0.1 in single precision is off by less than half of this.
    assert abs(float(single[1]) - 0.1) <= 0.5 * found.steps[1, 1] < 1e-8


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", ("is empty",)),
        ("time,camber\n", ("no line of numbers",)),
        ("time,camber\n0,1\n1,1.O\n", ("line 3, column 'camber'", "'1.O' is not a finite number")),
        ("time,camber\n0,1\n1,2,3\n", ("line 3", "3 cells", "2, one for each of time, camber")),
        ("time,time\n0,1\n", ("'time' occurs 2 times",)),
        ("a,b,c\n0,1\n", ("2 columns of numbers under 3 names",)),
        ("time,camber\ns,furlong\n0,1\n", ("line of units", "'furlong'")),
        ("time;camber\n0.5;1\n1.0;1,5\n", ("line 3", "has a decimal comma", "one sign before the decimals")),
    ],
)
def test_what_is_no_table_is_refused_with_its_place(text: str, words: tuple[str, ...]) -> None:
    with pytest.raises(FileError) as caught:
        columns_of_text(text, "mine.csv")
    assert [word for word in ("mine.csv", *words) if word not in str(caught.value)] == [], caught.value


def test_a_broken_file_of_parquet_is_refused(tmp_path: Path) -> None:
    (tmp_path / "bad.parquet").write_bytes(b"PAR1 and no more")
    with pytest.raises(FileError, match="not a Parquet file that can be read"):
        read_columns(str(tmp_path / "bad.parquet"))
