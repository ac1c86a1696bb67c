"""The verdict in a sentence, and what each scene has to say beside its numbers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from validate.ci.record import why_undecided
from validate.exit_status import ExitStatus
from validate.html.run import Run, Told
from validate.html.section import Block, Paragraph, Section
from validate.output.report import about, worst_rows

VERDICTS = {ExitStatus.AGREE: "agrees", ExitStatus.DISAGREE: "disagrees"}
# Lines of all scenes together, at most: there may be hundreds of scenes.
LINES = 150


def _blocks(run: Run) -> Sequence[Block]:
    # Several pairs of formulations may say the same. What concerns the verdict goes first.
    lines = list(dict.fromkeys(line for of in (_reasons, _notes) for one in run.told for line in of(one)))
    notes = [Paragraph(line) for line in lines[:LINES]]
    if len(lines) > LINES:
        notes.append(Paragraph(f"{len(lines) - LINES} more such lines are in the data beside this page."))
    # Times compare nothing that could be right or wrong.
    verdict = "" if run.head.kind == "cost" else VERDICTS.get(run.status, "not tested")
    return [Paragraph(run.sentence, verdict), *notes]


def _reasons(one: Told) -> Iterator[str]:
    """Why there is no verdict, or what does not agree and what would explain it."""
    name = one.examined.name
    if one.examined.complaint:
        yield _of(name, one.examined.complaint)
    for outcome, why in zip(one.examined.outcomes, one.explained, strict=True):
        pair = " and ".join(solution.formulation for solution in outcome.solutions)
        for row in worst_rows(outcome):
            what = about(row.quantity, row.name)
            if row.verdict == "disagrees":
                yield f"{name}: {pair} disagree in {what}: {row.share:.1e} times what is tolerated"
            elif row.verdict != "agrees":
                yield f"{name}: {pair}: {what} is {row.verdict}: {why_undecided(row, outcome)}"
        yield from (f"{name}: what would explain it: {explanation.words}" for explanation in why)


def _notes(one: Told) -> Iterator[str]:
    """What the user should know of a scene."""
    name = one.examined.name
    for line in (*one.examined.warnings, *one.examined.defaults):
        yield f"{name}: {line}"
    for outcome in one.examined.outcomes:
        yield from (f"{name}: {line}" for line in (*outcome.missing, *outcome.notes))


def _of(name: str, line: str) -> str:
    """A line that begins with the name of its scene, as some do by themselves."""
    return line if line.startswith(name) else f"{name}: {line}"


SECTION = Section("verdict", "Verdict", 10, _blocks)
