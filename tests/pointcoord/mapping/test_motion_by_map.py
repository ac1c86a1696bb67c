"""A motion through a map of its inputs: the same numbers as by series, however long or rough it is."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from within_bounds import beyond_claims

from pointcoord import (
    AssemblyError,
    MotionNotMapped,
    MotionTooLong,
    Scene,
    simulate,
    standing,
)
from pointcoord.patches import way_map

Make = Callable[..., Scene]
RATES = ("velocity", "acceleration", "knuckle_rates")


def table(rows: int, middle: float, size: float, turns: float = 3.0, noise: float = 0.0) -> dict[str, Any]:
    """A law of many rows over a second."""
    times = np.linspace(0.0, 1.0, rows)
    rough = noise * np.random.default_rng(rows).normal(size=rows)
    values = middle + size * np.sin(2.0 * np.pi * turns * times) + rough
    return {"table": {"times": times.tolist(), "values": values.tolist()}}


def test_an_input_that_leaves_its_reach_and_comes_back_between_instants_is_refused(make_scene: Make) -> None:
    arm = [1.6, 0.05]
    far = standing(make_scene(arm)).reach["rack"][1].value
    # Zero at both instants, and half as far again as the rack goes in between.
    rack = (24.0 * far * np.polynomial.Polynomial([0.0, 0.0, 1.0, -2.0, 1.0])).coef
    scene = make_scene(arm, rack, stop=1.0, samples=2, effects=RATES)
    assert len(simulate(scene, "newton").times) == 2
    for method in ("series", "map"):
        with pytest.raises(AssemblyError, match="rack") as caught:
            simulate(scene, method)
        assert list(caught.value.partial.times) == [0.0]
    within = make_scene(arm, 0.5 * rack, stop=1.0, samples=2, effects=RATES)
    assert beyond_claims(simulate(within, "map").proof(rates=True)) == []


def test_what_is_too_long_or_too_rough_for_series_is_solved_by_a_map_and_says_so(
    make_scene: Make, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A smooth table of many rows, noise, and many swings, where a chain may have so few segments."""
    monkeypatch.setattr("pointcoord.solve.taylor.MOST_SEGMENTS", 200)
    smooth = make_scene(table(210, 1.6, 0.1), table(210, 0.0, 20.0), stop=1.0, samples=101, effects=RATES)
    noise = table(2000, 1.6, 0.1, 3.0, 0.01), table(2000, 0.0, 9.0, 2.0, 2.0)
    noisy = make_scene(*noise, stop=1.0, effects=RATES)
    swings = {"sine": {"amplitude": 0.1, "angular_frequency": 6.0, "offset": 1.6}}
    long = make_scene(swings, stop=1e6, samples=21, effects=RATES)
    with pytest.raises(MotionTooLong):
        simulate(smooth, "series")
    motions = [simulate(scene) for scene in (smooth, noisy, long)]
    for motion in motions:
        assert motion.method == "map"
        assert beyond_claims(motion.proof(rates=True)) == []
        assert motion.notes[-1].startswith("solved by a map of the inputs: ")
    assert "series in time would be about 2.1e+02" in motions[0].notes[-1]


def test_where_neither_way_leads_to_the_end_the_series_say_why(make_scene: Make) -> None:
    # Beyond the reach of the rack at its crests, and too long.
    law = {"sine": {"amplitude": 150.0, "angular_frequency": 40.0}}
    with pytest.raises(AssemblyError, match="rack"):
        simulate(make_scene([1.6], law, stop=1e4, samples=3, effects=()))


@pytest.mark.parametrize("rate", [1e-25, 3.0])
def test_an_input_at_a_single_instant_has_its_rate(make_scene: Make, rate: float) -> None:
    scene = make_scene([1.6], [0.0, rate], start=0.0, stop=0.0, samples=1)
    velocity = simulate(scene, "map").velocity["tie_rod_inner"]
    assert velocity[0].tolist() == [0.0, -rate, 0.0]


def test_near_a_fold_what_no_patch_covers_is_refused_with_its_place(
    make_scene: Make, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(way_map, "HALVINGS", {1: 3})
    far = standing(make_scene([1.6])).reach["rack"][1].value
    scene = make_scene([1.6], [0.0, 0.99 * far], stop=1.0, samples=41, effects=RATES)
    with pytest.raises(MotionNotMapped, match=r"does not cover their path after t = .*a fold") as caught:
        simulate(scene, "map")
    error = caught.value
    assert set(error.inputs) == {"arm_angle", "rack"}
    assert 0 < len(error.partial.times) < 41
    assert error.partial.times[-1] <= error.instant
    assert np.isfinite(error.partial.proof().bound).all()
    # Nothing but the map is in the way.
    assert simulate(scene).method == "series"


@pytest.mark.parametrize(("way", "covered"), [(1.0, True), (60.0, False)])
def test_the_smallest_patch_is_kept_if_rounding_alone_keeps_it_from_being_nearer(
    way: float, covered: bool, make_scene: Make, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(way_map, "HALVINGS", {1: 0})
    scene = make_scene([1.6], [0.0, way], stop=1.0, samples=3).model_copy(update={"tolerance": 1e-14})
    if covered:
        motion = simulate(scene, "map")
        assert motion.status.complete
        assert len(motion.solved.patches.low) == 1
        assert motion.proof(rates=True).bound.max() < 1e-10
    else:
        with pytest.raises(MotionNotMapped, match="smallest"):
            simulate(scene, "map")
