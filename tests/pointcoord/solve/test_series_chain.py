"""A motion as a chain of series: cut where a table's pieces meet, on one branch, and honest about its end."""

from collections.abc import Callable

import numpy as np
import pytest

from pointcoord import AssemblyError, Motion, Scene, simulate
from pointcoord.results.by_series import ByChain

EPS = np.finfo(float).eps
# Where the tie rod locks at a level arm, mm; between 130.100768 and 130.100769 by its circle's closed form.
RACK_END = 130.10076831981567
Make = Callable[..., Scene]


def gap(one: Motion, other: Motion) -> float:
    return max(float(np.abs(place - other.position[name]).max()) for name, place in one.position.items())


def test_no_series_goes_on_where_the_pieces_of_a_table_meet(make_scene: Make) -> None:
    """Third derivatives jump there, which a series over it would carry on."""
    arm = {"times": [0.0, 0.5, 0.9, 1.6, 2.0], "values": [1.2, 1.5, 1.3, 1.7, 1.6]}
    rack = {"times": [0.0, 0.7, 1.1, 2.0], "values": [0.0, 20.0, -10.0, 5.0]}
    scene = make_scene({"table": arm}, {"table": rack}, samples=41)
    series, newton = simulate(scene, "series"), simulate(scene, "newton")
    assert isinstance(series.solved, ByChain)
    starts = {segment.start for segment in series.solved.chain.segments}
    assert {*arm["times"][1:-1], *rack["times"][1:-1]} <= starts
    bounds = [motion.proof(rates=True).proven for motion in (series, newton)]
    for quantity in ("position", "velocity", "acceleration"):
        for name, array in series.numbers[quantity].items():
            allowed = sum(bound[quantity][name] for bound in bounds)
            assert (np.abs(array - newton.numbers[quantity][name]) <= allowed).all(), (quantity, name)


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
    apart = gap(simulate(scene), simulate(scene, "newton"))
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
