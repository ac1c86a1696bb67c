"""A guess names the assembly that it is clearly nearer to than to any other, and points out no other way."""

from __future__ import annotations

from fractions import Fraction

import pytest
from flint import ctx
from reference_cars import CARS, OFF_AXIS, ReferenceCar

from validate.reference import (
    AmbiguousAssemblyError,
    BadInputError,
    InfeasibleError,
    closed_drawing,
    count_assemblies,
    sensitivities,
    solve_reference,
)
from validate.reference.candidates import every_candidate
from validate.reference.exact import as_fraction, bits, centre_of
from validate.reference.linkage import Candidate, Choices
from validate.reference.vectors import Vector, minus, plus, times

Places = dict[str, Vector]


def apart(one: Places, other: Places) -> Fraction:
    return max(abs(x) for name in one for x in minus(one[name], other[name]))


def assemblies(car: ReferenceCar) -> list[tuple[Choices, Places]]:
    """Every assembly at the car's inputs, mm, the drawing's own first and then the nearer the sooner."""
    design = car.design

    def places(candidate: Candidate) -> Places:
        found = {}
        for name, ball in candidate.points.items():
            x, y, z = (as_fraction(centre_of(c), name) for c in ball)
            found[name] = plus(design.origin, times((x, y, z), design.unit))
        return found

    with ctx.workprec(bits(60)):
        every = [
            (one.choices, places(one)) for one in every_candidate(car.known()) if max(one.gaps.values()) < 0
        ]
    own = car.solve(car.still).choices
    start = next(place for choices, place in every if choices == own)
    return sorted(every, key=lambda row: apart(row[1], start))


@pytest.mark.parametrize(
    ("share", "found"), [("0", 0), ("0.3", 0), ("0.36", None), ("0.6", None), ("0.7", 1), ("1", 1)]
)
def test_a_guess_must_be_half_as_far_from_the_wanted_assembly_as_from_the_next(
    car: ReferenceCar, share: str, found: int | None
) -> None:
    pair = assemblies(car)[:2]
    (own, here), (_, there) = pair
    assert own == car.solve(car.still).choices
    guess = {n: plus(here[n], times(minus(there[n], here[n]), Fraction(share))) for n in here}
    if found is None:
        with pytest.raises(AmbiguousAssemblyError, match=r"limit 0\.5; name more points in the guess"):
            car.solve(car.still, guess=guess)
        return
    instant = car.solve(car.still, guess=guess)
    assert instant.choices == pair[found][0]
    for name, place in pair[found][1].items():
        for got, want in zip(instant.position[name], place, strict=True):
            assert abs(as_fraction(got, name) - want) < Fraction(1, 10**50)


def test_a_guess_next_to_a_pose_that_cannot_be_reached_is_told_that_it_cannot() -> None:
    car = CARS["collinear strut"]
    near = car.solve({**car.still, "rack": (130, 0, 0)})
    guess = {name: near.position_as_float(name) for name in car.points}
    assert car.solve({**car.still, "rack": (130, 0, 0)}, guess=guess).choices == near.choices
    with pytest.raises(InfeasibleError, match="less rack travel"):
        car.solve({**car.still, "rack": (200, 0, 0)}, guess=guess)


def test_a_point_that_no_car_has_is_no_guess(car: ReferenceCar) -> None:
    with pytest.raises(BadInputError, match="guess is 'hub'; allowed is names among lower_arm_front, "):
        car.solve(car.still, guess={"hub": (0, 0, 0)})


def test_axes_that_are_left_out_are_y_to_the_right_and_z_up_and_the_side_the_left_one() -> None:
    axes = {"up": (0, 0, 1), "right": (0, 1, 0), "side": "left"}
    inputs = CARS["strut as drawn"].inputs
    still = CARS["strut as drawn"].still
    assert solve_reference(OFF_AXIS, inputs) == solve_reference(OFF_AXIS, inputs, **axes)
    assert closed_drawing(OFF_AXIS) == closed_drawing(OFF_AXIS, **axes)
    assert sensitivities(OFF_AXIS, still) == sensitivities(OFF_AXIS, still, **axes)
    few = {"starts": 3, "seed": 2}
    assert count_assemblies(OFF_AXIS, still, **few) == count_assemblies(OFF_AXIS, still, **few, **axes)
