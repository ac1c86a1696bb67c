"""The MacPherson strut, described as data: its axis as drawn, or through the lower ball joint."""

from absolute.description import Axis, BranchSign, Carried, Joint, Model
from absolute.suspensions.control_arm import arm_angle, arm_pivot, beside_arm_axis
from absolute.suspensions.rack_steering import rack_travel, steering_joints, tie_rod_beside
from absolute.suspensions.suspension import Drawn, Suspension

ARM = ("lower_arm_front", "lower_arm_rear", "lower_ball_joint")
STRUT = ("strut axis",)


def _linkage(drawn: Drawn) -> Model:
    """The strut rod slides in the knuckle and does not turn in it.

    The rod's line, strut_rod_end to strut_top, slides along an axis of the knuckle:
        "drawn"      strut_lower to strut_top as drawn, wherever the lower ball joint is;
        "collinear"  lower_ball_joint to strut_lower (the paper's strut, eqs. 1-11).
    The steering axis leads to strut_top, or is that of the paper's eq. (16), to strut_lower.
    """
    front, rear, ball = ARM
    joints = {
        "arm_pivot": arm_pivot(front, rear, "lower_arm"),
        "lower_ball": Joint("spherical", "lower_arm", "knuckle", Axis(ball), Axis(ball)),
        "strut": Joint("prismatic", "knuckle", "strut_rod", *_strut_axes(drawn)),
        "top_mount": Joint("spherical", "chassis", "strut_rod", Axis("strut_top"), Axis("strut_top")),
        **steering_joints(drawn),
    }
    inputs = {
        "arm_angle": arm_angle(drawn, front, ball, "lower_arm"),
        "rack": rack_travel(drawn),
    }
    inner = "wheel_axis_inner" if "wheel_axis_inner" in drawn.place else "strut_lower"
    upper = "strut_top" if drawn.closure == "drawn" else "strut_lower"
    corner = drawn.corner((inner, "wheel_centre"), ("lower_ball_joint", upper))
    return Model(drawn.points, "chassis", drawn.bodies, joints, inputs, _branch_signs(drawn), corner)


def _strut_axes(drawn: Drawn) -> tuple[Axis, Axis]:
    """The axis that slides in the knuckle, and the rod's line in the same sense."""
    rod = Axis("strut_rod_end", "strut_top")
    if drawn.closure == "collinear":
        return Axis("lower_ball_joint", "strut_lower"), rod
    axis = drawn.line("strut_lower", "strut_top")
    # The rod end stays on the side of the top mount where it is drawn.
    below = float(axis @ drawn.line("strut_rod_end", "strut_top")) >= 0
    return Axis("strut_lower", "strut_top"), rod if below else Axis("strut_top", "strut_rod_end")


def _branch_signs(drawn: Drawn) -> dict[str, BranchSign]:
    kingpin = ("lower_ball_joint", "strut_top")
    if drawn.closure == "collinear":
        # Where the knuckle's own line is not the kingpin yet, it is the knuckle's line that counts: tie
        # rod and steering arm stand in one plane with it where they are at their dead point as drawn.
        steered = ("lower_ball_joint", "strut_lower")
        strut = {
            "knuckle along the kingpin": BranchSign((steered, kingpin), STRUT),
            "strut rod along the kingpin": BranchSign((("strut_rod_end", "strut_top"), kingpin), STRUT),
        }
    else:
        # The top mount is on the strut axis, and as far from the ball joint as on the chassis: at two
        # places, one on each side of the foot of the ball joint on the axis.
        steered = kingpin
        axis = Carried("knuckle", "strut_lower", "strut_top")
        strut = {"strut axis along the kingpin": BranchSign((axis, kingpin), STRUT)}
    return {
        "ball joint beside the arm axis": beside_arm_axis(drawn, *ARM),
        **strut,
        "tie rod beside the kingpin": tie_rod_beside(steered),
    }


macpherson = Suspension(
    title="a MacPherson strut",
    bodies={
        "chassis": ("lower_arm_front", "lower_arm_rear", "rack_centre", "strut_top"),
        "lower_arm": ("lower_arm_front", "lower_arm_rear", "lower_ball_joint"),
        "knuckle": ("lower_ball_joint", "tie_rod_outer", "strut_lower", "wheel_centre", "wheel_axis_inner"),
        "strut_rod": ("strut_top", "strut_rod_end"),
        "tie_rod": ("tie_rod_outer", "tie_rod_inner"),
        "rack": ("tie_rod_inner",),
    },
    optional={"rack_centre": "tie_rod_inner", "wheel_axis_inner": "strut_lower"},
    closures=("drawn", "collinear"),
    inputs=("arm_angle", "rack"),
    linkage=_linkage,
)
