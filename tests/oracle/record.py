"""What a part of the oracle keeps: facts and numbers by case, on disk and in memory.

A fact is a word or a whole number that must stay equal, or a number with how far it may be off:
[value, allowed]. A number with an error bound from a formulation is a row of a table, for there are hundreds
of thousands.
"""

from __future__ import annotations

import json
import lzma
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq

from pointcoord.numerics.arrays import Array

Fact = Any  # str, int, bool, None, a list of words, or [value, allowed] of two numbers
Facts = dict[str, dict[str, Fact]]

KEYS = ["case", "formulation", "quantity", "name", "instant", "axis"]
COLUMNS = [*KEYS, "value", "bound"]
PACKED = ("random",)  # parts whose facts are too many for plain text
FINE = 1024.0  # values are kept to this part of their bound, which is widened by as much


@dataclass(frozen=True)
class Record:
    """What a run of the program answered.

    Attributes:
        facts: by case and quantity.
        numbers: a row for each component of each number, with the columns `COLUMNS`; units as in the program.
    """

    facts: Facts
    numbers: pd.DataFrame = field(default_factory=lambda: pd.DataFrame(columns=COLUMNS))

    def only(self, cases: set[str]) -> Record:
        """The same of some cases."""
        facts = {case: found for case, found in self.facts.items() if case in cases}
        return Record(facts, self.numbers[self.numbers["case"].isin(cases)])


def write_text(path: Path, content: Any) -> None:
    """Plain data as JSON, a case on each line; packed if the name ends in .xz."""
    lines = (f"{json.dumps(key)}: {json.dumps(value, sort_keys=True)}" for key, value in content.items())
    text = "{\n" + ",\n".join(lines) + "\n}\n"
    path.write_bytes(lzma.compress(text.encode()) if path.suffix == ".xz" else text.encode())


def read_text(path: Path) -> Any:
    """What `write_text` wrote."""
    content = path.read_bytes()
    return json.loads(lzma.decompress(content) if path.suffix == ".xz" else content)


def _facts_of(folder: Path, part: str) -> Path:
    """The file of a part's facts."""
    return folder / f"{part}.json{'.xz' if part in PACKED else ''}"


def write_record(folder: Path, part: str, record: Record) -> None:
    """Keep a record: facts as JSON, numbers as Parquet."""
    folder.mkdir(parents=True, exist_ok=True)
    write_text(_facts_of(folder, part), record.facts)
    if len(record.numbers):
        _write_numbers(folder / f"{part}.parquet", record.numbers)


def read_record(folder: Path, part: str) -> Record:
    """Read a record back.

    Raises:
        FileNotFoundError: the part was never frozen.
    """
    facts: Facts = read_text(_facts_of(folder, part))
    numbers = folder / f"{part}.parquet"
    return Record(facts, _read_numbers(numbers)) if numbers.exists() else Record(facts)


def _write_numbers(path: Path, numbers: pd.DataFrame) -> None:
    table = numbers[COLUMNS].copy()
    table["value"], table["bound"] = rounded(table["value"].to_numpy(), table["bound"].to_numpy())
    for name in KEYS:
        table[name] = table[name].astype("int32" if name == "instant" else "category")
    packed = dict.fromkeys(("value", "bound"), "BYTE_STREAM_SPLIT")
    pq.write_table(
        pa.Table.from_pandas(table, preserve_index=False),
        path,
        compression="zstd",
        compression_level=19,
        use_dictionary=[name for name in KEYS if name != "instant"],
        column_encoding=packed,
    )


def _read_numbers(path: Path) -> pd.DataFrame:
    return pq.read_table(path).to_pandas()


def rounded(values: Array, bounds: Array) -> tuple[Array, Array]:
    """Values without the bits below 1 / FINE of their bound, and bounds with eight bits, widened by that.

    Half a unit of the last bit that is kept is at most bound / FINE; a value without a bound stays as it is.
    """
    mantissa, exponent = np.frexp(bounds * (1.0 + 1.0 / FINE))
    kept = np.ldexp(np.ceil(mantissa * 256.0) / 256.0, exponent)
    unit = np.ldexp(1.0, np.frexp(bounds)[1]) / FINE
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        coarse = np.round(values / unit) * unit
    return np.where((bounds > 0.0) & np.isfinite(coarse), coarse, values), kept
