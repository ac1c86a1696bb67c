"""Every kind of input gives the motion that another one gives, or the quantity that it says."""

import tomllib

import numpy as np
import pytest

from pointcoord import Scene, SceneError, kinematic_map, simulate, solve_poses
from pointcoord.mechanism.file import MECHANISMS
from pointcoord.results.motion import Motion

WISHBONE = Scene.load("double-wishbone").model_dump(exclude_none=True)["mechanism"]
STRUT = Scene.load("off-axis-strut").model_dump(exclude_none=True)["mechanism"]
RACK = {"polynomial": [0.0, 10.0]}
SAMPLES = 5


def with_inputs(part: dict[str, object], inputs: dict[str, object], **laws: object) -> Scene:
    """A scene of a shipped mechanism with further inputs that can be driven."""
    tables = tomllib.loads((MECHANISMS / f"{part['type']}.toml").read_text())
    tables["inputs"] = {**tables["inputs"], **inputs}
    own = {name: value for name, value in part.items() if name != "type"}
    return Scene.from_mapping(
        {
            "mechanism": {**own, **tables},
            "effects": ["velocity", "acceleration", "knuckle_rates", "wheel_angles"],
            "inputs": laws,
            "time": {"start": 0.0, "stop": 1.0, "samples": SAMPLES},
        }
    )


def same(one: Motion, other: Motion, instants: slice = slice(None)) -> None:
    within = one.proof().bound.max() + other.proof().bound.max()
    for name, place in one.position.items():
        assert np.abs(place - other.position[name])[instants].max() <= within + 1e-12


ENDS = slice(None, None, SAMPLES - 1)
ARM = simulate(with_inputs(WISHBONE, {}, arm_angle={"polynomial": [1.5, 0.05]}, rack=RACK))


def law(values: np.ndarray) -> dict[str, list[float]]:
    return {"polynomial": [float(values[0]), float(values[-1] - values[0])]}


def test_height_of_the_wheel_gives_the_motion_of_the_arm_angle() -> None:
    drawn = np.array(WISHBONE["points"]["wheel_centre"])
    rise = ARM.position["wheel_centre"][:, 2] - drawn[2]
    same(ARM, simulate(with_inputs(WISHBONE, {}, wheel_travel=law(rise), rack=RACK)), ENDS)


def test_distance_of_two_points_gives_the_motion_of_the_arm_angle() -> None:
    ends = ("upper_arm_front", "lower_ball_joint")
    apart = np.linalg.norm(ARM.position[ends[0]] - ARM.position[ends[1]], axis=1)
    same(ARM, simulate(with_inputs(WISHBONE, {"d": {"distance": ends}}, d=law(apart), rack=RACK)), ENDS)


def test_turn_of_the_arm_from_the_drawing_gives_the_motion_of_the_arm_angle() -> None:
    points = {name: np.array(place) for name, place in WISHBONE["points"].items()}
    axis = points["lower_arm_rear"] - points["lower_arm_front"]
    axis /= np.linalg.norm(axis)
    drawn = points["lower_ball_joint"] - points["lower_arm_front"]
    there = ARM.position["lower_ball_joint"] - points["lower_arm_front"]
    turn = np.arctan2(there @ np.cross(axis, drawn), there @ drawn - (there @ axis) * (axis @ drawn))
    inputs = {"t": {"angle": "lower_arm", "from": "drawing"}}
    same(ARM, simulate(with_inputs(WISHBONE, inputs, t=law(turn), rack=RACK)), ENDS)


MOVES: dict[str, object] = {
    "heave": {"moves": "chassis", "along": "up"},
    "shift": {"moves": "chassis", "along": "left"},
    "roll": {"turns": "chassis", "about": "upper_arm_front", "along": "forward"},
    "pitch": {"turns": "chassis", "about": "lower_arm_rear", "along": "right"},
    "yaw": {"turns": "chassis", "about": "rack_centre", "along": "up"},
}
OVER_GROUND = {"c": {"contact": ["wheel_axis_inner", "wheel_centre"], "over": "ground"}}
MOVED = {
    "heave": {"sine": {"amplitude": 9.0, "angular_frequency": 4.0}},
    "shift": {"polynomial": [0.0, 5.0]},
    "roll": {"sine": {"amplitude": 0.06, "angular_frequency": 5.0}},
    "pitch": {"polynomial": [0.0, 0.03, -0.05]},
    "yaw": {"polynomial": [0.0, 0.2]},
}


def height_over_ground(place: dict[str, np.ndarray]) -> np.ndarray:
    """Of the lowest point of the disc, above that of the drawing, of points as they are reported."""
    axis = place["wheel_centre"] - place["wheel_axis_inner"]
    lean = axis[..., 2] / np.linalg.norm(axis, axis=-1)
    drawn = np.array(WISHBONE["points"]["wheel_centre"])[2] - 300.0  # the axis is drawn level
    return np.asarray(place["wheel_centre"][..., 2] - 300.0 * np.sqrt(1.0 - lean**2) - drawn)


def over_ground(**laws: object) -> Scene:
    part = {**WISHBONE, "wheel_radius": 300.0}
    return with_inputs(part, {**MOVES, **OVER_GROUND}, c={"polynomial": [0.0, 3.0]}, rack=RACK, **laws)


@pytest.mark.parametrize("moved", [(), ("heave", "shift"), ("roll",), ("heave", "roll", "pitch", "yaw")])
def test_the_contact_point_keeps_its_height_over_the_ground(moved: tuple[str, ...]) -> None:
    scene = over_ground(**{name: MOVED[name] for name in moved})
    motion = simulate(scene.model_copy(update={"effects": (*scene.effects, "wheel_travel")}))
    # Heights of some 500 mm are found from three numbers that round, and the motion is proven to 1e-11 mm.
    assert np.abs(height_over_ground(motion.position) - 3.0 * motion.times).max() < 1e-10
    # In the chassis' frame it moves, so that the ground is not the chassis.
    assert not moved or np.ptp(motion.dimension["contact_travel"] - 3.0 * motion.times) > 1.0


def test_a_height_over_the_ground_needs_a_turn_about_a_point_of_the_chassis() -> None:
    moves = {**MOVES, "roll": {"turns": "chassis", "about": "wheel_centre", "along": "forward"}}
    part = {**WISHBONE, "wheel_radius": 300.0}
    laws = {"c": {"constant": 0.0}, "rack": RACK, "roll": MOVED["roll"]}
    problem = "roll turns the chassis about wheel_centre, which it does not carry"
    with pytest.raises(SceneError, match=problem):
        with_inputs(part, {**moves, **OVER_GROUND}, **laws)


def test_maps_and_poses_hold_the_height_over_the_ground_too() -> None:
    scene = over_ground(roll=MOVED["roll"])
    motion = simulate(scene)
    inputs = {name: f.series(motion.times, 0)[:, 0] for name, f in scene.functions.items()}
    same_places = {"poses": solve_poses(scene, inputs).position}
    ranges = {name: (float(v.min()) - 0.01, float(v.max()) + 0.01) for name, v in inputs.items()}
    same_places["map"] = kinematic_map(scene, ranges, 1e-6)(inputs).position
    held = kinematic_map(scene, {**ranges, "roll": (0.05, 0.05)}, 1e-6)
    at = {name: values[0] for name, values in inputs.items() if name != "roll"}
    assert abs(float(height_over_ground(held(at).position)) - at["c"]) < 2e-6
    for name, place in motion.position.items():
        for other in same_places.values():
            assert np.abs(other[name] - place).max() < 2e-6  # the map's bound of 1e-6, and a turn


def test_the_contact_point_rises_by_its_input() -> None:
    inputs = {"c": {"contact": ["wheel_axis_inner", "wheel_centre"]}}
    part = {**WISHBONE, "wheel_radius": 300.0}
    motion = simulate(with_inputs(part, inputs, c={"polynomial": [0.0, 20.0]}, rack=RACK))
    axis = motion.position["wheel_centre"] - motion.position["wheel_axis_inner"]
    lean = axis[:, 2] / np.linalg.norm(axis, axis=1)
    height = motion.position["wheel_centre"][:, 2] - 300.0 * np.sqrt(1.0 - lean**2)
    assert np.abs(height - height[0] - np.linspace(0.0, 20.0, SAMPLES)).max() < 1e-10
    with pytest.raises(SceneError, match="wheel_radius"):
        with_inputs({**WISHBONE, "wheel_radius": None}, inputs, c={"constant": 0.0}, rack=RACK)


def test_travel_along_a_line_of_a_moving_body_is_its_length_in_mm() -> None:
    motion = simulate(
        with_inputs(
            STRUT, {"s": {"travel": "strut"}}, s={"polynomial": [390.0, 20.0]}, rack={"constant": 0.0}
        )
    )
    reach = np.linalg.norm(motion.position["strut_top"] - motion.position["strut_lower"], axis=1)
    assert np.abs(reach - np.linspace(390.0, 410.0, SAMPLES)).max() < 1e-10


@pytest.mark.parametrize(
    ("laws", "words"),
    [
        (
            {"rack": RACK},
            ("2 freedoms", "rack", "free are", "1 more of arm_angle, steering_wheel, wheel_travel"),
        ),
        (
            {"arm_angle": {"constant": 1.5}, "wheel_travel": {"constant": 0.0}, "rack": RACK},
            ("2 freedoms", "3 are driven", "leave 1 out"),
        ),
    ],
)
def test_too_few_and_too_many_inputs_are_named(laws: dict[str, object], words: tuple[str, ...]) -> None:
    with pytest.raises(SceneError) as caught:
        with_inputs(WISHBONE, {}, **laws)
    assert all(word in str(caught.value) for word in words)


def test_a_block_that_may_not_turn_slides_without_turning() -> None:
    points = {"o": (0, 0, 0), "g": (500, 0, 0), "a": (0, 0, 0), "b": (30, 40, 100), "k": (60, 0, 20)}
    scene = Scene.from_mapping(
        {
            "mechanism": {
                "bodies": {"chassis": ["o", "g"], "block": ["a", "b", "k"]},
                "slides": {"guide": {"points": ["a", "b"], "through": "o", "along": "b", "turns": False}},
                "inputs": {"lift": {"travel": "guide"}},
                "points": {name: list(map(float, place)) for name, place in points.items()},
            },
            "inputs": {"lift": {"polynomial": [0.0, 50.0]}},
            "time": {"start": 0.0, "stop": 1.0, "samples": 3},
        }
    )
    moved = {name: place - place[0] for name, place in simulate(scene).position.items()}
    along = np.array(points["b"]) / np.linalg.norm(points["b"])
    for name in ("a", "b", "k"):
        assert np.abs(moved[name] - np.linspace(0.0, 50.0, 3)[:, None] * along).max() < 1e-11


@pytest.mark.parametrize("other", [0.0, 1.0])
def test_two_inputs_of_one_slide_are_refused_by_name(other: float) -> None:
    again = {"again": {"travel": "rack"}}
    with pytest.raises(SceneError, match="rack and again both drive the travel of rack"):
        with_inputs(WISHBONE, again, arm_angle={"constant": 1.5}, rack=RACK, again={"constant": other})


ARM_SCENE = Scene.load("semi-trailing-arm").model_dump(exclude_none=True)


def turned_arm(polynomial: list[float]) -> Motion:
    time = {"start": 0.0, "stop": 1.0, "samples": 9}
    effects = ["velocity", "knuckle_rates"]
    law = {"arm_turn": {"polynomial": polynomial}}
    return simulate(Scene.from_mapping({**ARM_SCENE, "inputs": law, "time": time, "effects": effects}))


def test_a_turn_is_right_handed_about_the_hinge_and_goes_round_as_often_as_it_says() -> None:
    inner, outer = (np.array(ARM_SCENE["mechanism"]["points"][f"pivot_{end}"]) for end in ("inner", "outer"))
    hinge = (outer - inner) / np.linalg.norm(outer - inner)
    motion = turned_arm([0.0, 8.0 * np.pi])
    assert np.abs(motion.angular_velocity["arm"] - 8.0 * np.pi * hinge).max() < 1e-10
    there = motion.position["wheel_centre"]
    assert np.abs(there[-1] - there[0]).max() < 1e-9
    # An eighth of four rounds is half of one: the centre is across the hinge.
    arm = there[0] - inner
    across = 2.0 * (arm @ hinge) * hinge - arm + inner
    assert np.abs(there[1] - across).max() < 1e-9
    # A motion that starts rounds away from the drawing goes there round by round.
    assert np.abs(turned_arm([7.0 * np.pi]).position["wheel_centre"][0] - across).max() < 1e-9


def test_a_tripod_of_rods_is_refused_as_a_structure() -> None:
    content = {
        "mechanism": {
            "bodies": {"chassis": ["a", "b", "c"]},
            "rods": {"r1": ["a", "p"], "r2": ["b", "p"], "r3": ["c", "p"]},
            "points": {"a": [0, 0, 0], "b": [300, 0, 0], "c": [0, 300, 10], "p": [100, 100, 300]},
        },
        "inputs": {},
        "time": {"start": 0.0, "stop": 1.0, "samples": 3},
    }
    with pytest.raises(SceneError, match="structure that nothing moves"):
        Scene.from_mapping(content)
