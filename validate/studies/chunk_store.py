"""The record of a long run: lines that are only appended, and a chunk that counts when all of it is there.

A finding is written when it is found, a chunk when it is finished. A process killed at any moment leaves at
most one torn line, which is no JSON object because its closing brace is missing; the chunk that it was in
is done again, and findings that are there already are not written twice.
"""

from __future__ import annotations

import json
import os
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

OURS = "pointcoord"
CHUNK = 20  # scenes: a few seconds of work, which is all that a kill can cost


class StoreError(Exception):
    """The store cannot be used."""


@dataclass(frozen=True)
class Chunk:
    """What came of the scenes `CHUNK * number` and on.

    Attributes:
        outcomes: how often each suspension/kind of scene/outcome was seen; the counts make up CHUNK.
        shares: per quantity, the largest difference / tolerance of the scenes that agreed.
        found: numbers of the scenes with a finding of their own.
        seconds: what it took.
    """

    number: int
    outcomes: Mapping[str, int]
    shares: Mapping[str, tuple[float, int]]
    found: tuple[int, ...]
    seconds: float


@dataclass(frozen=True)
class Record:
    """What a store holds: finished chunks and findings, each once, and lines that are torn."""

    chunks: dict[int, Chunk] = field(default_factory=dict)
    findings: dict[int, dict[str, Any]] = field(default_factory=dict)
    torn: int = 0

    def outcomes(self) -> Counter[str]:
        """All outcomes counted."""
        total: Counter[str] = Counter()
        for chunk in self.chunks.values():
            total.update(chunk.outcomes)
        return total

    def shares(self) -> dict[str, tuple[float, int]]:
        """Per quantity, the largest share of its tolerance and the scene that used it."""
        largest: dict[str, tuple[float, int]] = {}
        for chunk in self.chunks.values():
            for quantity, share in chunk.shares.items():
                largest[quantity] = max(largest.get(quantity, share), share)
        return largest


class Store:
    """A file of JSON lines; several processes may append to it at once.

    Attributes:
        seed: of the scenes. ours: pointcoord's method that they are solved by.
    """

    def __init__(self, path: Path, seed: int, ours: str = OURS) -> None:
        self.path = path
        self.seed = seed
        self.ours = ours

    def append(self, line: Mapping[str, Any]) -> None:
        """Write one line by a single write at the end of the file.

        It begins with a line break, so that a torn line before it stays alone.

        Raises:
            StoreError: the file cannot be written.
        """
        text = ("\n" + json.dumps(line, allow_nan=False) + "\n").encode()
        try:
            handle = os.open(self.path, os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o644)
            try:
                written = os.write(handle, text)
                os.fsync(handle)
            finally:
                os.close(handle)
        except OSError as error:
            raise StoreError(f"{self.path}: cannot be written ({error.strerror})") from None
        if written != len(text):
            raise StoreError(f"{self.path}: {written} of {len(text)} bytes written; is the disk full?")

    def finding(self, scene: int, content: Mapping[str, Any]) -> None:
        """Record a finding."""
        self.append({"scene": scene, **content})

    def chunk(self, chunk: Chunk) -> None:
        """Record a finished chunk."""
        self.append(
            {
                "chunk": chunk.number,
                "seed": self.seed,
                "ours": self.ours,
                "outcomes": dict(chunk.outcomes),
                "shares": {name: list(share) for name, share in chunk.shares.items()},
                "found": list(chunk.found),
                "seconds": round(chunk.seconds, 3),
            }
        )

    def read(self) -> Record:
        """All that is there. A chunk whose findings are not all there counts as not done.

        Raises:
            StoreError: the file cannot be read, or holds lines that are none of this program's.
        """
        record, torn = Record(), 0
        if not self.path.exists():
            return record
        try:
            lines = self.path.read_text(encoding="utf-8", errors="replace").split("\n")
        except OSError as error:
            raise StoreError(f"{self.path}: cannot be read ({error.strerror})") from None
        for number, text in enumerate(lines, 1):
            if not text:
                continue
            try:
                line = json.loads(text)
            except json.JSONDecodeError:
                torn += 1
                continue
            if isinstance(line, dict) and "chunk" in line:
                chunk = _chunk(line)
                if line["seed"] != self.seed:
                    raise StoreError(
                        f"{self.path}: line {number} has scenes of seed {line['seed']}, this program makes "
                        f"those of seed {self.seed}; give another file"
                    )
                # Older stores do not say: there was one method.
                if (ours := line.get("ours", OURS)) != self.ours:
                    raise StoreError(
                        f"{self.path}: line {number} has scenes solved by {ours}, not by {self.ours}; "
                        "give another file"
                    )
                record.chunks[chunk.number] = chunk
            elif isinstance(line, dict) and "scene" in line:
                record.findings.setdefault(int(line["scene"]), line)
            else:
                raise StoreError(f"{self.path}: line {number} is no line of a deep run; give another file")
        whole = {n: c for n, c in record.chunks.items() if set(c.found) <= record.findings.keys()}
        return Record(whole, record.findings, torn)


def _chunk(line: Mapping[str, Any]) -> Chunk:
    return Chunk(
        number=int(line["chunk"]),
        outcomes=line["outcomes"],
        shares={name: (float(share), int(scene)) for name, (share, scene) in line["shares"].items()},
        found=tuple(line["found"]),
        seconds=float(line["seconds"]),
    )
