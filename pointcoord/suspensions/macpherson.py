"""The MacPherson strut as point coordinates: topology only (paper section 2.1 and Figure 3).

The paper's numbers: 1 lower_arm_front, 2 lower_arm_rear, 3 rack_centre, 4 strut_top, 5 lower_ball_joint,
6 tie_rod_outer, 7 strut_lower, 8 strut_rod_end, 9 tie_rod_inner, 10 wheel_centre.

Two kinds of strut. The general one takes the drawing as it stands: the strut axis is fixed in the knuckle,
through strut_lower and strut_top as drawn, and the lower ball joint lies anywhere beside it. The paper's
("collinear") puts the ball joint and the strut's points on one line, which makes the axis an edge of the
knuckle: (a, b, c) of `AxisInBody` is then (0, 1, 0), and its three vectors drop out. Its table 1 needs that.
"""

from __future__ import annotations

from pointcoord.linkage.constraints.axis_in_body import AxisInBody
from pointcoord.linkage.constraints.constraint import Constraint
from pointcoord.linkage.constraints.held_on_axis import HeldOnAxis
from pointcoord.linkage.constraints.link import Link
from pointcoord.linkage.constraints.normal import Normal
from pointcoord.linkage.constraints.on_axis import OnAxis
from pointcoord.linkage.constraints.on_line import OnLine
from pointcoord.linkage.constraints.rack import Rack
from pointcoord.linkage.constraints.rise import Rise
from pointcoord.linkage.drives import ArmAngle, Travel
from pointcoord.linkage.topology import Topology
from pointcoord.suspensions.suspension import Suspension

KNUCKLE = ("lower_ball_joint", "tie_rod_outer", "strut_lower")

_ROD_END = Link("strut_rod_end", "strut_top")  # (6)
_LINKS = (
    Link("lower_ball_joint", "lower_arm_front"),  # (1)
    Link("lower_ball_joint", "lower_arm_rear"),  # (2)
    Link("tie_rod_outer", "lower_ball_joint"),  # (3)
    Link("strut_lower", "lower_ball_joint"),  # (4)
    Link("strut_lower", "tie_rod_outer"),  # (5)
)
_TIE_ROD = Link("tie_rod_inner", "tie_rod_outer")  # (7)
_COLLINEAR = (
    OnLine("lower_ball_joint", "strut_top", "strut_rod_end", "place of lower_ball_joint on the strut"),
    OnLine("strut_lower", "strut_top", "strut_rod_end", "place of strut_lower on the strut"),
)
_NORMAL = Normal("normal of the knuckle", *KNUCKLE)
_AXIS = AxisInBody("strut axis", "strut_lower", "strut_top", _NORMAL)
_GENERAL = (
    _NORMAL,
    _AXIS,
    OnAxis("strut_top", "strut_lower", "strut axis", "place of strut_top on the strut axis"),
    HeldOnAxis("strut_rod_end", "strut_top", _AXIS, "place of strut_rod_end on the strut axis"),
)
_DRIVEN = (
    Rise("lower_ball_joint", "lower_arm_front", "up", "arm rise"),  # (12)
    Rack("tie_rod_inner", "rack_centre", "right", "rack travel"),  # (13)-(15)
)


def _macpherson(
    name: str, strut: tuple[Constraint, ...], steering_axis: tuple[str, str], puts_in_place: bool = True
) -> Topology:
    return Topology(
        name=name,
        chassis=("lower_arm_front", "lower_arm_rear", "rack_centre", "strut_top"),
        moving=("lower_ball_joint", "tie_rod_outer", "strut_lower", "strut_rod_end", "tie_rod_inner"),
        bodies={"knuckle": KNUCKLE},
        carried={"wheel_centre": KNUCKLE, "wheel_axis_inner": KNUCKLE},
        directions=("up", "right"),
        constraints=(*strut, *_DRIVEN),
        drives=(
            ArmAngle("arm rise", "arm_angle", "lower_arm_front", "lower_ball_joint", "up"),
            Travel("rack travel", "rack", "rack_centre", "tie_rod_inner", "right"),
        ),
        knuckle="knuckle",
        steering_axis=steering_axis,
        wheel_axis=("wheel_axis_inner", "wheel_centre"),
        wheel_centre="wheel_centre",
        inboard="strut_top",
        front_and_rear=("lower_arm_front", "lower_arm_rear"),
        stand_ins={"rack_centre": "tie_rod_inner", "wheel_axis_inner": "strut_lower"},
        chassis_motion={"heave": "up"},
        puts_in_place=puts_in_place,
    )


_EQ_16 = ("lower_ball_joint", "strut_lower")

DRAWN = _macpherson("macpherson", (*_LINKS, _TIE_ROD, *_GENERAL), ("lower_ball_joint", "strut_top"), False)
"""The strut as drawn: its axis fixed in the knuckle, the ball joint anywhere beside it."""

COLLINEAR = _macpherson("macpherson, collinear", (*_LINKS, _ROD_END, _TIE_ROD, *_COLLINEAR), _EQ_16)
"""The paper's strut, with a coordinate of its own for each of its two sliding points."""

MACPHERSON = Suspension("macpherson", {"drawn": DRAWN, "collinear": COLLINEAR})
