"""Faults in time: rates by finite differences, a wrong input, a motion that is earlier or later.

With h the time between two instants, differences are forward (x_{k+1} - x_k) / h, backward (x_k - x_{k-1}) /
h, central (the mean of both), and for accelerations also (x_{k+1} - 2 x_k + x_{k-1}) / h^2.
Differences of numbers that disagree explain nothing: the rates of any car are nearly differences of its
positions.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from pointcoord.effects.registry import QUANTITIES
from pointcoord.numerics.rounding import EPS
from validate.arrays import Array
from validate.diagnosis.evidence import ANY, Content, Evidence, Hypothesis, Row, WouldBe
from validate.diagnosis.other_car import Change, any_of
from validate.formulations.input_rates import rates

Rule = Callable[[Array, Array], Array]

SCALED = {"amplitude", "offset", "values"}  # the entries of a law that are multiplied if the law is
STEP = 1e-3  # step of a difference by a factor or an amount
COST = 1.5  # cost of a wrong input, which is likelier than a shift of all numbers in time
FARTHEST = 3  # largest shift in time, samples


def _steps(x: Array, t: Array) -> Array:
    return np.diff(x, axis=0) / np.diff(t).reshape(-1, *[1] * (x.ndim - 1))


def _forward(x: Array, t: Array) -> Array:
    return np.concatenate([_steps(x, t), x[:1]])


def _backward(x: Array, t: Array) -> Array:
    return np.concatenate([x[:1], _steps(x, t)])


def _central(x: Array, t: Array) -> Array:
    return np.asarray(np.gradient(x, t, axis=0))


def _second(x: Array, t: Array) -> Array:
    return np.concatenate([x[:1], _steps(_steps(x, t), 0.5 * (t[1:] + t[:-1])), x[:1]])


ONCE: dict[str, Rule] = {"central": _central, "forward": _forward, "backward": _backward}
RULES: list[tuple[str, Rule, int]] = [
    *((f"{words} differences", rule, 1) for words, rule in ONCE.items()),
    *(
        (f"{words} differences, taken twice", lambda x, t, rule=rule: rule(rule(x, t), t), 2)
        for words, rule in ONCE.items()
    ),
    ("second differences of positions", _second, 2),
]
"""The rules: in words, the function, and the order of the derivative. The first and last numbers, as many as
the order, are any: programs fill them in different ways."""


def _integral(row: Row, below: int, evidence: Evidence) -> Row | None:
    """The row of which a row is the time derivative of order `below`; None if it is not given."""
    for quantity in QUANTITIES:
        other = Row(quantity, row.name)
        alike = other.of == row.of and other.unit == row.unit
        if alike and other.order == row.order - below and other in evidence.given:
            return other
    return None


def differences(evidence: Evidence) -> Iterator[Hypothesis]:
    """Each rule, for all rates that disagree, applied to given numbers of lower order that agree."""
    times = evidence.times
    if len(times) < 4 or not (np.diff(times) > 0.0).all():
        return
    step, latest = float(np.diff(times).min()), float(np.abs(evidence.scene.instants).max())
    for words, rule, below in RULES:
        rows: dict[Row, WouldBe] = {}
        for row in evidence.wrong:
            source = _integral(row, below, evidence)
            if source is None or source in evidence.wrong:
                continue
            numbers = evidence.given[source]
            value = rule(numbers, times)
            # The numbers and the instants are each rounded before they are subtracted, and printed after it.
            late = latest / step * float(np.abs(value).max(initial=0.0))
            printed = 2.0**below * float(np.max(evidence.own.get(source, 0.0), initial=0.0))
            rounding = (16.0 * EPS * float(np.abs(numbers).max()) + printed) / step**below + 16.0 * EPS * late
            allowed = evidence.rounded(row) + rounding
            allowed[:below] = allowed[-below:] = ANY
            rows[row] = value, allowed
        yield Hypothesis(f"rates by {words}", rows)


def wrong_inputs(evidence: Evidence) -> Iterator[Hypothesis]:
    """Each input alone, multiplied by a factor or shifted by an amount."""
    laws = evidence.scene.inputs
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
