"""A linkage that three inputs drive at once is covered by proven patches in all three."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from pointcoord.linkage.constraints.link import Link
from pointcoord.linkage.constraints.on_line import OnLine
from pointcoord.linkage.drives import Travel
from pointcoord.linkage.hardpoints import build_mechanism
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.linkage.topology import Topology
from pointcoord.patches.domain import Domain
from pointcoord.patches.flood import Limits, flood
from pointcoord.patches.reported_points import moving_points
from pointcoord.poses import solve_unrelated
from pointcoord.solve.assembly import close_drawing

Array = NDArray[np.float64]

# Three sliders on upright rails, and a tip that a rod links to each: its place is where three spheres meet.
NUMBERS = (1, 2, 3)
RAILS = {1: (200.0, 0.0, 0.0), 2: (-110.0, 170.0, 20.0), 3: (-90.0, -180.0, -10.0)}
TIP = (15.0, -10.0, -260.0)
TRIPOD = Topology(
    name="tripod",
    chassis=tuple(f"rail_{n}" for n in NUMBERS),
    moving=(*(f"slider_{n}" for n in NUMBERS), "tip"),
    bodies={},
    carried={},
    directions={"up": ("", "up")},
    constraints=(
        *(Link("tip", f"slider_{n}") for n in NUMBERS),
        *(OnLine(f"slider_{n}", f"rail_{n}", "rail", "up", f"travel {n}", "driven") for n in NUMBERS),
    ),
    drives=tuple(Travel(f"travel {n}", f"push_{n}", f"rail_{n}", f"slider_{n}", "up") for n in NUMBERS),
    roles={
        "steering_axis": ("rail_1", "rail_2"),
        "wheel_axis": ("slider_1", "tip"),
        "inboard": ("rail_1",),
        "front_and_rear": ("rail_1", "rail_2"),
    },
)


def tripod() -> Mechanism:
    points = {f"rail_{n}": place for n, place in RAILS.items()}
    points |= {f"slider_{n}": place for n, place in RAILS.items()} | {"tip": TIP}
    return build_mechanism(TRIPOD, points, {"up": (0.0, 0.0, 1.0), "right": (0.0, 1.0, 0.0)})


def tip_at(pushes: Array) -> Array:
    """Where the spheres about the sliders meet, on the drawn side of these; pushes (N, 3) in mm."""
    rails, drawn = np.array([RAILS[n] for n in NUMBERS]), np.array(TIP)
    squares = ((drawn - rails) ** 2).sum(axis=-1)
    found = []
    for push in pushes:
        centres = rails + push[:, None] * np.array([0.0, 0.0, 1.0])
        # Differences of the spheres are two planes; their line meets the first sphere twice.
        normals = centres[1:] - centres[0]
        sides = 0.5 * (squares[0] - squares[1:] + (normals**2).sum(axis=-1))
        along = np.cross(*normals)
        foot = np.linalg.lstsq(normals, sides, rcond=None)[0]
        height = np.sqrt((squares[0] - foot @ foot) / (along @ along))
        # Normals turn so that `along` points up: the drawn tip hangs below.
        found.append(centres[0] + foot - np.sign(along[2]) * height * along)
    return np.array(found)


@pytest.mark.parametrize("reach", [20.0, 60.0])
def test_three_inputs_are_covered_and_every_place_is_within_its_bound(reach: float) -> None:
    mechanism, tolerance = tripod(), 1e-6
    ranges = {f"push_{n}": (-reach, reach) for n in NUMBERS}
    domain = Domain(mechanism, ranges, 3)
    start = close_drawing(mechanism)
    middle = np.full(3, domain.parts)
    cover = flood(domain, 8, Limits(tolerance), (middle, start.y), 512)
    assert cover.given_up == ()
    patches = cover.patches
    pushes = np.random.default_rng(5).uniform(-reach, reach, (200, 3))
    which = patches.lookup.at(pushes)
    assert (which >= 0).all()
    (summed,) = patches.sums([patches.coefficients], [pushes])
    place = 3 * list(moving_points(TRIPOD)).index("tip")
    off = np.abs(summed[place : place + 3].T + mechanism.origin - tip_at(pushes)).max(axis=-1)
    bound = patches.off.value[which].max(axis=-1)
    assert bound.max() <= tolerance
    # The closed form itself is rounded, in squares of some 300 mm over a height of some 260 mm.
    assert (off <= bound + 1e-11).all()
    assert np.allclose(tip_at(np.zeros((1, 3)))[0], TIP, atol=1e-11)


def test_unrelated_poses_of_three_inputs_are_the_closed_form_within_their_bounds() -> None:
    mechanism = tripod()
    pushes = np.random.default_rng(3).uniform(-15.0, 15.0, (2000, 3))
    inputs = {name: pushes[:, i] for i, name in enumerate(mechanism.topology.required_inputs)}
    found = solve_unrelated(mechanism, inputs, 1e-9)
    assert not found.failures
    tip = mechanism.origin + found.places[:, moving_points(TRIPOD).index("tip")]
    # The closed form rounds some 50 times in sizes of 300 mm.
    assert (np.abs(tip - tip_at(pushes)).max(axis=-1) <= found.bound + 50 * 2.0**-53 * 300.0).all()
    assert found.bound.max() <= 1e-9
