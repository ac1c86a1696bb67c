"""Rows of a comparison that are made together, held to each made by itself, as its definitions say."""

import math
from dataclasses import astuple, replace

import numpy as np
import pytest
from every_effect import every_effect
from numpy.typing import NDArray

from pointcoord.effects.registry import QUANTITIES
from validate.comparison import compare
from validate.comparison.compare import Comparison, Verdict, compare_solutions
from validate.comparison.tolerance import LOOSEST
from validate.formulations.protocol import Solution
from validate.formulations.registry import formulation

Array = NDArray[np.float64]

EPS, TINY = 2.0**-52, 2.0**-1022
SCENE = every_effect("bounce")


@pytest.fixture(scope="module")
def solutions() -> tuple[Solution, Solution]:
    """Of two formulations, as they are."""
    one, two = (formulation(name).solve(SCENE) for name in ("pointcoord", "pointcoord-newton"))
    return one, two


def most(array: Array) -> Array:
    """The largest magnitude at each instant."""
    return np.abs(array).reshape(len(array), -1).max(axis=-1)


def level(solution: Solution, quantity: str) -> Array:
    """What a side would claim of any number of a quantity."""
    numbers = [np.where(np.isfinite(a), a, 0.0) for a in solution.numbers[quantity].values()]
    rounding = [EPS * solution.accuracy.condition * most(array) for array in numbers]
    claims = [most(claim) for claim in solution.accuracy.claims[quantity].values()]
    return np.max([*rounding, *claims], axis=0)


def by_itself(quantity: str, part: str, one: Solution, two: Solution) -> Comparison:
    """The row of one part, worked out without any other."""
    unit, nan = QUANTITIES[quantity].unit, math.nan
    ends = ("a scene", one.formulation, two.formulation, quantity, part, unit)
    if not (part in one.numbers[quantity] and part in two.numbers[quantity]):
        return Comparison(*ends, nan, nan, nan, nan, "not given", "", nan)
    gap = np.abs(one.numbers[quantity][part] - two.numbers[quantity][part])
    if unit == "rad":
        gap = np.minimum(gap, np.abs(2.0 * np.pi - gap))
    gap = np.where(np.isfinite(gap), gap, np.inf)
    claims = [side.accuracy.claims[quantity].get(part) for side in (one, two)]
    held = [np.zeros_like(gap) if claim is None else claim for claim in claims]
    sizes = [
        max(float(np.abs(a[np.isfinite(a)]).max(initial=0.0)) for a in side.numbers[quantity].values())
        for side in (one, two)
    ]
    allowed = held[0] + held[1] + EPS**2 * min(sizes)
    with np.errstate(divide="ignore", invalid="ignore"):
        shares = np.where(gap == 0.0, 0.0, gap / (allowed + TINY))
    loose = (most(held[0]) > LOOSEST * level(two, quantity)) | (
        most(held[1]) > LOOSEST * level(one, quantity)
    )
    verdict: Verdict = "agrees"
    if any(claim is None for claim in claims):
        verdict = "not tested"
    elif shares.max() > 1.0:
        verdict = "disagrees"
    elif (loose & (most(gap) > TINY)).any():
        verdict = "not tested"
    worst, widest = (np.unravel_index(int(np.argmax(a)), a.shape) for a in (gap, allowed))
    larger = int(held[1][widest] > held[0][widest])
    return Comparison(
        *ends,
        difference=float(gap[worst]),
        tolerance=float(allowed[worst]),
        share=float(shares.max()),
        instant=float(SCENE.instants[worst[0]]),
        verdict=verdict,
        rests_on=(one, two)[larger].formulation,
        part=float(held[larger][widest] / (allowed[widest] + TINY)),
    )


def spoilt(solution: Solution) -> Solution:
    """With numbers that are none, that are far off, that are exact, and some that are missing."""
    rng = np.random.default_rng(4)
    numbers = {quantity: dict(part) for quantity, part in solution.numbers.items()}
    claims = {quantity: dict(part) for quantity, part in solution.accuracy.claims.items()}
    for quantity, part in numbers.items():
        for name, array in list(part.items()):
            changed, claimed = array.copy(), claims[quantity][name].copy()
            kind, when = int(rng.integers(7)), int(rng.integers(len(array)))
            if kind == 0:
                changed[when] = math.nan
            elif kind == 1:
                changed[when] += 1e-3
            elif kind == 2:
                claimed *= 1e5
            elif kind == 3:
                changed, claimed = np.round(array, 3), claimed + 1.0
            elif kind == 4 and QUANTITIES[quantity].unit == "rad":
                changed[when] += 2.0 * np.pi
            part[name], claims[quantity][name] = changed, claimed
            if kind == 5:
                del claims[quantity][name]
            elif kind == 6:
                del part[name], claims[quantity][name]
    return replace(solution, numbers=numbers, accuracy=replace(solution.accuracy, claims=claims))


@pytest.mark.parametrize("at_once", [1, 1000, 2**30])
@pytest.mark.parametrize("spoil", [False, True])
def test_rows_together_are_the_rows_by_themselves(
    spoil: bool, at_once: int, solutions: tuple[Solution, Solution], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(compare, "AT_ONCE", at_once)
    one, two = solutions[0], spoilt(solutions[1]) if spoil else solutions[1]
    rows = compare_solutions(SCENE, one, two, "a scene").rows
    assert len(rows) > 30
    if spoil:
        assert {row.verdict for row in rows} == {"agrees", "disagrees", "not tested", "not given"}
    for row in rows:
        expected = by_itself(row.quantity, row.name, one, two)
        # NaN is no number equal to itself, but the same here; a reason is one of the whole solution.
        assert repr(astuple(replace(row, why=""))) == repr(astuple(expected))
        assert bool(row.why) == (row.verdict in ("not tested", "not given"))
