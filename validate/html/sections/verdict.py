"""The verdict in a sentence, and what each scene has to say beside its numbers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from validate.exit_status import ExitStatus
from validate.html.run import Run, Told
from validate.html.section import Block, Paragraph, Section

VERDICTS = {ExitStatus.AGREE: "agrees", ExitStatus.DISAGREE: "disagrees"}


def _blocks(run: Run) -> Sequence[Block]:
    # Several pairs of formulations may say the same.
    lines = dict.fromkeys(line for one in run.told for line in _notes(one))
    notes = [Paragraph(line) for line in lines]
    return [Paragraph(run.sentence, VERDICTS.get(run.status, "not tested")), *notes]


def _notes(one: Told) -> Iterator[str]:
    """Why there is no verdict, what the user should know, what would explain a disagreement."""
    name = one.examined.name
    if one.examined.complaint:
        yield f"{name}: {one.examined.complaint}"
    for line in (*one.examined.warnings, *one.examined.defaults):
        yield f"{name}: {line}"
    for outcome, why in zip(one.examined.outcomes, one.explained, strict=True):
        yield from (f"{name}: {line}" for line in (*outcome.missing, *outcome.notes))
        yield from (f"{name}: what would explain it: {explanation.words}" for explanation in why)


SECTION = Section("verdict", "Verdict", 10, _blocks)
