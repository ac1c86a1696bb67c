"""A run in Markdown, as services for continuous integration show beside it.

Names and messages are text: what could act in Markdown or HTML is written as a character reference, which is
never part of the markup.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from validate.ci.baseline import Since
from validate.ci.moves import told_apart, worst_moves
from validate.ci.record import Record, explained, why_undecided
from validate.comparison.compare import Comparison, Outcome
from validate.exit_status import MEANINGS, ExitStatus
from validate.output.report import about, agreeing, heading, held_to, when
from validate.plain_text import shown

# A service shows no more than a megabyte of it (GitHub: 1 MiB a step); a line has some 200 characters.
LISTED = 200
ROWS = 500
VERDICTS = ("disagrees", "not given", "not tested", "agrees")
SAFE = frozenset(" ,.;:/()=-'?")
"""Characters beside letters and digits that begin nothing inside of a line."""


def markdown(text: str) -> str:
    """Text that Markdown shows as it is, in one line."""
    return "".join(_character(text, i) for i in range(len(text))) if (text := shown(text)) else ""


def _character(text: str, place: int) -> str:
    one = text[place]
    inside = 0 < place < len(text) - 1 and text[place - 1].isalnum() and text[place + 1].isalnum()
    # A colon before slashes makes a link; an underscore inside of a word is one.
    if one == ":" and text[place + 1 : place + 3] == "//":
        return "&#58;"
    if one.isalnum() or (one in SAFE and (place or one == "/")) or (one == "_" and inside):
        return one
    return f"&#{ord(one)};"


def summary(record: Record, status: ExitStatus) -> str:
    """The Markdown of a run that ends with a status."""
    blocks = ["## pointcoord validate", _verdict(record, status)]
    if record.factor != 1.0:
        blocks.append(f"Differences are **{markdown(held_to(record.factor))}**.")
    blocks += _agreement(record)
    blocks += _list("What disagrees", [*_disagreements(record)])
    blocks += _list("Without a verdict", [*_undecided(record)])
    blocks += _list("Not compared", [*_refused(record)])
    blocks += _list(
        "Not run", [f"scene {markdown(name)}: {markdown(record.stopped)}" for name in record.not_run]
    )
    if record.baseline is not None:
        blocks += _baseline(record)
    return "\n\n".join(blocks) + "\n"


def _verdict(record: Record, status: ExitStatus) -> str:
    """One sentence."""
    count = len(record.names)
    agree = sum(one.status is ExitStatus.AGREE for one in record.examined)
    wrong = sum(any(outcome.disagreements for outcome in one.outcomes) for one in record.examined)
    parts = [agreeing(agree, count)]
    if wrong:
        parts.append(f"{wrong} {'disagrees' if wrong == 1 else 'disagree'}")
    silent = len(record.examined) - agree - wrong
    if silent:
        parts.append(f"{silent} {'has' if silent == 1 else 'have'} no verdict")
    if record.not_run:
        parts.append(f"{len(record.not_run)} not run")
    moved = sum(bool(since.moved) for since in record.since)
    if record.baseline is not None:
        parts.append(f"{moved} moved since the baseline")
        if lost := sum(bool(since.lost) for since in record.since):
            parts.append(f"{lost} {'lacks' if lost == 1 else 'lack'} numbers of the baseline")
    return (
        f"**{status.verdict.capitalize()}**: {', '.join(parts)} "
        f"(exit status {status.value}: {markdown(MEANINGS[status])})."
    )


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def _limited(rows: Sequence[Sequence[str]], head: Sequence[str]) -> list[str]:
    """A table in as many rows as fit."""
    if not rows:
        return []
    blocks = [_table(head, rows[:ROWS])]
    if len(rows) > ROWS:
        blocks.append(f"and {len(rows) - ROWS} rows more.")
    return blocks


def _list(title: str, lines: Sequence[str]) -> list[str]:
    if not lines:
        return []
    more = [f"- and {len(lines) - LISTED} more"] if len(lines) > LISTED else []
    return [f"### {title}", "\n".join([*(f"- {line}" for line in lines[:LISTED]), *more])]


def _agreement(record: Record) -> list[str]:
    """Scenes x quantities."""
    cases = [*record.outcomes]
    headings = dict.fromkeys(heading(r.quantity, r.name) for _, outcome in cases for r in outcome.rows)
    rows = []
    for examined, outcome in cases:
        cells = [
            _cell([row for row in outcome.rows if heading(row.quantity, row.name) == one]) for one in headings
        ]
        pair = " and ".join(solution.formulation for solution in outcome.solutions)
        rows.append([markdown(examined.name), markdown(pair), *cells])
    return _limited(rows, ["scene", "compared", *map(markdown, headings)])


def _cell(rows: Sequence[Comparison]) -> str:
    """The verdicts of a quantity, the worst first, counted where there are several."""
    counts = {one: sum(row.verdict == one for row in rows) for one in VERDICTS}
    found = [one for one in VERDICTS if counts[one]]
    if not found:
        return "not asked"
    told = [one if len(found) == 1 else f"{one} {counts[one]}" for one in found]
    if counts["disagrees"]:
        told[0] = f"**{told[0]}**, {_times(max(row.share for row in rows if row.verdict == 'disagrees'))}"
    return ", ".join(told)


def _times(share: float) -> str:
    return f"{share:.1e} times" if math.isfinite(share) else "not a number"


def _beyond(share: float) -> str:
    return f"up to {share:.1e} times the tolerance" if math.isfinite(share) else "no tolerance allows that"


def _told(value: float, unit: str) -> str:
    return f"{value:.3g} {unit}" if math.isfinite(value) else "not a number"


def _where(scene: str, outcome: Outcome, row: Comparison) -> str:
    pair = " and ".join(solution.formulation for solution in outcome.solutions)
    return f"scene {markdown(scene)}, {markdown(pair)}: {markdown(about(row.quantity, row.name))}"


def _disagreements(record: Record) -> Iterator[str]:
    for examined, outcome in record.outcomes:
        for row in sorted(outcome.disagreements, key=lambda row: -row.share):
            why = [f"; what would explain it: {markdown(words)}" for words in explained(row, outcome)]
            yield (
                f"{_where(examined.name, outcome, row)}: {_told(row.difference, row.unit)} apart at "
                f"{markdown(when(row, 6))}, tolerance there {_told(row.tolerance, row.unit)}; "
                f"{_beyond(row.share)}{''.join(why[:1])}"
            )


def _undecided(record: Record) -> Iterator[str]:
    """Rows that say nothing, with the reason; those of one reason together."""
    for examined, outcome in record.outcomes:
        found: dict[str, list[str]] = {}
        for row in outcome.undecided:
            reason = f"{row.verdict}: {why_undecided(row, outcome)}"
            found.setdefault(reason, []).append(about(row.quantity, row.name))
        pair = " and ".join(solution.formulation for solution in outcome.solutions)
        where = f"scene {markdown(examined.name)}, {markdown(pair)}"
        told = [outcome.why_no_verdict, *(f"cannot be used: {fault}" for fault in outcome.faults)]
        yield from (f"{where}: {markdown(line)}" for line in told if line)
        for reason, whats in found.items():
            yield f"{where}: {markdown(', '.join(whats))}: {markdown(reason)}"


def _refused(record: Record) -> Iterator[str]:
    for examined in record.examined:
        if examined.complaint:
            yield f"scene {markdown(examined.name)}: {markdown(examined.complaint)}"


def _baseline(record: Record) -> list[str]:
    blocks = [f"### Since the baseline {markdown(str(record.baseline))}"]
    rows = [cells for since in record.since for cells in _moves(since)]
    head = ["scene", "solved by", "quantity", "worst at", "moved", "bound", "moved / bound", "verdict"]
    blocks += _limited(rows, head)
    told = [markdown(line) for line in told_apart(record.since, record.gone)]
    more = [f"and {len(told) - LISTED} more"] if len(told) > LISTED else []
    if told:
        blocks.append("\n".join(f"- {line}" for line in (*told[:LISTED], *more)))
    return blocks


def _moves(since: Since) -> Iterator[list[str]]:
    for move in worst_moves(since):
        yield [
            markdown(since.scene),
            markdown(move.formulation),
            markdown(heading(move.quantity, move.name)),
            markdown(move.name),
            _told(move.moved, move.unit),
            _told(move.bound, move.unit),
            f"{move.share:.2g}" if math.isfinite(move.share) else "not a number",
            f"**{move.verdict}**" if move.verdict == "moved" else move.verdict,
        ]
