"""Lines of a solved motion, and what they claim to be off by, from the turns and places they are made of."""

import numpy as np
import pytest
from numpy.typing import NDArray

import absolute
from absolute.estimate import Errors
from absolute.lines import SolvedLines
from absolute.mechanism import Mechanism

Array = NDArray[np.float64]
EPS = float(np.finfo(float).eps)
COUNT = 5


def solved_lines(model: absolute.Model, turn: float, place: float) -> SolvedLines:
    """At random poses, with turns and places that are off by up to so much."""
    mechanism, random = Mechanism(model), np.random.default_rng(3)
    drawn = mechanism.poses(mechanism.drawn).rotation
    q = [
        mechanism.moved(mechanism.drawn, drawn, 0.3 * random.normal(size=mechanism.stack.count))
        for _ in range(COUNT)
    ]
    turns = {body: turn * random.uniform(0.1, 1.0, (COUNT, 3)) for body in model.moving}
    places = {point: place * random.uniform(0.1, 1.0, (COUNT, 3)) for point in model.points}
    return SolvedLines(mechanism, *mechanism.poses(np.array(q)), Errors(places, {}, {}, turns, {}, {}))


def body_of(model: absolute.Model, ends: tuple[str, str]) -> str:
    return next(body for body in model.moving if set(ends) <= set(model.bodies[body]))


def lines_of(model: absolute.Model) -> list[tuple[str, str]]:
    """The first and the last point of each moving body."""
    return [
        (model.bodies[body][0], model.bodies[body][-1]) for body in model.moving if model.bodies[body][1:]
    ]


def test_a_line_of_a_body_is_as_drawn_and_turned(model: absolute.Model) -> None:
    lines = solved_lines(model, 0.0, 0.0)
    for start, end in lines_of(model):
        index = lines.mechanism.drawing.bodies[body_of(model, (start, end))]
        drawn = np.subtract(model.points[end], model.points[start])
        found = lines.line((start, end))
        # Two roundings of the drawing, a rotation and three products.
        assert np.abs(found - lines.rotation[:, index] @ drawn).max() <= 16 * EPS * np.linalg.norm(drawn)


def test_a_line_is_off_by_the_worst_its_body_may_be_turned_by(model: absolute.Model) -> None:
    # Places are off by so much more that they tell nothing of a line.
    lines = solved_lines(model, 1e-9, 1.0)
    for ends in lines_of(model):
        along, turn = lines.line(ends), lines.errors.rotation[body_of(model, ends)]
        worst = np.zeros_like(along)
        for signs in np.array(np.meshgrid(*[(-1.0, 1.0)] * 3)).reshape(3, -1).T:
            worst = np.maximum(worst, np.abs(np.cross(signs * turn, along)))
        rounding = 32 * EPS * np.linalg.norm(along, axis=1)[:, None]
        claim = lines.error(ends)
        assert (claim >= worst).all()
        assert (claim <= worst + rounding).all()


def test_a_line_of_an_exact_body_is_off_by_its_roundings(model: absolute.Model) -> None:
    lines = solved_lines(model, 0.0, 1.0)
    for ends in lines_of(model):
        along = np.abs(lines.line(ends))
        # Four standard deviations of thirteen roundings of its length (see test_rounding), and two of each
        # component where it becomes millimetres.
        arms = 4.0 * np.sqrt(13 / 18) * EPS / 2.0 * np.linalg.norm(along, axis=1)[:, None]
        assert lines.error(ends) == pytest.approx(arms + EPS * along, rel=1e-9, abs=0.0)


def test_a_line_is_off_by_no_more_than_its_ends(model: absolute.Model) -> None:
    lines = solved_lines(model, 1.0, 1e-9)
    for ends in lines_of(model):
        places = lines.errors.position
        claim = lines.error(ends)
        assert (claim >= places[ends[0]] + places[ends[1]]).all()
        assert (claim <= places[ends[0]] + places[ends[1]] + 64 * EPS * lines.mechanism.drawing.size).all()


def test_a_line_of_the_chassis_is_as_drawn_to_a_rounding(model: absolute.Model) -> None:
    lines = solved_lines(model, 1.0, 1.0)
    ends = model.bodies[model.chassis][0], model.bodies[model.chassis][1]
    drawn = np.subtract(model.points[ends[1]], model.points[ends[0]])
    assert lines.line(ends) == pytest.approx(np.tile(drawn, (COUNT, 1)), rel=2 * EPS, abs=0.0)
    assert lines.error(ends) == pytest.approx(EPS * np.abs(np.tile(drawn, (COUNT, 1))), rel=1e-9, abs=0.0)


def test_a_line_between_bodies_leads_from_place_to_place(model: absolute.Model) -> None:
    lines = solved_lines(model, 1.0, 1e-9)
    drawing, bodies = lines.mechanism.drawing, lines.mechanism.drawing.bodies
    wheel = next(body for body in model.moving if "wheel_centre" in model.bodies[body])
    chassis = model.bodies[model.chassis][0]
    assert chassis not in model.bodies[wheel]
    found = lines.line((chassis, "wheel_centre"))
    arm = drawing.arm(wheel, "wheel_centre")
    place = lines.origin[:, bodies[wheel]] + lines.rotation[:, bodies[wheel]] @ arm
    there = place * drawing.size + drawing.middle
    assert np.abs(found - (there - model.points[chassis])).max() <= 32 * EPS * drawing.size
    places = lines.errors.position
    sums = places[chassis] + places["wheel_centre"]
    assert (lines.error((chassis, "wheel_centre")) >= sums).all()
    assert (lines.error((chassis, "wheel_centre")) <= sums + 64 * EPS * drawing.size).all()
