"""A way is followed in few steps, however thin a body or long a rod, and each step holds its solution."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from fractions import Fraction

import pytest
from flint import arb, arb_poly, ctx
from reference_cars import CARS, ReferenceCar

from validate.reference import closed_drawing, route
from validate.reference.design import Design, values_only
from validate.reference.exact import as_fraction
from validate.reference.route import closed, reached
from validate.reference.vectors import Vector, dot, minus, plus, times
from validate.reference.way import Way, proven_tube, series_of, start_pose

# Each car takes as many when it is neither thin nor long; one more would be a surprise.
STEPS = 2


Change = Callable[[Mapping[str, Vector], Fraction], dict[str, Vector]]


def assembled(car: ReferenceCar) -> dict[str, Vector]:
    """Its points where its drawing closes, each coordinate the nearest double."""
    instant = closed_drawing(car.design).instant
    places = ((name, instant.position_as_float(name)) for name in car.points)
    return {name: (Fraction(x), Fraction(y), Fraction(z)) for name, (x, y, z) in places}


def thin_knuckle(p: Mapping[str, Vector], share: Fraction) -> dict[str, Vector]:
    """The tie rod's outer end near the line through two other points of the knuckle."""
    base, end = p["lower_ball_joint"], p["tie_rod_outer"]
    line = minus(p["upper_ball_joint" if "upper_ball_joint" in p else "strut_lower"], base)
    foot = plus(base, times(line, dot(minus(end, base), line) / dot(line, line)))
    return {**p, "tie_rod_outer": plus(foot, times(minus(end, foot), share))}


def long_arm(p: Mapping[str, Vector], share: Fraction) -> dict[str, Vector]:
    """The pivots of the lower arm farther from its ball joint."""
    base = p["lower_ball_joint"]
    far = ((name, minus(p[name], base)) for name in ("lower_arm_front", "lower_arm_rear"))
    return {**p, **{name: plus(base, times(way, 1 / share)) for name, way in far}}


@pytest.mark.parametrize("changed", [thin_knuckle, long_arm])
@pytest.mark.parametrize("power", [0, 6, 12])
@pytest.mark.parametrize("name", ["double wishbone", "collinear strut"])
def test_a_way_takes_no_more_steps_however_thin_a_knuckle_is_or_long_an_arm(
    name: str, power: int, changed: Change, monkeypatch: pytest.MonkeyPatch
) -> None:
    share = Fraction(1, 10**power)
    car = replace(CARS[name], points=changed(assembled(CARS[name]), share))
    monkeypatch.setattr(route, "MOST_STEPS", STEPS)
    drawn = closed_drawing(car.design, clearness=0.0).inputs
    ahead = {"arm_angle": share / 20, "rack": 10 * share}
    inputs = {n: (as_fraction(drawn[n], n) + more, 0, 0) for n, more in ahead.items()}
    assert reached(car.design, 0.0, car.design.driven(inputs)).pose.t == 1


def way_of_the_rack(design: Design, car: ReferenceCar) -> Way:
    """From the drawing to half of the last rack travel."""
    begin = values_only(design.known_as_drawn())
    end = values_only(design.known(design.driven({**car.still, "rack": (car.last_rack / 2, 0, 0)})))
    return Way(begin.equations, begin.numbers, [begin.numbers[0], end.numbers[1]])


@pytest.mark.parametrize("off", ["0", "1e-9", "1e-3"])
def test_a_step_holds_the_solution_all_along_or_is_not_proven(car: ReferenceCar, off: str) -> None:
    with ctx.workprec(212):
        way = way_of_the_rack(car.design, car)
        pose = start_pose(way, closed(car.design).pose.unknown, arb(0))
        series = series_of(way, pose, 7)
        # A series that is off makes the tube wider, or none: never one beside the solution.
        planted = [one + arb_poly([0, 0, arb(off).mid()]) for one in series]
        tube = proven_tube(way, pose.t, planted, pose.t, arb(0.125))
        assert tube is not None or off == "1e-3"
        if tube is not None:
            for t in (arb(k) / 32 for k in range(5)):
                right = start_pose(way, [one(t) for one in series], t)
                assert tube.holds(t, right.box)
