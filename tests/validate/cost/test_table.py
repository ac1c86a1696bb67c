"""What was measured is found again as it was, and what is no such table is refused."""

from pathlib import Path

import pandas as pd
import pytest
from made_rows import kept, study

from validate.cost.table import frame, read_rows
from validate.errors import UsageError

ROW, *OTHERS = study()


def test_rows_come_back_as_they_were_with_every_digit_and_pandas_reads_them(tmp_path: Path) -> None:
    path = tmp_path / "rows"
    assert read_rows(kept(path, [ROW, *OTHERS])) == [ROW, *OTHERS]
    pd.testing.assert_frame_equal(pd.read_parquet(path), frame([ROW, *OTHERS]))


WHOLE = frame([ROW]).to_parquet()


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"hello", "Parquet"),
        (WHOLE[:-1], "Parquet"),
        (frame([]).to_parquet(), "it has no rows"),
        (frame([ROW]).drop(columns="time").to_parquet(), "the columns time are missing"),
        (frame([ROW]).assign(scene=None).to_parquet(), "scene of row 0: Input should be a valid string"),
        (frame([ROW]).assign(verdict="fine").to_parquet(), "verdict of row 0: Input should be 'measured'"),
    ],
)
def test_a_file_that_is_no_such_table_is_refused_with_the_reason(
    tmp_path: Path, content: bytes, words: str
) -> None:
    path = tmp_path / "rows"
    path.write_bytes(content)
    with pytest.raises(UsageError, match="is not a Parquet file of pointcoord cost --rows ") as caught:
        read_rows(str(path))
    assert words in str(caught.value)
    assert str(caught.value).endswith("; give another file")
