"""Suspected sets of coordinates in words, as plain data, and as a table."""

from __future__ import annotations

import math
from typing import Any

from validate.extras import needed
from validate.fitting.fit import CONFIDENCE, Fit
from validate.fitting.suspects import Suspects
from validate.fitting.words import coordinates_of
from validate.plain_text import shown

SIZES = ("coordinate alone", "sets of two", "sets of three")
REFUSED = 3  # sets that are named one by one


def text_of_suspects(found: Suspects, name: str, source: str) -> str:
    """Everything that is to be said of them."""
    drawn = math.sqrt(found.left / found.count)
    lines = [
        f"{name}: which hardpoints would explain {source} (a diagnosis: nothing is corrected)",
        f"  as drawn {drawn:.3g} times what the digits explain is left, r.m.s. of {found.count} numbers",
    ]
    if found.drawn:
        return "\n".join([*lines, "  The car as drawn explains the file: there is nothing to look for."])
    fitted = (
        f"{'each ' if size == 0 else ''}{SIZES[size]}: {some} of {all_} fitted"
        for size, (some, all_) in enumerate(found.tried)
    )
    lines.append(f"  {'; '.join(fitted)}; the others explain less in the linear problem")
    if found.unseen:
        lines.append(f"  change nothing that the file shows: {', '.join(found.unseen)}")
    sets = found.explaining or found.nearest
    head = "sets that explain the file" if found.explaining else "no set explains the file; nearest are"
    where = f"where it lies {100.0 * CONFIDENCE:g} times in 100"
    lines += ["", f"  {head}, with what each leaves in times of the digits, and its offsets, mm, {where}"]
    width = max((len(at) for one in sets for at in one.coordinates), default=0)
    for rank, one in enumerate(sets, 1):
        for i, (at, moved) in enumerate(one.coordinates.items()):
            known = f"+- {moved.deviation:.2g}   {moved.low:+z.4f} to {moved.high:+z.4f}"
            known = "on its bound" if moved.on_bound else known
            before = f"{rank:4}. {times(one):8.3g}" if i == 0 else " " * 14
            lines.append(f"  {before}  {at.ljust(width)} {moved.correction:+z10.4f} {known}")
    return "\n".join([*lines, "", f"  {verdict(found)}"])


def verdict(found: Suspects) -> str:
    """In a sentence, which sets explain the file."""
    if found.drawn:
        return "The car as drawn explains the file."
    if found.explaining:
        best, *others = (names(one) for one in found.equal)
        if not others:
            verb = "explain" if len(found.explaining[0].coordinates) > 1 else "explains"
            return f"{best} {verb} it best; the file can tell that from every other set that was fitted."
        return f"These sets explain it equally well: {'; '.join((best, *others))}."
    if not found.nearest:
        return "No set explains the file: none could be fitted."
    nearest = found.nearest[0]
    return (
        f"No set explains the file; nearest is {names(nearest)}, which leaves {times(nearest):.3g} times "
        "what the digits explain: another unit, sign or definition of a column, or more is off than these."
    )


def names(fit: Fit) -> str:
    """The coordinates of a set."""
    return " and ".join(fit.coordinates)


def times(fit: Fit) -> float:
    """What a set leaves, r.m.s. in times of what the digits explain."""
    return math.sqrt(fit.left / max(fit.freedom, 1))


def warnings_of_suspects(found: Suspects) -> tuple[str, ...]:
    """What must not be overlooked."""
    warned = []
    if not (found.ended or found.explaining):
        warned.append("some fits did not end at a minimum: such a set might explain the file yet")
    if found.refused:
        some = "; ".join(found.refused[:REFUSED])
        warned.append(f"{len(found.refused)} sets could not be fitted: {some}")
    return tuple(warned)


def data_of_suspects(found: Suspects, name: str, source: str) -> dict[str, Any]:
    """Everything that is said of them."""
    equal = {id(one) for one in found.equal}

    def told(one: Fit) -> dict[str, Any]:
        own = {"left_over_digits": times(one), "freedom": one.freedom, "converged": one.converged}
        return {"coordinates": coordinates_of(one), "equally_well": id(one) in equal, **own}

    return {
        "scene": name,
        "data": shown(source),
        "explained_as_drawn": found.drawn,
        "left_over_digits": math.sqrt(found.left / found.count),
        "explaining": [told(one) for one in found.explaining],
        "nearest": [told(one) for one in found.nearest],
        "tried": [{"fitted": some, "sets": every} for some, every in found.tried],
        "changes_nothing": list(found.unseen),
        "words": verdict(found),
        "confidence": CONFIDENCE,
        "notes": [shown(note) for note in found.notes],
        "warnings": [shown(words) for words in warnings_of_suspects(found)],
    }


def table_of_suspects(found: Suspects) -> str:
    """A row for each coordinate of each set (CSV), the best set first."""
    rows = [
        {"set": rank, "explains": str(one in found.explaining).lower(), "left_over_digits": times(one)} | row
        for rank, one in enumerate((*found.explaining, *found.nearest), 1)
        for row in coordinates_of(one)
    ]
    return str(needed("fit", "pandas").DataFrame(rows).to_csv(index=False))
