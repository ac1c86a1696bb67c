"""The verdict of a run in words, for a terminal, for Markdown and for a page."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import islice
from typing import get_args

from validate.ci.baseline import WHY, Move, MoveVerdict, Since
from validate.ci.record import Record
from validate.comparison.compare import Verdict
from validate.comparison.examined import Examined
from validate.exit_status import ExitStatus
from validate.output.report import (
    about,
    agreeing,
    counted_as,
    explained_lines,
    held_to,
    pair_of,
    severity,
    share_of,
    silent_lines,
    told_row,
    when,
)
from validate.plain_text import gathered, shown, some_of
from validate.solvers.plain import SolverFailed

NAMED = 10  # scenes that a sentence names of each verdict
NUMBERS = 8  # numbers in a sentence: the table's notes have them all
NOT_TESTED = "not tested"
NEXT = {
    "refused": "pointcoord plan {} says how far each input can go and what holds it there",
    ExitStatus.WRONG_INPUT.verdict: "mend {} as the message about it says",
    "failed": "report what failed on {}, with its file",
}
"""What to do about a scene that was not tested, by the reason."""
# The line of a scene tells of the last verdict that any of its numbers has.
OF_THE_LINE = ("not given", NOT_TESTED, "agrees", "disagrees")


def word(status: ExitStatus) -> str:
    """The verdict of a status on what was compared."""
    return {ExitStatus.AGREE: "agrees", ExitStatus.DISAGREE: "disagrees"}.get(status, NOT_TESTED)


def standing(examined: Examined) -> tuple[str, str]:
    """The verdict on a scene, and why there is none, in a word or two; empty where claims are too wide."""
    status = examined.status
    if word(status) != NOT_TESTED or not examined.complaint:
        return word(status), ""
    if status is ExitStatus.WRONG_INPUT:
        return NOT_TESTED, status.verdict
    return NOT_TESTED, "failed" if status is ExitStatus.NOT_FINISHED else "refused"


def sentence(record: Record) -> str:
    """What a run comes to; what does not agree is named."""
    parts = [*_of_files(record)] if record.files else [*_of_scenes(record)]
    if record.factor != 1.0:
        parts.append(held_to(record.factor))
    return "; ".join([*parts, *_since(record)])


def _of_files(record: Record) -> Iterator[str]:
    for name, file in record.files.items():
        rows, source = file.outcome.rows, file.outcome.solutions[0].formulation
        by_verdict = gathered((row.verdict, about(row.quantity, row.name)) for row in rows)
        agree = len(by_verdict.pop("agrees", ()))
        yield f"{source} and the car of {name}: {agree} of {len(rows)} agree"
        yield from _by_verdict(by_verdict)


def _by_verdict(names: Mapping[str, Sequence[str]]) -> Iterator[str]:
    yield from (f"{verdict}: {some_of(some, NAMED)}" for verdict, some in sorted(names.items()))


def _of_scenes(record: Record) -> Iterator[str]:
    verdicts = ((*standing(one), one.name) for one in record.examined)
    by_verdict = gathered((f"{verdict} ({why})" if why else verdict, name) for verdict, why, name in verdicts)
    yield agreeing(len(by_verdict.pop("agrees", ())), len(record.names))
    yield from _by_verdict(by_verdict)
    if record.not_run:
        yield f"not run ({record.stopped}): {some_of(record.not_run, NAMED)}"
    # How much of what is asked for was compared, of a solver that may give what it has.
    stated = [outcome.counts for outcome in record.outcomes if outcome.stated]
    counts = {key: sum(one[key] for one in stated) for key in (*get_args(Verdict), "given back")}
    if count := sum(counts[verdict] for verdict in get_args(Verdict)):
        rest = "".join(f", {counts[v]} {v}" for v in ("not given", NOT_TESTED) if counts[v])
        back = (
            f", {counts['given back']} of them data that the solver was given" if counts["given back"] else ""
        )
        yield f"{counts['agrees'] + counts['disagrees']} of {count} numbers compared{back}{rest}"


def _since(record: Record) -> Iterator[str]:
    """What moved, went or could not be held to the baseline."""
    if record.baseline is None:
        return
    held = [since for since in record.since if since.compared]
    moved = [since.scene for since in held if since.moved]
    target = shown(record.baseline.target)
    if moved:
        yield f"moved since the baseline {target}: {some_of(moved, NAMED)}"
    else:
        yield f"nothing {'moved since' if held else 'could be compared with'} the baseline {target}"
    lost = [
        f"{since.scene}: {some_of(whats, NUMBERS)} by {formulation}"
        for since in record.since
        for formulation, whats in _by_formulation(since.lost).items()
    ]
    if lost:
        yield f"given then and not now: {'; '.join(lost)}"
    yield from (f"no verdict: {since.words}" for since in record.since if since.replaced)
    if record.gone:
        gone = [since.scene for since in record.gone]
        yield f"gone, in the baseline and not in this run: {some_of(gone, NAMED)}"


HEAD = ("scene", "verdict", "largest share of a tolerance, and where")
"""Of the table of scenes, in a terminal and in Markdown."""


def scene_row(examined: Examined) -> tuple[str, str, str]:
    """A scene in a line: its verdict, the largest share of a tolerance and where, or why there is none."""
    verdict, why = standing(examined)
    told = why or (silence(examined) if verdict == NOT_TESTED else "")
    if not told and (rows := [(row, outcome) for outcome in examined.outcomes for row in outcome.rows]):
        row, outcome = max(rows, key=lambda one: severity(one[0], OF_THE_LINE))
        told = f"{share_of(row.share):>4}  {about(row.quantity, row.name)} at {when(row, 4)}"
        if outcome is not examined.outcomes[0]:
            told += f", {outcome.solutions[0].formulation}"
    return examined.name, verdict, told


def scene_line(row: Sequence[str], seconds: float | str, width: int) -> str:
    """Such a row, or the head of all, in a terminal, where it is said as soon as the scene is done."""
    name, verdict, told = row
    took = f"{seconds:>5.1f} s" if isinstance(seconds, float) else seconds.rjust(7)
    said = verdict.upper() if verdict == "disagrees" else verdict
    return f"{name.ljust(width)}  {said:<10}  {took}  {told}".rstrip()


def scene_notes(examined: Examined) -> Iterator[str]:
    """What stands below the line of a scene: what would explain that it does not agree."""
    for outcome in examined.outcomes:
        if not outcome.passed:
            yield from (f"  cannot be used: {fault}" for fault in outcome.faults)
            yield from explained_lines(outcome)


def next_step(record: Record, verbose: bool = False) -> str:
    """What to do next where something is not as wanted; empty where all is."""
    by_standing = {standing(one): one for one in record.examined}
    steps = []
    if record.files and record.status is not ExitStatus.AGREE:
        steps.append("--report DIR draws the file's columns beside ours")
    elif any(not why and verdict != "agrees" for verdict, why in by_standing):
        table = "" if verbose else "-v prints the table of every quantity, "
        steps.append(f"{table}--report DIR makes a page with both models in motion")
    for (_, why), one in by_standing.items():
        solvers = [r.formulation for r in one.refusals if r.error == SolverFailed.__name__]
        if solvers and why == "refused":
            steps.append(f"mend {solvers[0]} as the message about it says")
        elif why in NEXT:
            steps.append(NEXT[why].format(one.name))
    if any(since.status is ExitStatus.DISAGREE for since in record.since):
        steps.append("if the new numbers are right, keep them by --save-baseline FILE")
    return f"Next: {'; '.join(steps)}." if steps else ""


Lines = Callable[[Examined], Iterator[str]]


def disagreements(examined: Examined) -> Iterator[str]:
    """What does not agree, the worst first, and what would explain it."""
    for outcome in examined.outcomes:
        for row in sorted(outcome.disagreements, key=lambda row: -row.share):
            yield f"{pair_of(outcome)}: {told_row(row)}"
        yield from (line.strip() for line in explained_lines(outcome))


def complaints(examined: Examined) -> Iterator[str]:
    """Why there is no verdict on a scene."""
    if examined.complaint:
        complaint, why = examined.complaint.removeprefix(f"{examined.name}: "), standing(examined)[1]
        yield f"{why}: {complaint}" if why else complaint


def undecided(examined: Examined) -> Iterator[str]:
    """Of what nothing can be said, and why; what has one reason together."""
    for outcome in examined.outcomes:
        yield from (f"{pair_of(outcome)}: {line.strip()}" for line in silent_lines(outcome))
        rows = sorted(outcome.undecided, key=lambda row: row.verdict == "not given")
        reasons = gathered((f"{row.verdict}: {row.why}", about(row.quantity, row.name)) for row in rows)
        yield from (f"{pair_of(outcome)}: {some_of(w, NUMBERS)}: {reason}" for reason, w in reasons.items())


def silence(examined: Examined) -> str:
    """Why there is no verdict on a scene that was solved, in one line."""
    whys = dict.fromkeys(line.partition(": ")[2] for line in undecided(examined))
    return "; ".join(islice(whys, 2))


def notes(examined: Examined) -> Iterator[str]:
    """What the user should know of a scene, beside what is told already."""
    yield from (*examined.warnings, *examined.defaults)
    told = " ".join(undecided(examined))
    for outcome in examined.outcomes:
        yield from (line for line in (*outcome.missing, *outcome.notes) if line not in told)


def by_scene(record: Record, *lines: Lines) -> list[str]:
    """Lines of all scenes, each once, with the scenes that it is about."""
    told = []
    for of in lines:
        scenes = gathered((line, one.name) for one in record.examined for line in of(one))
        told += [f"{some_of([*dict.fromkeys(names)], NAMED)}: {line}" for line, names in scenes.items()]
    return told


def since_lines(since: Since) -> Iterator[str]:
    """What of a scene is not as it was in the baseline, the farthest moved first; and how much is."""
    if since.words:
        yield since.words
    for move in sorted(since.moved, key=lambda move: -move.row.share):
        yield f"MOVED, solved by {move.formulation}: {told_row(move.row)}"
    shared = {move.formulation for move in since.moves if move.verdict not in ("new", "gone")}
    untold: tuple[MoveVerdict, ...] = ("new", "gone", "not tested")
    for verdict in untold:
        found = _by_formulation(move for move in since.moves if move.verdict == verdict)
        for formulation, whats in found.items():
            what = ", ".join(whats) if formulation in shared else "every number"
            yield f"{verdict}, {WHY[verdict]}: {what} by {formulation}"
    if same := sum(move.verdict == "agrees" for move in since.moves):
        yield f"{counted_as(same, 'number')} did not move"


def _by_formulation(moves: Iterable[Move]) -> dict[str, list[str]]:
    """What the numbers of each formulation are, in words."""
    return gathered((move.formulation, about(move.row.quantity, move.row.name)) for move in moves)
