"""Tables as programs and people write them: the same numbers, and how finely each is written."""

from pathlib import Path

import numpy as np
import pyarrow
import pyarrow.parquet
import pytest

from validate.measured.reading import Columns, columns_of_text, read_columns
from validate.tables.errors import FileError

VALUES = [[0.0, 0.1, 0.25], [1.5, -2.75, 3e-3]]
WRITTEN = {
    "commas": "time [s],camber [deg]\n0.0,1.5\n0.1,-2.75\n0.25,3e-3\n",
    "semicolons and decimal commas": "time;camber\ns;deg\n0,0;1,5\n0,1;-2,75\n0,25;3e-3\n",
    "tabs and a unit line in brackets": "time\tcamber\n[s]\t[deg]\n0.0\t1.5\n0.1\t-2.75\n0.25\t3e-3\n",
    "blanks and decimal commas": "time [s]  camber (deg)\n 0,0   1,5\n 0,1  -2,75\n 0,25 3e-3\n",
    "numpy's comment": "# time [s] camber [deg]\n0.0 1.5\n0.1 -2.75\n0.25 3e-3\n",
    "comments, a title and quotes": (
        'Run 7\n# a car\n"time [s]","camber [deg]"\n0.0,1.5\n% x\n0.1,-2.75\n\n0.25,3d-3\n'
    ),
    "a delimiter at the end": "time [s],camber [deg],\n0.0,1.5,\n0.1,-2.75,\n0.25,3e-3,\n",
    "a byte order mark and a minus sign": (
        "\ufefftime [s],camber [deg]\r\n0.0,1.5\r\n0.1,\u22122.75\r\n0.25,3e-3\r\n"
    ),
}


@pytest.mark.parametrize("how", WRITTEN)
def test_a_table_is_read_however_it_is_written(how: str, tmp_path: Path) -> None:
    path = tmp_path / "table.txt"
    path.write_text(WRITTEN[how], encoding="utf-8", newline="")
    found = read_columns(str(path))
    assert found.names == ("time", "camber")
    assert found.units == ("s", "deg")
    assert found.values.tolist() == VALUES
    assert found.steps == pytest.approx(np.array([[0.1, 0.1, 0.01], [0.1, 0.01, 1e-3]]))


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


def test_cells_without_a_number_are_none() -> None:
    found = columns_of_text("time,camber\n0.1,\n0.2,NaN\n0.3,n/a\n0.4,1.0\n", "mine")
    assert np.isnan(found.values[1]).tolist() == [True, True, True, False]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", ("is empty",)),
        ("# nothing\n", ("is empty",)),
        ("time,camber\n", ("no line of numbers",)),
        ("time,camber\n0,1\n1,1.O\n", ("line 3, column 'camber'", "'1.O' is no finite number")),
        ("time,camber\n0,1\n1,1e999\n", ("line 3, column 'camber'", "'1e999'")),
        ("time,camber\n0,1\n1,2,3\n", ("line 3", "3 cells", "2, one for each of time, camber")),
        (
            "time,who,camber\n0,me,1\n1,me,1\n2,3\n",
            ("line 4", "2 cells", "3, one for each of time, who, camber"),
        ),
        ("time,time\n0,1\n", ("'time' is there 2 times",)),
        ("a,b,c\n0,1\n", ("2 columns of numbers under 3 names",)),
        ("time,camber\ns,furlong\n0,1\n", ("line of units", "'furlong'")),
        ("time;camber\n0.5;1\n1.0;1,5\n", ("line 3", "has a decimal comma", "one sign before the decimals")),
    ],
)
def test_what_is_no_table_is_refused_with_its_place(text: str, words: tuple[str, ...]) -> None:
    with pytest.raises(FileError) as caught:
        columns_of_text(text, "mine.csv")
    assert [word for word in ("mine.csv", *words) if word not in str(caught.value)] == [], caught.value


def test_a_missing_file_is_said_to_be_missing(tmp_path: Path) -> None:
    with pytest.raises(FileError, match="cannot be read"):
        read_columns(str(tmp_path / "none.csv"))
    (tmp_path / "bad.parquet").write_bytes(b"PAR1 and no more")
    with pytest.raises(FileError, match="no Parquet that can be read"):
        read_columns(str(tmp_path / "bad.parquet"))
    assert isinstance(columns_of_text("1 2\n", "x"), Columns)
