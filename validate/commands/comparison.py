"""`pointcoord validate`: scenes solved by several formulations, and every quantity compared."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from pointcoord import Scene, SceneError
from validate.commands.usage import (
    SCENE_HELP,
    STANDARD_INPUT,
    UsageError,
    add_quiet,
    load_scene,
    require_target,
)
from validate.comparison.examined import Examined, examine
from validate.comparison.findings import Finding, findings
from validate.diagnosis import Explanation, explain_outcome
from validate.exit_status import ExitStatus, combined
from validate.formulations.refusals import Refusal
from validate.formulations.registry import NAMES, WORDS, formulation
from validate.output import report
from validate.output.console import Console
from validate.output.document import Head, Journal
from validate.paper.scenes import DEFAULT_SCENES, PAPER_SCENES
from validate.paper.tables import PaperRow, compare_with_paper
from validate.plain_text import shown

Explained = Sequence[Sequence[Explanation]]

FIRST, SECOND = "pointcoord", "absolute"
# Without names on the command line the paper's own algorithm is held to the other model too.
FURTHER = ("pointcoord-newton", "absolute")

_WIDTH = max(map(len, WORDS))
DESCRIPTION = """\
Solve each scene by two formulations and compare every number that it asks for. Each
formulation claims how far off its numbers may be, and a difference is held to the sum of both
claims. For each quantity the row is printed that comes closest to that.

formulations:
""" + "\n".join(f"  {name.ljust(_WIDTH)}  {words}" for name, words in WORDS.items())


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command with its options."""
    parser = commands.add_parser(
        "validate",
        help="solve scenes by two formulations and compare them",
        description=DESCRIPTION,
    )
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=f"{SCENE_HELP}; none: all built-in scenes")
    parser.add_argument(
        "--first",
        metavar="NAME",
        help=f"a formulation ({FIRST} if not given)",
    )
    parser.add_argument(
        "--second",
        metavar="NAME",
        help=f"the one to compare it with ({SECOND} if not given); without --first and --second "
        f"{FURTHER[0]} is compared with {FURTHER[1]} as well",
    )
    parser.add_argument("--json", metavar="FILE", help="write the results as JSON; - for standard output")
    add_quiet(parser)
    parser.set_defaults(run=run)


@dataclass
class _Results:
    """What is there so far, as plain data and in counts."""

    scenes: list[dict[str, Any]] = field(default_factory=list)
    statuses: list[ExitStatus] = field(default_factory=list)
    agreed: dict[tuple[str, str], int] = field(default_factory=dict)
    uncompared: int = 0
    printed: list[str] = field(default_factory=list)
    findings: list[Finding] = field(default_factory=list)
    unprinted: list[tuple[str, Refusal]] = field(default_factory=list)
    paper: Sequence[PaperRow] = ()

    def add(self, examined: Examined, explanations: Explained = ()) -> None:
        self.scenes.append(report.examined_data(examined, explanations))
        self.statuses.append(examined.status)
        self.uncompared += not examined.outcomes
        for outcome in examined.outcomes:
            first, second = (s.formulation for s in outcome.solutions)
            self.agreed[first, second] = self.agreed.get((first, second), 0) + outcome.agreed
        if examined.printed is not None:
            self.printed.append(examined.name)
            self.findings += findings([examined.printed])
        if examined.unprinted is not None:
            self.unprinted.append((examined.name, examined.unprinted))

    def data(self) -> dict[str, Any]:
        return {
            "scenes": self.scenes,
            "printed_formulas": [report.finding_data(finding) for finding in self.findings],
            "printed_tables": report.paper_data(self.paper) if self.paper else None,
        }


def run(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Compare the scenes; each is said, and written as JSON, as soon as it is done.

    Raises:
        UsageError: the options do not go together.
        UnknownFormulation, MissingPackage: a formulation is not there.
        OutputError: the results cannot be written.
    """
    names = options.scenes or list(DEFAULT_SCENES)
    pairs = _pairs(options)
    if names.count(STANDARD_INPUT) > 1:
        raise UsageError("standard input (-) is given as a scene more than once; it can be read once")
    require_target(options.json, "--json", tuple(names))
    console.quiet, console.mute = options.quiet, options.json == "-"
    if not console.quiet or console.mute:
        console.require("use --quiet, or --quiet --json FILE")
    for name in dict.fromkeys(name for pair in pairs for name in pair):
        formulation(name)  # found before any scene is read
    journal = Journal(options.json, Head.of("validate", options.command), console)
    results = _Results()
    with journal.closing(results.data, lambda: results.scenes, lambda: _finished(results, names)) as ending:
        for name, scene in _loaded(names, console):
            if isinstance(scene, Scene):
                examined = examine(name, scene, pairs, name in PAPER_SCENES)
                explained = [explain_outcome(scene, outcome) for outcome in examined.outcomes]
                _say(examined, explained, console)
                results.add(examined, explained)
            else:
                results.add(scene)
            journal.keep(results.data, _finished(results, names))
        if not options.scenes:
            results.paper = compare_with_paper()
        _say_at_the_end(results, pairs, len(names), console)
        ending.status = combined(results.statuses)
    return ending.status


def _pairs(options: argparse.Namespace) -> tuple[tuple[str, str], ...]:
    first, second = options.first or FIRST, options.second or SECOND
    if options.first == "" or options.second == "":
        raise UsageError(f"a formulation without a name; there are: {', '.join(NAMES)}")
    if first == second:
        others = ", ".join(name for name in NAMES if name != first)
        raise UsageError(
            f"{first!r} is to be compared with itself, which tells nothing; "
            f"give another --first or --second: {others}"
        )
    alone = options.first is None and options.second is None
    return ((first, second), FURTHER) if alone else ((first, second),)


def _loaded(names: Sequence[str], console: Console) -> list[tuple[str, Scene | Examined]]:
    """The scenes, all read before any is solved; of those that cannot be, it is said at once why not."""
    scenes: list[tuple[str, Scene | Examined]] = []
    for name in names:
        try:
            scenes.append((name, load_scene(name)))
        except SceneError as error:
            bad = Examined(name=shown(name), problem=str(error))
            console.complain(bad.complaint)
            scenes.append((name, bad))
    return scenes


def _say(examined: Examined, explained: Explained, console: Console) -> None:
    if examined.complaint:
        console.complain(examined.complaint)
    else:
        for warning in examined.warnings:
            console.warn(f"{examined.name}: {warning}")
    told = list(zip(examined.outcomes, explained, strict=True))
    for outcome, why in told[:1]:
        notes = "".join(f"\n  note: {note}" for note in examined.defaults)
        console.say(report.outcome_text(outcome, why) + notes + "\n")
    for outcome, why in told[1:]:
        # The tables of a further pair would say nearly the same.
        text = report.agreement_line(outcome) if outcome.agreed else report.outcome_text(outcome, why)
        console.say(text + "\n")


def _finished(results: _Results, names: Sequence[str]) -> str:
    return f"{len(results.scenes)} of {len(names)} scenes"


def _say_at_the_end(
    results: _Results, pairs: Sequence[tuple[str, str]], count: int, console: Console
) -> None:
    if results.printed:
        console.say(report.findings_text(results.findings, results.printed) + "\n")
    for name, why in results.unprinted:
        console.say(f"The paper's formulas as printed cannot solve {name}: {why.message}\n")
    if results.paper:
        console.say(report.paper_text(results.paper) + "\n")
    told = [
        f"{results.agreed.get(pair, 0)} of {count} {'scenes agree ' if i == 0 else ''}between {pair[0]} and "
        f"{pair[1]}"
        for i, pair in enumerate(pairs)
    ]
    # No agreement is no disagreement yet: what was not compared is counted apart.
    rest = f"; {results.uncompared} of {count} could not be compared at all" if results.uncompared else ""
    console.say(", ".join(told) + rest + ".")
