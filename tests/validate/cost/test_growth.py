"""How cost grows: a size in a process of its own, what is left out, and the chain with its closed form."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest
from grown_tasks import LEAST, ending

from validate.cost import growth
from validate.cost.apart import Limits, measure_apart
from validate.cost.chain import RISE, TOLERANCE, closed_form
from validate.cost.growth import (
    CHAIN_INSTANTS,
    FULL,
    Line,
    chain_errors,
    designs_one_by_one,
    designs_together,
    grow,
    lines_of,
    long_chain,
    many_instants,
)
from validate.cost.race import Effort, NoNumbers, race
from validate.cost.scenes import own_scene, study_scene
from validate.cost.table import Row, Store, measured_here
from validate.cost.way import Answer
from validate.cost.ways.registry import WAYS

MB = 2**20
LIMITS = Limits(seconds=0.5)
ROW = Row("growth", "a", "series", "1e-9 mm", 1e-9, poses=10, against="instants", size=10)
STEER = study_scene("steer", own_scene("steer"))


def apart(how: str, taken: int = 0, loading: int = 0, limits: Limits = LIMITS) -> Row:
    (row,) = measure_apart(partial(ending, how, taken, loading), LEAST, ROW, limits)
    return row


@pytest.mark.parametrize(
    ("how", "verdict", "words"),
    [
        ("killed", "failed", "its process ended with status -9; -9 is that of a system out of memory"),
        ("exits", "failed", "its process ended with status 3; -9 is that of a system out of memory"),
        ("does not apply", "left out", "only struts"),
    ],
)
def test_a_process_that_dies_is_a_failure_with_its_reason(how: str, verdict: str, words: str) -> None:
    row = apart(how)
    assert (row.verdict, row.reason) == (verdict, words)
    assert (row.time, row.peak_bytes, row.poses) == (None, None, 0)


def test_more_memory_than_allowed_is_a_failure_and_not_the_end_of_the_machine() -> None:
    row = apart("takes and gives back", 600 * MB, limits=Limits(0.5, memory=256 * MB))
    assert row.verdict == "failed"
    assert "MemoryError: Unable to allocate 600" in row.reason


def test_peak_memory_is_the_runs_own_and_not_of_those_who_started_it() -> None:
    ballast = np.ones(120 * MB // 8)
    taken = apart("takes and gives back", 40 * MB).peak_bytes
    loaded = apart("takes and gives back", 20 * MB, loading=80 * MB).peak_bytes
    nothing = apart("prints").peak_bytes
    assert ballast[-1] == 1.0
    # What loading gave back is used again, and Python keeps some pages beside: a MB or two.
    assert taken is not None
    assert loaded is not None
    assert nothing is not None
    assert 38 * MB <= taken <= 44 * MB
    assert 18 * MB <= loaded <= 24 * MB
    assert nothing <= 4 * MB


def grown(
    patch: pytest.MonkeyPatch, sizes: tuple[int, ...], measure: Callable[[Row], list[Row]]
) -> tuple[list[Row], list[int | None]]:
    """The rows of a line whose sizes take what somebody says, and the sizes that were measured."""
    measured: list[int | None] = []

    def measure_apart(make: Any, least: int, row: Row, limits: Limits) -> list[Row]:
        measured.append(row.size)
        return measure(row)

    patch.setattr(growth, "measure_apart", measure_apart)
    store = Store(None, measured_here())
    grow(Line(replace(ROW, size=None), sizes, 1, long_chain, 6), store, Limits(20.0))
    return store.rows, measured


def taking(row: Row, seconds: float) -> list[Row]:
    return [replace(row, quantity="position", time=seconds / row.poses, set_up=0.0)]


def test_what_would_take_too_long_is_left_out_with_the_reason(monkeypatch: pytest.MonkeyPatch) -> None:
    found, measured = grown(
        monkeypatch, (100, 1000, 100_000, 1_000_000), lambda row: taking(row, 0.002 * row.poses)
    )
    assert measured == [100, 1000]
    assert [row.verdict for row in found] == ["measured", "measured", "left out", "left out"]
    assert found[2].reason == "it would take some 2e+02 s, as 1000 say; allowed: 20 s"


def test_sizes_above_one_that_failed_are_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    def measure(row: Row) -> list[Row]:
        return [replace(row, verdict="failed", reason="died")] if row.size == 1000 else taking(row, 1e-3)

    found, _ = grown(monkeypatch, (100, 1000, 10_000), measure)
    assert [(row.size, row.verdict, row.reason) for row in found] == [
        (100, "measured", ""),
        (1000, "failed", "died"),
        (10_000, "left out", "1000 instants failed"),
    ]


def test_numbers_at_many_instants_are_held_to_the_reference_the_last_ones_too() -> None:
    runner = many_instants(STEER.scene, ROW, 50)
    answer = runner.set_up()()
    good = runner.found(answer)
    assert good["position"]["error"] <= 1e-9
    assert {"velocity", "acceleration"} <= set(good)
    places = dict(answer.numbers["position"])
    places["wheel_centre"] = (
        places["wheel_centre"] + np.array([0.0, 0.0, 1e-3]) * (np.arange(50) == 49)[:, None]
    )
    spoilt = Answer({**answer.numbers, "position": places})
    assert runner.found(spoilt)["position"]["error"] == pytest.approx(1e-3, rel=1e-5)


def test_designs_together_and_one_by_one_are_the_same_cars_held_to_the_reference() -> None:
    scene, places = STEER.positions_only(), {}
    for together, make in ((True, designs_together), (False, designs_one_by_one)):
        runner = make(scene, ROW, 4)
        answers = runner.set_up()()
        assert runner.found(answers)["position"]["error"] < 2e-9
        places[together] = [answers(k).numbers["position"]["wheel_centre"] for k in range(4)]
        # A wrong design is seen, whichever it is.
        swapped = {0: 1, 1: 0, 2: 2, 3: 3}
        assert runner.found(lambda k, a=answers, s=swapped: a(s[k]))["position"]["error"] > 1e-3
    np.testing.assert_allclose(places[True], places[False], atol=4e-9)
    few, many = (growth.drawn_at_random(scene, count, None) for count in (3, 7))
    assert few.design(0).mechanism.points == scene.mechanism.points
    assert few.design(2).mechanism.points != many.design(1).mechanism.points


@pytest.mark.parametrize("way", FULL["unknowns"][1])
def test_every_way_finds_the_closed_form(way: str) -> None:
    # As it is measured: with the setting of the study.
    row = next(
        one.row for one in lines_of(STEER, WAYS) if (one.row.against, one.row.way) == ("unknowns", way)
    )
    (found,) = race([long_chain(row, 12)], Effort(repeats=1))
    if found.error is None:
        # Powell's method, which makes up its Jacobian by differences, ends early at some starts and not at
        # others that differ in the last digit; it must say so, and no other way may.
        assert way == "scipy-root"
        assert found.reason.startswith("SolverStopped: scipy.optimize.root at t = ")
        return
    # A last step of 1e-9 of the coordinates leaves less than 1e-9 mm, because errors fall faster than steps.
    assert found.error <= TOLERANCE
    assert found.numbers == len(CHAIN_INSTANTS) * 12


def test_another_assembly_is_no_answer_and_a_small_error_is_told_with_its_size() -> None:
    form = closed_form(12, CHAIN_INSTANTS)
    right = np.stack(list(form.values()), axis=1)

    def answer(tips: np.ndarray) -> Answer:
        return Answer({"position": {name: tips[:, j] for j, name in enumerate(form)}})

    off = right.copy()
    off[3, 2, 1] += 1e-6
    assert chain_errors(12, answer(off))["position"]["error"] == pytest.approx(1e-6, rel=1e-6)
    other = right.copy()
    # The last rocker on the other side of the line from the tip before it to its own pivot.
    pivot, before = np.array([0.0, RISE]), right[:, 2, 1:]
    along = (pivot - before) / np.linalg.norm(pivot - before, axis=-1)[:, None]
    foot = before + along * np.sum((right[:, 3, 1:] - before) * along, axis=-1)[:, None]
    other[:, 3, 1:] = 2.0 * foot - right[:, 3, 1:]
    rods = [np.linalg.norm(tips[:, 3] - tips[:, 2], axis=-1) for tips in (right, other)]
    assert np.allclose(*rods, rtol=1e-12)
    with pytest.raises(NoNumbers, match="tip_3"):
        chain_errors(12, answer(other))
    with pytest.raises(NoNumbers, match="tip_0 is nan"):
        chain_errors(12, answer(np.full_like(right, np.nan)))
