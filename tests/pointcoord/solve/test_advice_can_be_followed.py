"""What an error advises is done, and helps."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest
from within_bounds import beyond_claims

from pointcoord import (
    AssemblyError,
    InputNotKnown,
    MotionTooLong,
    MotionTooRough,
    Scene,
    simulate,
)

Make = Callable[..., Scene]
# The arm jumps by 0.01 rad within a nanosecond: cubics of size 1e25 that rounding cannot hold.
JUMP = {
    "table": {
        "times": (0.0, 0.2, 0.5, 0.5 + 1e-9, 0.8, 1.0),
        "values": [1.6, 1.6, 1.6, 1.61, 1.61, 1.61],
    }
}


def test_a_motion_too_long_is_solved_by_newton_or_slower_or_shorter(
    make_scene: Make, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("pointcoord.solve.taylor.MOST_SEGMENTS", 20)

    def scene(frequency: float, stop: float) -> Scene:
        law = {"sine": {"amplitude": 0.3, "angular_frequency": frequency, "offset": 1.5}}
        return make_scene(law, samples=101, stop=stop)

    with pytest.raises(
        MotionTooLong, match=r"shorten the time, slow the inputs down, or use .* 'newton'"
    ) as caught:
        simulate(scene(40.0, 2.0), "series")
    part = caught.value.partial
    assert 1 < len(part.times) < 101
    assert beyond_claims(part.proof_of(part.at(part.times), rates=True)) == []
    assert part.work.segments == 20
    assert simulate(scene(40.0, 2.0), "newton").proof().bound.max() < 1e-10
    assert len(simulate(scene(1.0, 2.0)).times) == len(simulate(scene(40.0, 0.05)).times) == 101


def test_a_motion_too_rough_is_solved_by_newton_or_smoother_or_more_coarsely(make_scene: Make) -> None:
    rough = make_scene(JUMP, start=0.5 - 2e-8, stop=0.5 + 2e-9)
    with pytest.raises(MotionTooRough, match=r"smooth it there, allow a larger tolerance, or use .*'newton'"):
        simulate(rough, "series")
    assert simulate(rough).method == "map"
    assert np.isfinite(simulate(rough).proof().bound).all()
    assert np.isfinite(simulate(rough, "newton").proof().bound).all()
    assert len(simulate(rough.model_copy(update={"tolerance": 1e-3})).times) == 9
    smooth = {"table": {**JUMP["table"], "times": (0.0, 0.2, 0.5, 0.6, 0.8, 1.0)}}
    assert len(simulate(make_scene(smooth, stop=1.0)).times) == 9


@pytest.mark.parametrize(("arm", "rack"), [([1.6], [0.0, 100.0]), ([1.6, 0.6], [0.0]), ([1.5], [0.0, -80.0])])
def test_an_input_brought_back_to_where_assembly_stopped_is_reached(
    make_scene: Make, arm: Any, rack: Any
) -> None:
    with pytest.raises(AssemblyError, match=r"bring '(rack|arm_angle)' back towards its value") as caught:
        simulate(make_scene(arm, rack))
    error = caught.value
    # A thousandth of the way back from there to the drawing.
    drawn = {"arm_angle": 1.65, "rack": 0.0}
    values = {name: value + 1e-3 * (drawn[name] - value) for name, value in error.reached.items()}
    scene = make_scene([values["arm_angle"]], [values["rack"]], start=0.0, stop=0.0, samples=1)
    assert np.isfinite(simulate(scene).start.bound)


def cancelling(make_scene: Make, start: float, law: Mapping[str, Any]) -> Scene:
    return make_scene([1.6], law, start=start, stop=start + 1.0, samples=5)


def test_a_law_that_cancels_is_named_and_is_known_from_smaller_terms(make_scene: Make) -> None:
    start, t = 2.0**15, np.polynomial.Polynomial([0.0, 1.0])
    late = {"polynomial": (16.0 * (t - start) ** 6).coef.tolist()}
    for method in ("series", "newton"):
        with pytest.raises(InputNotKnown, match=r"input 'rack' is not known .* its polynomial") as caught:
            simulate(cancelling(make_scene, start, late), method)
        assert (caught.value.name, caught.value.law) == ("rack", "polynomial")
    values = [16.0 * s**6 for s in (0.0, 0.25, 0.5, 0.75, 1.0)]
    table = {"table": {"times": [start + s for s in (0.0, 0.25, 0.5, 0.75, 1.0)], "values": values}}
    simulate(cancelling(make_scene, start, table))
    early = simulate(cancelling(make_scene, 0.0, {"polynomial": [0.0] * 6 + [16.0]}))
    assert np.isfinite(early.proof().bound).all()


def test_a_law_is_not_named_where_nothing_hangs_on_its_doubt(make_scene: Make) -> None:
    start, t = 2.0**13, np.polynomial.Polynomial([0.0, 1.0])
    law = {"polynomial": (16.0 * (t - start) ** 6).coef.tolist()}
    motion = simulate(cancelling(make_scene, start, law))
    # Off by less than a thousandth of a millimetre: the bound says so.
    assert 1e-4 < motion.proof().bound.max() < 1e-2
