"""A wrong input: with the other sign, k times ours, or an angle as pi minus it; for the whole car.

k is found by least squares of the numbers of one unit: from how they change with it, from step to step, by
solving the car's motion with k times the input.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from pointcoord import Motion, PointcoordError, simulate
from pointcoord.scene.scene_file import InputPart
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
        for name, law in evidence.scene.inputs.items():
            if not np.abs(rates(law, few.times)[:, 0]).max() > 0.0:
                continue
            known = [("has the other sign", changed(law, -1.0))]
            if units[name] == "rad":
                known.append(("is taken as pi minus it", changed(law, -1.0, np.pi)))
            done = False
            for words, other in known:
                numbers = _read(few, name, other, looked)
                if numbers is None or np.linalg.norm(theirs - numbers) > PROMISING * apart:
                    continue
                rows = _rows(evidence, name, other)
                if rows is not None:
                    yield Hypothesis(self.name, (name, words), f"the input {name} {words}", rows, whole=True)
                    done |= all(evidence.left(row, *rows[row]) <= 1.0 for row in looked)
            factor = None if done else _factor(few, name, law, looked, theirs)
            rows = None if factor is None else _rows(evidence, name, changed(law, factor))
            if rows is not None:
                words = f"the input {name} is taken {factor:.6g} times"
                yield Hypothesis(self.name, (name, "times"), words, rows, 1, 1.5, whole=True)


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


def _motion(evidence: Evidence, name: str, law: InputPart) -> Motion | None:
    """The car's motion by another input, with every point; None where it cannot follow it."""
    scene = evidence.solved.fine
    try:
        return simulate(scene.model_copy(update={"inputs": {**scene.inputs, name: law}, "points": None}))
    except PointcoordError:
        return None


def _rows(evidence: Evidence, name: str, law: InputPart) -> dict[Row, tuple[Array, Array]] | None:
    motion = _motion(evidence, name, law)
    if motion is None:
        return None
    samples = motion.at(evidence.times)
    proven = motion.proof_of(samples, rates=True).proven
    rows: dict[Row, tuple[Array, Array]] = {}
    for row in evidence.held:
        quantity, of = row
        if of in samples.numbers[quantity]:
            value = np.array(samples.numbers[quantity][of])
            # Ours by this input are off by their own bound, and by as much again for what the law's numbers
            # and a factor that is found are rounded by.
            bound = np.nan_to_num(proven[quantity][of], posinf=0.0)
            rows[row] = (value, 2.0 * (evidence.rounded(row, value) + bound))
    return rows


def _read(evidence: Evidence, name: str, law: InputPart, rows: Sequence[Row]) -> Array | None:
    """Numbers of some rows by another input, one after the other; None where there are none."""
    motion = _motion(evidence, name, law)
    if motion is None:
        return None
    numbers = motion.at(evidence.times).numbers
    if any(of not in numbers[quantity] for quantity, of in rows):
        return None
    return np.concatenate([numbers[quantity][of].ravel() for quantity, of in rows])


def _factor(
    evidence: Evidence, name: str, law: InputPart, rows: Sequence[Row], theirs: Array
) -> float | None:
    """The factor of least squares; None where none leaves much less than ours."""
    before, factor = 1.0 - STEP, 1.0
    old, here = (_read(evidence, name, changed(law, k), rows) for k in (before, factor))
    if old is None or here is None:
        return None
    first = rest = float(np.linalg.norm(theirs - here))
    for _ in range(STEPS):
        slope = (here - old) / (factor - before)
        square = float(slope @ slope)
        change = float(slope @ (theirs - here)) / square if square > 0.0 else np.nan
        if not np.isfinite(change) or change == 0.0:
            break
        new = _read(evidence, name, changed(law, factor + change), rows)
        left = np.inf if new is None else float(np.linalg.norm(theirs - new))
        if new is None or not left <= FALLING * rest:
            break
        before, factor, old, here, rest = factor, factor + change, here, new, left
    if rest > PROMISING * first:
        return None
    meant = float(f"{factor:.6g}")
    return meant if abs(meant - factor) <= MEANT * abs(factor) else factor


KIND = Inputs()
