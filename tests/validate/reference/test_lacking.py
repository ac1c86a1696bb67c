"""A car has exactly the effects for which it has all that they need."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from mechanism_drawings import described
from mechanism_files import plain_scene

from validate.reference import Design, instants_of
from validate.reference.effects.registry import EFFECTS

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
