"""What is known of mutants from earlier runs: a file of JSON lines, appended to and read by the next run.

A verdict holds as long as the module's source is the same and, for one that was killed, the file of the test
that killed it; for one that survived, all files of tests of its part. What else changes, such as a fixture or
another module, the store does not see: figures that are to be shown to somebody are made with a new file.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable
from dataclasses import asdict
from pathlib import Path
from typing import Any

from validate.commands.usage import UsageError
from validate.studies.mutants.changes import Change, source_of
from validate.studies.mutants.plan import Part, Plan
from validate.studies.mutants.trial import Baseline, Verdict


class Store:
    """Verdicts and baselines in a file, or nowhere if there is none."""

    def __init__(self, plan: Plan, path: Path | None) -> None:
        self.plan, self.path = plan, path
        self._verdicts: dict[tuple[str, Change], Verdict] = {}
        self._baselines: dict[str, Baseline] = {}
        # As they were at first: what is edited during a run is not what its trials began with.
        self._contents: dict[Path, bytes] = {}
        if path is None or not path.exists():
            return
        for number, text in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            try:
                row = json.loads(text)
            except json.JSONDecodeError:
                continue  # torn by the end of the run that wrote it
            try:
                self._take(row)
            except (KeyError, TypeError, AttributeError) as error:
                raise UsageError(
                    f"{path}: line {number} is of no study of mutants; give another file"
                ) from error

    def _take(self, row: dict[str, Any]) -> None:
        if "baseline" in row:
            self._baselines[row["held_to"]] = Baseline.of(row["baseline"])
        else:
            self._verdicts[row["held_to"], Change(**row["change"])] = Verdict(**row["verdict"])

    def _append(self, row: dict[str, Any]) -> None:
        if self.path is not None:
            with self.path.open("a", encoding="utf-8") as file:
                file.write(json.dumps(row) + "\n")

    def baseline(self, part: Part) -> Baseline | None:
        """What the tests of a part do, if neither they nor their modules have changed since."""
        return self._baselines.get(self._digest((*part.modules, *self._files(part))))

    def keep_baseline(self, part: Part, baseline: Baseline) -> None:
        """Remember it for the next module of the part, and write it down."""
        held_to = self._digest((*part.modules, *self._files(part)))
        self._baselines[held_to] = baseline
        self._append({"held_to": held_to, "baseline": baseline.document()})

    def verdict(self, part: Part, change: Change) -> Verdict | None:
        """What became of a mutant, if it holds still."""
        held_to = self._digest((change.module,))
        known = self._verdicts.get((held_to + self._digest(self._files(part)), change))
        if known is None:
            # Killed by a file of tests that has not changed.
            for file in self._files(part):
                known = self._verdicts.get((held_to + self._digest((file,)), change))
                # One that survived this file alone, when the part had no other, may be killed by another.
                if known is not None and known.result == "killed":
                    return known
            return None
        return known

    def keep_verdict(self, part: Part, change: Change, verdict: Verdict) -> None:
        """Write it down."""
        killer = verdict.by.split("::")[0]
        files = self._files(part)
        tests = (killer,) if verdict.result == "killed" and killer in files else files
        held_to = self._digest((change.module,)) + self._digest(tests)
        self._append({"held_to": held_to, "change": asdict(change), "verdict": asdict(verdict)})

    def _files(self, part: Part) -> tuple[str, ...]:
        """The files of tests of a part, from the root."""
        root = self.plan.root
        found = [
            path
            for test in part.tests
            for path in (
                [root / test] if (root / test).is_file() else sorted((root / test).rglob("test_*.py"))
            )
        ]
        return tuple(path.relative_to(root).as_posix() for path in found)

    def _digest(self, names: Iterable[str]) -> str:
        """Of files and modules, by name and content."""
        sum_of_all = hashlib.sha256()
        for name in names:
            file = self.plan.root / name if name.endswith(".py") else source_of(self.plan.root, name)
            if file not in self._contents:
                self._contents[file] = file.read_bytes()
            sum_of_all.update(name.encode() + b"\0" + self._contents[file] + b"\0")
        return sum_of_all.hexdigest()[:16]
