"""Mutation testing of the mathematics: does some test fail for each small change of it?

    python -m validate.studies.mutants --store mutants.jsonl

in the folder of a checkout. Each mutant is a module with one change, made by operators of Cosmic Ray, and is
tried in a process of its own (see `trial`) against the tests that run the changed statement. It is

    killed       a test fails, or the module cannot even be imported,
    hung         the tests take many times as long: noticed as well,
    equivalent   no test fails, and `equivalent.toml` says why none can,
    survived     no test fails, and nobody has said why.

Exit status 0 only if none survived. Reasons of changes that do not exist any more, or that a test does
notice, are listed as stale. `plan.toml` says which modules are mutated, and of which a sample of the mutants
is tried (--whole: all of them); the others of the mathematics are listed too.
"""

from __future__ import annotations

import argparse
import os
import random
import sys
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from validate.commands.usage import UsageError
from validate.door import guarded
from validate.exit_status import ExitStatus
from validate.output.console import Console
from validate.output.document import Head, write_json
from validate.output.files import require_writable
from validate.output.report import table
from validate.studies.mutants.changes import Change, Mutant, mutants, sampled, source_of
from validate.studies.mutants.plan import PLAN, Part, Plan, read_plan
from validate.studies.mutants.reasons import REASONS, read_reasons
from validate.studies.mutants.store import Store
from validate.studies.mutants.trial import Verdict, measure, tried

PROGRAM = "validate.studies.mutants"
GRACE = 10.0
RESULTS = ("killed", "hung", "equivalent", "survived")


@dataclass(frozen=True)
class Row:
    """A mutant that was tried; `reason` if it is equivalent."""

    change: Change
    result: str
    by: str
    seconds: float
    reason: str = ""


@dataclass(frozen=True)
class Study:
    """What a run found.

    Attributes:
        made: how many mutants each module has, tried or not.
        stale: changes that have a reason, and either do not exist or are noticed.
        left_out: modules of the mathematics that are not mutated.
    """

    rows: tuple[Row, ...]
    made: Mapping[str, int]
    stale: tuple[Change, ...]
    left_out: tuple[str, ...]

    @property
    def survivors(self) -> tuple[Row, ...]:
        """Those that nobody has a reason for."""
        return tuple(row for row in self.rows if row.result == "survived")


def study(
    plan: Plan,
    reasons: dict[Change, str],
    store: Store,
    console: Console,
    *,
    modules: Iterable[str] = (),
    whole: bool = False,
    sample: int | None = None,
    seed: int = 0,
    workers: int = 1,
    grace: float = GRACE,
) -> Study:
    """Try the mutants of a plan.

    Args:
        modules: these only; packages stand for what is in them. whole: also what the plan does not draw.
        sample: so many of all these, drawn by `seed`.
        workers: trials at a time. grace: seconds of processor time that any trial has beyond its tests'.
    Raises:
        UsageError: a module is not in the plan, or a test fails without a change.
        MissingPackage: Cosmic Ray, coverage or pytest is not installed.
    """
    wanted = _wanted(plan, tuple(modules))
    made = {}
    for done, (_, name) in enumerate(wanted, 1):
        made[name] = mutants(name, source_of(plan.root, name).read_text("utf-8"))
        console.progress(f"mutants of {done} of {len(wanted)} modules are made")
    planned = {name: sampled(made[name], None if whole else part.sample) for part, name in wanted}
    every = [mutant for found in planned.values() for mutant in found]
    chosen = set(every if sample is None else random.Random(seed).sample(every, min(sample, len(every))))
    rows: list[Row] = []
    for part, name in wanted:
        mine = [mutant for mutant in planned[name] if mutant in chosen]
        if mine:
            rows += _of_module(plan, part, name, mine, reasons, store, console, workers, grace)
    exist = {mutant.change for found in made.values() for mutant in found}
    noticed = {row.change for row in rows if row.result in ("killed", "hung")}
    stale = [c for c in reasons if c.module in made and (c not in exist or c in noticed)]
    counts = {name: len(found) for name, found in made.items()}
    return Study(tuple(rows), counts, tuple(stale), plan.left_out)


def _wanted(plan: Plan, asked: tuple[str, ...]) -> list[tuple[Part, str]]:
    known = [(part, module) for part in plan.parts for module in part.modules]
    for name in asked:
        if not any(f"{module}.".startswith(f"{name}.") for _, module in known):
            allowed = ", ".join(module for _, module in known)
            raise UsageError(f"--modules {name}: no module of the plan; allowed: {allowed}")
    return [
        (part, module)
        for part, module in known
        if not asked or any(f"{module}.".startswith(f"{name}.") for name in asked)
    ]


def _of_module(
    plan: Plan,
    part: Part,
    name: str,
    found: Sequence[Mutant],
    reasons: dict[Change, str],
    store: Store,
    console: Console,
    workers: int,
    grace: float,
) -> list[Row]:
    known = {mutant: store.verdict(part, mutant.change) for mutant in found}
    missing = [mutant for mutant, verdict in known.items() if verdict is None]
    if missing:
        baseline = store.baseline(part)
        if baseline is None:
            baseline = measure(plan, part)
            store.keep_baseline(part, baseline)
        for done, (mutant, verdict) in enumerate(tried(plan, name, baseline, missing, workers, grace), 1):
            store.keep_verdict(part, mutant.change, verdict)
            known[mutant] = verdict
            console.progress(f"{name}: {done} of {len(missing)}")
    return [_row(mutant.change, verdict, reasons) for mutant, verdict in known.items() if verdict is not None]


def _row(change: Change, verdict: Verdict, reasons: dict[Change, str]) -> Row:
    reason = reasons.get(change, "") if verdict.result == "survived" else ""
    return Row(change, "equivalent" if reason else verdict.result, verdict.by, verdict.seconds, reason)


def study_text(done: Study) -> str:
    """A row for each module, then the survivors and the stale reasons."""
    count = Counter((row.change.module, row.result) for row in done.rows)
    names = list(dict.fromkeys(row.change.module for row in done.rows))
    seconds = {name: sum(row.seconds for row in done.rows if row.change.module == name) for name in names}
    lines = [
        _line(name, done.made[name], [count[name, result] for result in RESULTS], seconds[name])
        for name in names
    ]
    total = [sum(count[name, result] for name in names) for result in RESULTS]
    lines.append(_line("all", sum(done.made[name] for name in names), total, sum(seconds.values())))
    blocks = [table(("module", "mutants", "tried", *RESULTS, "CPU s"), lines)]
    for title, changes in (
        ("Survived, and nobody has said why", [row.change for row in done.survivors]),
        ("Stale reasons: the change does not exist, or a test notices it", done.stale),
    ):
        if changes:
            blocks.append("\n".join((f"{title}:", *(f"  {change}" for change in changes))))
    if done.left_out:
        blocks.append(f"Mathematics that is not mutated: {', '.join(done.left_out)}.")
    return "\n\n".join(blocks)


def _line(name: str, made: int, counts: Sequence[int], seconds: float) -> tuple[str, ...]:
    return name, str(made), str(sum(counts)), *map(str, counts), f"{seconds:.0f}"


def study_data(done: Study) -> dict[str, Any]:
    """For JSON: every mutant, the stale reasons, what is left out."""
    return {
        "counts": dict(Counter(row.result for row in done.rows)),
        "made": dict(done.made),
        "mutants": [asdict(row) for row in done.rows],
        "stale_reasons": [asdict(change) for change in done.stale],
        "not_mutated": list(done.left_out),
    }


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the study and print it; 0 if no mutant survived without a reason, else 1."""
    parser = argparse.ArgumentParser(
        prog=f"python -m {PROGRAM}", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--modules", metavar="A,B", help="these only, or those of these packages")
    parser.add_argument("--whole", action="store_true", help="all mutants of modules that the plan samples")
    parser.add_argument("--sample", type=int, metavar="N", help="so many mutants, drawn at random")
    parser.add_argument("--seed", type=int, default=0, help="of the sample")
    parser.add_argument(
        "--store", type=Path, metavar="FILE", help="JSON lines; a later run goes on from them"
    )
    parser.add_argument("--workers", type=int, default=1, help="trials at a time")
    parser.add_argument(
        "--grace", type=float, default=GRACE, help="CPU seconds that a trial has beyond its tests'"
    )
    parser.add_argument("--root", type=Path, default=Path(), help="the checkout, with its tests")
    parser.add_argument("--plan", type=Path, default=PLAN, help="which modules, and their tests")
    parser.add_argument("--reasons", type=Path, default=REASONS, help="of equivalent mutants")
    parser.add_argument("--json", metavar="FILE", help="- for standard output, which is then all of it")
    options = parser.parse_args(arguments)
    if options.workers < 1 or (options.sample is not None and options.sample < 1):
        parser.error(f"--workers {options.workers} --sample {options.sample}: allowed: from 1")
    return guarded(lambda console: _run(options, console), PROGRAM)


def _run(options: argparse.Namespace, console: Console) -> ExitStatus:
    if not hasattr(os, "fork"):
        raise UsageError(f"{sys.platform}: trials are forked, which this system cannot; try Linux or macOS")
    if options.json not in (None, "-"):
        require_writable(options.json)
    head = Head.of("mutants", ("python", "-m", PROGRAM, *sys.argv[1:]))
    plan = read_plan(options.root.resolve(), options.plan)
    done = study(
        plan,
        dict(read_reasons(options.reasons)),
        Store(plan, options.store),
        console,
        modules=options.modules.split(",") if options.modules else (),
        whole=options.whole,
        sample=options.sample,
        seed=options.seed,
        workers=options.workers,
        grace=options.grace,
    )
    console.end_progress()
    status = ExitStatus.DISAGREE if done.survivors else ExitStatus.AGREE
    if options.json:
        write_json(options.json, head.document(study_data(done), status, True), console)
    console.mute = options.json == "-"
    console.say(study_text(done))
    return status


if __name__ == "__main__":
    raise SystemExit(main())
