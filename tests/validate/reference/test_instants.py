"""An instant: the right assembly, its error bounds, its effects."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import Any

import pytest
from flint import arb, ctx
from mechanism_drawings import ReferenceCar, described
from mechanism_files import plain_scene
from mpmath import mpf

from validate.reference import Design, NotDecidedError, instants_of
from validate.reference.effects.car import Effect
from validate.reference.effects.registry import EFFECTS
from validate.reference.exact import bits
from validate.reference.instant import prove_instant
from validate.reference.route import CLEAR, reached

ORDERS = ("position", "velocity", "acceleration", "angular_velocity", "angular_acceleration")


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


def test_another_assembly_than_the_one_followed_is_not_taken(car: ReferenceCar) -> None:
    design, driven = car.design, car.design.driven(car.still)
    pose = reached(design, CLEAR, driven).pose
    elsewhere = replace(pose, unknown=[(x + arb("1e-3")).mid() for x in pose.unknown])
    with ctx.workprec(bits(60)):
        prove_instant(design, driven, pose, 40)
        narrow = replace(elsewhere, reach=[arb("1e-4")] * len(pose.unknown))
        with pytest.raises(NotDecidedError, match="the assembly found"):
            prove_instant(design, driven, narrow, 40)


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


# A wheel on an arm about a line across the car.
HINGE = {"pivot": (600, 400, 350), "end": (600, 500, 350)}
WHEEL = {"inner": (964, 652, 275), "centre": (1000, 700, 300)}


def effects_of(plain: dict[str, Any], **inputs: Fraction | int) -> set[str]:
    """The effects at rest."""
    still = {name: (value, 0, 0) for name, value in inputs.items()}
    return set(next(instants_of(Design.from_plain(plain), [still], effects=EFFECTS)).effects)


def test_of_a_spin_axis_alone_there_is_what_is_made_of_it() -> None:
    bodies, roles = {"chassis": [*HINGE], "arm": [*HINGE, *WHEEL]}, {"wheel_axis": [*WHEEL]}
    swing = {"swing": {"angle": "arm", "from": "drawing"}}
    of_the_axis = {"camber", "toe", "camber_by_arcsine", "toe_by_arcsine", "steer_angle"}
    of_the_axis |= {"toe_change_by_arcsine", "travel"}
    along = {f"{name}_{way}" for name in of_the_axis for way in ("by_travel", "by_time")}
    assert effects_of(described(HINGE | WHEEL, bodies, swing, roles=roles), swing=0) == of_the_axis | along


def test_two_inputs_that_move_the_wheel_leave_no_gradient_by_its_travel() -> None:
    plain = plain_scene("double-wishbone", ["arm_angle"], wheel_radius=290)
    plain["inputs"] |= {"gap": {"distance": ["tie_rod_outer", "upper_arm_front"]}}
    found = effects_of(plain, arm_angle=Fraction(3, 2), gap=400)
    assert "camber" in found
    assert not [one for one in found if one.endswith(("_by_travel", "_by_rack")) or "roll_centre" in one]
