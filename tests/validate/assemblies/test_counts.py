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


def test_a_wishbone_whose_lower_arm_is_held_has_four_assemblies() -> None:
    """A circle and a sphere meet in two points, the upper ball joint's; three spheres in two."""
    mechanism, places = pose("double-wishbone", "arm_angle", "rack")
    found = count.count_assemblies(mechanism, places)
    assert len(found.assemblies) == 4
    assert found.agreed
    assert found.drawn


@pytest.mark.parametrize(("scene", "held", "number"), [("off-axis-strut", "wheel_travel", 20)])
def test_every_real_assembly_keeps_every_length(scene: str, held: str, number: int) -> None:
    mechanism, places = pose(scene, held, "rack")
    found = count.count_assemblies(mechanism, places)
    assert len(found.assemblies) == number
    assert found.agreed
    assert found.drawn
    # Complex ones come in pairs.
    assert (number - found.real) % 2 == 0
    for one in found.assemblies:
        if not one.real:
            continue
        at = {n: _placed(one.box, n, mechanism, places) for n in places}
        for end, far in (
            ("lower_ball_joint", "lower_arm_front"),
            ("lower_ball_joint", "lower_arm_rear"),
            ("tie_rod_outer", "tie_rod_inner"),
        ):
            drawn = np.linalg.norm(places[end] - places[far])
            assert abs(np.linalg.norm(at[end] - places[far]) - drawn) <= 1e-9
        assert abs(at["wheel_centre"][2] - places["wheel_centre"][2]) <= 1e-9


def _placed(box: tuple[acb, ...], name: str, mechanism: dict[str, Any], places: dict[str, Array]) -> Array:
    """A point of the knuckle at a pose, mm: e x e* / |e|^2 + 2 g e* / |e|^2 about the knuckle's middle."""
    z = np.array([float(number.real.mid()) for number in box])
    body = mechanism["bodies"]["knuckle"]
    middle = np.mean([places[n] for n in body], axis=0)
    size = max(float(np.abs(place - middle).max()) for place in places.values())
    e, g = z[:4], z[4:]
    square = e @ e
    turn = Rotation.from_quat([*e[1:], e[0]])
    move = 2.0 * (e[0] * g[1:] - g[0] * e[1:] - np.cross(g[1:], e[1:])) / square
    return np.asarray(middle + size * (turn.apply((places[name] - middle) / size) + move))


def test_what_is_no_solution_is_not_certified() -> None:
    mechanism, places = pose("double-wishbone", "arm_angle", "rack")
    quadratic = forms(mechanism, places)
    drawn = np.eye(8)[0]
    with ctx.workprec(count.BITS):
        matrices = [acb_mat([[float(x) for x in row] for row in form]) for form in quadratic]
        parts, middle = count._Forms(matrices, 0), [acb(0)] * 7
        assert not parts.holds_one([acb(1e-6 * k) for k in range(1, 8)], count.WIDE)
        assert parts.holds_one(middle, count.WIDE)
        assert not parts.holds_one(middle, "10")  # other assemblies are in these discs
        certified = count._certified(matrices, drawn.astype(complex))
        assert certified is not None
        assert certified.real
        assert certified.drawn
        # Where a condition stands twice the solutions are curves, and nothing is proven.
        twice = [*matrices[:-1], matrices[-2]]
        assert count._certified(twice, drawn.astype(complex)) is None


def test_what_is_not_on_six_legs_is_refused_with_what_holds_it() -> None:
    (found,) = counts("bricard")
    assert "names no knuckle" in found["reason"]
    assert "agreed" not in found
    mechanism, places = pose("semi-trailing-arm", "wheel_travel")
    with pytest.raises(NoAnswer, match="arm is held by 1 conditions"):
        forms(mechanism, places)
