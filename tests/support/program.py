"""The program as a shell runs it: a process of its own, with short scenes."""

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import jsonschema
import pytest

import pointcoord
from validate.commands.schema import schema_text

ROOT = Path(pointcoord.__file__).parent.parent
CHECK = jsonschema.Draft202012Validator(json.loads(schema_text()))
PROGRAM = [sys.executable, "-m", "pointcoord"]
BOUNCE = (ROOT / "pointcoord" / "scenes" / "bounce.toml").read_text(encoding="utf-8")
ENVIRONMENT = {
    **os.environ,
    "PYTHONPATH": str(ROOT),
    "OPENBLAS_NUM_THREADS": "1",
    "OMP_NUM_THREADS": "1",
}


def short_scene(folder: Path, name: str = "short.toml", **changes: str) -> str:
    """A scene file of five instants, with other values of some keys."""
    lines = BOUNCE.splitlines()
    for key, value in {"samples": "5", **changes}.items():
        (place,) = (i for i, line in enumerate(lines) if line.partition("=")[0].strip() == key)
        lines[place] = f"{key} = {value}"
    path = folder / name
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return str(path)


def document(written: str | Path) -> dict[str, Any]:
    """What the program wrote as JSON, into a file too: strict, and true to the schema that is shipped."""
    text = written.read_text() if isinstance(written, Path) else written
    data: dict[str, Any] = json.loads(text, parse_constant=lambda name: pytest.fail(f"{name} is no JSON"))
    CHECK.validate(data)
    return data


# Laws of the arm that lead the car past its dead point, and out of the range of angles.
PAST_ITS_END = {"arm_angle": "{ polynomial = [0.8, 0.8] }"}


def complaints(err: str) -> list[str]:
    """The lines on standard error that are no warnings or notes: the paper's car warns of its drawing."""
    said = ("pointcoord: warning: ", "pointcoord: note: ")
    return [line for line in err.splitlines() if not line.startswith(said)]


def run(*words: str, **more: object) -> subprocess.CompletedProcess[str]:
    """Run the program to its end."""
    options = {"capture_output": True, "text": True, "env": ENVIRONMENT, "cwd": ROOT} | more
    return subprocess.run([*PROGRAM, *words], check=False, timeout=600, **options)


def in_shell(line: str, **more: object) -> subprocess.CompletedProcess[str]:
    """Run a line of a shell in which `pointcoord` is the program."""
    options = {"capture_output": True, "text": True, "env": ENVIRONMENT, "cwd": ROOT} | more
    script = f'words=("$@"); pointcoord() {{ "${{words[@]}}" "$@"; }}; {line}'
    return subprocess.run(["bash", "-c", script, "bash", *PROGRAM], check=False, timeout=600, **options)
