"""`python -m validate.NAME` does the module's job, or says in one line that it has none."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn

ROOT = Path(__file__).parent
JOB = 'if __name__ == "__main__":'


def asked_for(argv: Sequence[str], original: Sequence[str]) -> str | None:
    """The module of `python -m MODULE`, while Python imports the packages that it is in; else None.

    Until the module itself is found, Python calls the program `-m`.

    Args:
        argv: `sys.argv`. original: `sys.orig_argv`, in which the module stands before the same arguments.
    """
    if list(argv[:1]) != ["-m"]:
        return None
    word = original[len(original) - len(argv)]
    return word.partition("m")[2] if word.startswith("-") else word


def has_job(module: str) -> bool:
    """Whether a module of this package does something when it is run."""
    place = ROOT.joinpath(*module.split(".")[1:])
    path = place / "__main__.py" if place.is_dir() else place.with_suffix(".py")
    return path.is_file() and any(
        line.startswith(JOB) for line in path.read_text(encoding="utf-8").splitlines()
    )


def modules_with_a_job() -> list[str]:
    """Their names, for the one who runs another."""
    names = (path.relative_to(ROOT.parent).with_suffix("") for path in sorted(ROOT.rglob("*.py")))
    found = {".".join(name.parts).removesuffix(".__main__") for name in names}
    return sorted(name for name in found if has_job(name))


def check_what_is_run() -> None:
    """End the program if it was to run a module of this package that has no job.

    Raises:
        SystemExit: status 2, after one line on standard error.
    """
    module = asked_for(sys.argv, sys.orig_argv)
    if module is None or module.partition(".")[0] != ROOT.name:
        return
    if not has_job(module):
        jobs = ", ".join(modules_with_a_job())
        _refuse(f"{module} has nothing to run; run pointcoord, or python -m with one of: {jobs}")


def _refuse(message: str) -> NoReturn:
    if sys.stderr is not None:
        print(f"pointcoord: {message}", file=sys.stderr)
    raise SystemExit(2)
