"""A drawing that lies on a fold, to within rounding, is closed on its own side or not at all."""

from collections.abc import Mapping

import numpy as np
import pytest
from many_digits import fractions
from sample_cars import CARS
from scipy.spatial.transform import Rotation

import pointcoord.solve.assembly
from pointcoord import AssemblyError, MechanismError, Scene
from pointcoord.linkage.hardpoints import build_mechanism
from pointcoord.numerics.arrays import Array
from pointcoord.scene.mechanism_part import MechanismPart
from pointcoord.solve.assembly import close_drawing
from pointcoord.solve.proven_step import Proof

# Only a drawing that closes says by itself on which side it stands.
CLOSING = [part for part in (Scene.load(car).mechanism for car in CARS) if part.closure == "drawn"]
by_part = pytest.mark.parametrize("part", CLOSING, ids=lambda part: part.type)


def steering_side(part: MechanismPart, points: Mapping[str, Array]) -> int:
    """The exact sign of (k x inner end of the tie rod) . outer end, from the lower end of the kingpin k."""
    lower, upper = part.topology.role("steering_axis")
    k, inner, outer = (
        fractions(points[name]) - fractions(points[lower])
        for name in (upper, "tie_rod_inner", "tie_rod_outer")
    )
    product = np.cross(k, inner) @ outer
    return int(product > 0) - int(product < 0)


def drawn_with_a_dead_tie_rod(part: MechanismPart, sine: float, turn: Rotation) -> dict[str, Array]:
    """The car turned, its tie rod drawn out of the plane of kingpin and steering arm by an angle."""
    points = {name: np.array(place, float) for name, place in part.points.items()}
    lower, upper = (points[name] for name in part.topology.role("steering_axis"))
    outer = points["tie_rod_outer"]
    normal = np.cross(upper - lower, outer - lower)
    normal /= np.linalg.norm(normal)
    rod = points["tie_rod_inner"] - outer
    flat = rod - (rod @ normal) * normal
    points["tie_rod_inner"] = outer + flat + sine * np.linalg.norm(flat) * normal
    points["rack_centre"] = points["tie_rod_inner"]
    return {name: turn.apply(place) for name, place in points.items()}


def sides(part: MechanismPart, sine: float, count: int) -> list[bool]:
    """Of some turned cars, whether the closed drawing is on the side of the drawing; none that is refused."""
    found = []
    for turn in Rotation.random(count, rng=np.random.default_rng(1)):
        points = drawn_with_a_dead_tie_rod(part, sine, turn)
        axes = {"up": turn.apply([0.0, 0.0, 1.0]), "right": turn.apply([0.0, 1.0, 0.0])}
        try:
            mechanism = build_mechanism(part.topology, points, axes)
            closed = close_drawing(mechanism).y
        except (AssemblyError, MechanismError):
            continue
        places = {
            n: closed[list(mechanism.layout.vector(n))]
            for n in (*mechanism.topology.chassis, *mechanism.topology.moving)
        }
        found.append(steering_side(part, places) == steering_side(part, points))
    return found


@by_part
@pytest.mark.parametrize("power", [-12, -9, -8, -6])
def test_a_drawing_with_a_tie_rod_all_but_at_its_dead_point_keeps_its_side(
    part: MechanismPart, power: int
) -> None:
    for sine in (5.0 * 10.0**power, -5.0 * 10.0**power):
        assert all(sides(part, sine, 6))


@by_part
def test_one_that_rounding_cannot_put_on_the_fold_is_closed(part: MechanismPart) -> None:
    assert len(sides(part, 1e-5, 20)) == 20


def test_without_what_guards_the_end_of_a_step_a_side_is_lost(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        pointcoord.solve.follower, "same_side", lambda system, y, *_: np.ones(y.shape[:-1], bool)
    )
    monkeypatch.setattr(Proof, "within", lambda self, apart: np.ones(apart.shape[:-1], bool))
    assert not all(
        side for part in CLOSING for power in (-9, -8) for side in sides(part, 5.0 * 10.0**power, 40)
    )
