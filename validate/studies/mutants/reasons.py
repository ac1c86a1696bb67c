"""Mutants that no test can tell from the module, each with the reason why: `equivalent.toml`.

    [[equivalent]]
    module = "package.room.module"
    function = "Class.method"      # "" for the module's own statements
    reason = "why nothing that anybody can see changes"
    changes = [["the statement's line as Python writes it", "the line with the change"]]

A third element says which of several that are the same is meant, from 1.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from pathlib import Path

from validate.commands.usage import UsageError
from validate.studies.mutants.changes import Change

REASONS = Path(__file__).with_name("equivalent.toml")


def read_reasons(path: Path = REASONS) -> Mapping[Change, str]:
    """The reason of each change that has one.

    Raises:
        UsageError: the file is no list of reasons, or gives two for one change.
    """
    found: dict[Change, str] = {}
    try:
        for entry in tomllib.loads(path.read_text(encoding="utf-8")).get("equivalent", []):
            for change in entry["changes"]:
                before, after, place = (*change, 1)[:3]
                key = Change(entry["module"], entry["function"], before, after, place)
                if not entry["reason"].strip() or key in found:
                    problem = "two reasons" if key in found else "an empty reason"
                    raise UsageError(f"{path}: {problem} for {key}; give one")
                found[key] = entry["reason"]
    except (OSError, tomllib.TOMLDecodeError, KeyError, TypeError, ValueError) as error:
        if isinstance(error, UsageError):
            raise
        raise UsageError(f"{path}: no list of reasons ({error!r}); see {REASONS}") from error
    return found
