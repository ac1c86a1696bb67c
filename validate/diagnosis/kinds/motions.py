"""Faults in the motion: an input multiplied or shifted, or the whole motion earlier or later."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from validate.diagnosis.evidence import Content, Evidence
from validate.diagnosis.hypothesis import Hypothesis
from validate.diagnosis.other_car import Change, any_of
from validate.formulations.input_rates import rates

SCALED = {"amplitude", "offset", "values"}  # the entries of a law that are multiplied if the law is
STEP = 1e-3  # step of a difference by a factor or an amount
COST = 1.5  # cost of a wrong input, which is likelier than a shift of all numbers in time
FARTHEST = 3  # largest shift in time, samples


def wrong_inputs(evidence: Evidence) -> Iterator[Hypothesis]:
    """Each input alone, multiplied by a factor or shifted by an amount."""
    # If numbers are given over an input, the input has no law in time.
    laws = evidence.scene.inputs if evidence.over_time else {}
    # An input at 0 has no factor.
    moving = [name for name, law in laws.items() if rates(law, evidence.times)[:, 0].any()]
    return any_of(evidence, [*map(_times, moving), *(_more(evidence, name) for name in laws)])


def _times(name: str) -> Change:
    def put(content: Content, factor: float) -> None:
        content["inputs"][name] = _law_times(content["inputs"][name], factor)

    def words(factor: float) -> str:
        words = {-1.0: "has the other sign", 0.0: "is taken as 0"}
        return f"the input {name} {words.get(round(factor, 8), f'is taken {factor:.6g} times')}"

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
    """The given numbers at t are ours at t + s, for the whole car, with s a few samples at most."""
    most = FARTHEST * float(np.diff(evidence.times).max(initial=0.0))

    def put(content: Content, shift: float) -> None:
        content["time"] |= {end: content["time"][end] + shift for end in ("start", "stop")}

    def words(shift: float) -> str:
        return f"the same curves {abs(shift):.6g} s {'later' if shift < 0.0 else 'earlier'}"

    shift = Change("shift", put, words, 1e-4 * most, farthest=most, cost=2.0, late=True)
    return any_of(evidence, [shift] if evidence.over_time and most > 0.0 else [])
