"""The MacPherson strut as point coordinates: topology only (paper section 2.1 and Figure 3).

The paper's numbers: 1 lower_arm_front, 2 lower_arm_rear, 3 rack_centre, 4 strut_top, 5 lower_ball_joint,
6 tie_rod_outer, 7 strut_lower, 8 strut_rod_end, 9 tie_rod_inner, 10 wheel_centre.
"""

from __future__ import annotations

from pointcoord.constraints import Constraint, Link, OnLine, PrintedParallel, Rack, Rise
from pointcoord.drives import ArmAngle, Travel
from pointcoord.topology import Topology

_LINKS = (
    Link("lower_ball_joint", "lower_arm_front"),  # (1)
    Link("lower_ball_joint", "lower_arm_rear"),  # (2)
    Link("tie_rod_outer", "lower_ball_joint"),  # (3)
    Link("strut_lower", "lower_ball_joint"),  # (4)
    Link("strut_lower", "tie_rod_outer"),  # (5)
    Link("strut_rod_end", "strut_top"),  # (6)
    Link("tie_rod_inner", "tie_rod_outer"),  # (7)
)
_STRUT = (
    OnLine("lower_ball_joint", "strut_top", "strut_rod_end", "place of lower_ball_joint on the strut"),
    OnLine("strut_lower", "strut_top", "strut_rod_end", "place of strut_lower on the strut"),
)
_PRINTED_STRUT = (
    PrintedParallel("lower_ball_joint", "strut_lower", "strut_top", "strut_rod_end"),  # (8), (9)
    PrintedParallel("strut_top", "strut_lower", "strut_top", "strut_rod_end"),  # (10), (11)
)
_DRIVEN = (
    Rise("lower_ball_joint", "lower_arm_front", "up", "arm rise"),  # (12)
    Rack("tie_rod_inner", "rack_centre", "right", "rack travel"),  # (13)-(15)
)


def _macpherson(name: str, strut: tuple[Constraint, ...]) -> Topology:
    return Topology(
        name=name,
        chassis=("lower_arm_front", "lower_arm_rear", "rack_centre", "strut_top"),
        moving=("lower_ball_joint", "tie_rod_outer", "strut_lower", "strut_rod_end", "tie_rod_inner"),
        bodies={"knuckle": ("lower_ball_joint", "tie_rod_outer", "strut_lower")},
        carried={"wheel_centre": ("lower_ball_joint", "tie_rod_outer", "strut_lower")},
        directions=("up", "right"),
        constraints=(*_LINKS, *strut, *_DRIVEN),
        drives=(
            ArmAngle("arm rise", "arm_angle", "lower_arm_front", "lower_ball_joint", "up"),
            Travel("rack travel", "rack", "rack_centre", "tie_rod_inner", "right"),
        ),
        chassis_motion={"heave": "up"},
    )


MACPHERSON = _macpherson("macpherson", _STRUT)
"""The strut with a coordinate of its own for each of its two sliding points."""

MACPHERSON_PRINTED = _macpherson("macpherson, as printed", _PRINTED_STRUT)
"""The strut with the paper's cross-product rows (8)-(11)."""
