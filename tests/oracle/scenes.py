"""The built-in scenes by every formulation: numbers with their bounds, verdicts, refusals, exit statuses."""

from __future__ import annotations

from pathlib import Path

import pandas as pd
from program import document, numbers_of, pointcoord, scene_facts
from record import Facts, Record

OURS = "pointcoord"
QUICK = ("absolute",)
OTHERS = (
    *QUICK,
    "pointcoord-newton",
    "pointcoord-newton-cold",
    "pointcoord-chord",
    "pointcoord-as-asked",
    "pointcoord-map",
    "printed",
    "relative",
    "mujoco",
    "exudyn",
)
# The built-in scenes of the frozen commit: what is asked for later has no frozen answer, nor exit status.
SCENES = (
    "bounce",
    "steer",
    "bounce-and-steer",
    "bounce-on-a-heaving-chassis",
    "off-axis-strut",
    "double-wishbone",
)
EVERY = 4  # of so many instants one is kept, and the last: motions are smooth


def record(folder: Path, others: tuple[str, ...] = OTHERS) -> Record:
    """Each formulation beside pointcoord, in the scenes that were built in."""
    facts: Facts = {}
    tables = []
    for other in others:
        target, baseline = folder / f"{other}.json", folder / f"{other}.npz"
        options = ("--first", OURS, "--second", other, "-q", "--json", target, "--save-baseline", baseline)
        status = pointcoord("validate", *SCENES, *options)
        facts[f"by {other}"] = {"exit status": status}
        for scene, found in scene_facts(document(target)).items():
            facts[f"{scene} by {other}"] = found
        # Our own numbers once: they are the same beside every other formulation.
        tables.append(numbers_of(baseline, EVERY, leave_out=() if other == others[0] else (OURS,)))
    return Record(facts, pd.concat(tables, ignore_index=True))


def quick_of(whole: Record) -> Record:
    """The same piece of all of it."""
    facts = {case: found for case, found in whole.facts.items() if case.endswith(f" {QUICK[0]}")}
    return Record(facts, whole.numbers[whole.numbers["formulation"].isin((OURS, *QUICK))])


def quick(folder: Path) -> Record:
    """Pointcoord and absolute alone."""
    return record(folder, QUICK)
