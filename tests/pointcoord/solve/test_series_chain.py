"""A motion as a chain of series: continuous, accurate as asked, and honest about where it ends."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray
from sample_cars import SAMPLES

from pointcoord import AssemblyError, Motion, Scene, simulate
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.counters import Work
from pointcoord.solve.assembly import assemble
from pointcoord.solve.dense_output import evaluate
from pointcoord.solve.taylor import Chain, Segment, Settings, build_chain
from pointcoord.time_functions import Polynomial, Sine, Table, TimeFunction

Array = NDArray[np.float64]
EPS = np.finfo(float).eps
# Where the tie rod locks at a level arm, mm; between 130.100768 and 130.100769 by its circle's closed form.
RACK_END = 130.10076831981567
BOUNCE: dict[str, TimeFunction] = {"arm_angle": Polynomial((0.8, 0.25, 0.0625)), "rack": Polynomial((0.0,))}
BOTH: dict[str, TimeFunction] = {"arm_angle": Sine(0.4, 2.0, 0.0, 1.5), "rack": Sine(30.0, 3.0)}
TABLE: dict[str, TimeFunction] = {
    "arm_angle": Table((0.0, 0.5, 0.9, 1.6, 2.0), (1.2, 1.5, 1.3, 1.7, 1.6)),
    "rack": Table((0.0, 0.7, 1.1, 2.0), (0.0, 20.0, -10.0, 5.0)),
}
MOTIONS = {"bounce": BOUNCE, "both": BOTH, "table": TABLE}
MECHANISMS = {car.name: car.mechanism() for car in SAMPLES}
by_motion = pytest.mark.parametrize("functions", MOTIONS.values(), ids=MOTIONS.keys())
by_mechanism = pytest.mark.parametrize("mechanism", MECHANISMS.values(), ids=MECHANISMS.keys())


def chain_of(
    mechanism: Mechanism, functions: dict[str, TimeFunction], tolerance: float, stop: float = 2.0
) -> Chain:
    pose = assemble(mechanism, {name: f.series(0.0, 0)[..., 0] for name, f in functions.items()})
    return build_chain(mechanism, functions, pose, 0.0, stop, Settings(tolerance, derivative=2))


def loop_size(chain: Chain, derivatives: int) -> Array:
    """Largest sum of magnitudes of the terms of each derivative, over the segments."""
    sizes = []
    for segment in chain.segments:
        s = (segment.stop - segment.start) / segment.scale
        size = np.abs(segment.coefficients).max(axis=-1)
        k = np.arange(len(size))
        sizes.append(
            [
                sum(float(np.prod(np.arange(j - d + 1, j + 1))) * size[j] * s ** (j - d) for j in k[d:])
                / segment.scale**d
                for d in range(derivatives + 1)
            ]
        )
    return np.max(sizes, axis=0)


@by_mechanism
@by_motion
@pytest.mark.parametrize("tolerance", [1e-7, 1e-10, 1e-12])
def test_position_velocity_and_acceleration_are_continuous_across_joints(
    mechanism: Mechanism, functions: dict[str, TimeFunction], tolerance: float
) -> None:
    chain = chain_of(mechanism, functions, tolerance)
    assert len(chain.segments) > 1
    n = mechanism.layout.unknowns
    for before, after in zip(chain.segments[:-1], chain.segments[1:], strict=True):
        single = Chain((before,), Work())
        left = evaluate(single, [before.coefficients], np.array([before.stop]), 2)[:, 0, :n]
        right = evaluate(Chain((after,), Work()), [after.coefficients], np.array([after.start]), 2)[:, 0, :n]
        # Truncation of position: the tolerance (the unit is the size). Of a derivative: the tolerance
        # relative to its largest term. Rounding: two solves at the joint, condition number below 200,
        # once per derivative more.
        size = np.maximum(loop_size(single, 2), 1.0)
        for d in range(3):
            rounding = 64 * EPS * 200.0 ** (min(d, 1) + 1) * size[d]
            assert np.abs(left[d] - right[d]).max() <= tolerance * size[d] + rounding


@by_mechanism
def test_breaks_of_a_table_are_joints_of_the_chain(mechanism: Mechanism) -> None:
    chain = chain_of(mechanism, TABLE, 1e-9)
    starts = [segment.start for segment in chain.segments]
    for function in TABLE.values():
        assert set(function.breaks) <= set(starts)
    # and so no series is used across one: third derivatives may differ on both sides, but each side
    # agrees with the input's own piece
    for segment in chain.segments:
        middle = 0.5 * (segment.start + segment.stop)
        s = (middle - segment.start) / segment.scale
        rack = np.polynomial.polynomial.polyval(
            s, segment.coefficients[:, mechanism.layout.scalar("rack travel")]
        )
        # A cubic evaluated two ways, values up to 30 mm and steps above 0.3 s.
        assert abs(rack * float(mechanism.unit) - TABLE["rack"].series(middle, 0)[0]) <= 1e3 * EPS * 30.0


def largest_gap(series: Motion, newton: Motion, quantity: str) -> float:
    ours, theirs = getattr(series, quantity), getattr(newton, quantity)
    return max(float(np.abs(ours[name] - theirs[name]).max()) for name in ours)


def test_motion_that_meets_the_end_of_its_range_stops_there_with_what_it_has(
    make_scene: Callable[..., Scene],
) -> None:
    # The arm turns to 152.013 degrees = 2.65313 rad at t = 1.15313 s and the scene goes on to 1.5 s.
    end = np.deg2rad(152.013) - 1.5
    scene = make_scene((1.5, 1.0), samples=151, stop=1.5)
    partial = {}
    for method in ("series", "newton"):
        with pytest.raises(AssemblyError, match="bring 'arm_angle' back") as caught:
            simulate(scene, method)
        error = caught.value
        assert isinstance(error.partial, Motion)
        partial[method] = error.partial
        assert np.array_equal(error.partial.times, scene.instants[scene.instants < end])
        assert error.partial.position["wheel_centre"].shape == (len(error.partial.times), 3)
        # The limit is printed to a thousandth of a degree.
        assert abs(error.reached["arm_angle"] - (1.5 + end)) <= np.deg2rad(0.001)
    gap = largest_gap(partial["series"], partial["newton"], "position")
    assert gap <= 1e-9 + 4 * float(partial["newton"].proof().bound.max())
    inside = partial["series"].at(end - 1e-4).position["strut_lower"]
    assert np.isfinite(inside).all()


@pytest.mark.parametrize("tolerance", [1e-9, 1e9])
@pytest.mark.parametrize("short", [1e-6, 1e-10, 1e-12, 1e-13])
def test_no_tolerance_lets_a_motion_cross_to_a_branch_that_it_only_touches(
    make_scene: Callable[..., Scene], tolerance: float, short: float
) -> None:
    # The rack comes near the end of its travel and goes back. The other branch, its tie rod's outer end
    # 200 mm away in the end, comes within the root of `short` of the car's size.
    rack = {"sine": {"amplitude": (1.0 - short) * RACK_END, "angular_frequency": 1.0}}
    scene = make_scene((np.pi / 2,), rack, stop=np.pi, samples=21, tolerance=tolerance, effects=[])
    # Newton's method takes steps that are proven to keep the branch.
    gap = largest_gap(simulate(scene), simulate(scene, "newton"), "position")
    # The series keep ten times the coarsest truncation, 1e-6 of 512 mm; at the turn rounding is
    # magnified by the inverse root of `short`.
    assert gap <= 10 * 1e-6 * 512 + 16 * EPS * 512 / np.sqrt(short)


@pytest.mark.parametrize("beyond", [1e-14, 1e-9, 1e-3])
def test_a_motion_that_cannot_go_on_names_the_input_that_moves(
    make_scene: Callable[..., Scene], beyond: float
) -> None:
    # The arm rests and the rack runs past its end, if only by rounding.
    scene = make_scene((np.pi / 2,), (0.0, (1.0 + beyond) * RACK_END), stop=1.0)
    with pytest.raises(AssemblyError, match="bring 'rack' back") as caught:
        simulate(scene)
    error = caught.value
    # The range is 219 mm: its last value is found to a billionth of that at least.
    assert abs(error.reached["rack"] - RACK_END) <= 1e-9 * 219
    assert error.limits[0].startswith("link ")
    assert all("tie_rod" in name or "strut_lower" in name for name in error.limits[:3])


@pytest.mark.parametrize("batch", [(), (2, 3)])
@pytest.mark.parametrize("ordered", [True, False])
def test_sums_are_those_of_the_polynomials(batch: tuple[int, ...], ordered: bool) -> None:
    rng, size = np.random.default_rng(5), 4
    ends, scales, orders = (0.0, 0.5, 0.75, 2.0), (1.0, 0.25, 2.0), (6, 3, 7)
    segments = tuple(
        Segment(start, stop, scale, rng.normal(size=(*batch, order + 1, size)))
        for start, stop, scale, order in zip(ends[:-1], ends[1:], scales, orders, strict=True)
    )
    chain = Chain(segments, Work())
    # More than a block of them in the last segment.
    instants = np.sort(rng.uniform(0.0, 2.0, 3000))
    if not ordered:
        instants = rng.permutation(instants)
    found = evaluate(chain, [segment.coefficients for segment in segments], instants, 2)
    assert found.shape == (3, *batch, 3000, size)
    for number, t in list(enumerate(instants.tolist()))[::149]:
        segment = next(s for s in reversed(segments) if s.start <= t)
        for place in np.ndindex(*batch):
            for k in range(size):
                series = np.polynomial.Polynomial(segment.coefficients[(*place, slice(None), k)])
                for d in range(3):
                    one = series.deriv(d)((t - segment.start) / segment.scale) / segment.scale**d
                    assert found[(d, *place, number, k)] == pytest.approx(one, rel=1e-11, abs=1e-11)
