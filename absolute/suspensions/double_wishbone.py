"""The double wishbone, described as data: two arms that hold the knuckle by a ball joint each."""

from absolute.description import Axis, BranchSign, Joint, Model
from absolute.suspensions.control_arm import arm_angle, arm_links, arm_pivot, beside_arm_axis
from absolute.suspensions.rack_steering import rack_travel, steering_joints, tie_rod_beside
from absolute.suspensions.suspension import Drawn, Suspension

LOWER = ("lower_arm_front", "lower_arm_rear", "lower_ball_joint")
UPPER = ("upper_arm_front", "upper_arm_rear", "upper_ball_joint")
KINGPIN = ("lower_ball_joint", "upper_ball_joint")


def _linkage(drawn: Drawn) -> Model:
    """The lower arm is driven; the upper one follows, and the tie rod steers about the line of the balls."""
    lower, upper = (Axis(ball) for ball in KINGPIN)
    joints = {
        "lower_arm_pivot": arm_pivot(*LOWER[:2], "lower_arm"),
        "upper_arm_pivot": arm_pivot(*UPPER[:2], "upper_arm"),
        "lower_ball": Joint("spherical", "lower_arm", "knuckle", lower, lower),
        "upper_ball": Joint("spherical", "upper_arm", "knuckle", upper, upper),
        **steering_joints(drawn),
    }
    inputs = {
        "arm_angle": arm_angle(drawn, LOWER[0], LOWER[2], "lower_arm"),
        "rack": rack_travel(drawn),
    }
    # The upper ball joint is as far from both upper pivots and from the lower ball joint as drawn: at two
    # places, one on each side of the plane of these three.
    front, rear, ball = (("lower_ball_joint", point) for point in UPPER)
    signs = {
        "ball joint beside the arm axis": beside_arm_axis(drawn, *LOWER),
        "upper ball joint beside the plane of the upper pivots and the lower ball joint": BranchSign(
            (front, rear, ball), arm_links(*UPPER)
        ),
        "tie rod beside the kingpin": tie_rod_beside(KINGPIN),
    }
    corner = drawn.corner(("wheel_axis_inner", "wheel_centre"), KINGPIN)
    return Model(drawn.points, "chassis", drawn.bodies, joints, inputs, signs, corner)


double_wishbone = Suspension(
    title="a double wishbone",
    bodies={
        "chassis": (*LOWER[:2], *UPPER[:2], "rack_centre"),
        "lower_arm": LOWER,
        "upper_arm": UPPER,
        "knuckle": (*KINGPIN, "tie_rod_outer", "wheel_axis_inner", "wheel_centre"),
        "tie_rod": ("tie_rod_outer", "tie_rod_inner"),
        "rack": ("tie_rod_inner",),
    },
    optional={"rack_centre": "tie_rod_inner"},
    closures=("drawn",),
    inputs=("arm_angle", "rack"),
    linkage=_linkage,
)
