"""Wrong inputs x, each taken as k x + m: with the other sign, as pi minus it, k times, so much more.

k or m of one input, then k and m of all together, are found by least squares. It is for the whole car.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from pointcoord import Motion, PointcoordError, simulate
from pointcoord.drawing_stands import drawn_inputs
from pointcoord.scene.input_part import InputPart
from validate.diagnosis.evidence import Evidence
from validate.diagnosis.hypothesis import Hypothesis
from validate.diagnosis.least import fitted, meant
from validate.formulations.input_rates import rates

Array = NDArray[np.float64]
Taken = Mapping[str, tuple[float, float]]
"""k and m by input."""

OURS = (1.0, 0.0)
STEP = 1e-3  # of differences by k and m
FEW = 64  # instants that a wrong input is looked for at
NEAR = 1e-5  # of an input's drawn value: how near to it what is missing is meant to be it
MEANT = 1e-8


def wrong_inputs(evidence: Evidence) -> Iterator[Hypothesis]:
    """Simple before far-fetched, and no more of these where something explains all."""
    laws = evidence.scene.inputs
    count, looked = len(evidence.times), evidence.first_wrong
    few = evidence.at(np.unique(np.linspace(0, count - 1, min(FEW, count)).astype(np.intp)).tolist())
    theirs = np.concatenate([few.given[row].ravel() for row in looked])
    if not np.isfinite(theirs).all():
        return
    sizes = {name: np.abs(rates(law, few.times)[:, 0]) for name, law in laws.items()}
    moving = [name for name in laws if sizes[name].any()]

    def read(taken: Taken) -> Array | None:
        motion = _motion(evidence, taken)
        numbers = {} if motion is None else motion.at(few.times).numbers
        if any(quantity not in numbers or of not in numbers[quantity] for quantity, of in looked):
            return None
        return np.concatenate([numbers[quantity][of].ravel() for quantity, of in looked])

    def supposed(taken: Taken) -> Hypothesis | None:
        motion = _motion(evidence, taken)
        if motion is None:
            return None
        found = sum((abs(k) != 1.0) + (m != 0.0) for k, m in taken.values())
        cost = 1.2 + 0.2 * found + 0.1 * len(taken)
        words = ", and ".join(f"the input {name} {_said(evidence, name, *km)}" for name, km in taken.items())
        return Hypothesis(tuple(taken.items()), words, evidence.by(motion), found, cost, whole=True)

    def search(places: list[tuple[str, int]]) -> dict[str, tuple[float, float]] | None:
        """k (0) and m (1) of some inputs; of those only that are found not to be ours."""

        def at(values: Array) -> dict[str, tuple[float, float]]:
            taken = {name: [*OURS] for name, _ in places}
            for (name, which), value in zip(places, values.tolist(), strict=True):
                taken[name][which] = value
            return {name: (k, m) for name, (k, m) in taken.items()}

        def numbers(sets: Array) -> Array:
            found = [read(at(values)) for values in sets]
            return np.stack([np.full(len(theirs), np.nan) if one is None else one for one in found])

        found = fitted(numbers, [OURS[which] for _, which in places], STEP, theirs)
        if found is None:
            return None
        for i, (name, which) in enumerate(places):
            # An amount is little beside numbers of the law's own size.
            scale = 1.0 if which == 0 else float(sizes[name].max()) or 1.0
            near = [plain for plain in (OURS[which], 0.0) if abs(found[i] - plain) <= MEANT * scale]
            found[i] = near[0] if near else meant(float(found[i]))
        return {name: km for name, km in at(found).items() if km != OURS}

    # One number alone, then all together; of an input that stands still k and m are one.
    single = [[(name, which)] for which in (0, 1) for name in (laws if which else moving)]
    every = [(name, which) for name in laws for which in (0, 1) if which or np.ptp(sizes[name]) > 0.0]
    for stage in (single, [every]):
        some = [one for places in stage if (taken := search(places)) and (one := supposed(taken))]
        yield from some
        if any(all(evidence.left(row, *one.rows[row]) <= 1.0 for row in looked) for one in some):
            return


def _motion(evidence: Evidence, taken: Taken) -> Motion | None:
    """The car's motion by other inputs, with every point; None where it cannot follow them."""
    scene = evidence.solved.fine
    laws = {name: _changed(scene.inputs[name], *km) for name, km in taken.items()}
    try:
        return simulate(scene.model_copy(update={"inputs": {**scene.inputs, **laws}, "points": None}))
    except PointcoordError:
        return None


def _changed(law: InputPart, factor: float, more: float) -> InputPart:
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
        values = (factor * first + more, *(factor * value for value in others))
        return law.model_copy(update={"polynomial": values})
    return law.model_copy(update={"constant": factor * (law.constant or 0.0) + more})


def _said(evidence: Evidence, name: str, factor: float, more: float) -> str:
    """An input that is taken as k times itself and so much more, in words."""
    unit = evidence.scene.mechanism.topology.input_units[name]
    amount = f"{abs(more):.6g} {unit}"
    if factor == 1.0:
        drawn = _drawn(evidence, name)
        if drawn is not None and abs(more + drawn) <= NEAR * abs(drawn):
            return f"is taken from the drawing on: {abs(drawn):.6g} {unit} are missing"
        if drawn is not None and abs(more - drawn) <= NEAR * abs(drawn):
            return f"is taken from the drawing on, and is not: {abs(drawn):.6g} {unit} are too many"
        return f"is taken {amount} {'more' if more > 0.0 else 'less'}"
    if more == 0.0:
        return {-1.0: "has the other sign", 0.0: "is taken as 0"}.get(factor, f"is taken {factor:.6g} times")
    if factor == -1.0:
        whole = "pi" if unit == "rad" and abs(more - np.pi) <= NEAR else f"{more:.6g} {unit}"
        return f"is taken as {whole} minus it"
    if factor == 0.0:
        return f"is taken as {more:.6g} {unit} all the time"
    return f"is taken {factor:.6g} times and {amount} {'more' if more > 0.0 else 'less'}"


def _drawn(evidence: Evidence, name: str) -> float | None:
    """An input of the closed drawing; None of one that does not close, or that moves the chassis."""
    try:
        return drawn_inputs(evidence.scene).get(name)
    except PointcoordError:
        return None
