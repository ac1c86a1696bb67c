"""Faults in time: rates by finite differences, a wrong input, a motion that is earlier or later; and another
closure of the drawing.

Differences of numbers that disagree explain nothing: the rates of any car are nearly differences of its
positions.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

import numpy as np

from pointcoord import Motion, Scene
from pointcoord.effects.registry import QUANTITIES
from pointcoord.method import AUTO
from pointcoord.numerics.rounding import EPS
from pointcoord.simulation import prepare_task, solve_task
from validate.arrays import Array
from validate.diagnosis.evidence import Evidence, Row, WouldBe
from validate.diagnosis.fault import ANY, Fault
from validate.diagnosis.other_car import Change, any_of, rows_of
from validate.diagnosis.solved import Content

SCALED = {"amplitude", "offset", "values"}  # the entries of a law that are multiplied if the law is
COST = 1.5  # cost of a wrong input, which is likelier than a shift of all numbers in time
FARTHEST = 3  # largest shift in time, samples


def _steps(x: Array, t: Array) -> Array:
    return np.diff(x, axis=0) / np.diff(t).reshape(-1, *[1] * (x.ndim - 1))


RULES: Mapping[str, Callable[[Array, Array], Array]] = {
    "central": lambda x, t: np.gradient(x, t, axis=0),
    "forward": lambda x, t: np.concatenate([_steps(x, t), x[:1]]),
    "backward": lambda x, t: np.concatenate([x[:1], _steps(x, t)]),
}
"""Differences of numbers x at instants t: forward (x_{k+1} - x_k) / h, backward (x_k - x_{k-1}) / h, and
central, the mean of both. The first and last ones are not compared: programs fill them in different ways."""


def _integral(row: Row, evidence: Evidence) -> Row | None:
    """The row of which a row is the time derivative; None if it is not given."""
    for quantity in QUANTITIES:
        other = Row(quantity, row.name)
        alike = other.of == row.of and other.unit == row.unit
        if alike and other.order == row.order - 1 and other in evidence.given:
            return other
    return None


def differences(evidence: Evidence) -> Iterator[Fault]:
    """Each rule, for all rates that disagree, applied to given numbers that agree."""
    times = evidence.times
    if len(times) < 3 or not (np.diff(times) > 0.0).all():
        return
    step, latest = float(np.diff(times).min()), float(np.abs(evidence.scene.instants).max())
    for words, rule in RULES.items():
        rows: dict[Row, WouldBe] = {}
        for row in evidence.wrong:
            source = _integral(row, evidence)
            if source is None or source in evidence.wrong:
                continue
            numbers = evidence.given[source]
            value = rule(numbers, times)
            # The numbers and the instants are each rounded before they are subtracted, and printed after it.
            late = latest / step * float(np.abs(value).max())
            printed = 2.0 * float(np.max(evidence.own.get(source, 0.0)))
            rounding = (16.0 * EPS * float(np.abs(numbers).max()) + printed) / step + 16.0 * EPS * late
            allowed = evidence.rounded(row) + rounding
            allowed[[0, -1]] = ANY
            rows[row] = value, allowed
        yield Fault(f"rates by {words} differences", rows)


def wrong_inputs(evidence: Evidence) -> Iterator[Fault]:
    """Each input alone, multiplied by a factor or shifted by an amount."""
    laws = evidence.scene.inputs
    return any_of(evidence, [*map(_times, laws), *(_more(evidence, name) for name in laws)])


def _times(name: str) -> Change:
    def put(content: Content, factor: float) -> None:
        content["inputs"][name] = _law_times(content["inputs"][name], factor)

    def words(factor: float) -> str:
        words = {-1.0: "has the other sign", 0.0: "is taken as 0"}
        return f"the input {name} {words.get(round(factor, 8), f'is taken {factor:.6g} times')}"

    return Change(put, words, ours=1.0, cost=COST)


def _more(evidence: Evidence, name: str) -> Change:
    unit = evidence.scene.mechanism.topology.input_units[name]

    def put(content: Content, more: float) -> None:
        content["inputs"][name] = {"sum": [content["inputs"][name], {"constant": more}]}

    def words(more: float) -> str:
        return f"the input {name} is taken {abs(more):.6g} {unit} {'more' if more > 0.0 else 'less'}"

    return Change(put, words, cost=COST)


def _law_times(law: Content, factor: float) -> Content:
    ((kind, of),) = law.items()
    if kind == "sum":
        return {kind: [_law_times(term, factor) for term in of]}
    if isinstance(of, dict):
        scaled = {key: np.multiply(factor, of[key]).tolist() for key in SCALED & of.keys()}
        return {kind: {**of, **scaled}}
    return {kind: np.multiply(factor, of).tolist()}


def shifted_in_time(evidence: Evidence) -> Iterator[Fault]:
    """The given numbers at t are ours at t + s, for the whole car, with s a few samples at most."""
    most = FARTHEST * float(np.diff(evidence.times).max(initial=0.0))

    def put(content: Content, shift: float) -> None:
        content["time"] |= {end: content["time"][end] + shift for end in ("start", "stop")}

    def words(shift: float) -> str:
        return f"the same curves {abs(shift):.6g} s {'later' if shift < 0.0 else 'earlier'}"

    shift = Change(put, words, step=1e-4 * most, farthest=most, cost=2.0, late=True)
    return any_of(evidence, [shift] if evidence.over_time and most > 0.0 else [])


def other_closures(evidence: Evidence) -> Iterator[Fault]:
    """The whole car with another closure of its suspension type."""
    part = evidence.scene.mechanism
    for closure in part.file.closures:

        def put(content: Content, closure: str = closure) -> None:
            content["mechanism"]["closure"] = closure

        if closure != part.closure:
            words = f"the car is closed as {closure}, where the scene asks for {part.closure}"
            rows = rows_of(evidence, evidence.solved.other(words, put, _as_it_stands))
            yield Fault(words, rows, whole=True)


def _as_it_stands(scene: Scene) -> Motion:
    """The motion without a check of the drawing, which could refuse a drawing with another closure."""
    return solve_task(prepare_task(scene, AUTO))
