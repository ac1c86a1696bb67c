"""Which modules are mutated, and which files of tests are to notice: `plan.toml`, read and checked.

mathematics = ["package.room"]   # what the study speaks of; modules of it that no part has are listed

[[part]]
modules = ["package.room.module"]
tests = ["tests/room/test_module.py"]   # files or folders
sample = 12   # of each module so many mutants; without it all
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from validate.commands.usage import UsageError
from validate.studies.mutants.changes import source_of

PLAN = Path(__file__).with_name("plan.toml")


@dataclass(frozen=True)
class Part:
    """Modules, and the files of tests that are to notice a change of them.

    Attributes:
        sample: how many mutants of each module are tried; None: all.
    """

    modules: tuple[str, ...]
    tests: tuple[str, ...]
    sample: int | None = None


@dataclass(frozen=True)
class Plan:
    """What the study covers, in the tree of a checkout.

    Attributes:
        left_out: modules of the mathematics that no part has.
    """

    root: Path
    parts: tuple[Part, ...]
    left_out: tuple[str, ...]

    @property
    def packages(self) -> frozenset[str]:
        """The packages that the modules lie in, which import each other."""
        return frozenset(module.split(".")[0] for part in self.parts for module in part.modules)


def read_plan(root: Path, path: Path = PLAN) -> Plan:
    """The plan of a file, for the checkout in a folder.

    Raises:
        UsageError: the file is no plan, or the checkout has not what it names.
    """
    try:
        content: dict[str, Any] = tomllib.loads(path.read_text(encoding="utf-8"))
        parts = tuple(
            Part(tuple(part["modules"]), tuple(part["tests"]), part.get("sample")) for part in content["part"]
        )
        rooms = content["mathematics"]
    except (OSError, tomllib.TOMLDecodeError, KeyError, TypeError) as error:
        raise UsageError(f"{path}: no plan of mutants ({error!r}); see {PLAN}") from error
    for part in parts:
        if part.sample is not None and not (type(part.sample) is int and part.sample > 0):
            raise UsageError(f"{path}: sample = {part.sample!r}; allowed: whole numbers from 1, or no sample")
        files = [source_of(root, module) for module in part.modules] + [root / test for test in part.tests]
        for file in files:
            if not file.exists():
                raise UsageError(
                    f"{file}, which {path.name} names, is not there; run the study in the folder of a "
                    "checkout with its tests, or give that as --root"
                )
    covered = {module for part in parts for module in part.modules}
    known = [module for room in rooms for module in modules_of(root, room)]
    return Plan(root, parts, tuple(module for module in known if module not in covered))


def modules_of(root: Path, room: str) -> list[str]:
    """The dotted names of all modules of a room that have code: no `__init__`."""
    folder = root.joinpath(*room.split("."))
    if not folder.is_dir():
        return [room]
    files = sorted(path for path in folder.rglob("*.py") if path.name != "__init__.py")
    return [".".join(path.relative_to(root).with_suffix("").parts) for path in files]
