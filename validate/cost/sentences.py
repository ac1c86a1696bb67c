"""The findings as sentences: where another way is quicker comes first."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence

from validate.cost.findings import (
    ACCURACIES,
    OURS,
    Crossover,
    Dial,
    Findings,
    Growth,
    Line,
    Race,
    Reach,
    Verdict,
    unit_of,
    words_of,
)

Groups = dict[tuple[Verdict, str, str], list[Race]]


def duration(seconds: float) -> str:
    """Three digits and the unit that suits them."""
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("us", 1e-6)):
        if abs(seconds) >= size * 0.9995:
            return f"{digits(seconds / size)} {unit}"
    return f"{digits(seconds / 1e-9)} ns"


def digits(value: float) -> str:
    """Three significant digits; plain where they are readable."""
    if not math.isfinite(value):
        return "not a number"
    if value and not 1e-3 <= abs(value) < 99950.0:
        return f"{value:.2e}"
    return f"{float(f'{value:.3g}'):.10g}"


def bytes_words(count: float) -> str:
    """Three digits and the unit that suits them."""
    for unit, size in (("GB", 1e9), ("MB", 1e6), ("kB", 1e3)):
        if count >= size * 0.9995:
            return f"{digits(count / size)} {unit}"
    return f"{digits(count)} B"


def listed(words: Sequence[str]) -> str:
    """Words as a person lists them."""
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}" if words else ""


def exponent_words(exponent: float, error: float | None) -> str:
    """An exponent with its standard error; without one where two points leave none."""
    return f"{exponent:.2f}" if error is None else f"{exponent:.3f} +- {error:.3f}"


def power(number: float) -> str:
    """A power of ten, or a number with one digit, such as 1e-9."""
    mantissa, exponent = f"{number:.0e}".split("e")
    return f"{mantissa}e{int(exponent)}"


def verdicts(found: Findings) -> list[str]:
    """All sentences: the count, where our advantage vanishes, where it holds, crossovers and dials."""
    return [
        *summary(found.races),
        *where_it_vanishes(found.races),
        *where_it_holds(found.races),
        *nobody(found.races),
        *crossover_sentences(found.crossovers),
        *dial_sentences(found.dials),
    ]


def summary(races: Sequence[Race]) -> list[str]:
    """How many races there are, and who is quicker in how many."""
    if not races:
        return []
    count = {verdict: sum(r.verdict == verdict for r in races) for verdict in ("ours", "tie", "other")}
    alone = {
        verdict: sum(r.verdict == verdict for r in races)
        for verdict in ("only ours", "only others", "nobody")
    }
    rest = [
        f"{n} {words}"
        for n, words in (
            (alone["only ours"], "reached by point coordinates alone"),
            (alone["only others"], "reached by others alone"),
            (alone["nobody"], "reached by nobody"),
        )
        if n
    ]
    return [
        f"Races: {len(races)}, each of a scene, a quantity and an accuracy ({_accuracies(ACCURACIES)} in its "
        f"unit). "
        f"Point coordinates ({', '.join(OURS)}) are quickest in {count['ours']}, "
        f"another way in {count['other']}, "
        f"and {count['tie']} are ties, their quartiles overlapping" + (f"; {listed(rest)}." if rest else ".")
    ]


def where_it_vanishes(races: Iterable[Race]) -> list[str]:
    """A sentence for each scene and pair in which another way is quicker, ties, or reaches alone."""
    lines = []
    for scene, groups in _by_scene(races).items():
        for (verdict, ours, other), group in groups.items():
            if verdict == "other":
                lines.append(
                    f"{scene}: {other} is quickest for {_what(group)}: {_times_as_long(group)} times as long "
                    f"as {ours}, the quickest of ours ({_span([r.other for r in group])} against "
                    f"{_span([r.ours for r in group])} a configuration)."
                )
            elif verdict == "tie":
                lines.append(
                    f"{scene}: {ours} and {other} tie for {_what(group)} ({_span([r.ours for r in group])} "
                    f"and {_span([r.other for r in group])} a configuration)."
                )
            elif verdict == "only others":
                lines.append(
                    f"{scene}: {other} is quickest for {_what(group)}, and none of ours reaches it "
                    f"({_floors(group)})."
                )
    return lines


def where_it_holds(races: Iterable[Race]) -> list[str]:
    """A sentence for each scene and pair in which one of ours is quicker, or reaches alone."""
    lines = []
    for scene, groups in _by_scene(races).items():
        for (verdict, ours, other), group in groups.items():
            if verdict == "ours":
                lines.append(
                    f"{scene}: {ours} is quickest for {_what(group)}: {other}, the quickest of the others, "
                    f"takes {_times_as_long(group)} times as long ({_span([r.other for r in group])} against "
                    f"{_span([r.ours for r in group])} a configuration)."
                )
            elif verdict == "only ours":
                lines.append(
                    f"{scene}: only point coordinates reach {_what(group)}, {ours} the quickest "
                    f"({_span([r.ours for r in group])} a configuration)."
                )
    return lines


def nobody(races: Iterable[Race]) -> list[str]:
    """What no way reaches."""
    lines = []
    for scene, groups in _by_scene(races).items():
        for (verdict, _, _), group in groups.items():
            if verdict == "nobody":
                floors = {
                    race.quantity: min((m.floor for m in race.missed if m.floor is not None), default=None)
                    for race in group
                }
                told = [f"{words_of(q)} to {f:.1e} {unit_of(q)}" for q, f in floors.items() if f is not None]
                closest = f"; the closest come to {listed(told)}" if told else ""
                lines.append(f"{scene}: nobody reaches {_what(group)}{closest}.")
    return lines


def _by_scene(races: Iterable[Race]) -> Mapping[str, Groups]:
    """Races with the same verdict and the same pair, by scene."""
    scenes: dict[str, Groups] = {}
    for race in races:
        ours = race.ours.way if race.ours else ""
        # Without one of ours in the race the quickest is named; with it, the pair.
        other = race.other.way if race.other else ""
        scenes.setdefault(race.scene, {}).setdefault((race.verdict, ours, other), []).append(race)
    return scenes


def _what(group: Sequence[Race]) -> str:
    """Quantities and accuracies of some races, those with the same accuracies together."""
    accuracies: dict[str, list[float]] = {}
    for race in group:
        accuracies.setdefault(race.quantity, []).append(race.accuracy)
    together: dict[tuple[float, ...], list[str]] = {}
    for quantity, found in accuracies.items():
        together.setdefault(tuple(found), []).append(quantity)
    return "; ".join(
        f"{listed([words_of(q) for q in quantities])} at {_at(found)}"
        for found, quantities in together.items()
    )


def _at(accuracies: Sequence[float]) -> str:
    return "every accuracy" if tuple(accuracies) == ACCURACIES else _accuracies(accuracies)


def _accuracies(accuracies: Sequence[float]) -> str:
    return listed([power(accuracy) for accuracy in accuracies])


def _times_as_long(group: Sequence[Race]) -> str:
    ratios = [race.ratio for race in group if race.ratio is not None]
    low, high = f"{min(ratios):.2g}", f"{max(ratios):.2g}"
    low, high = (f"{float(text):g}" for text in (low, high))
    return low if low == high else f"{low} to {high}"


def _span(reaches: Iterable[Reach | None]) -> str:
    times = [r.time.median for r in reaches if r is not None and r.time is not None]
    low, high = duration(min(times)), duration(max(times))
    return low if low == high else f"{low} to {high}"


def _floors(group: Sequence[Race]) -> str:
    """How close ours come where they do not reach."""
    told = []
    for quantity in dict.fromkeys(race.quantity for race in group):
        race = next(r for r in group if r.quantity == quantity)
        floors = {m.way: m.floor for m in race.missed if m.way in OURS and m.floor is not None}
        if floors:
            way = min(floors, key=lambda name: floors[name])
            told.append(f"{way} comes to {floors[way]:.1e} {unit_of(quantity)} of {words_of(quantity)}")
    if told:
        return listed(told)
    reasons = {m.way: m.reason for m in group[0].missed if m.way in OURS}
    return "; ".join(f"{way}: {reason}" for way, reason in reasons.items()) or "none of them was run"


def crossover_sentences(crossovers: Sequence[Crossover]) -> list[str]:
    """From how many instants our dense way is quicker than each other way, at the finest accuracy of both."""
    lines = []
    pairs: dict[tuple[str, str, str, str], dict[float, dict[bool, Crossover]]] = {}
    for one in crossovers:
        if one.ours.dense:
            key = (one.scene, one.quantity, one.ours.way, one.other.way)
            pairs.setdefault(key, {}).setdefault(one.accuracy, {})[one.with_set_up] = one
    for (scene, quantity, _, _), by_accuracy in pairs.items():
        accuracy = min(by_accuracy)
        alone, counted = by_accuracy[accuracy][False], by_accuracy[accuracy][True]
        start = f"{scene}, {words_of(quantity)} at {power(accuracy)} {unit_of(quantity)}: "
        lines.append(start + _crossing(alone) + _counted(alone, counted) + "; " + _lines_words(alone) + ".")
    return lines


def _crossing(one: Crossover) -> str:
    ours, other = one.ours.way, one.other.way
    if one.instants is None:
        return f"{one.above} is quicker than {other if one.above == ours else ours} at any number of instants"
    beyond = ", beyond what was measured" if one.instants > one.measured else ""
    return f"{one.below} is quicker below {_count(one.instants)} instants{beyond}, {one.above} above"


def _counted(alone: Crossover, counted: Crossover) -> str:
    if (counted.below, counted.above) == (alone.below, alone.above):
        if counted.instants is None or alone.instants is None:
            return ", one set-up counted or not"
        return f" ({_count(counted.instants)} with one set-up counted)"
    if counted.instants is None:
        return f" (with one set-up counted {counted.above} at any number)"
    return (
        f" (with one set-up counted {counted.below} below {_count(counted.instants)}, {counted.above} above)"
    )


def _lines_words(one: Crossover) -> str:
    return " and ".join(
        f"{line.way} takes {_fixed(line)}{duration(line.each)} an instant" for line in (one.ours, one.other)
    )


def _fixed(line: Line) -> str:
    """The fixed part, if it is as much as a hundredth of one instant."""
    return f"{duration(line.fixed)} and " if line.fixed > 0.01 * line.each else ""


def _count(instants: float) -> str:
    """A count that is fitted has two digits."""
    return f"{float(f'{math.ceil(instants):.2g}'):,.0f}"


def dial_sentences(dials: Iterable[Dial]) -> list[str]:
    """What a tenth of the tolerance costs, for each scene and way of ours."""
    lines = []
    for dial in (dial for dial in dials if dial.way in OURS):
        coarse, fine = dial.settings
        ratio = dial.fine.median / dial.coarse.median
        start = f"{dial.scene}: {dial.way} at {fine} takes {digits(ratio)} times as long as at {coarse}"
        slope = f"time goes with the setting to the power {exponent_words(dial.fit.exponent, dial.fit.error)}"
        if dial.turns:
            lines.append(f"{start}, {dial.a_digit:.3f} times for each digit; {slope}.")
        else:
            lines.append(f"{start}; {_not_certain(dial)}; {slope}.")
    return lines


def _not_certain(dial: Dial) -> str:
    """What the figures say where the two ends and the slope do not both say that accuracy costs time."""
    ends = "the quartiles of these two "
    if dial.apart:
        return f"{ends}are apart, but the slope over all settings is within two standard errors of none"
    if dial.rises:
        return (
            f"{ends}overlap, but the slope over all settings is beyond two standard errors: "
            f"{dial.a_digit:.3f} times for each digit"
        )
    if dial.fit.error is None:
        return f"{ends}do not show that accuracy costs time"
    return f"neither {ends}nor the slope over all settings show that accuracy costs time"


def growth_words(growth: Growth) -> str:
    """The exponent of a growth and where it was fitted."""
    if growth.fit is None:
        return "one size" if growth.points else "none"
    return exponent_words(growth.fit.exponent, growth.fit.error)
