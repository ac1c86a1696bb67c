"""The double wishbone as point coordinates: topology only.

The lower and the upper arm each hold a ball joint of the knuckle at two links' distance from their pivots on
the chassis; the tie rod steers. Every link keeps its drawn length.
"""

from __future__ import annotations

from pointcoord.linkage.constraints.link import Link
from pointcoord.linkage.constraints.rack import Rack
from pointcoord.linkage.constraints.rise import Rise
from pointcoord.linkage.drives import ArmAngle, Travel
from pointcoord.linkage.topology import Topology
from pointcoord.suspensions.suspension import Suspension

KNUCKLE = ("lower_ball_joint", "upper_ball_joint", "tie_rod_outer")

DRAWN = Topology(
    name="double wishbone",
    chassis=("lower_arm_front", "lower_arm_rear", "upper_arm_front", "upper_arm_rear", "rack_centre"),
    moving=("lower_ball_joint", "upper_ball_joint", "tie_rod_outer", "tie_rod_inner"),
    bodies={"knuckle": KNUCKLE},
    carried={"wheel_centre": KNUCKLE, "wheel_axis_inner": KNUCKLE},
    directions=("up", "right"),
    constraints=(
        Link("lower_ball_joint", "lower_arm_front"),
        Link("lower_ball_joint", "lower_arm_rear"),
        Link("upper_ball_joint", "upper_arm_front"),
        Link("upper_ball_joint", "upper_arm_rear"),
        Link("upper_ball_joint", "lower_ball_joint"),
        Link("tie_rod_outer", "lower_ball_joint"),
        Link("tie_rod_outer", "upper_ball_joint"),
        Link("tie_rod_inner", "tie_rod_outer"),
        Rise("lower_ball_joint", "lower_arm_front", "up", "arm rise"),
        Rack("tie_rod_inner", "rack_centre", "right", "rack travel"),
    ),
    drives=(
        ArmAngle("arm rise", "arm_angle", "lower_arm_front", "lower_ball_joint", "up"),
        Travel("rack travel", "rack", "rack_centre", "tie_rod_inner", "right"),
    ),
    knuckle="knuckle",
    steering_axis=("lower_ball_joint", "upper_ball_joint"),
    wheel_axis=("wheel_axis_inner", "wheel_centre"),
    wheel_centre="wheel_centre",
    inboard="upper_arm_front",
    front_and_rear=("lower_arm_front", "lower_arm_rear"),
    stand_ins={"rack_centre": "tie_rod_inner"},
    chassis_motion={"heave": "up"},
)
"""Both arms, the knuckle and the tie rod as drawn; the drawing closes if tie_rod_inner lies on the rack."""

DOUBLE_WISHBONE = Suspension("double_wishbone", {"drawn": DRAWN})
