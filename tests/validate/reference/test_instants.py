"""What an instant says of itself: how alone it is, how far its numbers may be off, which effects it has."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import pytest
from flint import arb, ctx
from mpmath import mpf
from reference_cars import ReferenceCar

from validate.reference import NotDecidedError
from validate.reference.effects.effect import Effect
from validate.reference.effects.registry import EFFECTS
from validate.reference.exact import as_fraction, bits
from validate.reference.instant import prove_instant, prove_pose
from validate.reference.route import CLEAR, reached
from validate.reference.vectors import minus


def anything(_: Sequence[arb]) -> bool:
    """Whichever assembly is found."""
    return True


def start_of(car: ReferenceCar) -> list[arb]:
    """The unknowns of its pose without motion."""
    design = car.design
    return list(reached(design, CLEAR, design.driven(car.still)).pose.unknown)


ORDERS = ("position", "velocity", "acceleration", "angular_velocity", "angular_acceleration")


def test_the_radius_of_an_instant_is_half_that_of_the_box_that_is_proven(car: ReferenceCar) -> None:
    found = car.solve(car.still, digits=40)
    with ctx.workprec(bits(found.digits)):
        box = prove_pose(car.known(), start_of(car), anything, 40, found.digits).radius * car.design.unit
    # So wherever in the middle of the box the answer is, the ball about it lies inside; rounded once.
    assert abs(2 * as_fraction(found.radius, "radius") - box) <= box / 10**40


def test_numbers_of_few_digits_are_off_by_no_more_than_they_say(car: ReferenceCar) -> None:
    few, many = (car.solve(car.inputs, digits=digits) for digits in (15, 120))
    for quantity in ORDERS:
        limit = few.error_bound[quantity] + many.error_bound[quantity]
        off = max(
            abs(a - b)
            for name, vector in getattr(few, quantity).items()
            for a, b in zip(vector, getattr(many, quantity)[name], strict=True)
        )
        assert 0 < off <= limit
        largest = max(abs(x) for vector in getattr(many, quantity).values() for x in vector)
        assert few.error_bound[quantity] <= largest * mpf("1e-15")


def test_another_assembly_than_the_expected_one_is_not_taken(car: ReferenceCar) -> None:
    with ctx.workprec(bits(60)):
        known = car.design.known(car.design.driven(car.still))
        prove_instant(car.design, known, start_of(car), anything, 40, 60)
        with pytest.raises(NotDecidedError, match="the assembly found"):
            prove_instant(car.design, known, start_of(car), lambda _: False, 40, 60)


@pytest.mark.parametrize(("size", "given"), [(0.9, True), (1.1, False), (1.9, False)])
def test_an_effect_that_has_not_the_digits_asked_for_is_left_out(
    car: ReferenceCar, size: float, given: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    ball = arb(2, size * 1e-30)
    made_up = Effect("made_up", "rad", (), lambda _: ball)
    monkeypatch.setitem(EFFECTS, made_up.name, made_up)
    found = car.solve(car.still, digits=30, effects=[made_up.name])
    assert ("made_up" in found.effects) == given
    if given:
        assert found.effects["made_up"] == 2
        # A ball keeps its radius to 30 bits, rounded up.
        assert found.error_bound["effects"] == pytest.approx(size * 1e-30, rel=1e-8)
        assert found.error_bound["effects"] >= Fraction(9, 10) * mpf("1e-30")


def test_a_car_at_rest_has_rates_of_exactly_zero_and_heave_alone_turns_nothing(car: ReferenceCar) -> None:
    rest, lifted = car.solve(car.still), car.solve({**car.still, "heave": (12.5, 3.0, -7.0)})
    assert {x for v in (*rest.velocity.values(), *rest.acceleration.values()) for x in v} == {0}
    assert {x for omega in rest.angular_velocity.values() for x in omega} == {0}
    for name in rest.position:
        assert max(abs(x) for x in minus(lifted.velocity[name], (0, 0, 3))) < mpf("1e-57")
        assert max(abs(x) for x in minus(lifted.acceleration[name], (0, 0, -7))) < mpf("1e-57")
    assert all(abs(x) < mpf("1e-57") for omega in lifted.angular_velocity.values() for x in omega)
