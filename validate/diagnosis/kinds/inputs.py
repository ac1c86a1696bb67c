"""A wrong input: with the other sign, k times ours, so much more, or an angle as pi minus it; or two of them.

k, or how much more, is found by least squares of the numbers of one unit: from how they change with it, from
step to step, by solving the car's motion with that input. It is for the whole car. Where one such change of
one input does not do, every input x is taken as k x + m, all k and m together, by Gauss and Newton's method.
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
# k and m of an input k x + m that is not wrong.
OURS = (1.0, 0.0)
# What all inputs together may leave of the difference by how numbers change with each, and be worth solving.
LIKELY = 0.5
# Parts of a step that are tried until one leaves less.
PARTS = (1.0, 0.5, 0.25)
# Of the largest singular value: changes of inputs that the numbers do not tell apart.
FLAT = 1e-9


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
        read = _Reader(few, looked)
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
                numbers = read({name: other})
                if numbers is None or np.linalg.norm(theirs - numbers) > PROMISING * apart:
                    continue
                rows = _rows(evidence, {name: other})
                if rows is not None:
                    yield Hypothesis(self.name, (name, words), f"the input {name} {words}", rows, whole=True)
                    done |= _explains(evidence, rows, looked)
            found: tuple[tuple[str, float | None, InputPart | None, float], ...] = ()
            if not done:
                factor = _found(read, name, partial(changed, law), 1.0, theirs)
                if factor is not None and abs(factor) <= MEANT:
                    factor = 0.0
                times = None if factor is None or not moves else changed(law, factor)
                more = _found(read, name, partial(changed, law, 1.0), 0.0, theirs)
                added = None if more is None else changed(law, 1.0, more)
                found = (("times", factor, times, 1.5), ("more", more, added, 1.4))
            for what, amount, other_law, cost in found:
                rows = None if other_law is None else _rows(evidence, {name: other_law})
                if rows is None or amount is None:
                    continue
                km = (amount, 0.0) if what == "times" else (1.0, amount)
                words = f"the input {name} {_taken(evidence, name, *km)}"
                yield Hypothesis(self.name, (name, what), words, rows, 1, cost, whole=True)
                done |= _explains(evidence, rows, looked)
            explained |= done
        if not explained:
            for one in self._pairs(evidence, read, every, theirs, apart):
                yield one
                explained |= _explains(evidence, one.rows, looked)
        if not explained:
            yield from self._every(evidence, read, theirs)

    def _every(self, evidence: Evidence, read: _Reader, theirs: Array) -> Iterator[Hypothesis]:
        """All inputs as k x + m; those that are found to be ours are not said."""
        found = _affine(read, evidence.scene.inputs, theirs)
        wrong = {name: km for name, km in found.items() if km != OURS}
        if not wrong:
            return
        rows = _rows(
            evidence, {name: changed(evidence.scene.inputs[name], *km) for name, km in wrong.items()}
        )
        if rows is not None:
            said = ", and ".join(
                f"the input {name} {_taken(evidence, name, *km)}" for name, km in wrong.items()
            )
            fitted = sum(k not in (1.0, -1.0) for k, _ in wrong.values()) + sum(
                m != 0.0 for _, m in wrong.values()
            )
            yield Hypothesis(self.name, ("every", *wrong), said, rows, fitted, 1.6 + 0.2 * fitted, whole=True)

    def _pairs(
        self,
        evidence: Evidence,
        read: _Reader,
        every: Mapping[str, Sequence[tuple[str, InputPart]]],
        theirs: Array,
        apart: float,
    ) -> Iterator[Hypothesis]:
        """Known changes of two inputs at once."""
        for first, second in combinations(every, 2):
            for (words, one), (other_words, two) in product(every[first], every[second]):
                laws = {first: one, second: two}
                numbers = read(laws)
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


class _Reader:
    """Numbers of some rows by other inputs, one after the other; each motion is solved once."""

    def __init__(self, evidence: Evidence, rows: Sequence[Row]) -> None:
        self.evidence = evidence
        self._rows = rows
        self._known: dict[str, Array | None] = {}

    def __call__(self, laws: Mapping[str, InputPart]) -> Array | None:
        """The numbers; None where there are none."""
        ours = self.evidence.scene.inputs
        key = repr(sorted((name, repr(law)) for name, law in laws.items() if law != ours[name]))
        if key not in self._known:
            self._known[key] = self._read(laws)
        return self._known[key]

    def _read(self, laws: Mapping[str, InputPart]) -> Array | None:
        motion = _motion(self.evidence, laws)
        if motion is None:
            return None
        numbers = motion.at(self.evidence.times).numbers
        if any(of not in numbers[quantity] for quantity, of in self._rows):
            return None
        return np.concatenate([numbers[quantity][of].ravel() for quantity, of in self._rows])


def _found(
    read: _Reader,
    name: str,
    law_of: Callable[[float], InputPart],
    here_at: float,
    theirs: Array,
) -> float | None:
    """The parameter of a law by least squares, from where it is ours; None where it leaves little less."""
    before, amount = here_at - STEP, here_at
    old, here = (read({name: law_of(k)}) for k in (before, amount))
    if old is None or here is None:
        return None
    first = rest = float(np.linalg.norm(theirs - here))
    for _ in range(STEPS):
        slope = (here - old) / (amount - before)
        square = float(slope @ slope)
        change = float(slope @ (theirs - here)) / square if square > 0.0 else np.nan
        if not np.isfinite(change) or change == 0.0:
            break
        new = read({name: law_of(amount + change)})
        left = np.inf if new is None else float(np.linalg.norm(theirs - new))
        if new is None or not left <= FALLING * rest:
            break
        before, amount, old, here, rest = amount, amount + change, here, new, left
    if rest > PROMISING * first:
        return None
    return _meant(amount)


def _meant(amount: float) -> float:
    meant = float(f"{amount:.6g}")
    return meant if abs(meant - amount) <= MEANT * abs(amount) else amount


def _affine(read: _Reader, laws: Mapping[str, InputPart], theirs: Array) -> dict[str, tuple[float, float]]:
    """By input the k and m of k x + m, by least squares; none where they leave little less.

    A law that stands still has no k.
    """
    times = read.evidence.times
    places = [
        (name, which)
        for name, law in laws.items()
        for which in (0, 1)
        if which == 1 or np.ptp(rates(law, times)[:, 0]) > 0.0
    ]
    at = np.array([OURS[which] for _, which in places])

    def laws_at(values: Array) -> dict[str, InputPart]:
        pairs = {name: [*OURS] for name in laws}
        for (name, which), value in zip(places, values.tolist(), strict=True):
            pairs[name][which] = value
        return {name: changed(laws[name], *km) for name, km in pairs.items()}

    here = read(laws_at(at))
    if here is None:
        return {}
    first = rest = float(np.linalg.norm(theirs - here))
    for step in range(STEPS):
        near = [read(laws_at(at + STEP * one)) for one in -np.eye(len(at))]
        columns = [(here - other) / STEP for other in near if other is not None]
        if len(columns) < len(at):
            return {}
        slopes = np.stack(columns, axis=1)
        size = np.linalg.norm(slopes, axis=0)
        size = np.where(size > 0.0, size, 1.0)
        change = np.linalg.lstsq(slopes / size, theirs - here, rcond=FLAT)[0] / size
        if step == 0 and float(np.linalg.norm(theirs - here - slopes @ change)) > LIKELY * first:
            return {}
        for part in PARTS:
            new = read(laws_at(at + part * change))
            left = np.inf if new is None else float(np.linalg.norm(theirs - new))
            if left <= FALLING * rest:
                break
        if new is None or not left <= FALLING * rest:
            break
        at, here, rest = at + part * change, new, left
    if rest > PROMISING * first:
        return {}
    found = {name: [*OURS] for name in laws}
    for (name, which), value in zip(places, at.tolist(), strict=True):
        # Numbers of the law's own size, that an amount is little beside.
        scale = 1.0 if which == 0 else float(np.abs(rates(laws[name], times)[:, 0]).max()) or 1.0
        same = abs(value - OURS[which]) <= MEANT * scale
        found[name][which] = OURS[which] if same else _meant(value)
    return {name: (k, m) for name, (k, m) in found.items()}


def _taken(evidence: Evidence, name: str, factor: float, more: float) -> str:
    """An input that is taken as k times itself and so much more, in words."""
    if factor == 1.0:
        return _offset(evidence, name, more)
    if more == 0.0:
        return (
            "has the other sign"
            if factor == -1.0
            else "is taken as 0"
            if factor == 0.0
            else f"is taken {factor:.6g} times"
        )
    unit = evidence.scene.mechanism.topology.input_units[name]
    if factor == -1.0:
        whole = "pi" if unit == "rad" and abs(more - np.pi) <= NEAR else f"{more:.6g} {unit}"
        return f"is taken as {whole} minus it"
    if factor == 0.0:
        return f"is taken as {more:.6g} {unit} all the time"
    return f"is taken {factor:.6g} times and {abs(more):.6g} {unit} {'more' if more > 0.0 else 'less'}"


KIND = Inputs()
