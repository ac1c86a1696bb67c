"""Results as text for people and as plain data for machines."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import asdict
from typing import Any

from pointcoord.effects.registry import QUANTITIES
from validate.comparison.compare import Comparison, Outcome
from validate.comparison.examined import Examined
from validate.comparison.findings import Finding
from validate.diagnosis import Explanation
from validate.output.terminal import Part, Table, text_of
from validate.paper.tables import WHY_NOT_EQUAL, PaperRow, root_mean_square

MOST_EXPLANATIONS = 3  # that are printed

# "most used": the largest part of its tolerance that any number of the quantity uses; above 1 it disagrees.
HEAD = ("quantity", "where", "largest difference", "held to", "at", "most used", "resting on", "verdict")

# Verdicts from the one that tells least of a quantity to the one that tells most.
OF_EVERYTHING = ("agrees", "not tested", "not given", "disagrees")
OF_WHAT_IS_GIVEN = ("not given", "agrees", "not tested", "disagrees")


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Columns of text: words to the left, numbers to the right."""
    return _table(head, rows).text


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> Table:
    return Table(tuple(head), tuple(tuple(row) for row in rows))


def _with_unit(value: float, unit: str) -> str:
    """Two significant digits, as tolerances deserve."""
    return f"{value:.1e} {unit}" if math.isfinite(value) else "not a number"


def _told(rows: Sequence[Comparison], worst: Comparison) -> tuple[str, ...]:
    """A quantity's line: its largest difference, with where and what it is held to; the most of a tolerance
    that any of its numbers uses, which may be another number; and the verdict of the worst.

    Args:
        rows: all of the quantity. worst: the one of them that `worst_rows` tells.
    """
    given = [row for row in rows if row.verdict != "not given"]
    largest = max(given, key=lambda row: row.difference, default=worst)
    name = "" if _of_the_car(largest) else largest.name
    verdict = verdict_of(worst)
    if worst.verdict in ("disagrees", "not tested") and worst is not largest:
        verdict += f": {worst.name}"
    if not given:
        return name, "-", "-", "-", "-", "-", verdict
    # The unit is that of the difference beside it.
    tolerance = _with_unit(largest.tolerance, "").rstrip()
    used = _with_unit(max(row.share for row in given), "").rstrip()
    difference = _with_unit(largest.difference, largest.unit)
    return name, difference, tolerance, when(largest, 4), used, largest.rests_on, verdict


def when(row: Comparison, digits: int = 9) -> str:
    """At which instant a row is worst, or where in a file of results."""
    return row.place or f"{row.instant:.{digits}g} s"


def heading(quantity: str, name: str) -> str:
    """Under which quantity a number stands in a table; each number of the whole car is one of its own."""
    return name if QUANTITIES[quantity].of == "car" else QUANTITIES[quantity].words


def worst_rows(outcome: Outcome) -> list[Comparison]:
    """For each quantity the row that uses most of its tolerance, or exceeds it the most."""
    worst: dict[str, Comparison] = {}
    # A solver that is held to what it states need not give everything.
    order = OF_WHAT_IS_GIVEN if outcome.stated else OF_EVERYTHING
    for row in outcome.rows:
        key = heading(row.quantity, row.name)
        if key not in worst or _severity(row, order) > _severity(worst[key], order):
            worst[key] = row
    return list(worst.values())


def _of_the_car(row: Comparison) -> bool:
    """Whether a row is about a number that the whole car has, such as an angle of the wheel."""
    return QUANTITIES[row.quantity].of == "car"


def about(quantity: str, name: str) -> str:
    """What a number is, in words, such as position of a point; an angle of the wheel by its name."""
    kind = QUANTITIES[quantity]
    return name if kind.of == "car" else f"{kind.words} of {name}"


def _severity(row: Comparison, order: Sequence[str]) -> tuple[int, float]:
    return order.index(row.verdict), 0.0 if math.isnan(row.share) else row.share


def held_to(factor: float) -> str:
    """What differences are held to, in words."""
    if factor == 1.0:
        return "held to the derived tolerance"
    return f"held to {factor!r} times the derived tolerance, which is no longer the derived one"


def outcome_text(outcome: Outcome, explanations: Sequence[Explanation] = ()) -> str:
    """The agreement table of one scene and pair, what its tolerances rest on, what would explain it."""
    return text_of(outcome_parts(outcome, explanations))


def outcome_parts(outcome: Outcome, explanations: Sequence[Explanation] = ()) -> tuple[Part, ...]:
    """The same with its table apart."""
    first, second = (s.formulation for s in outcome.solutions)
    of_one: dict[str, list[Comparison]] = {}
    for row in outcome.rows:
        of_one.setdefault(heading(row.quantity, row.name), []).append(row)
    worst = {heading(row.quantity, row.name): row for row in worst_rows(outcome)}
    rows = [(words, *_told(mine, worst[words])) for words, mine in of_one.items()]
    factor = f"; {held_to(outcome.factor)}" if outcome.factor != 1.0 else ""
    instants = counted_as(len(outcome.solutions[0].times), "instant")
    lines: list[Part] = [
        f"{outcome.scene}: {first} and {second}, {instants}{factor}",
        _table(HEAD, rows),
    ]
    told = (*outcome.missing, *(note for note in outcome.notes if note not in outcome.faults))
    return (
        *lines,
        *verdict_lines(outcome),
        *(f"  note: {note}" for note in told),
        *explained_lines(explanations),
    )


def verdict_of(row: Comparison) -> str:
    """The verdict of a row in a table, and how far beyond its tolerance one lies that disagrees."""
    if row.verdict != "disagrees":
        return row.verdict
    return f"DISAGREES, {row.share:.1e} times" if math.isfinite(row.share) else "DISAGREES, not a number"


def counted_as(count: int, noun: str) -> str:
    """A number of things: 1 instant, 2 instants."""
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"


def agreeing(agreed: int, count: int) -> str:
    """How many scenes agree: 1 of 1 scene agrees, 2 of 3 scenes agree."""
    return f"{agreed} of {count} {'scene agrees' if count == 1 else 'scenes agree'}"


def verdict_lines(outcome: Outcome) -> list[str]:
    """What cannot be used, and why there is no verdict where the rows do not say it."""
    why = [f"  no verdict: {outcome.why_no_verdict}"] if outcome.why_no_verdict else []
    return [*why, *(f"  cannot be used: {fault}" for fault in outcome.faults)]


def explained_lines(explanations: Sequence[Explanation]) -> list[str]:
    """What would explain a disagreement, the likeliest first."""
    return [f"  what would explain it: {one.words}" for one in explanations[:MOST_EXPLANATIONS]]


def agreement_line(outcome: Outcome) -> str:
    """One line for a pair that agrees: how much of its tolerance a difference uses at most."""
    first, second = (s.formulation for s in outcome.solutions)
    worst = max(outcome.rows, key=lambda row: row.share if math.isfinite(row.share) else 0.0)
    return (
        f"{outcome.scene}: {first} and {second} agree in all {len(outcome.rows)} comparisons; no difference "
        f"uses more than {worst.share:.1e} of its tolerance ({about(worst.quantity, worst.name)})"
        + (f"; {held_to(outcome.factor)}" if outcome.factor != 1.0 else "")
    )


def findings_parts(findings: Sequence[Finding], scenes: Sequence[str]) -> tuple[Part, ...]:
    """What the printed formulas get wrong, each beside its erratum."""
    if not findings:
        return (f"The paper's printed formulas agree in {', '.join(scenes)}.",)
    rows = [
        (f.scene, QUANTITIES[f.quantity].words, _with_unit(f.worst.difference, f.worst.unit), f.erratum)
        for f in findings
    ]
    head = ("scene", "wrong quantity", "largest difference", "erratum")
    return "The paper's formulas as printed, against the mended ones:", _table(head, rows)


def paper_parts(rows: Sequence[PaperRow]) -> tuple[Part, ...]:
    """Tables 2 and 3, printed and computed."""
    parts: list[Part] = ["The paper's printed tables, row by row. " + WHY_NOT_EQUAL]
    for number_of_table, label in ((2, "theta [deg]"), (3, "S [mm]")):
        mine = [row for row in rows if row.printed.table == number_of_table]
        lines = [
            (
                f"{row.printed.time:.2f}",
                f"{row.printed.input:g}",
                f"{row.input:.2f}",
                _vector(row.printed.wheel_centre, "{:g}"),
                _vector(row.wheel_centre, "{:.1f}"),
                f"{row.position_gap:.1f}",
                f"{row.omega_gap:.2f}",
                f"{row.alpha_gap:.2f}",
                row.printed.slip,
            )
            for row in mine
        ]
        head = (
            "t [s]",
            label,
            "ours",
            "wheel centre, printed",
            "ours [mm]",
            "apart",
            "omega apart",
            "alpha apart",
            "slip of print",
        )
        parts += [f"Table {number_of_table}", _table(head, lines)]
    parts.append(f"Wheel centre, both tables: {root_mean_square(rows):.1f} mm r.m.s. per coordinate.")
    return tuple(parts)


def _vector(vector: Sequence[float], form: str) -> str:
    return "(" + ", ".join(form.format(component) for component in vector) + ")"


def examined_data(examined: Examined, explanations: Sequence[Sequence[Explanation]] = ()) -> dict[str, Any]:
    """One scene as plain data: its verdict, every comparison, and every reason why there is none.

    Args:
        explanations: of each comparison, what would explain that it disagrees.
    """
    told = explanations or [()] * len(examined.outcomes)
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
        "comparisons": [
            outcome_data(outcome, why) for outcome, why in zip(examined.outcomes, told, strict=True)
        ],
        "refusals": [asdict(refusal) for refusal in examined.refusals],
        "failures": [asdict(failure) for failure in examined.failures],
        "refusal_of_printed_formulas": None if examined.unprinted is None else asdict(examined.unprinted),
    }


def outcome_data(outcome: Outcome, explanations: Sequence[Explanation] = ()) -> dict[str, Any]:
    """One comparison as plain data."""
    return {
        "scene": outcome.scene,
        "formulations": [s.formulation for s in outcome.solutions],
        "instants": len(outcome.solutions[0].times),
        "agreed": outcome.passed,
        "tolerance_factor": outcome.factor,
        "accuracy": next(
            (s.accuracy.stated for s in outcome.solutions if s.accuracy.stated is not None), None
        ),
        "rows": [asdict(row) for row in outcome.rows],
        "missing": list(outcome.missing),
        "notes": list(outcome.notes),
        "unusable": list(outcome.faults),
        "why_no_verdict": outcome.why_no_verdict,
        "explanations": [asdict(one) for one in explanations],
    }


def finding_data(finding: Finding) -> dict[str, Any]:
    """A wrong printed quantity as plain data."""
    return {
        "scene": finding.scene,
        "quantity": finding.quantity,
        "worst": asdict(finding.worst),
        "erratum": finding.erratum,
    }


def paper_data(rows: Sequence[PaperRow]) -> dict[str, Any]:
    """The comparison with the printed tables as plain data."""
    return {
        "explanation": WHY_NOT_EQUAL,
        "wheel_centre_rms_mm": root_mean_square(rows),
        "rows": [asdict(row) for row in rows],
    }
