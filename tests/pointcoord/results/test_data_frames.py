"""A motion as a data frame is its CSV, whichever library makes it; nothing else needs one of them."""

import sys
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from every_effect import every_effect

from pointcoord import MissingLibrary, Scene, UnknownName, simulate
from pointcoord.results.named_columns import LIBRARIES
from validate.output.columns import csv_lines, rows_of_motion


class Frame:
    """What the constructor of either library takes: columns by name."""

    def __init__(self, columns: dict[str, Any]) -> None:
        self.columns = columns


def pretend(monkeypatch: pytest.MonkeyPatch, *there: str) -> None:
    """Have only some libraries installed, which keep their columns."""
    for name in LIBRARIES:
        kind = type(name, (Frame,), {"made_by": name})
        library = ModuleType(name)
        vars(library)["DataFrame"] = kind
        monkeypatch.setitem(sys.modules, name, library if name in there else None)


def as_csv(scene: Scene) -> dict[str, list[float]]:
    head, *rows = "".join(csv_lines(rows_of_motion(simulate(scene)))).splitlines()
    numbers = [[float(cell) for cell in row.split(",")] for row in rows]
    return dict(zip(head.split(","), map(list, zip(*numbers, strict=True)), strict=True))


# All effects, on a chassis that heaves.
SCENE = every_effect("bounce-on-a-heaving-chassis")


def test_a_frame_has_the_columns_of_the_csv_with_the_same_bits(monkeypatch: pytest.MonkeyPatch) -> None:
    expected = as_csv(SCENE)
    # Camber, kingpin, toe, caster and the steer angle, two of them by arcsine too, and the change of toe.
    assert sum(name.endswith("[deg]") for name in expected) == 8
    for there in LIBRARIES:
        if find_spec(there):
            frame = simulate(SCENE).to_dataframe(there)
            assert type(frame).__module__.partition(".")[0] == there
            assert list(frame.columns) == list(expected)
            for name, column in expected.items():
                assert frame[name].to_numpy().dtype == np.float64
                assert frame[name].to_list() == column, (there, name)
    pretend(monkeypatch, *LIBRARIES)
    motion = simulate(SCENE)
    made = motion.to_dataframe("polars")
    assert {name: column.tolist() for name, column in made.columns.items()} == expected
    assert list(made.columns) == list(expected)
    made.columns["time [s]"][:] = -1.0
    assert (motion.times >= 0.0).all()
    for there in (LIBRARIES, *((one,) for one in LIBRARIES)):
        pretend(monkeypatch, *there)
        assert motion.to_dataframe().made_by == there[0]


def test_a_library_that_is_not_there_is_named_with_its_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    pretend(monkeypatch, "pandas")
    motion = simulate(Scene.load("steer"))
    with pytest.raises(MissingLibrary, match=r"'polars', which is not .* 'pointcoord\[polars\]'$"):
        motion.to_dataframe("polars")
    pretend(monkeypatch)
    with pytest.raises(ImportError, match="'pandas' or 'polars'"):
        motion.to_dataframe()
    with pytest.raises(UnknownName, match="did you mean 'pandas'"):
        motion.to_dataframe("panda")


def test_a_library_that_does_not_load_is_said_not_to(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(sys.modules, "pandas", raising=False)
    (tmp_path / "pandas.py").write_text("import a_library_of_pandas_that_is_gone")
    monkeypatch.syspath_prepend(str(tmp_path))
    with pytest.raises(MissingLibrary, match="does not load: No module named 'a_library_of_pandas"):
        simulate(Scene.load("steer")).to_dataframe()
