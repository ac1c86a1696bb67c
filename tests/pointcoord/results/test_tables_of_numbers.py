"""Numbers in rows, computed in blocks: those of the plain formulas, however many they are."""

import tracemalloc
from collections.abc import Mapping

import numpy as np
import pytest
from every_effect import every_effect

from pointcoord import Motion, NotComputed, OutsideMotion, Samples, Scene, simulate
from pointcoord.effects.registry import ANGLES
from pointcoord.effects.rigid import body_rates, stack_points
from pointcoord.linkage.carried_points import carried_series
from pointcoord.results.readout import BLOCK
from pointcoord.results.states import StatesOfChain

EPS = float(np.finfo(float).eps)
EVERY = ("velocity", "acceleration", "knuckle_rates", "wheel_angles", "toe", "caster", "damper")
SCENES = ("bounce", "bounce-on-a-heaving-chassis", "double-wishbone", "off-axis-strut")
SUBSETS = ((), ("knuckle_rates",), ("acceleration", "toe"), EVERY)
Numbers = Mapping[str, Mapping[str, np.ndarray]]


def solved(name: str, effects: tuple[str, ...]) -> Motion:
    scene = Scene.load(name)
    had = tuple(effect for effect in effects if effect in scene.mechanism.effects)
    return simulate(scene.model_copy(update={"effects": had}))


def plain_rates(r: np.ndarray, v: np.ndarray, a: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Least squares by numpy's own solver, with one row for each component of each point."""

    def turning(edges: np.ndarray, rates: np.ndarray) -> np.ndarray:
        x, y, z = np.moveaxis(edges, -1, 0)
        o = np.zeros_like(x)
        rows = np.stack([np.stack(c, -1) for c in ((o, z, -y), (-z, o, x), (y, -x, o))], axis=-2)
        matrix = rows.reshape(len(edges), -1, 3)
        return (np.linalg.pinv(matrix) @ rates.reshape(len(edges), -1, 1))[..., 0]

    r, v, a = (each - each.mean(axis=1, keepdims=True) for each in (r, v, a))
    omega = turning(r, v)
    spin = omega[:, None]
    return omega, turning(r, a - np.cross(spin, np.cross(spin, r)))


def plain(motion: Motion, instants: np.ndarray) -> Numbers:
    """Every number by the plain formulas: Horner's rule for each point, and everything for all instants."""
    states, readout = motion.solved.states, motion.solved.readout
    assert isinstance(states, StatesOfChain)
    mechanism, plan = readout.mechanism, readout.plan
    topology, layout = mechanism.topology, mechanism.layout
    starts = np.array([segment.start for segment in states.chain.segments])
    which = np.maximum(np.searchsorted(starts, instants) - 1, 0)
    found: list[dict[str, np.ndarray]] = [
        {point: np.zeros((len(instants), 3)) for point in topology.points} for _ in range(3)
    ]
    for point in topology.chassis:
        found[0][point] += mechanism.drawing.vectors[point] * mechanism.unit
    for i, segment in enumerate(states.chain.segments):
        here = which == i
        s = (instants[here] - segment.start) / segment.scale
        series = {p: segment.coefficients[:, list(layout.vector(p))] for p in topology.moving}
        for point, carriers in topology.carried.items():
            weights = mechanism.carrier_weights[point]
            series[point] = carried_series(weights, *(series[carrier] for carrier in carriers))
        for point, coefficients in series.items():
            for d in range(3):
                law = np.polynomial.polynomial.polyder(coefficients, d)
                value = np.polynomial.polynomial.polyval(s, law).T
                found[d][point][here] = value * mechanism.unit / segment.scale**d
    shifts = readout.chassis.states(instants, 2) or [np.zeros(3)] * 3
    added = [mechanism.origin + shifts[0], *shifts[1:]]
    numbers: dict[str, dict[str, np.ndarray]] = {}
    for d, quantity in enumerate(("position", "velocity", "acceleration")):
        if d == 0 or quantity in plan.effects:
            numbers[quantity] = {point: found[d][point] + added[d] for point in topology.points}
    for effect in plan.computed:
        for angle in (ANGLES[name] for name in effect.names or () if name in ANGLES):
            start, end = (found[0][point] for point in angle.ends(topology))
            numbers.setdefault("wheel", {})[angle.name] = angle.value(start, end, readout.axes)
    if "damper" in plan.effects:
        lower, upper = (found[0][point] for point in topology.damper)
        numbers["dimension"] = {"damper_length": np.linalg.norm(upper - lower, axis=-1)}
    if "knuckle_rates" in plan.effects:
        body = [np.stack([each[p] for p in topology.bodies["knuckle"]], axis=1) for each in found]
        omega, alpha = plain_rates(*body)
        numbers |= {"angular_velocity": {"knuckle": omega}, "angular_acceleration": {"knuckle": alpha}}
    return numbers


def largest_difference(one: Numbers | Samples, other: Numbers) -> float:
    """Of all numbers, each by the largest of its quantity."""
    numbers = one.numbers if isinstance(one, Samples) else one
    assert {q: set(part) for q, part in numbers.items() if part} == {q: set(p) for q, p in other.items()}
    worst = 0.0
    for quantity, arrays in other.items():
        size = max(1e-300, *(float(np.abs(array).max()) for array in arrays.values()))
        for name, array in arrays.items():
            assert numbers[quantity][name].shape == array.shape
            worst = max(worst, float(np.abs(numbers[quantity][name] - array).max()) / size)
    return worst


@pytest.mark.parametrize("effects", SUBSETS, ids="+".join)
@pytest.mark.parametrize("name", SCENES)
def test_numbers_in_blocks_are_those_of_the_plain_formulas(name: str, effects: tuple[str, ...]) -> None:
    motion = solved(name, effects)
    instants = np.random.default_rng(7).uniform(motion.times[0], motion.times[-1], 2 * BLOCK + 3)
    # A sum of 21 terms is rounded some 21 times; terms of an acceleration are up to 50 times its sum, a
    # turn divides by edges that are a tenth of the car, and pinv squares no condition number.
    limit = 21 * 50 * 10 * EPS
    assert largest_difference(motion.at(instants), plain(motion, instants)) < limit
    ordered = np.sort(instants)
    assert largest_difference(motion.at(ordered), plain(motion, ordered)) < limit


@pytest.mark.parametrize("name", SCENES)
def test_numbers_at_the_scenes_instants_do_not_depend_on_how_many_are_asked_for_at_once(name: str) -> None:
    motion = solved(name, EVERY)
    one_by_one = [motion.at([instant]) for instant in motion.times]
    for quantity, channel in motion.numbers.items():
        for part, array in channel.items():
            alone = np.concatenate([samples.numbers[quantity][part] for samples in one_by_one])
            assert np.abs(alone - array).max() <= 21 * 50 * 10 * EPS * np.abs(array).max()


def test_rates_of_bodies_are_those_of_the_plain_formulas() -> None:
    rng = np.random.default_rng(3)
    for points, count in ((3, 1000), (5, 10)):
        r, v, a = rng.normal(size=(3, count, points, 3))
        thin = np.linalg.svd(r - r.mean(axis=1, keepdims=True), compute_uv=False)[:, 1]
        sound = thin > 0.1  # J squares the condition number, and rates that fit badly keep it
        stacked = [stack_points([each[:, i] for i in range(points)]) for each in (r, v, a)]
        for quick, exact in zip(body_rates(*stacked), plain_rates(r, v, a), strict=True):
            error = np.abs(quick - exact).max(axis=-1)[sound]
            size = np.abs(exact).max(axis=-1)[sound]
            assert (error <= 1e3 * EPS * (size + 1.0) / thin[sound] ** 4).all()


def test_results_are_written_where_they_are_wanted() -> None:
    motion = solved("bounce", EVERY)
    instants = np.linspace(0.0, 2.6, 1000)
    out = np.full((motion.height, 1000), np.nan)
    samples = motion.at(instants, out=out)
    assert not np.isnan(out).any()
    for quantity, channel in motion.at(instants).numbers.items():
        for name, array in channel.items():
            assert np.shares_memory(samples.numbers[quantity][name], out)
            np.testing.assert_array_equal(samples.numbers[quantity][name], array)
    with pytest.raises(ValueError, match="read-only"):
        samples.position["wheel_centre"][0] = 0.0


@pytest.mark.parametrize(
    "out",
    [np.empty((3, 4)), np.empty((130, 5)), np.empty((76, 4), np.float32)],
    ids=lambda out: str(out.shape),
)
def test_an_array_without_room_for_the_results_is_refused(out: np.ndarray) -> None:
    with pytest.raises(ValueError, match="allowed: a writeable array"):
        solved("bounce", ()).at(np.zeros(4), out=out)


@pytest.mark.parametrize("method", ["series", "newton"])
@pytest.mark.parametrize("size", [1, 7, 131, 1000])
def test_blocks_of_a_motion_are_its_parts_in_order(method: str, size: int) -> None:
    motion = simulate(Scene.load("bounce"), method)
    blocks = list(motion.blocks(size=size))
    assert all(len(block.times) == size for block in blocks[:-1])
    np.testing.assert_array_equal(np.concatenate([block.times for block in blocks]), motion.times)
    for quantity, channel in motion.numbers.items():
        for name, array in channel.items():
            joined = np.concatenate([block.numbers[quantity][name] for block in blocks])
            np.testing.assert_array_equal(joined, array)


@pytest.mark.parametrize("count", [1, 2, 131, 1000, 16384, 20001])
def test_any_number_of_instants_comes_in_blocks(count: int) -> None:
    motion = solved("steer", ("velocity",))
    blocks = list(motion.blocks(count, size=4096))
    part = motion.solved.states
    instants = (
        Scene.load("steer")
        .model_copy(
            update={"time": {"start": motion.times[0], "stop": motion.times[-1], "samples": max(count, 2)}}
        )
        .instants[:count]
    )
    times = np.concatenate([block.times for block in blocks])
    np.testing.assert_array_equal(times, instants)
    assert isinstance(part, StatesOfChain)
    whole = motion.at(instants)
    for quantity in ("position", "velocity"):
        for name, array in whole.numbers[quantity].items():
            joined = np.concatenate([block.numbers[quantity][name] for block in blocks])
            assert np.abs(joined - array).max() <= 21 * 50 * EPS * max(1e-300, np.abs(array).max())
    given = np.concatenate([block.position["wheel_centre"] for block in motion.blocks(instants[::-1], 100)])
    np.testing.assert_allclose(
        given[::-1], whole.position["wheel_centre"], rtol=0.0, atol=21 * 50 * EPS * 600
    )


def test_blocks_that_make_no_sense_are_refused() -> None:
    motion = solved("steer", ())
    with pytest.raises(ValueError, match="a block of 0 instants"):
        motion.blocks(10, size=0)
    with pytest.raises(ValueError, match="0 instants; allowed"):
        motion.blocks(0)
    with pytest.raises(ValueError, match="shape"):
        motion.blocks(np.zeros((2, 2)))
    with pytest.raises(OutsideMotion):
        list(motion.blocks([0.0, 1e9]))
    with pytest.raises(NotComputed, match="series"):
        simulate(Scene.load("steer"), "newton").blocks(10)


def peak(work: object) -> int:
    """The most memory that was taken at once while something ran, bytes; numpy's arrays among it."""
    assert callable(work)
    work()
    tracemalloc.start()
    try:
        work()
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def test_blocks_take_as_much_memory_for_many_instants_as_for_few() -> None:
    motion = solved("bounce", EVERY)

    def read(count: int) -> None:
        for _ in motion.blocks(count):
            pass

    # Two blocks live at once: the one that was given out, and the next.
    block = 8 * 16384 * (motion.height + 1)
    assert peak(lambda: read(300_000)) < 1.01 * peak(lambda: read(60_000)) < 2.01 * block + 8e6


@pytest.mark.parametrize("order", [1, -1], ids=["in order", "in reverse"])
def test_many_instants_take_no_more_memory_than_their_results_and_some_blocks(order: int) -> None:
    motion = solved("bounce-on-a-heaving-chassis", every_effect("bounce-on-a-heaving-chassis").effects)
    instants = np.linspace(0.0, 2.6, 200_000)[::order]
    results = 8 * len(instants) * (motion.height + 1)
    assert peak(lambda: motion.at(instants)) - results < 50e6 * len(instants) / 1e6 + 8e6
