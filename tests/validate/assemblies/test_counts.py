"""All assemblies of a knuckle on its legs are found, each is one, and none that is false is certified."""

from typing import Any

import numpy as np
import pytest
from flint import acb, acb_mat, ctx
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from pointcoord import Scene, simulate
from pointcoord.numerics.arrays import Array
from validate.assemblies import count
from validate.assemblies.legs import STUDY, at_distance, forms, on_plane, on_plane_of_body
from validate.assemblies.scenes import counts
from validate.errors import NoAnswer

seeds = st.integers(0, 2**32 - 1)


def study_numbers(turn: Rotation, move: Array) -> Array:
    """(e, g) of x -> turn(x) + move: 2 g e* = move |e|^2, so g = move e / 2 with |e| = 1."""
    x, y, z, w = turn.as_quat()
    e = np.array([w, x, y, z])
    real = -move @ e[1:]
    return np.concatenate([e, 0.5 * np.array([real, *(w * move + np.cross(move, e[1:]))])])


@given(seed=seeds)
def test_each_form_is_what_its_condition_misses_by(seed: int) -> None:
    random = np.random.default_rng(seed)
    turn, move = Rotation.random(random_state=seed % 2**31), random.normal(size=3)
    z = study_numbers(turn, move)
    point, fixed, normal = random.normal(size=(3, 3))
    placed = turn.apply(point) + move
    seen = turn.inv().apply(fixed - move)
    values = {
        "study": (STUDY, 0.0),
        "distance": (
            at_distance(point, fixed),
            (placed - fixed) @ (placed - fixed) - (point - fixed) @ (point - fixed),
        ),
        "plane": (on_plane(point, normal), normal @ (placed - point)),
        "plane of body": (on_plane_of_body(fixed, normal), normal @ (seen - fixed)),
    }
    size = 1.0 + max(np.abs(part).max() for part in (point, fixed, normal, move)) ** 2
    for name, (form, missed) in values.items():
        # Some hundred products of numbers of this size.
        assert abs(z @ form @ z - missed) <= 100 * 2.0**-52 * size**2, name


def pose(name: str, *held: str) -> tuple[dict[str, Any], dict[str, Array]]:
    scene = Scene.load(name)
    there = scene.model_copy(update={"inputs": {one: {"constant": "drawn"} for one in held}})
    motion = simulate(there)
    return there.mechanism.plain(held), {n: np.array(place[0]) for n, place in motion.position.items()}


@pytest.mark.parametrize(
    ("scene", "held", "number"), [("double-wishbone", "arm_angle", 4), ("off-axis-strut", "wheel_travel", 20)]
)
def test_every_assembly_of_a_knuckle_is_found(scene: str, held: str, number: int) -> None:
    """With the lower arm held a circle and a sphere meet in two points, the upper ball joint's; three spheres
    meet in two.
    """
    found = count.count_assemblies(*pose(scene, held, "rack"))
    assert found["distinct"] == number
    assert found["agreed"]
    assert found["drawn"]
    # Complex ones come in pairs.
    assert (number - found["real"]) % 2 == 0


def test_what_is_no_solution_is_not_certified() -> None:
    mechanism, places = pose("double-wishbone", "arm_angle", "rack")
    quadratic = forms(mechanism, places)
    drawn = np.eye(8)[0]
    with ctx.workprec(count.BITS):
        matrices = [acb_mat([[float(x) for x in row] for row in form]) for form in quadratic]
        parts, middle = count.Forms(matrices, 0), [acb(0)] * 7
        assert not parts.holds_one([acb(1e-6 * k) for k in range(1, 8)], count.WIDE)
        assert parts.holds_one(middle, count.WIDE)
        assert not parts.holds_one(middle, "10")  # other assemblies are in these discs
        certified = count.certify(matrices, drawn.astype(complex))
        assert certified is not None
        assert certified.real
        assert certified.drawn
        # Where a condition stands twice the solutions are curves, and nothing is proven.
        twice = [*matrices[:-1], matrices[-2]]
        assert count.certify(twice, drawn.astype(complex)) is None


def test_what_is_not_on_six_legs_is_refused_with_what_holds_it() -> None:
    (found,) = counts("bricard")
    assert "names no knuckle" in found["reason"]
    assert "agreed" not in found
    mechanism, places = pose("semi-trailing-arm", "wheel_travel")
    with pytest.raises(NoAnswer, match="arm is held by 1 condition;"):
        forms(mechanism, places)
