"""Properties of every solved motion, for a scene of each kind and for a car that rolls and pitches.

tests/mechanisms tests the numbers for all mechanics.
"""

import pickle

import numpy as np
import pytest
from one_arm import plain
from shipped import EPS, Array, Motion, shipped

import absolute
import absolute.follow

# One with ends that height and angle drive, one with more rows than unknowns, one that moves as a whole.
SCENES = ("pushrod-by-damper", "bricard", "axle-roll")


def one_arm() -> Motion:
    """The arm at random inputs with random rates up to the jerk."""
    random = np.random.default_rng(1)
    scales = {"turn": 0.5, "steer": 8.0, "roll": 0.3, "pitch": 0.3, "heave": 20.0, "sway": 20.0}
    inputs = {name: scale * random.uniform(-1.0, 1.0, (3, 4)) for name, scale in scales.items()}
    described, ways = plain(), {"heave": "up", "sway": "left"}
    moves = {name: {"moves": "chassis", "along": along} for name, along in ways.items()}
    return Motion({**described, "inputs": described["inputs"] | moves}, inputs)


@pytest.fixture(scope="module", params=[*SCENES, "one arm"])
def motion(request: pytest.FixtureRequest) -> Motion:
    # Instants are solved many at a time.
    return one_arm() if request.param == "one arm" else shipped(request.param, 81)


def rounding(solution: absolute.Solution, order: int) -> Array:
    """(N, 1) mm, mm/s, mm/s^2: the poses of two solutions are off by rounding times the condition number, and
    rates see it once more each, as shares of the largest of them."""
    condition, size = solution.condition[:, None], solution.accuracy.max() / EPS
    largest = max(size, *(float(np.abs(of).max()) for of in solution.derivatives[order].values()))
    return np.asarray(4 * EPS * largest * condition ** (1 + order))


def test_instants_do_not_depend_on_each_other_nor_positions_on_rates(motion: Motion) -> None:
    ways = ("toe_by_rack", "caster_by_travel")
    names = [n for n in absolute.effects_in(absolute.compile(motion.plain)) if n.endswith(ways)]
    names = names if motion.plain["roles"] else []
    whole = motion.solve(effects=names)
    places = np.random.default_rng(1).permutation(len(whole.residual))[:2]
    some = Motion(motion.plain, {name: law[places] for name, law in motion.inputs.items()})
    other = some.solve(effects=names)
    for name, found in other.effects.items():
        assert np.abs(found - whole.effects[name][places]).max() <= 1e-13, name
    for order in range(3):
        for name, found in other.derivatives[order].items():
            apart = np.abs(found - whole.derivatives[order][name][places])
            assert (apart <= rounding(whole, order)[places]).all(), (order, name)
    bare = motion.solve(rates=False)
    assert not any(bare.derivatives[1:])
    assert not bare.angular_velocity
    assert not bare.angular_acceleration
    assert all((bare.position[name] == place).all() for name, place in whole.position.items())


def test_a_car_that_has_rolled_many_times_stands_as_one_that_rolled_the_rest() -> None:
    many, rest = one_arm(), one_arm()
    many.inputs["roll"][:, 0] += 1000.0
    rest.inputs["roll"][:, 0] = np.angle(np.exp(1j * many.inputs["roll"][:, 0]))
    other, solution = many.solve().position, rest.solve()
    for name in ("stop_end", "damper_top"):  # of the chassis itself
        assert np.abs(solution.position[name] - other[name]).max() <= 2.0 * solution.accuracy.max(), name


def test_no_instants_give_an_empty_motion() -> None:
    motion = shipped("bounce")
    empty = Motion(motion.plain, {name: np.zeros((0, 3)) for name in motion.inputs}).solve(effects=["toe"])
    assert empty.position["wheel_centre"].shape == (0, 3)
    assert empty.effects["toe"].shape == (0,)


def test_models_solutions_and_refusals_travel_between_processes_and_results_cannot_be_changed() -> None:
    motion = shipped("bounce")
    model = pickle.loads(pickle.dumps(absolute.compile(motion.plain)))
    solution = absolute.solve(model, motion.inputs)
    again = pickle.loads(pickle.dumps(solution))
    assert (again.position["wheel_centre"] == solution.position["wheel_centre"]).all()
    with pytest.raises(ValueError, match="read-only"):
        solution.position["wheel_centre"][0] = 0.0
    with pytest.raises(absolute.UnreachableError) as refused:
        absolute.solve(model, motion.inputs | {"rack": np.full((5, 3), 500.0)})
    copy = pickle.loads(pickle.dumps(refused.value))
    assert (str(copy), copy.reached) == (str(refused.value), refused.value.reached)
