"""The verdict in a sentence, and what each scene has to say beside its numbers."""

from __future__ import annotations

from collections.abc import Sequence

from validate.ci.verdict import by_scene, complaints, disagreements, notes, undecided, word
from validate.exit_status import ExitStatus
from validate.html.run import Run
from validate.html.section import Block, Paragraph, Section

# Lines of all scenes together, at most: there may be hundreds of scenes.
LINES = 150


def _blocks(run: Run) -> Sequence[Block]:
    # What concerns the verdict goes first, and what several scenes have to say is said once.
    of = (disagreements, complaints, undecided, notes)
    lines = by_scene(run.record, *of)
    told = [Paragraph(line) for line in lines[:LINES]]
    if len(lines) > LINES:
        told.append(Paragraph(f"{len(lines) - LINES} more such lines are in the data beside this page."))
    verdict = word(run.status)
    if run.head.kind == "cost" and run.status is ExitStatus.AGREE:
        # Times compare nothing that could be right or wrong.
        verdict = "measured"
    status = f"Exit status {run.status.value}: {run.head.verdict(run.status)}"
    return [Paragraph(run.sentence, verdict, status), *told]


SECTION = Section("verdict", "Verdict", 10, _blocks)
