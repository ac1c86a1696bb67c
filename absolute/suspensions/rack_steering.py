"""A rack that slides to the right of the car, and the tie rod from it to the knuckle.

tie_rod_inner = rack_centre - rack * right (eqs. 13-15). A tie rod may spin about its own line without any
effect; here its ball at the rack is a universal joint, so its angular velocity along that line is a
convention.
"""

import numpy as np

from absolute.description import Axis, BranchSign, Input, Joint, plain, unit_of
from absolute.suspensions.suspension import Drawn

TIE_ROD = ("link tie_rod_inner - tie_rod_outer",)


def steering_joints(drawn: Drawn) -> dict[str, Joint]:
    """Ball at the knuckle, cross at the rack, slide of the rack."""
    along = drawn.line("tie_rod_inner", "tie_rod_outer")
    # Pins of the cross at right angles to the tie rod, made from the car's axis it is least along,
    # so that they turn with the car.
    sideways = min(
        (drawn.up, np.cross(drawn.right, drawn.up), drawn.right), key=lambda axis: abs(float(axis @ along))
    )
    pin_of_rack = unit_of("tie_rod", plain(np.cross(along, sideways)))
    pin_of_rod = np.cross(along, pin_of_rack)
    slide = plain(drawn.right)
    outer = Axis("tie_rod_outer")
    return {
        "tie_rod_outer_ball": Joint("spherical", "knuckle", "tie_rod", outer, outer),
        "tie_rod_inner_cross": Joint(
            "universal",
            "rack",
            "tie_rod",
            Axis("tie_rod_inner", plain(pin_of_rack)),
            Axis("tie_rod_inner", plain(pin_of_rod)),
        ),
        "rack_slide": Joint(
            "prismatic", "chassis", "rack", Axis("rack_centre", slide), Axis("tie_rod_inner", slide)
        ),
    }


def rack_travel(drawn: Drawn) -> Input:
    """The rack's travel to the left."""
    return Input("chassis", Axis("rack_centre", plain(drawn.right)), "rack", "tie_rod_inner", "linear", -1.0)


def tie_rod_beside(kingpin: tuple[str, str]) -> BranchSign:
    """On which side of the kingpin the tie rod passes: it is zero where rod and steering arm are in one
    plane with it."""
    low = kingpin[0]
    return BranchSign((kingpin, (low, "tie_rod_inner"), (low, "tie_rod_outer")), TIE_ROD)
