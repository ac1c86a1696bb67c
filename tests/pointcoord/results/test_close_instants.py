"""Many instants close together: polynomials in cells give what the plain formulas give, wherever they may."""

from dataclasses import replace

import numpy as np
import pytest
from every_effect import every_effect

from pointcoord import Motion, OutsideMotion, Samples, Scene, simulate
from pointcoord.effects.plan import plan_effects
from pointcoord.effects.toe import TOE
from pointcoord.results.cells import ENOUGH, CloseInstants
from pointcoord.results.states import StatesOfChain

EPS = float(np.finfo(float).eps)
SCENES = ("bounce", "bounce-on-a-heaving-chassis", "double-wishbone", "off-axis-strut")
AT_REST = {"constant": 1.5}


def solved(name: str, **changes: object) -> Motion:
    return simulate(every_effect(name).model_copy(update=changes))


def cells_of(motion: Motion) -> CloseInstants:
    states = motion.solved.states
    assert isinstance(states, StatesOfChain)
    return CloseInstants(motion.solved.readout, states)


def share_in_cells(motion: Motion, instants: np.ndarray) -> float:
    left = cells_of(motion).fill(instants, np.empty((motion.height, len(instants))))
    return 1.0 - sum(last - first for first, last in left) / len(instants)


def plain(motion: Motion, instants: np.ndarray) -> Samples:
    """The plain formulas: too few instants at a time for cells."""
    rows = np.empty((motion.height, len(instants)))
    for low in range(0, len(instants), ENOUGH - 1):
        part = instants[low : low + ENOUGH - 1]
        motion.at(part, out=(own := np.empty((motion.height, len(part)))))
        rows[:, low : low + ENOUGH - 1] = own
    return motion.solved.readout.named(instants, rows)


def some(samples: Samples, which: np.ndarray) -> Samples:
    numbers = {
        quantity: channel.with_arrays({name: array[which] for name, array in channel.items()})
        for quantity, channel in samples.numbers.items()
    }
    return Samples(samples.times[which], numbers)


def difference(one: Samples, other: Samples, quantity: str) -> float:
    """Of all numbers of a kind, by the largest of them."""
    arrays = [(one.numbers[quantity][n], other.numbers[quantity][n]) for n in other.numbers[quantity]]
    return max(float(np.abs(a - b).max()) for a, b in arrays) / max(float(np.abs(b).max()) for _, b in arrays)


def most_of_what_is_claimed(motion: Motion, samples: Samples) -> float:
    """How far numbers are off by what they claim, the worst of all of them."""
    proof = motion.proof_of(samples, rates=True)
    worst = 0.0
    for quantity, arrays in proof.proven.items():
        for name, proven in arrays.items():
            assert np.isfinite(proven).all()
            # Where nothing is claimed to be off, nothing may be.
            claimed = proof.expected[quantity][name]
            assert (proven[claimed == 0.0] == 0.0).all()
            worst = max(worst, float((proven[claimed > 0.0] / claimed[claimed > 0.0]).max(initial=0.0)))
    return worst


@pytest.mark.parametrize("tolerance", [1e-9, 1e-3])
@pytest.mark.parametrize("name", SCENES)
def test_numbers_in_cells_are_as_near_the_exact_ones_as_they_claim(name: str, tolerance: float) -> None:
    motion = solved(name, tolerance=tolerance)
    instants = np.linspace(motion.times[0], motion.times[-1], 150_000)
    assert share_in_cells(motion, instants) > 0.9
    which = np.unique(np.concatenate([np.arange(0, 150_000, 773), np.arange(100)]))
    assert most_of_what_is_claimed(motion, some(motion.at(instants), which)) <= 1.0


@pytest.mark.parametrize("name", SCENES)
def test_numbers_in_cells_are_those_of_the_plain_formulas(name: str) -> None:
    motion = solved(name)
    instants = np.linspace(motion.times[0], motion.times[-1], 60_000)
    assert share_in_cells(motion, instants) > 0.3
    quick, slow = motion.at(instants), plain(motion, instants)
    for quantity in (name for name, channel in slow.numbers.items() if channel.computed):
        # Two ways of a dozen roundings each, and a polynomial through points passes theirs on 2.3 times.
        # Terms of an acceleration are up to 50 times their sum; angles of 0.1 rad are seen on lines of 90 mm
        # between points at 600, and dimensions of 25 mm are differences of places at 700.
        lost = {"wheel": 600 / 90 / 0.1, "dimension": 700 / 25}
        larger = 50 if "acceleration" in quantity else lost.get(quantity, 4)
        assert difference(quick, slow, quantity) <= (12 + 2.3 * 12) * EPS * larger, quantity


@pytest.mark.parametrize("fourth", [0.0, 1.0])
def test_a_motion_that_begins_from_rest_keeps_the_digits_of_its_first_rates(fourth: float) -> None:
    laws = {"arm_angle": [1.5, 0.0, 0.0, 0.05, -0.02 * fourth], "rack": [0.0, 0.0, 0.0, 3.0, fourth]}
    motion = solved(
        "bounce",
        inputs={name: {"polynomial": law} for name, law in laws.items()},
        time={"start": 0.0, "stop": 1.0, "samples": 11},
    )
    instants = np.linspace(0.0, 1.0, 400_000)
    assert share_in_cells(motion, instants) > 0.9
    which = np.unique(np.geomspace(1, 399_999, 600).astype(int))
    quick, slow = some(motion.at(instants), which), plain(motion, instants[which])
    for quantity in ("velocity", "acceleration"):
        for name, array in quick.numbers[quantity].items():
            size = np.abs(slow.numbers[quantity][name]).max(axis=-1, keepdims=True)
            # Rates of t^3 are up to (17/15)^2 times as large elsewhere in a cell; some dozens of roundings.
            assert (np.abs(array - slow.numbers[quantity][name]) <= 100 * EPS * size).all()
    if fourth:
        assert most_of_what_is_claimed(motion, quick) <= 1.0


def test_instants_far_from_time_zero_lose_nothing_to_the_rounding_of_time() -> None:
    late = solved(
        "steer",
        inputs={"arm_angle": AT_REST, "rack": {"sine": {"amplitude": 20.0, "angular_frequency": 5.0}}},
        time={"start": 3000.0, "stop": 3000.4, "samples": 11},
    )
    instants = np.linspace(3000.0, 3000.4, 60_000)
    assert share_in_cells(late, instants) > 0.8
    assert most_of_what_is_claimed(late, some(late.at(instants), np.arange(0, 60_000, 301))) <= 1.0
    slow = plain(late, instants)
    # Of a point that moves with 100 mm/s, the rounding of 3000 s is 5e-11 mm.
    for name, array in late.at(instants).position.items():
        assert np.abs(array - slow.position[name]).max() < 2e-12
    very_late = solved(
        "steer",
        inputs={"arm_angle": AT_REST, "rack": {"constant": 10.0}},
        time={"start": 1e9, "stop": 1e9 + 1.0, "samples": 11},
    )
    assert share_in_cells(very_late, np.linspace(1e9, 1e9 + 1.0, 60_000)) == 0.0


HEAVES = {
    "a spline's third derivative jumps": (
        {"table": {"times": [0.0, 0.5, 0.61, 0.8, 1.3, 2.6], "values": [0.0, 9.0, -7.0, 12.0, 3.0, -5.0]}},
        (0.0, 0.0, 0.0),
    ),
    "an acceleration passes zero": ({"polynomial": [1.0, -3.0, 3.0, -1.0]}, (0.0, 0.0, 0.0)),
    "a sine": (
        {"sine": {"amplitude": 30.0, "angular_frequency": 7.0, "phase": 0.3, "offset": 4.0}},
        (30.0, 30.0 * 7.0, 30.0 * 49.0),
    ),
    "a sine too fast for any cell": (
        {"sine": {"amplitude": 3.0, "angular_frequency": 1e5}},
        (3.0, 3e5, 3e10),
    ),
    "at rest": ({"constant": 12.5}, (0.0, 0.0, 0.0)),
}


@pytest.mark.parametrize(("heave", "swing"), HEAVES.values(), ids=HEAVES)
def test_what_the_chassis_does_is_added_in_cells_as_exactly_as_anywhere(
    heave: dict[str, object], swing: tuple[float, ...]
) -> None:
    scene = Scene.load("bounce-on-a-heaving-chassis")
    still = {"arm_angle": AT_REST, "rack": {"constant": 0.0}}
    instants = np.linspace(0.0, 2.6, 50_000)
    which = np.concatenate([np.arange(0, 50_000, 1009), np.arange(19_200, 19_260)])
    for inputs in (still, dict(scene.inputs)):
        motion = solved("bounce-on-a-heaving-chassis", inputs={**inputs, "heave": heave})
        assert share_in_cells(motion, instants) > 0.3
        quick, slow = motion.at(instants), plain(motion, instants)
        for quantity, own in zip(("position", "velocity", "acceleration"), swing, strict=True):
            for name in scene.mechanism.topology.chassis:
                exact = slow.numbers[quantity][name]
                # Some eight roundings of the law by its own size, of a sine by its swing.
                off = np.abs(quick.numbers[quantity][name] - exact)
                assert (off <= 8 * EPS * (np.abs(exact) + own)).all()
        assert most_of_what_is_claimed(motion, some(quick, which)) <= 1.0


def test_an_angle_that_jumps_is_read_on_its_own_side() -> None:
    toe = replace(TOE, numbers=(replace(TOE.numbers[0], cosine="inboard"),))
    motion = solved("steer", inputs={"arm_angle": AT_REST, "rack": {"polynomial": [-40.0, 150.0]}})
    readout = replace(motion.solved.readout, plan=plan_effects(["toe"], {"toe": toe}))
    states = motion.solved.states
    assert isinstance(states, StatesOfChain)
    turned = replace(
        motion, solved=replace(motion.solved, readout=readout, states=replace(states, readout=readout))
    )
    instants = np.linspace(0.0, 0.4, 50_000)
    quick, slow = turned.at(instants).wheel["toe"], plain(turned, instants).wheel["toe"]
    assert slow.min() < -3.0
    assert slow.max() > 3.0
    assert 0.2 < share_in_cells(turned, instants) < 1.0
    aside = np.abs(slow) < np.pi - 1e-13
    assert np.abs(quick - slow)[aside].max() < 40 * EPS * 600 / 90


def test_instants_that_fill_no_cell_are_read_all_the_same() -> None:
    motion = solved("steer")
    same = np.full(5000, 0.125)
    assert share_in_cells(motion, same) == 0.0
    for quantity, channel in motion.at(same).numbers.items():
        for name, array in channel.items():
            alone = motion.at(0.125).numbers[quantity][name]
            assert np.abs(array - alone).max() <= 30 * EPS * np.abs(alone).max()
    wrong = np.linspace(0.0, 0.4, 5000)
    for place, instant in ((0, -1e-9), (4999, 0.5), (2500, np.nan)):
        asked = wrong.copy()
        asked[place] = instant
        with pytest.raises(OutsideMotion):
            motion.at(asked)
