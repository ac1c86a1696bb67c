"""Wrong inputs x, each taken as k x + m: with the other sign, as pi minus it, k times, so much more.

k or m of one input, then k and m of all together, are found by least squares. It is for the whole car.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import partial

import numpy as np

from pointcoord import Motion, PointcoordError, simulate
from pointcoord.scene.input_part import InputPart
from validate.diagnosis.evidence import Evidence, Row
from validate.diagnosis.hypothesis import Hypothesis, amounts_of, by_what_tells, gives
from validate.diagnosis.least import meant
from validate.formulations.input_rates import rates

Taken = Mapping[str, tuple[float, float]]
"""k and m by input."""

OURS = (1.0, 0.0)
STEP = 1e-3  # of differences by k and m
NEAR = 1e-5  # how near to pi an amount is meant to be it


def wrong_inputs(evidence: Evidence) -> Iterator[Hypothesis]:
    """Simple before far-fetched, and no more of these where something explains all."""
    return by_what_tells(evidence, partial(_wrong, evidence))


def _wrong(evidence: Evidence, looked: Sequence[Row], several: bool) -> list[Hypothesis]:
    """One number of an input by itself; all together if several are looked for and this does not do."""
    laws = evidence.scene.inputs
    sizes = {name: np.abs(rates(law, evidence.times)[:, 0]) for name, law in laws.items()}

    def search(places: Sequence[tuple[str, int]]) -> Taken:
        """k (0) and m (1) of some inputs; of those only that are found not to be ours."""
        start = [OURS[which] for _, which in places]

        def motion_of(*values: float) -> Motion | None:
            return _motion(evidence, _taken(places, values))

        found = amounts_of(evidence, looked, motion_of, start, STEP, rounded=False)
        if found is None:
            return {}
        for i, (name, which) in enumerate(places):
            # An amount is little beside numbers of the law's own size.
            found[i] = meant(found[i], 1.0 if which == 0 else float(sizes[name].max()) or 1.0)
        return {name: km for name, km in _taken(places, found).items() if km != OURS}

    # Of an input that stands still k and m are one, of one at 0 only m.
    moves = [name for name in laws if np.ptp(sizes[name]) > 0.0]
    single = [[(name, 0)] for name in laws if sizes[name].any()] + [[(name, 1)] for name in laws]
    every = [(name, which) for name in laws for which in (0, 1) if which or name in moves]
    found: list[Hypothesis] = []
    for stage in (single, [every]) if several else (single,):
        found += (
            one for places in stage if (taken := search(places)) and (one := _supposed(evidence, taken))
        )
        if any(gives(evidence, one, looked) for one in found):
            break
    return found


def _taken(places: Sequence[tuple[str, int]], values: Sequence[float]) -> dict[str, tuple[float, float]]:
    """k and m of inputs by some of these numbers, the others ours."""
    said = dict(zip(places, values, strict=True))
    return {
        n: (said.get((n, 0), OURS[0]), said.get((n, 1), OURS[1])) for n in dict.fromkeys(n for n, _ in places)
    }


def _supposed(evidence: Evidence, taken: Taken) -> Hypothesis | None:
    """All numbers of the car by inputs that are taken so; None where it cannot follow them."""
    motion = _motion(evidence, taken)
    if motion is None:
        return None
    found = sum((abs(k) != 1.0) + (m != 0.0) for k, m in taken.values())
    cost = 1.2 + 0.2 * found + 0.1 * len(taken)
    words = ", and ".join(f"the input {name} {_said(evidence, name, *km)}" for name, km in taken.items())
    return Hypothesis(tuple(taken.items()), words, evidence.by(motion), found, cost, whole=True)


def _motion(evidence: Evidence, taken: Taken) -> Motion | None:
    """The car's motion by other inputs, with every point; None where it cannot follow them."""
    scene = evidence.solved.ends
    laws = {name: _changed(scene.inputs[name], *km) for name, km in taken.items()}
    try:
        return simulate(scene.model_copy(update={"inputs": {**scene.inputs, **laws}}))
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
    first, *others = law.polynomial or (law.constant or 0.0,)
    return InputPart(polynomial=(factor * first + more, *(factor * value for value in others)))


def _said(evidence: Evidence, name: str, factor: float, more: float) -> str:
    """An input that is taken as k times itself and so much more, in words."""
    unit = evidence.scene.mechanism.topology.input_units[name]
    by = f"{abs(more):.6g} {unit} {'more' if more > 0.0 else 'less'}"
    if factor == 1.0:
        return f"is taken {by}"
    if more == 0.0:
        return {-1.0: "has the other sign", 0.0: "is taken as 0"}.get(factor, f"is taken {factor:.6g} times")
    if factor == -1.0:
        whole = "pi" if unit == "rad" and abs(more - np.pi) <= NEAR else f"{more:.6g} {unit}"
        return f"is taken as {whole} minus it"
    if factor == 0.0:
        return f"is taken as {more:.6g} {unit} all the time"
    return f"is taken {factor:.6g} times and {by}"
