"""What programs are told of a suspension: how far its arm is turned, and which assembly is the drawing's."""

from collections.abc import Iterator
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from sample_cars import SAMPLES, SampleCar
from suspensions_in_closed_form import FORMS, ClosedForm, rounded

from validate.peers.linkage import Linkage, PeerError, linkage_of

EPS = float(np.finfo(float).eps)


@pytest.fixture(autouse=True)
def digits() -> Iterator[None]:
    with mpmath.workdps(30):
        yield


def of_sample(car: SampleCar, **points: tuple[float, float, float]) -> Linkage:
    return linkage_of(car.type, {**car.points, **points}, (0, 0, 1), (0, 1, 0), car.closure)


def of_form(car: Any, form: ClosedForm) -> Linkage:
    points = {name: [float(c) for c in place] for name, place in car.points.items()}
    return linkage_of(form.type, points, [float(c) for c in car.up], [float(c) for c in car.right])


@pytest.mark.parametrize("form", FORMS, ids=lambda form: form.type)
@given(data=st.data())
def test_every_assembly_but_the_drawings_is_told_apart(form: ClosedForm, data: st.DataObject) -> None:
    """The closed form has two answers in each of three steps; the side of the arm is told by its turn."""
    car = rounded(data.draw(form.cars), form)
    linkage, (theta, travel) = of_form(car, form), car.drawn
    wanted = car.drawn_sides
    seen = 0
    for pose in car.poses(theta, travel + Fraction(1, 8)):
        if pose.sides[0] != wanted[0]:
            continue
        places = {
            n: (np.array([float(c) for c in pose.points[n]]) - linkage.origin) / linkage.unit
            if n in pose.points
            else linkage.drawn[n]
            for n in linkage.drawn
        }
        margin = np.abs(linkage.sides(places)).min()
        if margin > 1e-6:  # nearer to where two meet the places are rounded to either side
            seen += 1
            assert bool(linkage.on_other_side(places)) == (pose.sides != wanted), pose.sides
    assert seen


@pytest.mark.parametrize("form", FORMS, ids=lambda form: form.type)
@given(data=st.data(), away=st.floats(-0.3, 0.3), rate=st.floats(-3.0, 3.0), bend=st.floats(-9.0, 9.0))
def test_the_turn_of_the_arm_and_its_rates_are_those_of_the_closed_form(
    form: ClosedForm, data: st.DataObject, away: float, rate: float, bend: float
) -> None:
    car = rounded(data.draw(form.cars), form)
    linkage, start = of_form(car, form), float(car.drawn[0]) + away
    try:
        turn, off = linkage.turns(np.array([[start, rate, bend]]))
    except PeerError:
        return
    p = {n: [mpmath.mpf(c.numerator) / c.denominator for c in place] for n, place in car.points.items()}
    front, rear, ball = (
        mpmath.matrix(p[n]) for n in ("lower_arm_front", "lower_arm_rear", "lower_ball_joint")
    )
    n, r = (rear - front) / mpmath.norm(rear - front), ball - front
    up = mpmath.matrix([mpmath.mpf(c.numerator) / c.denominator for c in car.up])
    along = n * (n.T * r)[0]
    across = r - along
    turned = mpmath.matrix([n[1] * r[2] - n[2] * r[1], n[2] * r[0] - n[0] * r[2], n[0] * r[1] - n[1] * r[0]])
    d = mpmath.norm(r)

    def height(phi: mpmath.mpf) -> mpmath.mpf:
        return (up.T * (along + across * mpmath.cos(phi) + turned * mpmath.sin(phi)))[0]

    def phi_at(t: mpmath.mpf) -> mpmath.mpf:
        theta = mpmath.mpf(start) + mpmath.mpf(rate) * t + mpmath.mpf(bend) * t * t / 2
        return mpmath.findroot(lambda phi: height(phi) - d * mpmath.cos(theta), mpmath.mpf(turn[0, 0]))

    exact = [phi_at(mpmath.mpf(0)), *(mpmath.diff(phi_at, 0, k) for k in (1, 2))]
    # A numerical derivative of 30 digits keeps 10 of them in the second.
    for found, known, room in zip(turn[0], exact, off[0], strict=True):
        assert abs(found - float(known)) <= room + 1e-9 * EPS + 1e-13 * abs(found)


@pytest.mark.parametrize("car", SAMPLES, ids=lambda car: car.name)
def test_the_drawing_is_turned_by_nothing(car: SampleCar) -> None:
    linkage = of_sample(car)
    theta = car.drawn_inputs["arm_angle"]
    turn, off = linkage.turns(np.array([[theta, 0.0, 0.0]]))
    # The angle is rounded, and so is its cosine.
    assert (np.abs(turn) <= off + 4.0 * EPS).all()
    assert np.allclose(linkage.drawn_inputs[1] * linkage.unit, car.drawn_inputs["rack"], rtol=0, atol=1e-12)


def test_what_makes_no_mechanism_is_told_by_name() -> None:
    strut, wishbone = SAMPLES[1], SAMPLES[2]
    front = strut.points["lower_arm_front"]
    with pytest.raises(PeerError, match="lower_arm_front and lower_arm_rear are at the same place"):
        of_sample(strut, lower_arm_rear=front)
    with pytest.raises(PeerError, match="strut_lower and strut_top are at the same place"):
        of_sample(strut, strut_lower=strut.points["strut_top"])
    with pytest.raises(PeerError, match="no multi_link"):
        linkage_of("multi_link", wishbone.points, (0, 0, 1), (0, 1, 0))
    rear = (front[0] + 100.0, front[1], front[2])
    straight_down = (front[0], front[1], front[2] - 300.0)
    dead = of_sample(strut, lower_arm_rear=rear, lower_ball_joint=straight_down)
    with pytest.raises(PeerError, match="dead point"):
        dead.turns(np.array([[3.0, 0.0, 0.0]]))


def test_a_height_beyond_the_arms_reach_is_refused_at_its_instant() -> None:
    linkage = of_sample(SAMPLES[1])
    theta = np.stack([np.linspace(1.6, 0.01, 5), np.zeros(5), np.zeros(5)], axis=-1)
    with pytest.raises(PeerError, match="does not reach such a height") as caught:
        linkage.turns(theta)
    assert caught.value.instant == 4
    theta[2, 0] = 3.2
    with pytest.raises(PeerError, match="outside 0 to pi") as caught:
        linkage.turns(theta)
    assert caught.value.instant == 2


def test_a_drawing_where_two_assemblies_meet_is_refused() -> None:
    car = SAMPLES[2]
    # The tie rod's outer end on the line from the ball joint to its inner end.
    inner, ball = (np.array(car.points[n]) for n in ("tie_rod_inner", "lower_ball_joint"))
    x, y, z = (ball + 0.25 * (inner - ball)).tolist()
    linkage = of_sample(car, tie_rod_outer=(x, y, z))
    with pytest.raises(PeerError, match="two assemblies meet"):
        linkage.on_other_side(linkage.drawn)
