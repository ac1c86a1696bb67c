"""The same car moved otherwise: by an input that is taken otherwise, or earlier or later."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from pointcoord.numerics.rounding import EPS
from validate.diagnosis.evidence import Content, Evidence, Row, numbers_in
from validate.diagnosis.hypothesis import Hypothesis, WouldBe
from validate.diagnosis.least import fitted
from validate.diagnosis.other_car import FEW, Change, any_of
from validate.formulations.input_rates import rates

Array = NDArray[np.float64]

SCALED = {"amplitude", "offset", "values"}  # of a law, what is so many times itself if the law is
STEP = 1e-3  # of differences by a factor, and by an amount
COST = 1.5  # of another input, which is likelier than that all is late
FARTHEST = 3  # samples that a motion may be late or early


def wrong_inputs(evidence: Evidence) -> Iterator[Hypothesis]:
    """Each input by itself, taken so many times, or so much more."""
    # Of an input at 0 there is no factor.
    moving = [name for name, law in evidence.scene.inputs.items() if rates(law, evidence.times)[:, 0].any()]
    factors = [_times(name) for name in moving]
    return any_of(evidence, [*factors, *(_more(evidence, name) for name in evidence.scene.inputs)])


def _times(name: str) -> Change:
    def put(content: Content, factor: float) -> None:
        content["inputs"][name] = _law_times(content["inputs"][name], factor)

    def words(factor: float) -> str:
        said = {-1.0: "has the other sign", 0.0: "is taken as 0"}
        return f"the input {name} {said.get(round(factor, 8), f'is taken {factor:.6g} times')}"

    return Change((name, "times"), 1.0, STEP, put, words, COST)


def _more(evidence: Evidence, name: str) -> Change:
    unit = evidence.scene.mechanism.topology.input_units[name]

    def put(content: Content, more: float) -> None:
        content["inputs"][name] = {"sum": [content["inputs"][name], {"constant": more}]}

    def words(more: float) -> str:
        return f"the input {name} is taken {abs(more):.6g} {unit} {'more' if more > 0.0 else 'less'}"

    return Change((name, "more"), 0.0, STEP, put, words, COST)


def _law_times(law: Content, factor: float) -> Content:
    ((kind, of),) = law.items()
    if kind == "sum":
        return {kind: [_law_times(term, factor) for term in of]}
    if isinstance(of, dict):
        scaled = {key: np.multiply(factor, of[key]).tolist() for key in SCALED & of.keys()}
        return {kind: {**of, **scaled}}
    return {kind: np.multiply(factor, of).tolist()}


def shifted_in_time(evidence: Evidence) -> Iterator[Hypothesis]:
    """Their numbers at t are ours at t + s, of the whole car, with s a few samples at most."""
    times, looked = evidence.times, evidence.telling[0]
    few, time = evidence.thinned(FEW), evidence.solved.content["time"]
    most = FARTHEST * float(np.diff(times).max(initial=0.0))
    limits = {"start": time["start"] - most, "stop": time["stop"] + most}
    motion = evidence.solved.other("longer", lambda content: content["time"].update(limits))
    if motion is None or not most > 0.0:
        return  # the car does not go so far

    def read(shift: float) -> Array | None:
        return numbers_in(motion.at(few.times + shift).numbers, looked) if abs(shift) < most else None

    fit = fitted(read, 0.0, 1e-4 * most, few.joined(looked))
    if fit is None:
        return
    shift, found = fit[0], motion.at(times + fit[0]).numbers
    rows: dict[Row, WouldBe] = {}
    for row in evidence.held:
        if row[1] in found[row[0]]:
            value = np.asarray(found[row[0]][row[1]])
            # The instants are rounded too, and so moves what is read there.
            speed = np.abs(np.gradient(value, times, axis=0)).max()
            # What is claimed varies along the motion: the most of it, since it is read elsewhere.
            widest = np.broadcast_to(evidence.rounded(row).max(axis=0), value.shape)
            rows[row] = value, widest + 8.0 * EPS * speed * (abs(shift) + np.abs(times).max())
    words = f"the same curves {abs(shift):.6g} s {'later' if shift < 0.0 else 'earlier'}"
    yield Hypothesis("shift", words, rows, 1, 2.0, whole=True)
