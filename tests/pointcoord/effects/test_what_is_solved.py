"""A scene solves for what it reports, by counts of work and by numbers; a note says where there are none."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest
from changed_scenes import scene_with
from every_number import OF_A_WHEEL, every_effect
from three_mechanics import scene_of
from within_bounds import beyond_claims

from pointcoord import AssemblyError, NotComputed, Scene, simulate
from pointcoord.effects.registry import EFFECTS
from pointcoord.method import METHODS
from pointcoord.simulation import effort, prepare_task, solve_by_series
from validate.formulations.asked_numbers import per_second

STRUT = ("strut_lower", "strut_rod_end", "strut_top")
SAMPLES = 7
# None, of every point, of the knuckle beside these, and all.
SUBSETS: list[tuple[str, ...]] = [(), ("jerk",), ("velocity", "knuckle_rates"), OF_A_WHEEL]
NEEDED = {n: max(per_second(q.name) for q in effect.quantities) for n, effect in EFFECTS.items()}
OF_EVERY_POINT = {name for name, effect in EFFECTS.items() if effect.reports_states}


@pytest.mark.parametrize(
    ("name", "points", "unknowns", "not_needed"),
    [
        # The strut and the arm that it hangs on; no rack, no tie rod.
        ("bounce-and-steer", STRUT, 3 + 4 + 4, 3 + 3),
        # A wheel hangs on everything but the strut's rod end, which the strut line needs.
        ("bounce-and-steer", ["wheel_centre"], 3 + 4 + 4 + 3 + 3, 0),
        # A strut whose axis is fixed in the knuckle turns with it: only its rod end is left out.
        ("off-axis-strut", ["strut_lower"], 22 - 3, 3),
    ],
)
def test_only_the_blocks_that_are_needed_are_solved_for_as_the_plan_says(
    name: str, points: Sequence[str], unknowns: int, not_needed: int
) -> None:
    asked = scene_with(name, points=points, effects=[])
    work, plan = solve_by_series(prepare_task(asked, METHODS["series"])).solving, effort(asked)
    assert work.unknowns_solved / work.series_orders == plan.unknowns == unknowns
    assert plan.not_needed == not_needed
    if points == STRUT:
        assert plan.task.unsolved == ("tie_rod_outer", "tie_rod_inner", "wheel_centre")


@pytest.mark.parametrize("effects", SUBSETS, ids="+".join)
@pytest.mark.parametrize("method", ["series", "newton"])
def test_only_the_derivatives_that_are_asked_for_are_evaluated(
    make_scene: Callable[..., Scene], effects: tuple[str, ...], method: str
) -> None:
    asked = make_scene(samples=SAMPLES, effects=effects)
    topology, work = asked.mechanism.topology, simulate(asked, method).work
    highest = max((NEEDED[e] for e in effects), default=0)
    everything = max((NEEDED[e] for e in effects if e in OF_EVERY_POINT), default=0)
    assert work.derivatives_evaluated == highest + 1
    # Positions always; then each derivative of every point, or of the knuckle's points only.
    points = len(topology.points) - len(topology.chassis)
    wanted, knuckle = 3 * points * (everything + 1), len(topology.bodies["knuckle"])
    more = 3 * knuckle * (highest - everything)
    # One product gives all derivatives of a group of points, so the series sum the knuckle's from position.
    spare = 3 * knuckle * (everything + 1) if more and METHODS[method].dense else 0
    assert wanted + more <= work.coordinates_evaluated <= wanted + more + spare
    if method == "newton":
        assert (work.rate_solves, work.segments) == (SAMPLES * highest, 0)


def test_series_solve_once_for_any_number_of_instants(make_scene: Callable[..., Scene]) -> None:
    few, many = (simulate(make_scene(samples=n)).work for n in (2, 5000))
    for count in ("factorisations", "rate_solves", "segments", "series_orders"):
        assert getattr(few, count) == getattr(many, count) > 0


@pytest.mark.parametrize("effect", ["velocity", "knuckle_rates", "wheel_angles", "toe_by_travel"])
def test_reading_what_was_not_asked_for_names_the_effect(
    make_scene: Callable[..., Scene], effect: str
) -> None:
    # Nor by one that gives the same among others.
    mine = {*(EFFECTS[effect].own_names or (effect,))}
    others = tuple(n for n in OF_A_WHEEL if n != effect and not mine <= {*(EFFECTS[n].own_names or (n,))})
    motion = simulate(make_scene(samples=2, effects=others))
    gives = EFFECTS[effect].gives_numbers(motion.solved.readout.mechanism.topology)
    with pytest.raises(NotComputed, match=f"add '{effect}' to the scene's effects") as caught:
        [motion.numbers[quantity][n] for quantity, names in gives.items() for n in names or ("knuckle",)]
    assert caught.value.effect == effect


def test_an_effect_of_a_scene_that_reports_another_point_is_what_it_is_among_all() -> None:
    """It is made of the points that it names and of no others."""
    asked = every_effect("pushrod")
    asked = asked.model_copy(update={"time": asked.time.model_copy(update={"samples": 2})})
    for effect in (name for name in asked.effects if EFFECTS[name].own_names):
        alone = simulate(asked.model_copy(update={"effects": (effect,), "points": ("rocker_front",)}))
        for quantity in EFFECTS[effect].quantities:
            assert {*alone.numbers[quantity.name]} == {*EFFECTS[effect].own_names}
        assert beyond_claims(alone.proof(rates=True)) == []


def test_where_the_tie_rod_ends_the_motion_the_strut_goes_on_and_says_what_it_does_not_know() -> None:
    far: dict[str, Any] = {
        "inputs": {"arm_angle": {"polynomial": [1.57, 0.1]}, "rack": {"polynomial": [0.0, 500.0]}},
        "time": {"start": 0.0, "stop": 1.0, "samples": 11},
    }
    with pytest.raises(AssemblyError):
        simulate(scene_with("steer", effects=[], **far))
    motion = simulate(scene_with("steer", effects=[], points=STRUT, **far))
    assert motion.status.complete
    assert any("tie_rod_outer" in note and "is not checked" in note for note in motion.notes)
    assert np.isfinite(motion.proof().bound).all()
    with pytest.raises(NotComputed, match="add 'tie_rod_outer' to the scene's points"):
        motion.position["tie_rod_outer"]


def test_where_there_is_no_number_a_note_says_why() -> None:
    """A trailing arm that stands straight up moves its wheel level."""
    points = {"a": [0, 400, 0], "b": [0, 600, 0], "inner": [0, 650, -300], "centre": [0, 700, -300]}
    mechanism = {
        "bodies": {"chassis": ["a", "b"], "arm": ["a", "b", "inner", "centre"]},
        "inputs": {"turn": {"angle": "arm", "from": "drawing"}},
        "roles": {"knuckle": "arm", "wheel_axis": ["inner", "centre"]},
        "side": "right",
        "points": points,
    }
    motion = simulate(scene_of(mechanism, ["toe_by_travel"], turn=[0.0, 0.1]))
    assert np.isfinite(motion.angle_gradient["toe_by_travel"]).tolist() == [False, True, True]
    assert any("does not travel" in note for note in motion.notes)
