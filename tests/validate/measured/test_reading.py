"""Tables as programs and people write them: their numbers, how finely each is written, what is left out."""

from pathlib import Path

import numpy as np
import pyarrow
import pyarrow.parquet
import pytest
from case_lines import cases
from program import complaints

from pointcoord import Scene
from validate.cli import main
from validate.measured.mapping import Measured, read_results
from validate.measured.reading import columns_of_text, read_columns

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


def read(folder: Path, data: bytes) -> Measured:
    (folder / "mine.csv").write_bytes(data)
    return read_results(str(folder / "mine.csv"), None, CAR)


@pytest.mark.parametrize("how", WRITTEN)
def test_a_table_is_read_however_it_is_written(how: str, tmp_path: Path) -> None:
    found = read(tmp_path, WRITTEN[how].encode("utf-16" if how == "utf-16" else "utf-8"))
    (time,), (camber,) = found.independent, found.numbers
    assert [time.values.tolist(), np.degrees(camber.values).tolist()] == pytest.approx(np.array(VALUES))
    # Half a unit of the last digit as it is written.
    assert time.off == pytest.approx([0.05, 0.05, 0.005])
    assert np.degrees(camber.off) == pytest.approx([0.05, 0.005, 5e-4])
    assert any("ignored: who" in note for note in found.notes) == (how == "words")


@pytest.mark.parametrize(
    ("heads", "words"),
    [
        # In small letters with underscores; a coordinate of a point is its position.
        (b"RACK [mm],Half-track change [mm],y [mm]", ["dimension.half_track_change"]),
        (
            b"rack [mm],wheel_centre.x [mm],Wheel_Centre.Z [m]",
            ["position.wheel_centre.x", "position.wheel_centre.z"],
        ),
    ],
)
def test_names_of_columns_are_read_as_people_write_them(
    heads: bytes, words: list[str], tmp_path: Path
) -> None:
    found = read(tmp_path, heads + b"\n0,0.5,0.2\n")
    assert [one.meaning.name for one in found.independent] == ["rack"]
    assert [one.meaning.words for one in found.numbers] == words


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


def test_a_wrong_file_or_map_is_refused_in_one_line_with_its_place(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    for given, parts in cases(__file__, "refused.txt"):
        for name, text in zip(("mine.csv", "map.toml"), given.split(" |"), strict=True):
            Path(name).write_text(text.strip(" ").replace("\\n", "\n"), encoding="utf-8")
        map = ["--map", "map.toml"] * bool(Path("map.toml").stat().st_size)
        assert main(["validate", "steer", "--data", "mine.csv", *map]) == 2, given
        (told,) = complaints(capsys.readouterr().err)
        assert [part for part in parts if part not in told] == [], told
