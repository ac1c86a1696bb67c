"""The axis that a body carries: its constants against rational arithmetic, wherever the axis passes."""

from fractions import Fraction

import numpy as np
from hypothesis import assume, given
from hypothesis import strategies as st
from numpy.typing import NDArray

from pointcoord.linkage.constraints.in_body import AxisInBody, Normal
from pointcoord.linkage.constraints.on_line import OnLine
from pointcoord.linkage.drawing import Drawing, Placed
from validate.reference.vectors import Vector, cross, dot, minus, times

Array = NDArray[np.float64]
U = 2.0**-53
BODY = Normal("n", "base", "first", "second")
AXIS = AxisInBody("axis", "tail", "head", BODY)
HELD = OnLine("end", "head", "axis", "axis", "held", "held", axis=AXIS)


def exact(vector: Array) -> Vector:
    x, y, z = map(Fraction, vector.tolist())
    return x, y, z


def drawn(seed: int, place: str, height: float) -> dict[str, Array]:
    """Six points: a triangle of some height, an axis somewhere in or beside it, a point near the axis."""
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


places = st.sampled_from(["anywhere", "an edge", "the normal"])


@given(seed=st.integers(0, 2**32 - 1), place=places, power=st.floats(-6.0, 0.0))
def test_the_place_of_an_axis_in_its_body_is_right_to_its_stated_doubt(
    seed: int, place: str, power: float
) -> None:
    points = drawn(seed, place, 10.0**power)
    assume(np.linalg.norm(points["head"] - points["tail"]) > 1e-3)
    placed = AXIS.placed(Drawing(points, np.array(1.0)))
    direction, constants = placed["axis"], [placed[name] for name in AXIS.constants]
    base, first, second, tail, head = (exact(points[n]) for n in ("base", "first", "second", "tail", "head"))
    scale = _scale(minus(head, tail))
    axis = times(minus(head, tail), scale)
    e1, e2 = minus(first, base), minus(second, base)
    frame = [e1, e2, cross(e1, e2)]
    volume = dot(frame[0], cross(frame[1], frame[2]))
    for i in range(3):
        columns = [axis if j == i else frame[j] for j in range(3)]
        _is_right(constants[i], dot(columns[0], cross(columns[1], columns[2])) / volume)
    # The doubt is of the order of u^2, so that it never shows beside the rounding of a pose.
    height = np.linalg.norm(np.cross(points["first"] - points["base"], points["second"] - points["base"]))
    assert max(float(each.doubt) for each in constants) <= 1e5 * U**2 / height**4
    # An unknown: it is drawn to rounding only.
    assert np.allclose(direction.values, [float(c) for c in axis], rtol=4 * U, atol=0.0)


@given(seed=st.integers(0, 2**32 - 1), place=places)
def test_a_point_is_held_at_its_drawn_distance_on_its_drawn_side(seed: int, place: str) -> None:
    points = drawn(seed, place, 1.0)
    assume(np.linalg.norm(points["head"] - points["tail"]) > 1e-3)
    held = HELD.placed(Drawing(points, np.array(1.0)))["held"]
    tail, head, end = (exact(points[n]) for n in ("tail", "head", "end"))
    scale = _scale(minus(head, tail))
    axis = times(minus(head, tail), scale)
    squared = dot(minus(end, head), minus(end, head)) / dot(axis, axis)
    side = 1 if dot(minus(end, head), axis) >= 0 else -1
    found, lacks, doubt = _numbers(held)
    # found = side sqrt(squared) + e  gives  found^2 - squared = 2 found e - e^2
    error = ((found + lacks) ** 2 - squared) / (2 * (found + lacks)) if squared else found
    assert found * side >= 0
    assert abs(error) <= doubt * Fraction(101, 100)
    assert abs(lacks) <= 5 * U * abs(found)


def _scale(vector: Vector) -> Fraction:
    """The power of two that brings a length between 1/2 and 1."""
    scale, squared = Fraction(1), dot(vector, vector)
    while scale * scale * squared >= 1:
        scale /= 2
    while scale * scale * squared < Fraction(1, 4):
        scale *= 2
    return scale


def _numbers(placed: Placed) -> list[Fraction]:
    return [Fraction(float(part)) for part in placed]


def _is_right(placed: Placed, meant: Fraction) -> None:
    found, lacks, doubt = _numbers(placed)
    assert abs(found + lacks - meant) <= doubt
    assert abs(lacks) <= 5 * U * abs(found)
