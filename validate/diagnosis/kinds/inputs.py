"""A wrong input: with the other sign, k times ours, so much more, or an angle as pi minus it; or two of them.

k, or how much more, is found by least squares of the numbers of one unit: from how they change with it, from
step to step, by solving the car's motion with that input. It is for the whole car.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from itertools import combinations, product

import numpy as np
from numpy.typing import NDArray

from pointcoord import Motion, PointcoordError, simulate
from pointcoord.scene.scene_file import InputPart
from pointcoord.simulation import scene_mechanism
from pointcoord.solve.assembly import close_drawing
from validate.diagnosis.evidence import Evidence, Row
from validate.diagnosis.hypothesis import Hypothesis, Kind
from validate.diagnosis.kinds.hardpoint import looked_at
from validate.formulations.input_rates import rates

Array = NDArray[np.float64]

STEP = 1e-3  # of the first slope
STEPS = 9
# How near to a number of six digits a factor is meant to be that number: it is found no better.
MEANT = 1e-8
FEW = 64  # instants that a wrong input is looked for at
# What another input may leave of the difference, and be worth a look at all instants.
PROMISING = 0.1
# What a step must leave at most, to go on.
FALLING = 0.9


# Of an input's drawn value: how near to it what is missing is meant to be it.
NEAR = 1e-5


class Inputs(Kind):
    """One input of the scene."""

    name, solves, first, of_time = "input", True, True, True

    def hypotheses(self, evidence: Evidence) -> Iterator[Hypothesis]:
        """Known changes of each input that is not zero all the time, then its factor."""
        units = evidence.scene.mechanism.topology.input_units
        count = len(evidence.times)
        few = evidence.at(np.unique(np.linspace(0, count - 1, min(FEW, count)).astype(np.intp)).tolist())
        looked = looked_at(evidence)
        theirs, ours = (
            np.concatenate([part[row].ravel() for row in looked]) for part in (few.given, few.held)
        )
        if not np.isfinite(theirs).all():
            return
        apart = float(np.linalg.norm(theirs - ours))
        explained = False
        every: dict[str, list[tuple[str, InputPart]]] = {}
        for name, law in evidence.scene.inputs.items():
            known = []
            moves = np.abs(rates(law, few.times)[:, 0]).max() > 0.0
            if moves:
                known.append(("has the other sign", changed(law, -1.0)))
            if units[name] == "rad":
                known.append(("is taken as pi minus it", changed(law, -1.0, np.pi)))
            every[name] = known
            done = False
            for words, other in known:
                numbers = _read(few, {name: other}, looked)
                if numbers is None or np.linalg.norm(theirs - numbers) > PROMISING * apart:
                    continue
                rows = _rows(evidence, {name: other})
                if rows is not None:
                    yield Hypothesis(self.name, (name, words), f"the input {name} {words}", rows, whole=True)
                    done |= _explains(evidence, rows, looked)
            found: tuple[tuple[str, float | None, InputPart | None, float], ...] = ()
            if not done:
                factor = _found(few, name, partial(changed, law), 1.0, looked, theirs)
                times = None if factor is None or not moves else changed(law, factor)
                more = _found(few, name, partial(changed, law, 1.0), 0.0, looked, theirs)
                added = None if more is None else changed(law, 1.0, more)
                found = (("times", factor, times, 1.5), ("more", more, added, 1.4))
            for what, amount, other_law, cost in found:
                rows = None if other_law is None else _rows(evidence, {name: other_law})
                if rows is None or amount is None:
                    continue
                words = f"is taken {amount:.6g} times" if what == "times" else _offset(evidence, name, amount)
                words = f"the input {name} {words}"
                yield Hypothesis(self.name, (name, what), words, rows, 1, cost, whole=True)
                done |= _explains(evidence, rows, looked)
            explained |= done
        if not explained:
            yield from self._pairs(evidence, few, every, looked, theirs, apart)

    def _pairs(
        self,
        evidence: Evidence,
        few: Evidence,
        every: Mapping[str, Sequence[tuple[str, InputPart]]],
        looked: Sequence[Row],
        theirs: Array,
        apart: float,
    ) -> Iterator[Hypothesis]:
        """Known changes of two inputs at once."""
        for first, second in combinations(every, 2):
            for (words, one), (other_words, two) in product(every[first], every[second]):
                laws = {first: one, second: two}
                numbers = _read(few, laws, looked)
                if numbers is None or np.linalg.norm(theirs - numbers) > PROMISING * apart:
                    continue
                rows = _rows(evidence, laws)
                if rows is not None:
                    key = (first, words, second, other_words)
                    said = f"the input {first} {words}, and the input {second} {other_words}"
                    yield Hypothesis(self.name, key, said, rows, cost=1.8, whole=True)


def _explains(evidence: Evidence, rows: Mapping[Row, tuple[Array, Array]], looked: Sequence[Row]) -> bool:
    return all(evidence.left(row, *rows[row]) <= 1.0 for row in looked)


def _offset(evidence: Evidence, name: str, more: float) -> str:
    """An input that is off by a constant, in words: from the drawing on, if that is it."""
    unit = evidence.scene.mechanism.topology.input_units[name]
    drawn = _drawn(evidence, name)
    if drawn is not None and abs(more + drawn) <= NEAR * abs(drawn):
        return f"is taken from the drawing on: {abs(drawn):.6g} {unit} are missing"
    if drawn is not None and abs(more - drawn) <= NEAR * abs(drawn):
        return f"is taken from the drawing on, and is not: {abs(drawn):.6g} {unit} are too many"
    return f"is taken {abs(more):.6g} {unit} {'more' if more > 0.0 else 'less'}"


def _drawn(evidence: Evidence, name: str) -> float | None:
    """An input of the closed drawing; None of one that does not close, or that moves the chassis."""
    try:
        mechanism = scene_mechanism(evidence.scene)
        y = close_drawing(mechanism).y
        read = mechanism.input_values(y[mechanism.map.unknowns :])
    except PointcoordError:
        return None
    return float(np.ravel(read[name])[0]) if name in read else None


def changed(law: InputPart, factor: float, more: float = 0.0) -> InputPart:
    """A law times a factor, and a constant more."""
    if law.sine is not None:
        wave = law.sine
        update = {"amplitude": factor * wave.amplitude, "offset": factor * wave.offset + more}
        return law.model_copy(update={"sine": wave.model_copy(update=update)})
    if law.table is not None:
        values = tuple(factor * value + more for value in law.table.values)
        return law.model_copy(update={"table": law.table.model_copy(update={"values": values})})
    if law.polynomial is not None:
        first, *others = law.polynomial
        return law.model_copy(
            update={"polynomial": (factor * first + more, *(factor * value for value in others))}
        )
    return law.model_copy(update={"constant": factor * (law.constant or 0.0) + more})


def _motion(evidence: Evidence, laws: Mapping[str, InputPart]) -> Motion | None:
    """The car's motion by other inputs, with every point; None where it cannot follow them."""
    scene = evidence.solved.fine
    try:
        return simulate(scene.model_copy(update={"inputs": {**scene.inputs, **laws}, "points": None}))
    except PointcoordError:
        return None


def _rows(evidence: Evidence, laws: Mapping[str, InputPart]) -> dict[Row, tuple[Array, Array]] | None:
    motion = _motion(evidence, laws)
    return None if motion is None else rows_of(evidence, motion)


def rows_of(evidence: Evidence, motion: Motion) -> dict[Row, tuple[Array, Array]]:
    """What each row would be of another motion, and how far from that it may be."""
    samples = motion.at(evidence.times)
    proven = motion.proof_of(samples, rates=True).proven
    rows: dict[Row, tuple[Array, Array]] = {}
    for row in evidence.held:
        quantity, of = row
        if of in samples.numbers[quantity]:
            value = np.array(samples.numbers[quantity][of])
            # These are off by their own bound, and by as much again for what numbers of its laws, such as a
            # factor that is found, are rounded by.
            bound = np.nan_to_num(proven[quantity][of], posinf=0.0)
            rows[row] = (value, 2.0 * (evidence.rounded(row, value) + bound))
    return rows


def _read(evidence: Evidence, laws: Mapping[str, InputPart], rows: Sequence[Row]) -> Array | None:
    """Numbers of some rows by other inputs, one after the other; None where there are none."""
    motion = _motion(evidence, laws)
    if motion is None:
        return None
    numbers = motion.at(evidence.times).numbers
    if any(of not in numbers[quantity] for quantity, of in rows):
        return None
    return np.concatenate([numbers[quantity][of].ravel() for quantity, of in rows])


def _found(
    evidence: Evidence,
    name: str,
    law_of: Callable[[float], InputPart],
    here_at: float,
    rows: Sequence[Row],
    theirs: Array,
) -> float | None:
    """The parameter of a law by least squares, from where it is ours; None where it leaves little less."""
    before, amount = here_at - STEP, here_at
    old, here = (_read(evidence, {name: law_of(k)}, rows) for k in (before, amount))
    if old is None or here is None:
        return None
    first = rest = float(np.linalg.norm(theirs - here))
    for _ in range(STEPS):
        slope = (here - old) / (amount - before)
        square = float(slope @ slope)
        change = float(slope @ (theirs - here)) / square if square > 0.0 else np.nan
        if not np.isfinite(change) or change == 0.0:
            break
        new = _read(evidence, {name: law_of(amount + change)}, rows)
        left = np.inf if new is None else float(np.linalg.norm(theirs - new))
        if new is None or not left <= FALLING * rest:
            break
        before, amount, old, here, rest = amount, amount + change, here, new, left
    if rest > PROMISING * first:
        return None
    meant = float(f"{amount:.6g}")
    return meant if abs(meant - amount) <= MEANT * abs(amount) else amount


KIND = Inputs()
