"""The tables of the study of cost: one shape for the terminal, for Markdown and for CSV."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from textwrap import fill

from validate.cost.findings import (
    ACCURACIES,
    Findings,
    Reach,
    a_configuration,
    accuracy_rows,
    proven,
    quantities_of,
    reach,
    scenes_of,
    together,
    unit_of,
    words_of,
)
from validate.cost.row import NO_EFFECT, QuantityError, Row, Time
from validate.cost.sentences import bytes_words, digits, duration, growth_words, power
from validate.output import terminal
from validate.output.terminal import Part

WIDTH = 110  # columns of a terminal
PHASES = ("set-up", "solve", "rates", "output", "first")
OF_A_SCENE = ("set-up", "first")
"""Phases that are of a scene and not of each of its configurations."""
SHORT = {
    "position": "pos",
    "velocity": "vel",
    "acceleration": "acc",
    "angular_velocity": "omega",
    "angular_acceleration": "alpha",
}


def wrapped(text: str, indent: str = "") -> str:
    """A paragraph for a terminal; lines after the first stand further in."""
    return fill(
        text,
        WIDTH,
        initial_indent=indent,
        subsequent_indent=indent + "  ",
        break_long_words=False,
        break_on_hyphens=False,
    )


@dataclass(frozen=True)
class Table:
    """A table with what must be known to read it.

    Attributes:
        notes: lines below it.
    """

    title: str
    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    notes: tuple[str, ...] = ()

    def parts(self) -> tuple[Part, ...]:
        """For a terminal, its columns apart."""
        columns = terminal.Table(self.head, self.rows)
        return (wrapped(self.title), columns, *(wrapped(note, "  ") for note in self.notes))

    def markdown(self) -> str:
        """For a page."""
        lines = [self.head, tuple("---" for _ in self.head), *self.rows]
        body = "\n".join(
            "| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |" for line in lines
        )
        notes = "".join(f"\n- {note}" for note in self.notes)
        return f"**{self.title}**\n\n{body}\n" + (notes + "\n" if notes else "")


def short_tables(rows: Sequence[Row], found: Findings) -> list[Table]:
    """What a terminal shows: times to reach accuracies, the ways of each scene, effects, growth, loading, and
    unrelated inputs."""
    tables = []
    for scene in scenes_of(accuracy_rows(rows)):
        here = [row for row in accuracy_rows(rows) if row.scene == scene]
        tables += [reach_table(here, "position"), scene_table(here)]
    return [
        *tables,
        *effects_tables(rows),
        *growth_tables(found),
        *loading_tables(rows),
        *unrelated_tables(rows),
    ]


def full_tables(rows: Sequence[Row], found: Findings) -> list[Table]:
    """What a page shows: the same with every quantity, quartiles and counts."""
    tables = []
    for scene in scenes_of(accuracy_rows(rows)):
        here = [row for row in accuracy_rows(rows) if row.scene == scene]
        tables += [reach_table(here, quantity) for quantity in quantities_of(here)]
        tables += [error_table(here), time_table(here)]
    return [
        *tables,
        *effects_tables(rows),
        *growth_tables(found),
        *loading_tables(rows),
        *unrelated_tables(rows),
    ]


def other_tables(rows: Sequence[Row], found: Findings) -> list[Table]:
    """Of the parts of the study that are not about accuracy."""
    of_scenes = [*effects_tables(rows), *growth_tables(found)]
    return [*of_scenes, *loading_tables(rows), *unrelated_tables(rows)]


def name_of(row: Row, short: bool = False) -> str:
    """A way with its setting, or with the number that is dialled; `*`: one solve serves any instant."""
    setting = power(row.value) if short and row.value else row.setting
    return f"{row.way}{'*' if row.dense else ''} {setting}".strip()


def reach_table(here: Sequence[Row], quantity: str) -> Table:
    """Time of a configuration by the cheapest setting that reaches an accuracy, the quickest first."""
    ways = {way: [row for row in here if row.way == way] for way in dict.fromkeys(r.way for r in here)}
    lines = []
    for way, of_way in ways.items():
        reaches = [reach(of_way, quantity, accuracy) for accuracy in ACCURACIES]
        times = [math.inf if r.time is None else r.time.median for r in reaches]
        dense = "*" if any(row.dense for row in of_way) else ""
        if reaches[0].floor is not None:
            lines.append(
                (times[::-1], (way + dense, *map(_reach_cell, reaches), _error_words(reaches[0].floor)))
            )
    lines.sort(key=lambda line: line[0])
    unit = unit_of(quantity)
    absent = [
        f"{way}: {_absence(of_way, quantity)}" for way, of_way in ways.items() if _absence(of_way, quantity)
    ]
    return Table(
        f"{here[0].scene}: time of a configuration to reach an accuracy of {words_of(quantity)}, "
        "by the cheapest setting",
        ("way", *(f"{power(accuracy)} {unit}" for accuracy in ACCURACIES), f"floor, {unit}"),
        tuple(cells for _, cells in lines),
        tuple(absent),
    )


def _reach_cell(one: Reach) -> str:
    if one.time is None:
        return "not reached"
    setting = power(one.value) if one.value else one.setting
    return f"{duration(one.time.median)}" + (f" ({setting})" if setting else "")


def _absence(rows: Sequence[Row], quantity: str) -> str:
    one = reach(rows, quantity, ACCURACIES[0])
    return "" if one.floor is not None else one.reason


def scene_table(here: Sequence[Row]) -> Table:
    """Largest errors and median times on some 115 columns, of the settings that the races name.

    These are the cheapest that reach an accuracy of positions, and the most accurate.
    """
    named = _named(here)
    measured = [row for row in here if row.status == "measured" and (row.way, row.setting) in named]
    further = sum(row.status == "measured" for row in here) - len(measured)
    quantities = [q for q in quantities_of(here) if q in SHORT]
    lines = [
        (
            name_of(row, short=True),
            *(_error_words(row.errors[q].largest) if q in row.errors else "-" for q in quantities),
            *(_cells(row, phase)[0] for phase in PHASES),
            _spread(row),
        )
        for row in measured
    ]
    head = ("way and setting", *(SHORT[q] for q in quantities), *PHASES, "+-%")
    configurations = sorted({row.configurations for row in measured})
    units = "; ".join(f"{SHORT[q]} {unit_of(q)}" for q in quantities)
    return Table(
        f"{here[0].scene}: largest errors ({units}); set-up and first run in ms a scene, solve, rates and "
        f"output in us a configuration ({' or '.join(map(str, configurations)) or 'no'} a solve)",
        head,
        tuple(lines),
        (
            "beside a way: the number that is dialled; *: one solve serves any instant; "
            "first: all four phases of the first run; "
            "+-%: half the quartile range of solve",
            *((f"{further} further settings: --csv, --json or --report",) if further else ()),
            *radius_notes(here),
            *absences(here),
        ),
    )


def _named(here: Sequence[Row]) -> set[tuple[str, str]]:
    named = set()
    for way in dict.fromkeys(row.way for row in here):
        of_way = [row for row in here if row.way == way]
        settings = {reach(of_way, "position", accuracy).setting for accuracy in ACCURACIES}
        finest = min(
            (row for row in of_way if "position" in row.errors),
            key=lambda row: proven(row.errors["position"]),
            default=None,
        )
        named |= {(way, s) for s in settings if s is not None}
        named |= {(way, finest.setting)} if finest else {(row.way, row.setting) for row in of_way}
    return named


def error_table(here: Sequence[Row]) -> Table:
    """Largest and r.m.s. error of every quantity, beside the reference's own radius, and counts."""
    measured = [row for row in here if row.status == "measured"]
    quantities = quantities_of(here)
    counts = list(dict.fromkeys(name for row in measured for name in row.counts))
    lines = [
        (
            name_of(row),
            *(_both(row.errors.get(q)) for q in quantities),
            *(str(row.counts[name]) if name in row.counts else "-" for name in counts),
        )
        for row in measured
    ]
    return Table(
        f"{here[0].scene}: errors against the reference, largest (r.m.s.), and what was done in one run",
        (
            "way and setting",
            *(f"{words_of(q)}, {unit_of(q)}" for q in quantities),
            *(name.replace("_", " ") for name in counts),
        ),
        tuple(lines),
        (*radius_notes(here), *absences(here)),
    )


def time_table(here: Sequence[Row]) -> Table:
    """Of one scene: median and quartiles of every phase."""
    lines = [
        (
            name_of(row),
            "yes" if row.dense else "no",
            *(_cells(row, phase)[1] for phase in PHASES),
        )
        for row in here
        if row.status == "measured"
    ]
    return Table(
        f"{here[0].scene}: times, median (lower to upper quartile)",
        (
            "way and setting",
            "dense",
            *(f"{p}, {'ms a scene' if p in OF_A_SCENE else 'us a conf.'}" for p in PHASES),
        ),
        tuple(lines),
        ("us a conf.: us a configuration; first: all phases of the first run in a process, measured once",),
    )


def radius_notes(here: Sequence[Row]) -> list[str]:
    """The reference's own proven error, and quantities of which some ways give fewer numbers."""
    notes = []
    radii = {q: max(row.errors[q].radius for row in here if q in row.errors) for q in quantities_of(here)}
    if radii:
        told = ", ".join(f"{words_of(q)} {radius:.1e} {unit_of(q)}" for q, radius in radii.items())
        notes.append(f"the reference's own proven error: {told}")
    for quantity in radii:
        numbers = {row.way: row.errors[quantity].numbers for row in here if quantity in row.errors}
        fewer = {way: n for way, n in numbers.items() if n < max(numbers.values())}
        if fewer:
            told = ", ".join(f"{way} {n}" for way, n in fewer.items())
            notes.append(f"{words_of(quantity)} over fewer than {max(numbers.values())} numbers: {told}")
    return notes


def absences(here: Sequence[Row]) -> list[str]:
    """Failures, omissions, what was measured otherwise, and what is not given: each reason with its ways."""
    reasons: dict[str, dict[str, list[Row]]] = {}
    for row in here:
        told = [f"{words_of(quantity)} not given: {reason}" for quantity, reason in row.not_given.items()]
        if row.status != "measured":
            told.append(f"{row.status}: {row.reason or 'without a reason'}")
        elif row.reason:
            told.append(row.reason)
        for reason in told:
            reasons.setdefault(reason, {}).setdefault(row.way, []).append(row)
    lines = []
    for reason, ways in reasons.items():
        names = []
        for way, rows in ways.items():
            every = len(rows) == sum(row.way == way for row in here)
            names += [way] if every else [name_of(row) for row in rows]
        lines.append(f"{', '.join(names)}: {reason}")
    return lines


def growth_tables(found: Findings) -> list[Table]:
    """Fitted exponents of time and memory, a table for each thing that is varied and each scene."""
    tables = []
    for against, scene in dict.fromkeys((growth.against, growth.scene) for growth in found.growths):
        lines, notes = [], []
        for one in (g for g in found.growths if (g.against, g.scene) == (against, scene)):
            measure = duration if one.of == "time" else bytes_words
            name = f"{one.way} {one.setting}".strip()
            if one.points:
                size, value = one.points[-1]
                sizes = f"{one.fit.smallest:g} to {one.fit.largest:g}" if one.fit else "-"
                each = measure(value / size)
                lines.append((name, one.of, growth_words(one), sizes, f"{size:g}", measure(value), each))
            if one.of == "time":
                notes += [f"{name}, {size:g} {against}: {reason}" for size, reason in one.stopped]
        tables.append(
            Table(
                f"Growth in {against} of {scene}: value = factor x size^exponent, of the largest sizes",
                ("way and setting", "of", "exponent", "fitted from", "largest", "takes", "each"),
                tuple(lines),
                tuple(notes),
            )
        )
    return tables


def effects_tables(rows: Iterable[Row]) -> list[Table]:
    """Of each scene what reading it takes with each effect, beside a copy and beside positions alone."""
    tables = []
    for scene in scenes_of([row for row in rows if row.part == "effects"]):
        here = [row for row in rows if row.part == "effects" and row.scene == scene]
        alone = next((row.seconds("read") for row in here if row.setting == NO_EFFECT), None)
        lines = []
        for row in here:
            read, copy = row.seconds("read"), row.seconds("copy")
            if read is None or copy is None:
                continue
            time = row.times["read"]
            lines.append(
                (
                    row.setting,
                    f"{row.counts['numbers']}",
                    duration(read),
                    f"{50.0 * (time.upper - time.lower) / time.median:.0f} %",
                    f"{read / copy:.2f}",
                    "-" if not alone else f"{read / alone:.2f}",
                )
            )
        count = here[0].configurations
        head = ("asked for", "numbers", "an instant", "+-", "of a copy", "of positions")
        tables.append(
            Table(
                f"Reading {scene} at {count} instants, by effects", head, tuple(lines), tuple(absences(here))
            )
        )
    return tables


def loading_tables(rows: Iterable[Row]) -> list[Table]:
    """What it takes to load a scene, the package and the program."""
    here = [row for row in rows if row.part == "loading"]
    lines = [
        (
            " ".join(part for part in (row.scene, row.way, row.setting) if part),
            phase,
            duration(time.median),
            f"{duration(time.lower)} to {duration(time.upper)}",
        )
        for row in here
        if row.status == "measured"
        for phase, time in row.times.items()
    ]
    if not here:
        return []
    head = ("loading", "phase", "median", "quartiles")
    return [Table("Loading", head, tuple(lines), tuple(absences(here)))]


def _error_words(error: float) -> str:
    return "not a number" if math.isnan(error) else "0" if error == 0.0 else f"{error:.1e}"


def _both(error: QuantityError | None) -> str:
    return "-" if error is None else f"{_error_words(error.largest)} ({_error_words(error.rms)})"


def _cells(row: Row, phase: str) -> tuple[str, str]:
    """Median of a phase, and the same with its quartiles: ms of a scene, or us of a configuration."""
    of_scene = phase in OF_A_SCENE
    time, unit = (together(row, (phase,)), 1e3) if of_scene else (a_configuration(row, (phase,)), 1e6)
    if time is None:
        return "-", "-"
    median, lower, upper = (digits(value * unit) for value in (time.median, time.lower, time.upper))
    return median, median if time.repeats == 1 else f"{median} ({lower} to {upper})"


def _spread(row: Row) -> str:
    time = a_configuration(row, ("solve",))
    return "-" if time is None else f"{50.0 * (time.upper - time.lower) / time.median:.0f}"


def csv_text(rows: Sequence[Row]) -> str:
    """All rows, a line for each: errors, times of a whole run and of a configuration, counts and reasons."""
    quantities = quantities_of(rows)
    phases = [*PHASES, *sorted({name for row in rows for name in row.times} - set(PHASES))]
    counts = sorted({name for row in rows for name in row.counts})
    plain = (
        "part",
        "scene",
        "way",
        "setting",
        "value",
        "status",
        "reason",
        "dense",
        "configurations",
        "against",
        "size",
        "peak_bytes",
    )
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(
        [
            *plain,
            *(
                f"{q}_{name}"
                for q in quantities
                for name in ("largest", "rms", "radius", "numbers", "not_given")
            ),
            *(
                f"{phase}_{name}"
                for phase in phases
                for name in ("median_s", "lower_s", "upper_s", "repeats")
            ),
            *(f"{phase}_s_per_configuration" for phase in phases if phase not in OF_A_SCENE),
            *counts,
        ]
    )
    for row in rows:
        data = asdict(row)
        writer.writerow(
            [
                *(_cell(data[name]) for name in plain),
                *(cell for q in quantities for cell in _error_cells(row, q)),
                *(cell for phase in phases for cell in _time_cells(row.times.get(phase))),
                *(_cell(row.seconds(phase)) for phase in phases if phase not in OF_A_SCENE),
                *(_cell(row.counts.get(name)) for name in counts),
            ]
        )
    return stream.getvalue()


def _error_cells(row: Row, quantity: str) -> list[str]:
    error = row.errors.get(quantity)
    numbers = ["", "", "", ""] if error is None else [_cell(value) for value in asdict(error).values()]
    return [*numbers, row.not_given.get(quantity, "")]


def _time_cells(time: Time | None) -> list[str]:
    return ["", "", "", ""] if time is None else [_cell(value) for value in asdict(time).values()]


def _cell(value: object) -> str:
    """A number with all its digits; nothing for what is not there."""
    return "" if value is None else repr(value) if isinstance(value, float) else str(value)


def unrelated_tables(rows: Iterable[Row]) -> list[Table]:
    """Of each scene what a pose takes at inputs that have nothing to do with each other, quickest first."""
    tables = []
    for scene in scenes_of([row for row in rows if row.part == "unrelated"]):
        here = [row for row in rows if row.part == "unrelated" and row.scene == scene]
        timed = [(each, row) for row in here if (each := row.seconds("solve")) is not None]
        timed.sort(key=lambda one: one[0])
        alone = next((each for each, row in timed if row.way == "one by one"), None)
        lines, notes = [], list(absences(here))
        for each, row in timed:
            time = row.times["solve"]
            lines.append(
                (
                    f"{row.way}, {row.setting}" if row.setting else row.way,
                    f"{row.configurations:,}",
                    duration(each),
                    f"{50.0 * (time.upper - time.lower) / time.median:.0f} %",
                    "-" if alone is None else f"{each / alone:.2g}",
                    _error_words(row.errors["position"].largest),
                )
            )
            if "set-up" in row.times:
                notes.append(f"{row.way}: made in {duration(row.times['set-up'].median)}, which is not in it")
        numbers = max((row.errors["position"].numbers for _, row in timed), default=0)
        notes.append(f"errors are those of the first poses, {numbers} numbers, against the reference")
        head = ("way", "poses", "a pose", "+-", "of one by one", "error, mm")
        title = f"A pose of {scene} at inputs that have nothing to do with each other"
        tables.append(Table(title, head, tuple(lines), tuple(notes)))
    return tables
