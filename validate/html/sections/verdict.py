"""The verdict in a sentence, and what each scene has to say beside its numbers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from validate.ci.record import why_undecided
from validate.comparison.compare import Outcome
from validate.exit_status import ExitStatus
from validate.html.run import Run, Told, named
from validate.html.section import Block, Paragraph, Section
from validate.output.report import about, worst_rows

VERDICTS = {ExitStatus.AGREE: "agrees", ExitStatus.DISAGREE: "disagrees"}
# Lines of all scenes together, at most: there may be hundreds of scenes.
LINES = 150


def _blocks(run: Run) -> Sequence[Block]:
    # What concerns the verdict goes first, and what several scenes have to say is said once.
    lines: list[str] = []
    for of in (_disagreements, _complaints, _undecided, _notes):
        scenes: dict[str, dict[str, None]] = {}
        for one in run.told:
            for line in of(one):
                scenes.setdefault(line, {})[one.examined.name] = None
        lines += (f"{named(list(names))}: {line}" for line, names in scenes.items())
    notes = [Paragraph(line) for line in lines[:LINES]]
    if len(lines) > LINES:
        notes.append(Paragraph(f"{len(lines) - LINES} more such lines are in the data beside this page."))
    verdict = VERDICTS.get(run.status, "not tested")
    if run.head.kind == "cost" and run.status is ExitStatus.AGREE:
        # Times compare nothing that could be right or wrong.
        verdict = "measured"
    status = f"Exit status {run.status.value}: {run.status.verdict}"
    return [Paragraph(run.sentence, verdict, status), *notes]


def _pair(outcome: Outcome) -> str:
    return " and ".join(solution.formulation for solution in outcome.solutions)


def _disagreements(one: Told) -> Iterator[str]:
    """What does not agree, and what would explain it."""
    for outcome, why in zip(one.examined.outcomes, one.explained, strict=True):
        for row in worst_rows(outcome):
            if row.verdict == "disagrees":
                what = about(row.quantity, row.name)
                yield f"{_pair(outcome)} disagree in {what}: {row.share:.1e} times what is tolerated"
        yield from (f"what would explain it: {explanation.words}" for explanation in why)


def _complaints(one: Told) -> Iterator[str]:
    """Why there is no verdict on a scene."""
    if one.examined.complaint:
        complaint = one.examined.complaint.removeprefix(f"{one.examined.name}: ")
        yield f"{one.why_not}: {complaint}" if one.why_not else complaint


def _undecided(one: Told) -> Iterator[str]:
    """Of what nothing can be said, and why."""
    for outcome in one.examined.outcomes:
        for row in worst_rows(outcome):
            if row.verdict == "not given":
                yield f"{row.verdict}: {why_undecided(row, outcome)}"
            elif row.verdict == "not tested":
                what = about(row.quantity, row.name)
                yield f"{_pair(outcome)}: {what} is {row.verdict}: {why_undecided(row, outcome)}"


def _notes(one: Told) -> Iterator[str]:
    """What the user should know of a scene, beside what is told already."""
    yield from (*one.examined.warnings, *one.examined.defaults)
    told = " ".join(_undecided(one))
    for outcome in one.examined.outcomes:
        yield from (line for line in (*outcome.missing, *outcome.notes) if line not in told)


SECTION = Section("verdict", "Verdict", 10, _blocks)
