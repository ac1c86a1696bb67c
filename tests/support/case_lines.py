"""Files of cases beside a test, one a line: what is given => what comes of it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path


def cases(test: str, file: str) -> Iterator[tuple[str, list[str]]]:
    """What is given, and what stands between `|` after ` => `; lines with `#` are comments.

    Args:
        test: the path of the test.
    """
    for line in Path(test).with_name(file).read_text(encoding="utf-8").splitlines():
        if line and not line.startswith("#"):
            given, _, said = line.rpartition(" => ")
            yield given, [part.strip(" ") for part in said.split(" |")]
