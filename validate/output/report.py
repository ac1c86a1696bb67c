"""Results of comparisons as tables and lines to print, and as plain data for JSON."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence, Sized
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from pointcoord.effects.registry import QUANTITIES
from validate.comparison.compare import Comparison, Outcome
from validate.comparison.examined import Examined
from validate.comparison.findings import Finding
from validate.output.table import Cell, Part, Table
from validate.paper.tables import WHY_NOT_EQUAL, PaperRow, root_mean_square
from validate.plain_text import counted_as, gathered, shown
from validate.tables.units import degrees_of

if TYPE_CHECKING:  # most runs compare no file
    from validate.measured.comparing import DataOutcome

MOST_EXPLANATIONS = 3  # number of explanations printed

# "share": difference / tolerance, the largest of all numbers of the quantity; above 1 the quantity disagrees.
HEAD = ("quantity", "where", "largest difference", "tolerance", "at", "share", "limited by", "verdict")

# Verdicts in order of increasing importance for the row of a quantity.
OF_EVERYTHING = ("agrees", "not tested", "not given", "disagrees")
OF_WHAT_IS_GIVEN = ("not given", "agrees", "not tested", "disagrees")


def in_degrees(value: float, unit: str) -> str:
    """A number with two significant digits and its unit, angles in degrees; a dash for no number."""
    factor, unit = degrees_of(unit)
    return "-" if math.isnan(value) else f"{factor * value:.1e} {unit}"


def used(share: float) -> str:
    """How much of its tolerance a number uses: 37% of its tolerance, 18,000 times its tolerance."""
    text = share_of(share)
    words = " of its tolerance" if text.endswith("%") else " its tolerance"
    return text + words if math.isfinite(share) else text


def share_of(share: float) -> str:
    """A share of a tolerance: 37%, 18,000 times."""
    if not math.isfinite(share):
        return "not a number"
    if share <= 1.0:
        return f"{100.0 * share:.0f}%" if share >= 0.005 else "<1%"
    return f"{f'{share:.3g}' if share < 100.0 else f'{share:,.0f}' if share < 1e6 else f'{share:.1e}'} times"


def when(row: Comparison, digits: int = 9) -> str:
    """The instant at which a row is worst, or the place in a file of results."""
    return row.place or f"{row.instant:.{digits}g} s"


def heading(quantity: str, name: str) -> str:
    """The heading of a number in a table: its quantity; for a number of the whole car its own name."""
    return name if QUANTITIES[quantity].of == "car" else QUANTITIES[quantity].words


def about(quantity: str, name: str) -> str:
    """A number in words, such as `position of wheel_centre`, or `camber`."""
    given = QUANTITIES[quantity]
    return name if given.of == "car" else f"{given.words} of {name}"


def told_row(row: Comparison) -> str:
    """The comparison of a number in one sentence, for lists, test results and failed tests."""
    what = about(row.quantity, row.name)
    if not math.isfinite(row.difference):
        return f"{what}: not a number at {when(row)}"
    return (
        f"{what}: difference {row.difference:.3g} {row.unit}, tolerance {row.tolerance:.3g} {row.unit} at "
        f"{when(row)}; at most {used(row.share)}"
    )


def pair_of(outcome: Outcome) -> str:
    """The names of the two formulations compared, such as `pointcoord and absolute`."""
    return " and ".join(solution.formulation for solution in outcome.solutions)


def worst_rows(outcome: Outcome) -> list[Comparison]:
    """For each quantity the row that uses most of its tolerance, or exceeds it the most."""
    # A solver that states an accuracy may give only some of the numbers.
    return list(worst_of(outcome.rows, OF_WHAT_IS_GIVEN if outcome.stated else OF_EVERYTHING).values())


def worst_of(rows: Iterable[Comparison], order: Sequence[str] = OF_WHAT_IS_GIVEN) -> dict[str, Comparison]:
    """By heading, the row with the last verdict in an order; among equal verdicts, the largest share."""
    of_one = gathered((heading(row.quantity, row.name), row) for row in rows)
    return {words: max(some, key=lambda row: severity(row, order)) for words, some in of_one.items()}


def severity(row: Comparison, order: Sequence[str]) -> tuple[int, float]:
    """The sort key of the worst row: the place of its verdict in an order, then its share."""
    return order.index(row.verdict), 0.0 if math.isnan(row.share) else row.share


def held_to(factor: float) -> str:
    """The tolerances of the run, in words."""
    if factor == 1.0:
        return "tolerances as derived"
    return f"tolerances are not as derived but {factor!r} times the derived tolerances"


def share_of_all(done: Sized, every: Sized, noun: str) -> str:
    """How much of a run is done: 3 of 20 scenes; empty if nothing is done."""
    return f"{len(done)} of {counted_as(len(every), noun)}" if done else ""


def outcome_parts(outcome: Outcome, over: str = "", absent: Sequence[str] = ()) -> Iterator[Part]:
    """A comparison as a table with a heading and notes; angles are in degrees.

    Args:
        over: for a file of results: the abscissa of its rows, such as time.
        absent: for a file of results: the numbers that the scene asks for and the file lacks.
    """
    factor = f"; {held_to(outcome.factor)}" if outcome.factor != 1.0 else ""
    times = len(outcome.solutions[0].times)
    count = rows_over(times, over) if over else counted_as(times, "instant")
    yield f"{outcome.scene}: {pair_of(outcome)}, {count}{factor}"
    lacking: list[str | Cell] = ["", *["-"] * 5, Cell("not given")]
    yield Table(HEAD, (*quantity_rows(outcome), *((words, *lacking) for words in absent)))
    yield from (f"  {line}" for line in silent_lines(outcome))
    remarks = (*outcome.missing, *(note for note in outcome.notes if note not in outcome.faults))
    yield from (f"  note: {note}" for note in remarks)
    yield from (f"  {line}" for line in explained_lines(outcome))


def rows_over(rows: int, over: str) -> str:
    """The rows of a file in words, with their abscissa if it is one column: 11 rows over bump [mm]."""
    return counted_as(rows, "row") + ("" if over == "row" else f" over {shown(over)}")


def quantity_rows(outcome: Outcome) -> Iterator[tuple[str | Cell, ...]]:
    """A row for each quantity, with the columns of `HEAD`; angles are in degrees.

    A row has the largest difference with its place and tolerance; the largest share of a tolerance, which may
    be that of another number; and the verdict of the row from `worst_rows`.
    """
    of_one = gathered((heading(row.quantity, row.name), row) for row in outcome.rows)
    for worst in worst_rows(outcome):
        words = heading(worst.quantity, worst.name)
        given = [row for row in of_one[words] if row.verdict != "not given"]
        largest = max(given, key=lambda row: row.difference, default=worst)
        text = worst.verdict.upper() if worst.verdict == "disagrees" else worst.verdict
        if worst.verdict in ("disagrees", "not tested") and worst is not largest:
            text += f": {worst.name}"
        numbers = ["-"] * 5
        if given:
            size, held = (in_degrees(n, largest.unit) for n in (largest.difference, largest.tolerance))
            # The tolerance is shown without its unit, which is that of the difference.
            numbers = [size, held.partition(" ")[0], when(largest, 4)]
            numbers += [share_of(max(row.share for row in given)), largest.rests_on]
        name = "" if QUANTITIES[largest.quantity].of == "car" else largest.name
        yield words, name, *numbers, Cell(text, verdict=worst.verdict)


def file_parts(found: DataOutcome) -> Iterator[Part]:
    """The table of a file of results, and how many numbers were compared."""
    yield from outcome_parts(found.outcome, found.over, found.absent)
    verdicts = Counter(row.verdict for row in found.outcome.rows)
    # Singular and plural: 1 agrees, 2 agree.
    counts = (f"{n} {one if n == 1 else one.removesuffix('s')}" for one, n in verdicts.items())
    # A number is not tested if nothing can be compared with it, or if its tolerance hides any error.
    tested = verdicts.total() - verdicts["not tested"]
    total = f"{counted_as(tested, 'number')} compared" if tested else "Nothing was compared"
    yield f"{total}: {', '.join(counts)}."


def silent_lines(outcome: Outcome) -> Iterator[str]:
    """Why there is no verdict if the rows do not show it, and which given data cannot be used."""
    if outcome.why_no_verdict:
        yield f"no verdict: {outcome.why_no_verdict}"
    yield from (f"cannot be used: {fault}" for fault in outcome.faults)


def explained_lines(outcome: Outcome) -> Iterator[str]:
    """Possible explanations of a disagreement, the likeliest first."""
    yield from (f"possible explanation: {one.words}" for one in outcome.explanations[:MOST_EXPLANATIONS])


def printed_parts(examined: Sequence[Examined], findings: Sequence[Finding]) -> Iterator[Part]:
    """The errors of the paper's formulas as printed, with their errata, and the scenes they cannot solve."""
    if findings:
        head = ("scene", "wrong quantity", "largest difference", "erratum")
        rows = []
        for one in findings:
            worst, words = one.worst, QUANTITIES[one.quantity].words
            size = (
                f"{worst.difference:.1e} {worst.unit}" if math.isfinite(worst.difference) else "not a number"
            )
            rows.append((one.scene, words, Cell(size, worst.name), one.erratum))
        yield Table(head, tuple(rows), caption="The paper's formulas as printed, against the corrected ones.")
    elif tried := [one.name for one in examined if one.printed is not None]:
        yield f"The paper's formulas as printed agree in {', '.join(tried)}."
    for scene in examined:
        if scene.unprinted is not None:
            yield f"The paper's formulas as printed cannot solve {scene.name}: {scene.unprinted.message}"


def paper_tables(rows: Sequence[PaperRow]) -> Iterator[Table]:
    """Tables 2 and 3, printed and computed."""
    for number, label in ((2, "theta [deg]"), (3, "S [mm]")):
        lines = tuple(
            (
                *(f"{row.printed.time:.2f}", f"{row.printed.input:g}", f"{row.input:.2f}"),
                "({:g}, {:g}, {:g})".format(*row.printed.wheel_centre),
                "({:.1f}, {:.1f}, {:.1f})".format(*row.wheel_centre),
                *(f"{row.position_gap:.1f}", f"{row.omega_gap:.2f}", f"{row.alpha_gap:.2f}"),
                row.printed.slip,
            )
            for row in rows
            if row.printed.table == number
        )
        centre = ("wheel centre, printed", "computed [mm]", "difference")
        head = ("t [s]", label, "computed", *centre, "omega difference", "alpha difference", "misprint")
        yield Table(head, lines, caption=f"Table {number}, printed and computed.")


def paper_sentence(rows: Sequence[PaperRow]) -> str:
    """The r.m.s. difference between the printed tables and the motion of the paper's own hardpoints."""
    return f"Wheel centre, both tables: difference {root_mean_square(rows):.1f} mm r.m.s. per coordinate."


def examined_data(examined: Examined, file: DataOutcome | None = None) -> dict[str, Any]:
    """One scene as plain data: its verdict, every comparison, every refusal and every failure.

    Args:
        file: the file of results that the scene's car is compared with, if any.
    """
    return {
        "scene": examined.name,
        "title": examined.title,
        "exit_status": examined.status.value,
        "verdict": examined.status.verdict,
        "problem": examined.problem,
        "warnings": list(examined.warnings),
        "closing": examined.closing,
        "defaults": list(examined.defaults),
        "solved_by": list(examined.solved),
        "comparisons": [outcome_data(outcome, file) for outcome in examined.outcomes],
        "refusals": [asdict(refusal) for refusal in examined.refusals],
        "failures": [asdict(failure) for failure in examined.failures],
        "refusal_of_printed_formulas": None if examined.unprinted is None else asdict(examined.unprinted),
    }


def outcome_data(outcome: Outcome, file: DataOutcome | None = None) -> dict[str, Any]:
    """One comparison as plain data; for a file of results also its accuracy, abscissa and missing numbers."""
    stated = (s.accuracy.stated for s in outcome.solutions)
    of_file = {}
    if file is not None:
        of_file = {"accuracy": file.accuracy, "over": file.over, "not_given": list(file.absent)}
    return {
        "scene": outcome.scene,
        "formulations": [s.formulation for s in outcome.solutions],
        "instants": len(outcome.solutions[0].times),
        "agreed": outcome.passed,
        "tolerance_factor": outcome.factor,
        "accuracy": next((accuracy for accuracy in stated if accuracy is not None), None),
        "rows": [asdict(row) for row in outcome.rows],
        "missing": list(outcome.missing),
        "notes": list(outcome.notes),
        "unusable": list(outcome.faults),
        "why_no_verdict": outcome.why_no_verdict,
        "explanations": [asdict(one) for one in outcome.explanations],
        **of_file,
    }


def paper_data(rows: Sequence[PaperRow]) -> dict[str, Any]:
    """The comparison with the printed tables as plain data."""
    return {
        "explanation": WHY_NOT_EQUAL,
        "wheel_centre_rms_mm": root_mean_square(rows),
        "rows": [asdict(row) for row in rows],
    }
