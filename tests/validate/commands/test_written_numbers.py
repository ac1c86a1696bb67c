"""Files of numbers: what `simulate` and `sweep` write is what is solved, whatever the kind of the file."""

import csv
import tracemalloc
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pyarrow.parquet
import pytest
from changed_scenes import scene_with

from pointcoord import Scene, simulate, sweep
from pointcoord.numerics.arrays import Array
from pointcoord.results.named_columns import columns
from validate.cli import main
from validate.curves import picture
from validate.curves.of_sweep import columns_called, read_sweep
from validate.output.columns import ENDINGS, csv_lines, rows_of_sweep, write_table

SCENE = "double-wishbone"
FEW = scene_with(SCENE, samples=5)
Z = FEW.mechanism.points["lower_ball_joint"][2]
# The first design is the car as drawn, and the last one cannot be assembled.
VARY, OFFSETS = ("--vary", "lower_ball_joint.z=0,-10,150"), {"lower_ball_joint.z": [0.0, -10.0, 150.0]}


@pytest.fixture(scope="module")
def swept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the sweep in a file of every kind."""
    folder = tmp_path_factory.mktemp("sweep")
    for ending in ENDINGS:
        words = ["sweep", SCENE, *VARY, "--instants", "5", "-q", "-o", str(folder / f"t{ending}")]
        assert main(words) == 3
    return folder


def in_every_kind(folder: Path) -> Mapping[str, Array]:
    """The columns of files `t`, which have the same bits in every kind."""
    table, arrays = pyarrow.parquet.read_table(folder / "t.parquet"), np.load(folder / "t.npz")
    with (folder / "t.csv").open(newline="") as stream:
        head, *rows = csv.reader(stream)
    assert head == list(arrays) == table.column_names
    for name, *cells in zip(head, *rows, strict=True):
        text = np.array(cells).astype(arrays[name].dtype)
        np.testing.assert_array_equal(text, arrays[name])
        np.testing.assert_array_equal(text, np.array(table[name].to_pylist()))
    return arrays


def test_a_motion_of_several_blocks_is_written_in_every_kind_of_file(tmp_path: Path) -> None:
    (motion,) = simulate(Scene.load(SCENE)).blocks(7000, 7000)
    for ending in ENDINGS:
        target = tmp_path / f"t{ending}"
        assert main(["simulate", SCENE, "--instants", "7000", "-o", str(target), "-q"]) == 0
    found, wanted = in_every_kind(tmp_path), dict(columns(motion))
    assert list(found) == list(wanted)
    assert {"position.wheel_centre.x [mm]", "wheel.camber [deg]"} <= {*found}
    for name, column in wanted.items():
        # How a sum of 21 terms is rounded depends on the block that it is computed in.
        most = 21 * 50 * float(np.finfo(float).eps) * np.abs(column).max()
        assert np.abs(found[name] - column).max() <= most


def test_the_designs_of_a_sweep_are_written_in_every_kind_of_file(
    swept: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["sweep", SCENE, *VARY, "--instants", "5", "-o", "-"]) == 3
    out, err = capsys.readouterr()
    assert out.encode() == (swept / "t.csv").read_bytes()
    assert "1 of 3 designs failed: the mechanism cannot be assembled; such as design 2: " in err
    found = in_every_kind(swept)
    assert found["design"].tolist() == np.repeat(np.arange(3), 5).tolist()
    assert [status == "solved" for status in found["status"].tolist()] == [True] * 10 + [False] * 5
    assert np.isnan(found["wheel.camber [deg]"][10:]).all()
    # Tests of `sweep` compare each design with the car alone.
    (own,) = rows_of_sweep([sweep(FEW, offsets=OFFSETS)])
    assert {*own} == {*found}
    for name, column in own.items():
        np.testing.assert_array_equal(found[name], column)


@pytest.mark.parametrize("ending", ENDINGS)
def test_a_file_of_a_sweep_has_a_curve_for_each_design(ending: str, swept: Path) -> None:
    table = read_sweep(str(swept / f"t{ending}"))
    across, up = columns_called(table, ["time"]), columns_called(table, ["camber", "wheel.toe"])
    assert (across, up) == (["time [s]"], ["wheel.camber [deg]", "wheel.toe [deg]"])
    solved = sweep(FEW, offsets={"lower_ball_joint.z": [0.0, -10.0]}).numbers["wheel"]
    axes = picture.figure_of(table, across[0], up, "a car").axes
    for one, name in zip(axes, ("camber", "toe"), strict=True):
        *lines, none = (np.asarray(line.get_xydata()) for line in one.lines)
        assert np.isnan(none[:, 1]).all()
        for line, angles in zip(lines, solved[name], strict=True):
            # Degrees are one rounding away.
            assert line == pytest.approx(np.stack([FEW.instants, np.degrees(angles)], axis=-1), rel=1e-14)
    target = swept / f"{ending}.png"
    assert main(["plot", str(swept / f"t{ending}"), "-o", str(target)]) == 0
    assert target.read_bytes().startswith(b"\x89PNG")


def test_offsets_and_a_table_of_designs_mean_the_same(tmp_path: Path) -> None:
    (tmp_path / "d.csv").write_text(f"lower_ball_joint.z [mm]\n{Z - 2!r}\n{Z!r}\n{Z + 2!r}\n")
    ways = [["--vary", f"lower_ball_joint.z={v}"] for v in ("-2:2:3", "-2,0,2")]
    found = []
    for way in [*ways, ["--designs", str(tmp_path / "d.csv")]]:
        target = tmp_path / "t.csv"
        assert main(["sweep", SCENE, *way, "--instants", "5", "-q", "-o", str(target)]) == 0
        found.append(target.read_bytes())
    assert len(found[0].splitlines()) == 1 + 3 * 5
    assert found[1:] == found[:-1]


@pytest.mark.parametrize("ending", [".csv", ".parquet"])
def test_a_table_is_written_in_the_memory_of_a_block(ending: str, tmp_path: Path) -> None:
    part = sweep(scene_with(SCENE, samples=51), offsets={"lower_ball_joint.z": np.linspace(-1.0, 1.0, 8)})
    write_table(str(tmp_path / f"few{ending}"), rows_of_sweep([part]))  # what is made once stays
    copies = 8

    def peak(count: int) -> int:
        tracemalloc.start()
        try:
            write_table(str(tmp_path / f"many{ending}"), rows_of_sweep(part for _ in range(count)))
            return tracemalloc.get_traced_memory()[1]
        finally:
            tracemalloc.stop()

    # What grows is a few words for each column and block: Parquet keeps where each of a hundred is.
    numbers = copies * len(part) * len(part.times) * 8 * 100
    assert peak(copies) - peak(2) < 0.05 * numbers


def test_no_number_and_infinity_are_written_so_that_they_can_be_read() -> None:
    block = {"a": np.array([np.nan, np.inf, -np.inf])}
    assert "".join(csv_lines([block])).split() == ["a", "nan", "inf", "-inf"]
