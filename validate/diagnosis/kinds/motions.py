"""The same car moved otherwise: by an input that is taken otherwise, or earlier or later."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from validate.diagnosis.evidence import Content, Evidence
from validate.diagnosis.hypothesis import Hypothesis
from validate.diagnosis.other_car import Change, any_of
from validate.formulations.input_rates import rates

SCALED = {"amplitude", "offset", "values"}  # of a law, what is so many times itself if the law is
STEP = 1e-3  # of differences by a factor, and by an amount
COST = 1.5  # of another input, which is likelier than that all is late
FARTHEST = 3  # samples that a motion may be late or early


def wrong_inputs(evidence: Evidence) -> Iterator[Hypothesis]:
    """Each input by itself, taken so many times, or so much more."""
    # Of numbers over an input it is that input which is taken otherwise.
    laws = evidence.scene.inputs if evidence.over_time else {}
    # Of an input at 0 there is no factor.
    moving = [name for name, law in laws.items() if rates(law, evidence.times)[:, 0].any()]
    return any_of(evidence, [*map(_times, moving), *(_more(evidence, name) for name in laws)])


def _times(name: str) -> Change:
    def put(content: Content, factor: float) -> None:
        content["inputs"][name] = _law_times(content["inputs"][name], factor)

    def words(factor: float) -> str:
        said = {-1.0: "has the other sign", 0.0: "is taken as 0"}
        return f"the input {name} {said.get(round(factor, 8), f'is taken {factor:.6g} times')}"

    return Change((name, "times"), put, words, STEP, ours=1.0, cost=COST)


def _more(evidence: Evidence, name: str) -> Change:
    unit = evidence.scene.mechanism.topology.input_units[name]

    def put(content: Content, more: float) -> None:
        content["inputs"][name] = {"sum": [content["inputs"][name], {"constant": more}]}

    def words(more: float) -> str:
        return f"the input {name} is taken {abs(more):.6g} {unit} {'more' if more > 0.0 else 'less'}"

    return Change((name, "more"), put, words, STEP, cost=COST)


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
    most = FARTHEST * float(np.diff(evidence.times).max(initial=0.0))

    def put(content: Content, shift: float) -> None:
        content["time"] |= {end: content["time"][end] + shift for end in ("start", "stop")}

    def words(shift: float) -> str:
        return f"the same curves {abs(shift):.6g} s {'later' if shift < 0.0 else 'earlier'}"

    shift = Change("shift", put, words, 1e-4 * most, farthest=most, cost=2.0, late=True)
    return any_of(evidence, [shift] if evidence.over_time and most > 0.0 else [])
