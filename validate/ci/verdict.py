"""The verdict of a run in words, for the terminal, the Markdown summary and the HTML page."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import islice
from typing import get_args

from validate.ci.baseline import WHY, Move, MoveVerdict, Since
from validate.ci.record import Record
from validate.comparison.compare import Outcome, Verdict
from validate.comparison.examined import Examined
from validate.exit_status import ExitStatus
from validate.output import report
from validate.plain_text import counted_as, gathered, shown, some_of, typed
from validate.solvers.plain import SolverFailed

NAMED = 10  # largest number of scenes that a sentence names for each verdict
FAULTS = 3  # largest number of lines on unusable data below the line of a scene
NUMBERS = 8  # largest number of numbers in a sentence: the notes of the table have them all
NOT_TESTED = "not tested"
VERDICTS = {ExitStatus.AGREE: "agrees", ExitStatus.DISAGREE: "disagrees"}
# Why a scene has no verdict, and what to do about it.
REASONS = {ExitStatus.WRONG_INPUT: "wrong input", ExitStatus.NOT_FINISHED: "failed"}
NEXT = {
    "refused": "pointcoord plan {} shows how far each input can go and what stops it",
    "wrong input": "correct {} as its message says",
    "failed": "report the failure on {}, with its file",
}
# The line of a scene shows the number whose verdict is last in this order.
OF_THE_LINE = ("not given", NOT_TESTED, "agrees", "disagrees")
HEAD = ("scene", "verdict", "largest share of a tolerance, and where")
"""The header of the table of scenes, on the terminal and in Markdown."""
Lines = Callable[[Examined], Iterator[str]]


def word(status: ExitStatus) -> str:
    """The verdict that belongs to an exit status."""
    return VERDICTS.get(status, NOT_TESTED)


def standing(examined: Examined) -> tuple[str, str]:
    """The verdict on a scene, and the reason if it was not tested: wrong input, failed or refused.

    The reason is empty if the scene was solved, but error bounds are too wide to test it.
    """
    verdict = word(examined.status)
    why = REASONS.get(examined.status, "refused") if verdict == NOT_TESTED and examined.complaint else ""
    return verdict, why


def sentence(record: Record) -> str:
    """The verdict of a run in a sentence, which names everything that does not agree."""
    parts = [*(_of_files(record) if record.files else _of_scenes(record))]
    parts += [report.held_to(record.factor)] if record.factor != 1.0 else []
    return "; ".join([*parts, *_since(record)])


def _of_files(record: Record) -> Iterator[str]:
    for name, file in record.files.items():
        rows, source = file.outcome.rows, file.outcome.solutions[0].formulation
        by_verdict = gathered((str(row.verdict), report.about(row.quantity, row.name)) for row in rows)
        agree = len(by_verdict.pop("agrees", ()))
        yield f"{source} and the car of {name}: {agree} of {len(rows)} agree"
        yield from _named(by_verdict)


def _of_scenes(record: Record) -> Iterator[str]:
    verdicts = ((*standing(one), one.name) for one in record.examined)
    by_verdict = gathered((f"{verdict} ({why})" if why else verdict, name) for verdict, why, name in verdicts)
    agree, count = len(by_verdict.pop("agrees", ())), len(record.names)
    yield f"{agree} of {count} {'scene agrees' if count == 1 else 'scenes agree'}"
    yield from _named(by_verdict)
    if record.not_run:
        yield f"not run ({record.stopped}): {some_of(record.not_run, NAMED)}"
    # How many of the requested numbers were compared, for a solver that may give only some of them.
    stated = [outcome.counts for outcome in record.outcomes if outcome.stated]
    counts = {key: sum(one[key] for one in stated) for key in (*get_args(Verdict), "given back")}
    if every := sum(counts[verdict] for verdict in get_args(Verdict)):
        rest = "".join(f", {counts[v]} {v}" for v in ("not given", NOT_TESTED) if counts[v])
        back = f", {counts['given back']} of them input data of the solver" if counts["given back"] else ""
        yield f"{counts['agrees'] + counts['disagrees']} of {every} numbers compared{back}{rest}"


def _named(by_verdict: Mapping[str, Sequence[str]]) -> Iterator[str]:
    yield from (f"{verdict}: {some_of(some, NAMED)}" for verdict, some in sorted(by_verdict.items()))


def _since(record: Record) -> Iterator[str]:
    """Numbers and scenes that moved, are gone, or could not be compared with the baseline."""
    if record.baseline is None:
        return
    held = [since for since in record.since if since.compared]
    moved = [since.scene for since in held if since.moved]
    since_when = (
        f"{'moved since' if held else 'could be compared with'} the baseline {shown(record.baseline.target)}"
    )
    yield f"{since_when}: {some_of(moved, NAMED)}" if moved else f"nothing {since_when}"
    lost = [
        f"{since.scene}: {some_of(whats, NUMBERS)} by {formulation}"
        for since in record.since
        for formulation, whats in _by_formulation(since.lost).items()
    ]
    if lost:
        yield f"given in the baseline and not now: {'; '.join(lost)}"
    yield from (f"no verdict: {why}" for why in undecided_since(record))
    if gone := [since.scene for since in record.gone]:
        yield f"gone, in the baseline and not in this run: {some_of(gone, NAMED)}"


def undecided_since(record: Record) -> Iterator[str]:
    """Why scenes have no verdict on their movement since the baseline."""
    for since in record.since:
        if since.status is ExitStatus.NO_VERDICT:
            yield since.words or f"{since.scene}: some numbers are not tested"


def scene_row(examined: Examined) -> tuple[str, str, str]:
    """Name, verdict, and the largest share of a tolerance with its place, or the reason why there is none.

    If one formulation gives only some of the instants, the text says how many were compared.
    """
    verdict, text = standing(examined)
    if verdict == NOT_TESTED and not text:
        # Unusable data follow in lines of their own.
        text = silence(examined, 1 if any(outcome.faults for outcome in examined.outcomes) else 2)
    if not text and (rows := [(row, outcome) for outcome in examined.outcomes for row in outcome.rows]):
        row, outcome = max(rows, key=lambda one: report.severity(one[0], OF_THE_LINE))
        about, when = report.about(row.quantity, row.name), report.when(row, 4)
        text = f"{report.share_of(row.share):>4}  {about} at {when}"
        if outcome is not examined.outcomes[0]:
            text += f", {outcome.solutions[0].formulation}"
    asked = [(one.compared, len(one.solutions[1].times)) for one in examined.outcomes]
    few = (f"only {some} of {every} instants compared" for some, every in asked if some < every)
    return examined.name, verdict, "; ".join(filter(None, [text, *few]))


def scene_line(row: Sequence[str], seconds: float | str, width: int) -> str:
    """A row of `scene_row`, or `HEAD`, as a line on the terminal, printed as soon as the scene is done.

    Args:
        seconds: run time of the scene, or the heading of this column. width: width of the names.
    """
    name, verdict, text = row
    took = f"{seconds:>5.1f} s" if isinstance(seconds, float) else seconds.rjust(7)
    verdict = verdict.upper() if verdict == "disagrees" else verdict
    return f"{name.ljust(width)}  {verdict:<10}  {took}  {text}".rstrip()


def scene_notes(examined: Examined) -> Iterator[str]:
    """The lines below the line of a scene: unusable data, and possible explanations of a disagreement."""
    for outcome in examined.outcomes:
        if not outcome.passed:
            yield from (f"  cannot be used: {fault}" for fault in outcome.faults[:FAULTS])
            if more := outcome.faults[FAULTS:]:
                yield f"  cannot be used: {counted_as(len(more), 'further number')}; -v prints all lines"
            yield from (f"  {line}" for line in report.explained_lines(outcome))


def next_step(record: Record, verbose: bool = False) -> str:
    """What to do next if a scene does not agree; empty if all agree."""
    by_standing = {standing(one): one for one in record.examined}
    steps = []
    if record.files and record.status is not ExitStatus.AGREE:
        steps.append("--report DIR draws the columns of the file with the computed values")
    elif any(not why and verdict != "agrees" for verdict, why in by_standing):
        table = "" if verbose else "-v prints the table of every quantity, "
        steps.append(f"{table}--report DIR makes a page with both models in motion")
    for (_, why), one in by_standing.items():
        if solvers := [r.formulation for r in one.refusals if r.error == SolverFailed.__name__]:
            steps.append(f"correct {solvers[0]} as its message says")
        elif why:
            steps.append(NEXT[why].format(typed(one.name)))
    if any(since.status is ExitStatus.DISAGREE for since in record.since):
        steps.append("if the new numbers are right, save them with --save-baseline FILE")
    return f"Next: {'; '.join(steps)}." if steps else ""


def disagreements(examined: Examined) -> Iterator[str]:
    """The numbers that disagree, the worst first, and possible explanations."""
    for outcome in examined.outcomes:
        for row in sorted(outcome.disagreements, key=lambda row: -row.share):
            yield f"{report.pair_of(outcome)}: {report.told_row(row)}"
        yield from report.explained_lines(outcome)


def complaints(examined: Examined) -> Iterator[str]:
    """Why a scene was not compared."""
    if examined.complaint:
        complaint, why = examined.complaint.removeprefix(f"{examined.name}: "), standing(examined)[1]
        yield f"{why}: {complaint}" if why else complaint


def undecided(examined: Examined) -> Iterator[str]:
    """The numbers without a verdict, grouped by the reason."""
    for outcome in examined.outcomes:
        yield from (f"{report.pair_of(outcome)}: {line}" for line in _undecided(outcome))


def _undecided(outcome: Outcome) -> Iterator[str]:
    yield from report.silent_lines(outcome)
    rows = sorted(outcome.undecided, key=lambda row: row.verdict == "not given")
    reasons = gathered((f"{row.verdict}: {row.why}", report.about(row.quantity, row.name)) for row in rows)
    yield from (f"{some_of(words, NUMBERS)}: {reason}" for reason, words in reasons.items())


def silence(examined: Examined, most: int = 2) -> str:
    """Why a solved scene has no verdict, in one line: the first reasons."""
    whys = dict.fromkeys(line for outcome in examined.outcomes for line in _undecided(outcome))
    return "; ".join(islice(whys, most))


def notes(examined: Examined) -> Iterator[str]:
    """Warnings and notes on a scene, without those that `undecided` contains."""
    yield from (*examined.warnings, *examined.defaults)
    known = " ".join(undecided(examined))
    for outcome in examined.outcomes:
        yield from (line for line in (*outcome.missing, *outcome.notes) if line not in known)


def by_scene(record: Record, *lines: Lines) -> list[str]:
    """The lines of all scenes, equal lines once, each with the names of its scenes."""
    found = []
    for of in lines:
        scenes = gathered((line, one.name) for one in record.examined for line in of(one))
        found += [f"{some_of([*dict.fromkeys(names)], NAMED)}: {line}" for line, names in scenes.items()]
    return found


def since_lines(since: Since) -> Iterator[str]:
    """Differences of a scene from the baseline, the largest movement first, and the count of the rest."""
    if since.words:
        yield since.words
    for move in sorted(since.moved, key=lambda move: -move.row.share):
        yield f"MOVED, solved by {move.formulation}: {report.told_row(move.row)}"
    untold: tuple[MoveVerdict, ...] = ("new", "gone", "not tested")
    for verdict in untold:
        for formulation, whats in _by_formulation(m for m in since.moves if m.verdict == verdict).items():
            yield f"{verdict}, {WHY[verdict]}: {some_of(whats, NUMBERS)} by {formulation}"
    if same := sum(move.verdict == "agrees" for move in since.moves):
        yield f"{counted_as(same, 'number')} did not move"


def _by_formulation(moves: Iterable[Move]) -> dict[str, list[str]]:
    """The names of the moved numbers, by formulation."""
    return gathered((move.formulation, report.about(move.row.quantity, move.row.name)) for move in moves)
