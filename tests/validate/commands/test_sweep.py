"""`pointcoord sweep`: what it writes is what `sweep` solves."""

import csv
import tracemalloc
from pathlib import Path

import numpy as np
import pyarrow.parquet
import pytest
from changed_scenes import scene_with

from pointcoord import Scene, sweep
from validate.cli import main
from validate.output.columns import rows_of_sweep, write_table

SCENE = "double-wishbone"
POINTS = Scene.load(SCENE).mechanism.points
VARY = ("--vary", "lower_ball_joint.z=-10,0,150", "--vary", "upper_ball_joint.y=0:1:2")
INSTANTS = ("--instants", "5")


def test_every_kind_of_table_holds_the_designs_of_a_sweep(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("t.csv", "t.npz", "t.parquet"):
        assert main(["sweep", SCENE, *VARY, *INSTANTS, "-q", "-o", str(tmp_path / name)]) == 3
    capsys.readouterr()
    assert main(["sweep", SCENE, *VARY, *INSTANTS, "-o", "-"]) == 3
    out, err = capsys.readouterr()
    assert out.encode() == (tmp_path / "t.csv").read_bytes()
    assert "2 of 6 designs failed, the mechanism cannot be assembled; such as design 4: " in err
    rows = list(csv.DictReader(out.splitlines()))
    table, arrays = pyarrow.parquet.read_table(tmp_path / "t.parquet"), np.load(tmp_path / "t.npz")
    assert len(rows) == table.num_rows == 6 * 5
    assert [int(row["design"]) for row in rows] == np.repeat(np.arange(6), 5).tolist()
    assert table.column_names == list(rows[0])
    for name in rows[0]:
        # Equal bits, and NaN where a design could not be solved.
        text = np.array([row[name] for row in rows]).astype(arrays[name].dtype)
        np.testing.assert_array_equal(text, arrays[name])
        np.testing.assert_array_equal(text, np.array(table[name].to_pylist()))
    assert [status == "solved" for status in arrays["status"].tolist()] == [True] * 20 + [False] * 10
    assert np.isnan(arrays["wheel.camber [deg]"][20:]).all()
    # That each design is as it is alone, tests of `sweep` say.
    offsets = {"lower_ball_joint.z": [-10.0, 0.0, 150.0], "upper_ball_joint.y": [0.0, 1.0]}
    (own,) = rows_of_sweep([sweep(scene_with(SCENE, samples=5), offsets=offsets, grid=True)])
    assert {*own} == {*arrays.files}
    for name, column in own.items():
        np.testing.assert_array_equal(arrays[name], column)


def test_offsets_and_a_table_of_designs_mean_the_same(tmp_path: Path) -> None:
    z = POINTS["lower_ball_joint"][2]
    (tmp_path / "d.csv").write_text(f"lower_ball_joint.z [mm]\n{z - 2!r}\n{z!r}\n{z + 2!r}\n")
    ways = [["--vary", f"lower_ball_joint.z={v}"] for v in ("-2:2:3", "-2,0,2")]
    found = []
    for i, way in enumerate([*ways, ["--designs", str(tmp_path / "d.csv")]]):
        target = tmp_path / f"{i}.csv"
        assert main(["sweep", SCENE, *way, *INSTANTS, "-q", "-o", str(target)]) == 0
        found.append(target.read_bytes())
    assert len(found[0].splitlines()) == 1 + 3 * 5
    assert found[1:] == found[:-1]


@pytest.mark.parametrize("ending", [".csv", ".parquet"])
def test_a_table_is_written_in_the_memory_of_a_block(ending: str, tmp_path: Path) -> None:
    found = sweep(scene_with(SCENE, samples=101), offsets={"lower_ball_joint.z": np.linspace(-1.0, 1.0, 8)})
    write_table(str(tmp_path / f"few{ending}"), rows_of_sweep([found]))  # what is made once stays
    copies = 8

    def peak(count: int) -> int:
        tracemalloc.start()
        try:
            write_table(str(tmp_path / f"many{ending}"), rows_of_sweep(found for _ in range(count)))
            return tracemalloc.get_traced_memory()[1]
        finally:
            tracemalloc.stop()

    # What grows is a few words for each column and block: Parquet keeps where each of a hundred is.
    numbers = copies * len(found) * len(found.times) * 8 * 100
    assert peak(copies) - peak(2) < 0.05 * numbers
