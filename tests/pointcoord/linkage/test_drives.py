"""How an input becomes a known coordinate: against many digits, with all that is said of what is lost.

Its rates are in every velocity (see tests/pointcoord/test_every_way.py).
"""

from collections.abc import Callable
from typing import Any

import mpmath
import numpy as np
import pytest
from changed_scenes import scene_with
from mpmath import mpf

from pointcoord import InputOutOfRange, Scene, simulate
from pointcoord.linkage.constraints.on_line import Line
from pointcoord.linkage.drawing import Drawing
from pointcoord.linkage.drives import Drive, arm_angle, distance_of, travel, travel_along, turned_by
from pointcoord.results.motion import Motion

U = 2.0**-53
UNIT = 256.0
ARM = arm_angle("rise", "arm_angle", "pivot", "ball", "up")
RACK = travel("travel", "rack", "centre", "inner", "right")


def drawn(seed: int) -> Drawing:
    points = np.random.default_rng(seed).uniform(-1.0, 1.0, (4, 3))
    vectors = dict(zip(("pivot", "ball", "centre", "inner"), points, strict=True))
    return Drawing(
        {**vectors, "up": np.array([0.0, 0.0, 1.0]), "right": np.array([0.0, 1.0, 0.0])}, np.array(UNIT)
    )


DRAWING = drawn(3)


def length_of(drawing: Drawing) -> mpf:
    ends = (drawing.vectors["pivot"].tolist(), drawing.vectors["ball"].tolist())
    return mpmath.sqrt(sum((mpf(p) - mpf(q)) ** 2 for p, q in zip(*ends, strict=True)))


# Each kind with its equation, and inputs that it takes: a smallest and a largest value, and half a range.
Equation = Callable[[Any], Any]
CASES: dict[str, tuple[Drive, Equation, tuple[float, float, float]]] = {
    "arm": (ARM, lambda x: length_of(DRAWING) * mpmath.cos(x), (0.6, 2.5, 0.5)),
    "travel": (RACK, lambda x: x / UNIT, (-90.0, 90.0, 8.0)),
    "travel along a line": (
        travel_along("place", "strut", Line("line", "pivot", "ball", between=True), "inner"),
        lambda x: x / (UNIT * length_of(DRAWING)),
        (200.0, 400.0, 8.0),
    ),
    "distance": (
        distance_of("distance", "apart", "pivot", "ball"),
        lambda x: x / UNIT,
        (200.0, 400.0, 8.0),
    ),
    "cosine of a turn": (turned_by("cosine", "turn", 0), mpmath.cos, (-9.0, 9.0, 0.5)),
    "sine of a turn": (turned_by("sine", "turn", 1), mpmath.sin, (-9.0, 9.0, 0.5)),
}
by_kind = pytest.mark.parametrize("kind", CASES)


def polynomial(terms: Any, t: Any) -> Any:
    return sum((term * t**k for k, term in enumerate(terms)), mpf(0))


@by_kind
def test_a_coordinate_is_right_to_its_stated_doubt(kind: str) -> None:
    drive, equation, (least, most, half) = CASES[kind]
    for x in np.random.default_rng(4).uniform(least, most, 20).tolist():
        (value,) = drive.series(np.array([x]), DRAWING)
        lacks, doubt = (float(part) for part in drive.rounding(np.array(value), DRAWING, 0.0))
        with mpmath.workdps(50):
            assert abs(mpf(float(value)) + mpf(lacks) - equation(mpf(x))) <= doubt
            # A constant of the drawing is some two roundings off; a function and a product are three.
            assert abs(lacks) <= 4.0 * U * abs(value)
            assert doubt <= 3.1 * U * abs(value)
            law = 1e-3 * half
            _, wide = drive.rounding(np.array(value), DRAWING, law)
            for off in (-law, law):
                assert abs(equation(mpf(x) + off) - mpf(float(value)) - lacks) <= float(wide)


@by_kind
# Of 4 terms most of the doubt is what they leave out; of 20 it is what they are rounded by.
@pytest.mark.parametrize("order", [4, 20])
def test_a_series_over_a_range_is_as_near_as_it_says_with_its_derivatives(kind: str, order: int) -> None:
    drive, equation, (least, most, half) = CASES[kind]
    shares: list[Any] = []
    for middle in np.linspace(least, most, 5).tolist():
        series, doubts = drive.series_over(np.array([middle]), np.array([half]), order, DRAWING)
        assert series.shape == (1, order + 1)
        lacks = float(drive.rounding(series[:, 0], DRAWING, 0.0)[0][0])
        with mpmath.workdps(50):
            terms = [mpf(float(term)) for term in series[0]]
            terms[0] += lacks
            for derivative, doubt in enumerate(doubts):
                worst = max(
                    abs(
                        mpmath.diff(lambda s, at=middle: equation(mpf(at) + half * s), s, derivative)
                        - polynomial(terms, s)
                    )
                    for s in map(mpf, np.linspace(-1.0, 1.0, 7).tolist())
                )
                terms = [k * term for k, term in enumerate(terms)][1:]
                assert worst <= float(doubt[0]) + 1e-30
                shares.append(worst / float(doubt[0]) if doubt[0] else 0.0)
    # What is left out depends on the middle: at some it is near the doubt.
    assert order > 4 or "turn" not in kind or max(shares) > 0.5


@pytest.mark.parametrize("angle", [-1e-3, 3.2, 90.0, 180.0, 181.0, 6.0, np.nan])
def test_an_angle_that_no_rise_tells_is_refused_and_degrees_are_seen(angle: float) -> None:
    for law in (np.array([angle, 1.0]), np.array([[1.0, 2.0], [angle, 1.0], [-5.0, 0.0]])):
        with pytest.raises(InputOutOfRange, match="0 to pi rad") as caught:
            ARM.series(law, DRAWING)
        assert caught.value.name == "arm_angle"
        assert np.array_equal(caught.value.value, angle, equal_nan=True)
        # More than a turn cannot be meant in radians, nor more than half a turn in degrees.
        in_degrees = angle in (90.0, 180.0)
        assert ("degrees" in str(caught.value)) == in_degrees
        if in_degrees:
            assert f"it is {np.pi * angle / 180.0:.10g} rad" in str(caught.value)


@pytest.mark.parametrize("distance", [0.0, -3.0, np.nan])
def test_a_distance_that_is_not_positive_is_refused(distance: float) -> None:
    drive, _, _ = CASES["distance"]
    with pytest.raises(InputOutOfRange, match="a distance above 0 mm"):
        drive.series(np.array([[distance, 1.0]]), DRAWING)


def turned_arm(polynomial: list[float]) -> Motion:
    parts = {"time": {"start": 0.0, "stop": 1.0, "samples": 9}, "effects": ["velocity", "knuckle_rates"]}
    return simulate(scene_with("semi-trailing-arm", inputs={"arm_turn": {"polynomial": polynomial}}, **parts))


def test_a_turn_is_right_handed_about_the_hinge_and_goes_round_as_often_as_it_says() -> None:
    points = Scene.load("semi-trailing-arm").mechanism.points
    inner, outer = (np.array(points[f"pivot_{end}"]) for end in ("inner", "outer"))
    hinge = (outer - inner) / np.linalg.norm(outer - inner)
    motion = turned_arm([0.0, 8.0 * np.pi])
    assert np.abs(motion.angular_velocity["arm"] - 8.0 * np.pi * hinge).max() < 1e-10
    there = motion.position["wheel_centre"]
    assert np.abs(there[-1] - there[0]).max() < 1e-9
    # An eighth of four rounds is half of one: the centre is across the hinge.
    arm = there[0] - inner
    across = 2.0 * (arm @ hinge) * hinge - arm + inner
    assert np.abs(there[1] - across).max() < 1e-9
    # A motion that starts rounds away from the drawing goes there round by round.
    assert np.abs(turned_arm([7.0 * np.pi]).position["wheel_centre"][0] - across).max() < 1e-9
