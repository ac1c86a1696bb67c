"""What a scene does not ask for is not computed: shown by counts of work, never by time."""

from collections.abc import Callable
from itertools import combinations

import numpy as np
import pytest

import pointcoord.solve.place
import pointcoord.solve.pointwise
import pointcoord.solve.taylor
from pointcoord import Motion, NotComputed, Scene, UnknownName, simulate
from pointcoord.effects.plan import plan_effects
from pointcoord.effects.registry import EFFECTS
from pointcoord.mechanism import mechanism_file
from pointcoord.method import METHODS
from pointcoord.numerics import newton
from pointcoord.numerics.linear import Factors, factorise
from pointcoord.patches import flood
from pointcoord.solve import assembly
from pointcoord.solve.proven_path import inverses
from validate.cars.paper_car import PAPER

# None, each, every pair of kinds and all: what three need is what two of them need.
KINDS = (
    "velocity",
    "acceleration",
    "knuckle_rates",
    "wheel_angles",
    "steering_axis",
    "damper",
    "toe_by_travel",
    "steering_axis_by_rack",
)
SUBSETS = [(), *((name,) for name in EFFECTS), *combinations(KINDS, 2), tuple(EFFECTS)]
SAMPLES = 7
COLLINEAR = mechanism_file("macpherson").topology("collinear", points=PAPER)
POINTS = COLLINEAR.points
MOVING = len(POINTS) - len(COLLINEAR.chassis)
KNUCKLE = len(COLLINEAR.bodies["knuckle"])
POWER_OF_TIME = {"mm": 0, "rad": 0, "mm/s": 1, "rad/s": 1, "mm/s^2": 2, "rad/s^2": 2}
NEEDED = {n: max(POWER_OF_TIME.get(q.unit, 0) for q in effect.quantities) for n, effect in EFFECTS.items()}
OF_EVERY_POINT = {name for name, effect in EFFECTS.items() if any(q.of == "point" for q in effect.quantities)}


def read(motion: Motion, effect: str) -> np.ndarray:
    """All numbers of an effect."""
    arrays = []
    for quantity, names in EFFECTS[effect].gives_numbers.items():
        channel = motion.numbers[quantity]
        of_each = POINTS if effect in OF_EVERY_POINT else COLLINEAR.bodies
        arrays += [channel[name].ravel() for name in names or of_each]
    return np.concatenate(arrays)


def of_every_point(effects: tuple[str, ...]) -> int:
    """Highest derivative of every point: what the lists of velocities and accelerations need."""
    return max((NEEDED[e] for e in effects if e in OF_EVERY_POINT), default=0)


@pytest.mark.parametrize("effects", SUBSETS, ids="+".join)
@pytest.mark.parametrize("method", METHODS)
def test_only_the_derivatives_that_are_asked_for_are_evaluated(
    make_scene: Callable[..., Scene], effects: tuple[str, ...], method: str
) -> None:
    motion = simulate(make_scene(samples=SAMPLES, effects=effects), method)
    highest = max((NEEDED[e] for e in effects), default=0)
    everything = of_every_point(effects)
    assert motion.work.derivatives_evaluated == highest + 1
    # Positions always; then each derivative of every point, or of the knuckle's three points only.
    points = MOVING if METHODS[method].dense else len(POINTS)
    wanted = 3 * points * (everything + 1)
    more = 3 * KNUCKLE * (highest - everything)
    # One product gives all derivatives of a group of points, so the series sum the knuckle's from position.
    spare = 3 * KNUCKLE * (everything + 1) if more and METHODS[method].dense else 0
    assert wanted + more <= motion.work.coordinates_evaluated <= wanted + more + spare


@pytest.mark.parametrize("effects", SUBSETS, ids="+".join)
def test_newton_solves_for_no_rate_that_is_not_needed(
    make_scene: Callable[..., Scene], effects: tuple[str, ...]
) -> None:
    motion = simulate(make_scene(samples=SAMPLES, effects=effects), "newton")
    assert motion.work.rate_solves == SAMPLES * max((NEEDED[e] for e in effects), default=0)
    assert motion.work.segments == motion.work.series_orders == 0


def test_wheel_angles_alone_cost_nothing_but_positions(make_scene: Callable[..., Scene]) -> None:
    for method in METHODS:
        bare = simulate(make_scene(samples=SAMPLES, effects=()), method).work
        assert simulate(make_scene(samples=SAMPLES, effects=("wheel_angles",)), method).work == bare


def test_series_solve_once_for_any_number_of_instants(make_scene: Callable[..., Scene]) -> None:
    few, many = (simulate(make_scene(samples=n)).work for n in (2, 5000))
    assert (few.factorisations, few.rate_solves, few.segments) == (
        many.factorisations,
        many.rate_solves,
        many.segments,
    )
    assert few.series_orders == few.rate_solves


@pytest.mark.parametrize("method", METHODS)
def test_counts_are_what_was_done(
    make_scene: Callable[..., Scene], monkeypatch: pytest.MonkeyPatch, method: str
) -> None:
    seen = {"factorisations": 0}

    def counted(matrix: np.ndarray) -> Factors:
        seen["factorisations"] += int(np.prod(matrix.shape[:-2]))
        return factorise(matrix)

    def inverted(matrices: np.ndarray) -> np.ndarray | None:
        seen["factorisations"] += len(matrices)
        return inverses(matrices)

    solving = pointcoord.solve
    monkeypatch.setattr(solving.proven_path, "inverses", inverted)
    ways = (solving.pointwise, solving.proven_path)
    own = (newton, assembly, solving.follower, solving.place, flood)
    for module in (*own, *ways):
        monkeypatch.setattr(module, "factorise", counted)
    motion = simulate(make_scene(samples=SAMPLES), method)
    assert motion.work.factorisations == seen["factorisations"] > 0


def test_proof_is_not_computed_until_it_is_read(
    make_scene: Callable[..., Scene], monkeypatch: pytest.MonkeyPatch
) -> None:
    called = []
    motion = simulate(make_scene(samples=SAMPLES))
    monkeypatch.setattr(
        "pointcoord.bounds.certified_poses.factorise", lambda m: called.append(len(m)) or factorise(m)
    )
    assert simulate(make_scene(samples=SAMPLES)).position["wheel_centre"].shape == (SAMPLES, 3)
    assert called == []
    motion.proof()
    assert sum(called) == SAMPLES


@pytest.mark.parametrize("effect", EFFECTS)
@pytest.mark.parametrize("method", METHODS)
def test_reading_what_was_not_asked_for_names_the_effect(
    make_scene: Callable[..., Scene], effect: str, method: str
) -> None:
    # Nor by one that gives the same among others.
    mine = {*(EFFECTS[effect].names or (effect,))}
    others = tuple(n for n, e in EFFECTS.items() if n != effect and not mine <= {*(e.names or (n,))})
    motion = simulate(make_scene(samples=2, effects=others), method)
    with pytest.raises(NotComputed, match=f"add '{effect}' to the scene's effects") as caught:
        read(motion, effect)
    assert caught.value.effect == effect
    for other in others:
        assert np.isfinite(read(motion, other)).all()


@pytest.mark.parametrize("effects", SUBSETS, ids="+".join)
def test_effects_together_give_what_each_gives_alone(
    make_scene: Callable[..., Scene], effects: tuple[str, ...]
) -> None:
    together = simulate(make_scene(samples=3, effects=effects), "newton")
    for effect in effects:
        alone = simulate(make_scene(samples=3, effects=(effect,)), "newton")
        # The same poses and the same solves: the same bits.
        assert np.array_equal(read(together, effect), read(alone, effect))


def test_a_plan_names_what_it_leaves_out_and_refuses_unknown_effects() -> None:
    plan = plan_effects(("wheel_angles", "velocity"))
    assert set(plan.effects) == {"velocity", "wheel_angles"}
    assert set(plan.left_out) == set(EFFECTS) - {"velocity", "wheel_angles"}
    with pytest.raises(UnknownName, match="did you mean 'velocity'") as caught:
        plan_effects(("velocty",))
    assert set(caught.value.valid) == set(EFFECTS)
