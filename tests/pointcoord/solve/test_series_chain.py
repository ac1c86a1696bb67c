"""A motion as a chain of series: cut where it must, on one branch, and honest about what it leaves out."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from within_bounds import beyond_claims

from pointcoord import AssemblyError, Scene, simulate
from pointcoord.bounds.summed import Summed
from pointcoord.results.by_series import ByChain
from pointcoord.solve.step_rule import last_magnitudes

EPS = np.finfo(float).eps
# Where the tie rod locks at a level arm, mm; between 130.100768 and 130.100769 by its circle's closed form.
RACK_END = 130.10076831981567
Make = Callable[..., Scene]


def test_no_series_goes_on_where_the_pieces_of_a_table_meet(make_scene: Make) -> None:
    """Third derivatives jump there, which a series over it would carry on."""
    arm = {"times": [0.0, 0.5, 0.9, 1.6, 2.0], "values": [1.2, 1.5, 1.3, 1.7, 1.6]}
    rack = {"times": [0.0, 0.7, 1.1, 2.0], "values": [0.0, 20.0, -10.0, 5.0]}
    scene = make_scene({"table": arm}, {"table": rack}, samples=41)
    motion = simulate(scene, "series")
    assert isinstance(motion.solved, ByChain)
    starts = {segment.start for segment in motion.solved.chain.segments}
    assert {*arm["times"][1:-1], *rack["times"][1:-1]} <= starts
    assert beyond_claims(motion.proof(rates=True)) == []


@pytest.mark.parametrize(("tolerance", "short"), [(1e-9, 1e-13), (1e9, 1e-6), (1e9, 1e-13)])
def test_no_tolerance_lets_a_motion_cross_to_a_branch_that_it_only_touches(
    make_scene: Make, tolerance: float, short: float
) -> None:
    # The rack comes near the end of its travel and goes back. The other branch, its tie rod's outer end
    # 200 mm away in the end, comes within the root of `short` of the car's size.
    rack = {"sine": {"amplitude": (1.0 - short) * RACK_END, "angular_frequency": 1.0}}
    scene = make_scene((np.pi / 2,), rack, stop=np.pi, samples=21, tolerance=tolerance, effects=[])
    # Newton's method takes steps that are proven to keep the branch. The series keep ten times the coarsest
    # truncation, 1e-6 of 512 mm; at the turn rounding is magnified by the inverse root of `short`.
    places, others = (simulate(scene, method).position for method in ("auto", "newton"))
    apart = max(float(np.abs(place - others[name]).max()) for name, place in places.items())
    assert apart <= 10 * 1e-6 * 512 + 16 * EPS * 512 / np.sqrt(short)


@pytest.mark.parametrize("beyond", [1e-14, 1e-3])
def test_a_motion_that_cannot_go_on_names_the_input_that_moves(make_scene: Make, beyond: float) -> None:
    # The arm rests and the rack runs past its end, if only by rounding.
    scene = make_scene((np.pi / 2,), (0.0, (1.0 + beyond) * RACK_END), stop=1.0)
    with pytest.raises(AssemblyError, match="bring 'rack' back") as caught:
        simulate(scene)
    error = caught.value
    # The range is 219 mm: its last value is found to a billionth of that at least.
    assert abs(error.reached["rack"] - RACK_END) <= 1e-9 * 219
    assert error.limits[0].startswith("link ")
    assert all("tie_rod" in name or "strut_lower" in name for name in error.limits[:3])


SLOW = {
    "t^3": [0.0, 0.0, 1.0],
    "t^13": [*[0.0] * 12, 1.0],
    "t^3, and t hardly": [2e-6, 0.0, 1.0],
    "t^8, and t^2 hardly": [0.0, 2e-8, *[0.0] * 5, 1.0],
}


@pytest.mark.parametrize("tolerance", [1e-4, 1e-9])
@pytest.mark.parametrize("law", SLOW)
def test_a_motion_from_rest_keeps_what_it_claims(
    make_scene: Callable[..., Scene], law: str, tolerance: float
) -> None:
    shape, effects = np.array(SLOW[law]), ("velocity", "acceleration")
    arm, rack = [1.5, *(0.05 * shape)], [0.0, *(3.0 * shape)]
    scene = make_scene(arm, rack, samples=21, stop=1.0, tolerance=tolerance, effects=effects)
    motion = simulate(scene, "series")
    proof = motion.proof(rates=True)
    assert beyond_claims(proof) == []
    # And it is as near as was asked: rates to the part of themselves that the tolerance is of the car.
    fastest = max(float(np.abs(array).max()) for array in motion.acceleration.values())
    off = max(float(bound.max()) for bound in proof.proven["acceleration"].values())
    assert off <= fastest * (tolerance / motion.unit + 1e-12)


MANY = 200


def swinging(angle: float, radius: float, phase: float) -> np.ndarray:
    """Coefficients cos(k angle + phase) / radius^k of a pair of poles beside the axis, (MANY,)."""
    k = np.arange(MANY)
    return np.cos(k * angle + phase) / radius**k


def said(series: np.ndarray, at: float, length: float) -> float:
    """What the series is said to leave out at a place of its segment, rounding aside."""
    powers = at ** np.arange(len(series))
    last = (last_magnitudes(series[:, None], length)[:, 0] * powers[-2:]).sum()
    before = (np.abs(series) * powers)[-4:-2].sum()
    one = [np.array([[value]]) for value in (last, before, 0.0)]
    return float(Summed(*one).expected(np.zeros((1, 1)), np.ones(1), np.ones(1))[0, 0])


@given(
    angle=st.floats(0.05, 3.09),
    phase=st.floats(0.0, 6.28),
    order=st.integers(14, 40),
    part=st.floats(0.2, 0.6),
    place=st.floats(0.3, 1.0),
    unit=st.sampled_from([0.125, 1.0, 8.0]),
)
def test_terms_that_swing_leave_out_no_more_than_is_said(
    angle: float, phase: float, order: int, part: float, place: float, unit: float
) -> None:
    # Half a swing is seen in the last terms: what swings slower is at its end as smooth as no swing.
    if np.pi / angle > 4.0:
        angle = np.pi / 4.0
    every = swinging(angle, 1.0 / unit, phase)
    length = part / unit
    at = place * length
    left = abs(float(np.sum(every[order + 1 :] * at ** np.arange(order + 1, MANY))))
    assert left <= said(every[: order + 1], at, length)


def test_a_dip_at_the_end_is_not_taken_for_the_end() -> None:
    # Looked for: 24 times what is said if the fall is taken in this unit, in which terms rise.
    angle, phase, odd, order, part, at = (
        0.3531510656,
        0.0831998326,
        0.9315690877,
        23,
        0.6792952857,
        0.6663665443,
    )
    k = np.arange(MANY)
    swing = np.cos(k * angle + phase)
    every = (swing + odd * (-1.0) ** k * swing) * np.maximum(k, 1) ** -1.5 * 8.0**k
    left = abs(float(np.sum(every[order + 1 :] * (at / 8.0) ** k[order + 1 :])))
    assert left <= said(every[: order + 1], at / 8.0, part / 8.0)
