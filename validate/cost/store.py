"""The rows of the study of cost in a file: written when measured, and found again when a run goes on.

The file is lines of JSON that are only appended, each synchronised to the disk when it is written: first a
header, then what was measured. A process killed at any moment leaves at most one torn line, which is no
JSON object because its closing brace is missing; what it spoke of is measured again. What is kept is one
sample, which is all phases of one way with one setting, so a kill costs one sample, or the first run of a
way with its errors: some seconds at most.

Times of two programs, machines or numbers of threads do not belong into one table, so a file is only gone
on with where it was begun. To read it, anyone may.
"""

from __future__ import annotations

import hashlib
import json
import os
import platform
import sys
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, field
from importlib import metadata
from pathlib import Path
from typing import Any

from pointcoord import Scene
from validate.cost.row import Part, QuantityError, Row, Time
from validate.output.document import code_digest

FORMAT = 1
HEADER = "cost of accuracy"

# What is measured, of this distribution; how it is reported may change and the rows stay what they are.
MEASURED = (
    "pointcoord",
    "absolute",
    "validate/formulations",
    "validate/paper",
    "validate/peers",
    "validate/relative",
    "validate/cost/ways",
    "validate/cost/growth",
    "validate/cost/loading.py",
    "validate/cost/effects.py",
    "validate/cost/errors.py",
    "validate/cost/stopwatch.py",
    "validate/cost/instants.py",
    "validate/cost/accuracy.py",
)
PACKAGES = ("numpy", "scipy", "pin", "mujoco", "exudyn")
THREADS = (
    "OPENBLAS_NUM_THREADS",
    "OMP_NUM_THREADS",
    "MKL_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
    "NUMEXPR_NUM_THREADS",
)


class StoreError(Exception):
    """The file cannot be used; says why, and what to do."""


@dataclass(frozen=True)
class Header:
    """Where and by what the rows of a file are measured, in words.

    Attributes:
        program: version, and a digest of the code that is measured.
        machine: processor, cores and system.
        python: its version.
        packages: versions by name; `not installed` where one is not.
        threads: how many numerical libraries take, by what is measured.
        command: that began the file.
    """

    program: str
    machine: str
    python: str
    packages: Mapping[str, str]
    threads: Mapping[str, str]
    command: str = ""

    @classmethod
    def here(cls, command: str = "") -> Header:
        """Of this process."""
        return cls(
            program=f"pointcoord {_version('pointcoord')}, code {code_digest(MEASURED)}",
            machine=f"{_processor()}, {os.cpu_count()} cores, {platform.system()} {platform.release()}",
            python=f"{platform.python_implementation()} {platform.python_version()}",
            packages={name: _version(name) for name in PACKAGES},
            threads={"every part": "1"},
            command=command,
        )

    def differences(self, other: Header) -> list[str]:
        """What is another in the other one, so that times do not compare: `what: here; there`."""
        found = [
            f"{what}: {mine}; here: {others}"
            for what, mine, others in (
                ("program", self.program, other.program),
                ("machine", self.machine, other.machine),
                ("python", self.python, other.python),
            )
            if mine != others
        ]
        for mine_all, others_all in ((self.packages, other.packages), (self.threads, other.threads)):
            for name in dict.fromkeys((*mine_all, *others_all)):
                mine, others = (of.get(name, "not known") for of in (mine_all, others_all))
                if mine != others:
                    found.append(f"{name}: {mine}; here: {others}")
        return found


@dataclass(frozen=True)
class Key:
    """Which row it is.

    Attributes:
        part, scene, way, setting, against, size: as in the row.
        digest: of the scene's content (see `scene_digest`), so that another scene of the same name is another
            row; empty of a row without a scene.
        quick: whether less was measured, as `--quick` asks.
        configurations: how many were asked for; None where the scene says it.
    """

    part: Part
    scene: str
    digest: str
    way: str
    setting: str = ""
    against: str = ""
    size: int | None = None
    quick: bool = False
    configurations: int | None = None


@dataclass(frozen=True)
class Begun:
    """A row whose repeats are still to be measured: what its first run gave, with everything but times.

    Attributes:
        loops: how many runs make one sample.
        stride: every how many-th of the study's instants it is solved at.
    """

    row: Row
    loops: int
    stride: int


@dataclass(frozen=True)
class Record:
    """What a file holds.

    Attributes:
        rows: finished.
        begun: and unfinished.
        samples: seconds by phase, by key and number of the round.
        torn: how many lines were not written to their end.
    """

    header: Header
    rows: dict[Key, Row] = field(default_factory=dict)
    begun: dict[Key, Begun] = field(default_factory=dict)
    samples: dict[Key, dict[int, Mapping[str, float]]] = field(default_factory=dict)
    torn: int = 0


class Store:
    """A file of rows, or the same in memory; a row that is there is not measured again."""

    def __init__(self, path: Path | None, header: Header) -> None:
        """Open a file, or begin it.

        Args:
            path: None keeps the rows in memory.
            header: of this process, see `Header.here`.
        Raises:
            StoreError: the file cannot be read or written, is none of these, or was begun by another program
                or on another machine.
        """
        self.path = path
        record = None if path is None else _read(path)
        if record is None:
            self._record = Record(header)
            self._append({HEADER: FORMAT, **asdict(header)})
            return
        differences = record.header.differences(header)
        if differences:
            raise StoreError(
                f"{path}: was measured elsewhere or with something else, and such times do not compare: "
                f"{'; '.join(differences)}; give another file, or delete this one to measure all again"
            )
        self._record = record

    @property
    def header(self) -> Header:
        """Of the run that began the file."""
        return self._record.header

    def row(self, key: Key) -> Row | None:
        """A finished row; None if there is none."""
        return self._record.rows.get(key)

    def rows(self, part: Part | None = None, quick: bool | None = None) -> tuple[Row, ...]:
        """The finished rows, in the order in which they were finished."""
        return tuple(row for _, row in self.entries(part, quick))

    def entries(self, part: Part | None = None, quick: bool | None = None) -> tuple[tuple[Key, Row], ...]:
        """The same with their keys."""
        return tuple(_chosen(self._record, part, quick))

    def write(self, key: Key, row: Row) -> None:
        """Keep a finished row, now.

        Raises:
            StoreError: the file cannot be written.
        """
        self._append({"row": asdict(row), "key": asdict(key)})
        self._record.rows.setdefault(key, row)

    def begun(self, key: Key) -> Begun | None:
        """A row whose repeats are being measured; None if it is not begun."""
        return self._record.begun.get(key)

    def begin(self, key: Key, begun: Begun) -> None:
        """Keep what the first run of a row gave.

        Raises:
            StoreError: the file cannot be written.
        """
        self._append({"begun": asdict(begun), "key": asdict(key)})
        self._record.begun[key] = begun

    def samples(self, key: Key) -> Mapping[int, Mapping[str, float]]:
        """Seconds by phase of one run, by the number of the round."""
        return self._record.samples.get(key, {})

    def sample(self, key: Key, number: int, seconds: Mapping[str, float]) -> None:
        """Keep a sample of a begun row.

        Raises:
            StoreError: the file cannot be written.
        """
        self._append({"round": number, "seconds": dict(seconds), "key": asdict(key)})
        self._record.samples.setdefault(key, {})[number] = dict(seconds)

    def _append(self, line: Mapping[str, Any]) -> None:
        """Write one line at the end; it begins with a line break, so that a torn one before stays alone."""
        if self.path is None:
            return
        text = ("\n" + json.dumps(line, allow_nan=False) + "\n").encode()
        try:
            handle = os.open(self.path, os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o644)
            try:
                written = os.write(handle, text)
                os.fsync(handle)
            finally:
                os.close(handle)
        except OSError as error:
            raise StoreError(
                f"{self.path}: cannot be written ({error.strerror}); give another file"
            ) from None
        if written != len(text):
            raise StoreError(f"{self.path}: {written} of {len(text)} bytes written; is the disk full?")


def read_rows(
    path: Path, part: Part | None = None, quick: bool | None = None
) -> tuple[Header, tuple[tuple[Key, Row], ...]]:
    """The header and the finished rows of a file, wherever it was measured, to report them again.

    Raises:
        StoreError: the file cannot be read, holds nothing, or is none of these.
    """
    record = _read(path)
    if record is None:
        raise StoreError(f"{path}: holds no rows; measure them first")
    return record.header, tuple(_chosen(record, part, quick))


def scene_digest(scene: Scene) -> str:
    """Of what a scene says, whatever it is called."""
    content = scene.model_dump(mode="json", exclude={"title"})
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:16]


def _chosen(record: Record, part: Part | None, quick: bool | None) -> Iterator[tuple[Key, Row]]:
    for key, row in record.rows.items():
        if (part is None or key.part == part) and (quick is None or key.quick == quick):
            yield key, row


def _read(path: Path) -> Record | None:
    """All that a file holds; None if it is not there, or was killed before its header was written.

    Raises:
        StoreError: it cannot be read, or is none of these.
    """
    try:
        lines = path.read_text(encoding="utf-8", errors="replace").split("\n")
    except FileNotFoundError:
        return None
    except OSError as error:
        raise StoreError(f"{path}: cannot be read ({error.strerror}); give another file") from None
    record: Record | None = None
    torn = 0
    for number, text in enumerate(lines, 1):
        if not text:
            continue
        try:
            line = json.loads(text)
        except json.JSONDecodeError:
            torn += 1
            if not text.startswith("{"):
                raise _no_store(path, number) from None
            continue
        if not isinstance(line, dict):
            raise _no_store(path, number)
        try:
            if HEADER in line:
                if line[HEADER] != FORMAT:
                    raise StoreError(
                        f"{path}: is written in the form {line[HEADER]!r} of such files, this program knows "
                        f"the form {FORMAT}; give another file, or delete this one to measure all again"
                    )
                record = record or Record(_header(line))
            elif record is None:
                raise _no_store(path, number)
            else:
                _put(record, line)
        except (KeyError, TypeError, AttributeError, ValueError):
            raise _no_store(path, number) from None
    return None if record is None else Record(record.header, record.rows, record.begun, record.samples, torn)


def _no_store(path: Path, number: int) -> StoreError:
    return StoreError(f"{path}: line {number} is no row of what accuracy costs; give another file")


def _header(line: Mapping[str, Any]) -> Header:
    return Header(**{name: line[name] for name in Header.__dataclass_fields__})


def _put(record: Record, line: Mapping[str, Any]) -> None:
    """Add what a line says."""
    key = Key(**line["key"])
    if "row" in line:
        record.rows.setdefault(key, _row(line["row"]))
    elif "begun" in line:
        begun = line["begun"]
        record.begun[key] = Begun(_row(begun["row"]), int(begun["loops"]), int(begun["stride"]))
    else:
        seconds = {str(phase): float(value) for phase, value in line["seconds"].items()}
        record.samples.setdefault(key, {})[int(line["round"])] = seconds


def _row(content: Mapping[str, Any]) -> Row:
    errors = {name: QuantityError(**error) for name, error in content["errors"].items()}
    times = {name: Time(**time) for name, time in content["times"].items()}
    return Row(**{**content, "errors": errors, "times": times})


def _version(package: str) -> str:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return "not installed"


def _processor() -> str:
    """The processor's name, as far as the system tells it."""
    if sys.platform == "linux":
        try:
            text = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace")
        except OSError:
            text = ""
        for line in text.splitlines():
            name, _, value = line.partition(":")
            if name.strip() == "model name":
                return value.strip()
    return platform.processor() or platform.machine()
