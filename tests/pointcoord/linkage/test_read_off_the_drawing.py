"""What constraints read off a drawing: right to its stated doubt by rational arithmetic, and by hand."""

from collections.abc import Iterator
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from many_digits import fractions as exactly

from pointcoord import Scene
from pointcoord.errors import MechanismError
from pointcoord.linkage.constraints.in_body import Axis, axis_in_body, carrier_weights
from pointcoord.linkage.constraints.on_line import FARTHEST, Line, on_line
from pointcoord.linkage.constraints.scalar_product import link
from pointcoord.linkage.drawing import Drawing, Placed
from pointcoord.numerics.arrays import Array
from pointcoord.simulation import scene_mechanism
from validate.reference.vectors import Vector, cross, dot, minus, times

U = 2.0**-53
BODY = ("base", "first", "second")
DRAWN = Axis("axis", "tail", "head", "body")
AXIS = axis_in_body(DRAWN, BODY)
HELD = on_line("end", Line("axis", "head", "axis", axis=DRAWN), "held", "held")
LINE = on_line("c", Line("line a - b", "a", "b", between=True), "ratio")
seeds = st.integers(0, 2**32 - 1)
places = st.sampled_from(["anywhere", "an edge", "the normal"])


def alone(points: dict[str, Array]) -> Drawing:
    return Drawing(points, np.array(1.0))


def exact(points: dict[str, Array]) -> dict[str, Vector]:
    return {name: (Fraction(x), Fraction(y), Fraction(z)) for name, (x, y, z) in points.items()}


def fractions(placed: Placed) -> list[Fraction]:
    return [Fraction(float(part)) for part in placed]


def drawn(seed: int, place: str, height: float) -> dict[str, Array]:
    """A triangle of some height, an axis somewhere in or beside it, and a point near the axis."""
    rng = np.random.default_rng(seed)
    base, along, off, tail = rng.uniform(-1.0, 1.0, (4, 3))
    first, second = base + along, base + rng.uniform(0.3, 0.8) * along + height * off
    if place == "an edge":
        tail, head = base, base + rng.uniform(1.0, 3.0) * (second - base)
    elif place == "the normal":
        tail, head = second, second + np.cross(along, off)
    else:
        head = tail + rng.uniform(-1.0, 1.0, 3)
    end = head + rng.uniform(-1.0, 1.0) * (head - tail) + 1e-3 * rng.uniform(-1.0, 1.0, 3)
    return {"base": base, "first": first, "second": second, "tail": tail, "head": head, "end": end}


def by_cramer(p: dict[str, Vector], target: Vector) -> Iterator[Fraction]:
    """A vector's parts along the two edges of the body and its normal."""
    e1, e2 = minus(p["first"], p["base"]), minus(p["second"], p["base"])
    frame = [e1, e2, cross(e1, e2)]
    volume = dot(frame[0], cross(frame[1], frame[2]))
    for i in range(3):
        a, b, c = (target if j == i else frame[j] for j in range(3))
        yield dot(a, cross(b, c)) / volume


def scaled(vector: Vector) -> Vector:
    """By the power of two that brings its length between 1/2 and 1."""
    scale, squared = Fraction(1), dot(vector, vector)
    while scale * scale * squared >= 1:
        scale /= 2
    while scale * scale * squared < Fraction(1, 4):
        scale *= 2
    return times(vector, scale)


@given(seed=seeds, place=places, power=st.floats(-6.0, 0.0))
def test_the_place_of_an_axis_in_its_body_is_right_to_its_stated_doubt(
    seed: int, place: str, power: float
) -> None:
    points = drawn(seed, place, 10.0**power)
    placed, p = AXIS.placed(alone(points)), exact(points)
    axis = scaled(minus(p["head"], p["tail"]))
    for name, meant in zip(AXIS.constants, by_cramer(p, axis), strict=True):
        found, lacks, doubt = fractions(placed[name])
        assert abs(found + lacks - meant) <= doubt
        assert abs(lacks) <= 5 * U * abs(found)
    # The doubt is of the order of u^2, so that it never shows beside the rounding of a pose.
    height = np.linalg.norm(np.cross(points["first"] - points["base"], points["second"] - points["base"]))
    assert max(float(placed[name].doubt) for name in AXIS.constants) <= 1e5 * U**2 / height**4
    # An unknown: it is drawn to rounding only.
    assert np.allclose(placed["axis"].values, [float(c) for c in axis], rtol=4 * U, atol=0.0)


@given(seed=seeds, place=places)
def test_a_point_is_held_at_its_drawn_distance_on_its_drawn_side(seed: int, place: str) -> None:
    points = drawn(seed, place, 1.0)
    found, lacks, doubt = fractions(HELD.placed(alone(points))["held"])
    p = exact(points)
    axis, apart = scaled(minus(p["head"], p["tail"])), minus(p["end"], p["head"])
    squared = dot(apart, apart) / dot(axis, axis)
    # found = side sqrt(squared) + e  gives  found^2 - squared = 2 found e - e^2
    error = ((found + lacks) ** 2 - squared) / (2 * (found + lacks)) if squared else found
    assert found * (1 if dot(apart, axis) >= 0 else -1) >= 0
    assert abs(error) <= doubt * Fraction(101, 100)
    assert abs(lacks) <= 5 * U * abs(found)


@pytest.mark.parametrize("thin", [(-15.0, -14.0), (-14.0, -6.0), (-6.0, 0.0)])
def test_weights_of_carriers_however_nearly_in_line_are_within_their_doubt(thin: tuple[float, float]) -> None:
    shares = []
    for seed in range(200):
        rng = np.random.default_rng(seed)
        base, along, rider = rng.normal(size=(3, 3))
        second = base + along * rng.uniform(0.5, 2.0) + 10.0 ** rng.uniform(*thin) * rng.normal(size=3)
        points = {"base": base, "first": base + along, "second": second, "rider": rider}
        try:
            found = carrier_weights(alone(points), "rider", BODY)
        except MechanismError:
            continue
        p = exact(points)
        target = minus(p["rider"], p["base"])
        for meant, *parts in zip(by_cramer(p, target), *(part.tolist() for part in found), strict=True):
            value, lacks, doubt = map(Fraction, parts)
            assert abs(meant - value - lacks) <= doubt, seed
            shares.append(float(abs(meant - value - lacks) / doubt))
    assert len(shares) > 150
    assert max(shares) > 1e-4


def test_links_know_the_squares_of_their_lengths_to_their_doubt() -> None:
    rng, kept = np.random.default_rng(3), link("a", "b")
    # Of very different sizes, so that the differences are rounded too.
    cars = {name: rng.uniform(-1.0, 1.0, (40, 3)) * 10.0 ** rng.uniform(-4.0, 0.0, (40, 3)) for name in "ab"}
    ((_, (values, lacks, doubt)),) = kept.placed(Drawing(cars, np.ones(40))).items()
    square = ((exactly(cars["a"]) - exactly(cars["b"])) ** 2).sum(axis=1)
    assert (np.abs(exactly(values) + exactly(lacks) - square) <= exactly(doubt)).all()
    assert (np.abs(lacks) <= 5 * U * square).all()
    assert (doubt <= 1e3 * U**2 * square).all()


def test_a_point_on_a_line_stands_at_its_foot_up_to_235_of_its_lengths() -> None:
    # (3, 0, 6) . (2, 1, 2) = 18 over 9, and -24 over 16
    a, b, c = (
        [[1.0, 2.0, 3.0], [0.0, 1.0, 0.0]],
        [[3.0, 3.0, 5.0], [4.0, 1.0, 0.0]],
        [[4.0, 2.0, 9.0], [-6, 9, 7]],
    )
    both = {name: np.array(place, float) for name, place in (("a", a), ("b", b), ("c", c))}
    assert LINE.placed(Drawing(both, np.ones(2)))["ratio"].values.tolist() == [2.0, -1.5]
    with pytest.raises(MechanismError, match="a - b has no length"):
        LINE.placed(Drawing({**both, "b": both["a"]}, np.ones(2)))
    # A turn by 1 rad takes 0.036 R^2 proven steps, and a path may have 2000.
    assert 0.036 * FARTHEST**2 <= 2000.0 < 0.036 * (FARTHEST + 1.0) ** 2
    near = {"a": np.zeros(3), "b": np.array([2.0, 0.0, 0.0])}
    for sign in (1.0, -1.0):
        LINE.placed(alone({**near, "c": np.array([2.0 * sign * FARTHEST, 5.0, 0.0])}))
        with pytest.raises(MechanismError) as caught:
            LINE.placed(Drawing({**near, "c": np.array([sign * 500.0, 5.0, 0.0])}, np.array(100.0)))
        # Times 100 mm: 2 apart, 500 along, and 500 / 235 = 2.13
        for words in ("200 mm apart", "5e+04 mm along", "250 times as far", "most 235 times", "2.1e+02"):
            assert words in str(caught.value)


@pytest.mark.parametrize("scene", ["bounce", "pushrod", "five-link", "axle-steer"])
def test_no_error_of_the_carriers_moves_a_carried_point_farther_than_the_gain(scene: str) -> None:
    mechanism, off = scene_mechanism(Scene.load(scene)), 1e-6  # what is quadratic in it is below the slack
    signs = np.random.default_rng(5).choice([-1.0, 1.0], size=(2000, len(mechanism.drawn)))
    there, moved = (mechanism.places(y) for y in (mechanism.drawn, mechanism.drawn + off * signs))
    farthest = (
        max(float(np.abs(moved[name] - there[name]).max()) for name in mechanism.topology.carried) / off
    )
    # Among 2,000 corners of the cube of errors some come near the farthest.
    assert 0.5 * mechanism.carried_gain < farthest <= mechanism.carried_gain * (1.0 + 1e-4)
