"""Numbers of the wheel, of the steering axis and of the damper, and their gradients."""

from typing import Any

import numpy as np
import pytest
from flat import flat, shipped
from kinds import KINDS, mirrored
from numpy.typing import NDArray
from one_arm import BY_TRAVEL, CAR, DRAWN, RADIUS, ROLES, Written, plain, solved
from reach_of_accuracy import off

import absolute
from absolute.dual import arctan2, constant

Array = NDArray[np.float64]
EPS = float(np.finfo(float).eps)
EFFECTS = tuple(absolute.EFFECTS)
NUMBERS = tuple(name for name, effect in absolute.EFFECTS.items() if not effect.by)
GRADIENTS = tuple(name for name in EFFECTS if "_by_" in name)
POSES: tuple[dict[str, float], ...] = (
    {},
    {"turn": 0.2, "steer": 15.0},
    {"turn": -0.3, "steer": -20.0, "roll": 0.1, "pitch": -0.05},
)
# Every line of the arm is more than 100 mm long, and its condition number below 40 (asserted below): points
# are off by 40 roundings of 800 mm, numbers by ten times that, as contact points and axes reach 310 mm beyond
# such lines, and angles and gradients by a hundredth of it, as they change by no more over 100 mm. Of an
# anti-feature it is 500 times that. The hinge leans a tenth out of the plane of the front view, which has the
# instant centre ten times as far away as the hinge, and 50 times as far off; in the side view it is nearer.
OFF = 10 * 40 * EPS * 800.0
every_pose = pytest.mark.parametrize("values", POSES)


def tolerance(name: str, scale: float = 1.0) -> float:
    if "_view_" in name:
        return 50.0 * OFF * scale
    return {"mm": OFF * scale, "%": 5.0 * OFF}.get(absolute.EFFECTS[name].unit, OFF / 100.0)


def test_the_arm_is_as_well_conditioned_as_the_tolerances_assume() -> None:
    inputs = {name: np.array([[POSES[2][name], 0.0, 0.0]]) for name in POSES[2]}
    motion = absolute.solve(absolute.compile(plain()), inputs, conditions=True)
    assert off(motion)[0] < OFF / 10.0


def test_each_number_has_its_gradients_in_units_of_it() -> None:
    units = {name: effect.unit for name, effect in absolute.EFFECTS.items()}
    numbers = set(NUMBERS)
    assert len(numbers) == 15
    assert set(EFFECTS) == {
        *numbers,
        *(f"{name}_by_{by}" for name in numbers for by in ("travel", "rack")),
        *BY_TRAVEL,
    }
    assert {name for name in numbers if units[name] == "rad"} == {"camber", "kingpin", "toe", "caster"}
    assert {units[name] for name in numbers} == {"rad", "mm"}
    assert {name for name in BY_TRAVEL if units[name] != "mm"} == {"anti_brake", "anti_drive"}
    assert units["anti_brake"] == units["anti_drive"] == "%"
    assert all(units[name] == units[name.partition("_by_")[0]] + "/mm" for name in GRADIENTS)


@every_pose
def test_every_effect_is_what_is_written_out_in_many_digits(values: dict[str, float]) -> None:
    found, written = solved(EFFECTS, values), Written(**values)
    for name in EFFECTS:
        assert abs(found[name] - written.effect(name)) <= tolerance(name), name


@every_pose
def test_a_mirrored_car_has_the_same_numbers_on_its_other_side(values: dict[str, float]) -> None:
    # The mirror image turns the other way about lines that it keeps, and the same way about those across.
    other = {**values, "turn": -values.get("turn", 0.0), "roll": -values.get("roll", 0.0)}
    points = {name: (x, -y, z) for name, (x, y, z) in DRAWN.items()}
    plain_car, mirror = solved(EFFECTS, values), solved(EFFECTS, other, points, side="right")
    for name in EFFECTS:
        assert abs(mirror[name] - plain_car[name]) <= 2 * tolerance(name), name


@every_pose
@pytest.mark.parametrize("scale", [1e-3, 0.7, 1e3])
def test_a_scaled_car_has_scaled_lengths_and_the_same_angles(values: dict[str, float], scale: float) -> None:
    points = {name: tuple(scale * x for x in point) for name, point in DRAWN.items()}
    scaled = {**values, "steer": scale * values.get("steer", 0.0)}
    car = CAR | {name: scale * CAR[name] for name in ("wheelbase", "centre_of_gravity_height")}
    small = solved(EFFECTS, scaled, points, wheel_radius=scale * RADIUS, car=car)
    plain_car = solved(EFFECTS, values)
    for name in EFFECTS:
        factor = {"mm": scale, "rad/mm": 1.0 / scale}.get(absolute.EFFECTS[name].unit, 1.0)
        assert abs(small[name] / factor - plain_car[name]) <= 2 * tolerance(name), name


@every_pose
def test_a_car_drawn_elsewhere_has_the_same_numbers(values: dict[str, float]) -> None:
    # The roll centre's plane goes through the origin, so it may not move sideways. Places are rounded anew.
    plain_car = solved(EFFECTS, values)
    others = tuple(name for name in EFFECTS if name != "roll_centre_height")
    for shift, names in (((500.0, 0.0, -300.0), EFFECTS), ((100.0, 700.0, 50.0), others)):
        moved = solved(names, values, {name: np.add(point, shift) for name, point in DRAWN.items()})
        for name in names:
            assert abs(moved[name] - plain_car[name]) <= 4 * tolerance(name), name


@every_pose
def test_a_turned_frame_of_the_points_changes_nothing(values: dict[str, float]) -> None:
    turn = np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    points = {name: turn @ point for name, point in DRAWN.items()}
    there = solved(EFFECTS, values, points, up=turn[:, 2], right=turn[:, 1])
    for name, value in solved(EFFECTS, values).items():
        assert abs(there[name] - value) <= 4 * tolerance(name), name


def test_a_displaced_chassis_changes_no_number() -> None:
    model = absolute.compile(plain())
    inputs = {name: np.array([[value, 0.0, 0.0]]) for name, value in POSES[2].items()}
    heave = np.full((1, 3, 3), 40.0)
    still, displaced = (absolute.solve(model, inputs, chassis=by, effects=EFFECTS) for by in (None, heave))
    assert all(np.array_equal(still.effects[name], displaced.effects[name]) for name in EFFECTS)


# A wheel of 300 mm upright, one turned in by the angle of 3-4-5, and one leant out by it, whose lowest point
# is 180 mm further inboard and 60 mm higher. The axis is 10 mm inboard and 20 mm ahead of that point at its
# height, and 25 mm inboard and 10 mm behind the centre at the height of that.
UPRIGHT = {
    **DRAWN,
    "inner": (0.0, -600.0, 300.0),
    "centre": (0.0, -700.0, 300.0),
    "lower": (-10.0, -685.0, 100.0),
    "upper": (20.0, -670.0, 400.0),
}
BY_HAND = {
    "kingpin_offset": 10.0,
    "castor_offset": 20.0,
    "mechanical_trail": 20.0,
    "scrub_radius": np.sqrt(500.0),
    "kingpin_offset_at_wheel": 25.0,
    "hub_trail": 10.0,
}


@pytest.mark.parametrize(
    ("moved", "changed"),
    [
        ({}, {"camber": 0.0, "toe": 0.0, "kingpin": np.arctan(15 / 300), "caster": np.arctan(0.1)}),
        # Its own forward leads 0.6 inboard and 0.8 ahead.
        ({"inner": (60.0, -620.0, 300.0)}, {"mechanical_trail": 22.0, "toe": np.arctan(0.75)}),
        (
            {
                "inner": (0.0, -620.0, 360.0),
                "lower": (-20.0, -510.0, 60.0),
                "upper": (60.0, -1180.0, 620.0),
            },
            {
                "camber": np.arctan(0.75),
                # 3/7 of the way up the axis, 240 mm above its lower end.
                "kingpin_offset_at_wheel": 700.0 - 510.0 - 670.0 * 3 / 7,
                "hub_trail": -20.0 + 80.0 * 3 / 7,
            },
        ),
    ],
)
def test_a_wheel_drawn_by_hand_has_the_offsets_that_it_is_drawn_with(
    moved: dict[str, Any], changed: dict[str, float]
) -> None:
    wanted = BY_HAND | changed
    for out, side in ((1, "left"), (-1, "right")):
        points = {name: (x, out * y, z) for name, (x, y, z) in (UPRIGHT | moved).items()}
        for name, value in solved(wanted, {}, points, side=side, wheel_radius=300.0).items():
            assert abs(value - wanted[name]) <= tolerance(name), (name, side)


# A trailing link of 400 mm, hinged ahead of the wheel, with a damper straight above the middle of the link.
LINK = {
    **UPRIGHT,
    "pivot": (-400.0, -700.0, 300.0),
    "pivot_end": (-400.0, -500.0, 300.0),
    "damper_foot": (-200.0, -700.0, 300.0),
    "damper_top": (-200.0, -700.0, 600.0),
}


@pytest.mark.parametrize("angle", [-0.3, 0.0, 0.2])
def test_a_trailing_link_lifts_its_wheel_along_a_circle(angle: float) -> None:
    # About the line to the right the wheel behind goes down: up by minus the turn.
    sine, cosine, tangent = np.sin(angle), np.cos(angle), np.tan(angle)
    foot, damper = 200.0 * np.array([cosine - 1.0, sine]) - [0.0, 300.0], 0.0
    damper = float(np.hypot(*foot))
    wanted = {
        "travel": 400.0 * sine,
        "contact_travel": 400.0 * sine,
        "recession": 400.0 * (cosine - 1.0),
        "half_track_change": 0.0,
        "damper_length": damper,
        "travel_by_travel": 1.0,
        "recession_by_travel": -tangent,
        "half_track_change_by_travel": 0.0,
        # The axis is turned forward at its top.
        "caster": np.arctan(0.1) - angle,
        "caster_by_travel": -1.0 / (400.0 * cosine),
        "camber_by_travel": 0.0,
        "toe_by_travel": 0.0,
        "damper_length_by_travel": (foot @ np.array([-sine, cosine])) / damper / 2.0 / cosine,
        "roll_centre_height": 0.0,
    }
    for name, value in solved(wanted, {"turn": -angle}, LINK).items():
        assert abs(value - wanted[name]) <= tolerance(name), name
    if angle == 0.0:
        assert wanted["damper_length_by_travel"] == -0.5


def test_a_swing_axle_has_its_roll_centre_on_the_line_from_the_contact_point_to_its_hinge() -> None:
    # The hinge is 150 mm high and 600 mm inboard of the contact point; the middle plane is 700 mm inboard.
    points = {**UPRIGHT, "pivot": (-50.0, -100.0, 150.0), "pivot_end": (50.0, -100.0, 150.0)}
    wanted = {
        "roll_centre_height": 150.0 * 700.0 / 600.0,
        # Turned by d the wheel is 600 d higher and its top leans in; its lowest point, 150 mm below the
        # hinge, goes out.
        "camber_by_travel": -1.0 / 600.0,
        "half_track_change_by_travel": 150.0 / 600.0,
    }
    for name, value in solved(wanted, {}, points, wheel_radius=300.0).items():
        assert abs(value - wanted[name]) <= tolerance(name), name


@pytest.mark.parametrize(
    ("way", "wanted"),
    [
        (
            (0.0, -1.0, 0.0),
            {"half_track_change_by_rack": 1.0, "recession_by_rack": 0.0, "travel_by_rack": 0.0},
        ),
        (
            (1.0, 0.0, 0.0),
            {"half_track_change_by_rack": 0.0, "recession_by_rack": 1.0, "travel_by_rack": 0.0},
        ),
        (
            (0.0, 0.0, 1.0),
            {"half_track_change_by_rack": 0.0, "travel_by_rack": 1.0, "damper_length_by_rack": -1.0},
        ),
    ],
)
def test_a_wheel_pushed_along_a_direction_goes_that_way(
    way: tuple[float, ...], wanted: dict[str, float]
) -> None:
    points = {**LINK, "guide_end": tuple(np.add(DRAWN["guide"], np.multiply(80.0, way)))}
    found = solved([*wanted, "half_track_change", "recession", "travel"], {"steer": 12.0}, points)
    for name, slope in wanted.items():
        if name != "damper_length_by_rack":
            assert abs(found[name] - slope) <= tolerance(name), name
            assert abs(found[name.removesuffix("_by_rack")] - 12.0 * slope) <= OFF, name
        else:
            assert abs(found[name] - slope) <= tolerance(name)


def steered(kind: str, driven: tuple[str, ...], points: Any) -> absolute.Model:
    ends = {
        "double_wishbone": ["upper_arm_front", "lower_ball_joint"],
        "macpherson": ["strut_top", "strut_lower"],
    }
    described = flat(shipped(kind), points, driven, wheel_radius=300.0)
    described["roles"] = {**described["roles"], "damper": ends[kind]}
    return absolute.compile(described)


# Weights of f(k h) - f(-k h), k = 1, ..., of the derivative's central differences times h.
SIXTH, EIGHTH = (3 / 4, -3 / 20, 1 / 60), (4 / 5, -1 / 5, 4 / 105, -1 / 280)


def differences(values: Array, step: float) -> tuple[float, float]:
    """The derivative at the middle of nine samples by the rule of order 8, and how far off order 6 is."""
    fine, coarse = (
        sum(weight * (values[4 + k] - values[4 - k]) for k, weight in enumerate(rule, 1)) / step
        for rule in (EIGHTH, SIXTH)
    )
    return float(fine), float(abs(fine - coarse))


@pytest.mark.parametrize("bounce", ["arm_angle", "wheel_travel", "contact_travel"])
@pytest.mark.parametrize("kind", ["double_wishbone", "macpherson"])
def test_gradients_are_central_differences_of_the_numbers(kind: str, bounce: str) -> None:
    named = {"double_wishbone": "double wishbone", "macpherson": "strut"}[kind]
    car = KINDS[named].random_car(3, True)
    model = steered(kind, (bounce, "rack"), car)
    at = {name: value + 7.0 for name, value in absolute.close_drawing(model).inputs.items()}
    if bounce == "arm_angle":
        at[bounce] += 0.1 - 7.0
    steps = {bounce: 0.01 if bounce == "arm_angle" else 2.0, "rack": 2.0}
    slopes: dict[str, dict[str, tuple[float, float]]] = {}
    for by, step in steps.items():
        inputs = {name: np.full((9, 3), [value, 0.0, 0.0]) for name, value in at.items()}
        inputs[by][:, 0] += step * np.arange(-4, 5)
        motion = absolute.solve(model, inputs, rates=False, effects=[*NUMBERS, *GRADIENTS])
        slopes[by] = {name: differences(motion.effects[name], step) for name in NUMBERS}
        exact = {name: motion.effects[name][4] for name in GRADIENTS}
    rise, rise_off = slopes[bounce]["travel"]
    for name in NUMBERS:
        # What the two rules differ by is how far that of order 6 is off, a h^6, and the rounding of 1e-12 mm
        # over 2 mm; that of order 8 is off by less. It must be below 1e-6 of the slope (of 0.01 mm/mm where
        # the slope is smaller), and so must what the exact gradient is off.
        scale = 1.0 if absolute.EFFECTS[name].unit == "mm" else 1.0 / 300.0
        for wanted, uncertain, found in (
            (*slopes["rack"][name], exact[f"{name}_by_rack"]),
            (
                slopes[bounce][name][0] / rise,
                (slopes[bounce][name][1] + rise_off * abs(slopes[bounce][name][0] / rise)) / abs(rise),
                exact[f"{name}_by_travel"],
            ),
        ):
            allowed = 1e-6 * max(abs(wanted), scale / 100.0)
            assert uncertain <= allowed, (name, "differences that prove nothing")
            assert abs(found - wanted) <= allowed, name
    # What the rack does is no matter of travel, and a steered wheel turns.
    assert abs(exact["toe_by_rack"]) > 1e-3


def test_gradients_of_a_long_motion_are_those_of_its_instants_in_any_order() -> None:
    # Instants are solved many at a time.
    model = steered("double_wishbone", ("arm_angle", "rack"), KINDS["double wishbone"].car)
    inputs = KINDS["double wishbone"].inputs(np.linspace(0.0, 1.5, 200))
    there = absolute.solve(model, inputs, rates=False, conditions=True, effects=GRADIENTS)
    turned = {name: law[::-1].copy() for name, law in inputs.items()}
    back = absolute.solve(model, turned, rates=False, conditions=True, effects=GRADIENTS)
    # Numbers change by less than a tenth for each mm that points are off, and axes reach three times as far.
    allowed = (off(there) + off(back)[::-1]).max()
    assert np.ptp(there.effects["caster_by_travel"]) > 1e3 * allowed
    for name in GRADIENTS:
        assert np.abs(there.effects[name] - back.effects[name][::-1]).max() <= allowed, name


def test_half_a_turn_is_pi_with_either_zero() -> None:
    assert arctan2(constant(-0.0), constant(-1.0)).value == np.pi


def test_an_input_of_two_slides_moves_both() -> None:
    # A damper whose top stands on a sledge that goes with the carriage is as long as before.
    apart = tuple(np.add(DRAWN["damper_top"], np.subtract(DRAWN["guide_end"], DRAWN["guide"])))
    described = plain({**DRAWN, "sledge": DRAWN["damper_top"], "beside": apart})
    described["bodies"]["chassis"] += ["sledge", "beside"]
    described["bodies"]["chassis"].remove("damper_top")
    slide = {
        "points": ["damper_top"],
        "body": "chassis",
        "through": "sledge",
        "along": "beside",
        "turns": True,
    }
    described["slides"]["top"] = slide
    described["inputs"] = {"turn": described["inputs"]["turn"], "steer": {"travel": ["guide", "top"]}}
    names = ["half_track_change_by_rack", "damper_length_by_rack", "damper_length_by_travel"]
    inputs = {name: np.array([[value, 0.0, 0.0]]) for name, value in (("turn", 0.1), ("steer", 8.0))}
    found = absolute.solve(absolute.compile(described), inputs, effects=names).effects
    assert abs(found["damper_length_by_rack"][0]) <= tolerance("damper_length_by_rack")
    assert found["half_track_change_by_rack"][0] > 0.9
    assert found["damper_length_by_travel"][0] < -0.1


def test_a_wheel_that_does_not_rise_has_no_number_by_travel() -> None:
    # The wheel stands on the carriage, and what turns is a flap of the chassis that holds the damper's foot.
    described = plain()
    described["bodies"] = {
        "chassis": ["stop", "damper_top", "pivot", "pivot_end"],
        "carriage": ["guide", "guide_end", "inner", "centre", "lower", "upper"],
        "flap": ["pivot", "pivot_end", "damper_foot"],
    }
    described["inputs"]["turn"] = {"angle": "flap", "from": "drawing"}
    inputs = {"turn": np.zeros((1, 3)), "steer": np.array([[12.0, 0.0, 0.0]])}
    names = ["damper_length_by_travel", "travel_by_travel", "toe_by_travel", *BY_TRAVEL]
    found = absolute.solve(absolute.compile(described), inputs, effects=[*names, "recession_by_rack"]).effects
    assert all(np.isnan(found[name][0]) for name in names), found
    assert found["recession_by_rack"][0] > 0.1


@pytest.mark.parametrize(
    ("names", "roles", "radius", "words"),
    [
        (
            ["toe", "damper_length"],
            ("wheel_axis",),
            None,
            "'damper_length' needs the role 'damper'.*two points",
        ),
        (["hub_trail"], ("wheel_axis",), None, "'hub_trail' needs the role 'steering_axis'"),
        (["travel"], ("damper",), 300.0, "'travel' needs the role 'wheel_axis'"),
        (
            ["damper_length_by_travel"],
            ("damper",),
            300.0,
            "'damper_length_by_travel' needs the role 'wheel_axis'",
        ),
        (["travel", "recession"], ("wheel_axis",), None, "'recession' needs wheel_radius.*mechanism.*mm"),
        (
            ["scrub_radius_by_rack"],
            ("wheel_axis", "steering_axis"),
            None,
            "'scrub_radius_by_rack' needs wheel_rad",
        ),
    ],
)
def test_what_a_number_lacks_is_said_in_one_line(
    names: list[str], roles: tuple[str, ...], radius: float | None, words: str
) -> None:
    kept = {role: ROLES[role] for role in roles}
    with pytest.raises(absolute.DescriptionError, match=f"^effect {words}") as refused:
        solved(names, roles=kept, wheel_radius=radius)
    assert "\n" not in str(refused.value)


def test_numbers_that_need_no_radius_have_none() -> None:
    names = [
        "travel",
        "kingpin_offset_at_wheel",
        "hub_trail",
        "damper_length",
        "damper_length_by_travel",
        "toe",
    ]
    assert solved(names, wheel_radius=None) == solved(names)


@pytest.mark.parametrize("radius", [0.0, -300.0, float("nan"), float("inf"), "large"])
def test_a_radius_that_is_no_length_is_refused(radius: Any) -> None:
    with pytest.raises(absolute.DescriptionError, match=r"^wheel_radius is .*above 0"):
        solved(["camber"], wheel_radius=radius)


def test_a_gradient_without_exactly_one_input_of_its_kind_is_refused() -> None:
    fixed = plain()
    fixed["bodies"]["chassis"] += ["pivot", "pivot_end"]
    del fixed["bodies"]["carriage"], fixed["points"]["guide"], fixed["slides"], fixed["inputs"]["steer"]
    fixed["points"]["stop"] = fixed["points"].pop("guide_end")
    fixed["inputs"]["turn"] = {"angle": "arm", "from": "drawing"}
    turn = {"turn": np.zeros((1, 3))}
    model = absolute.compile(fixed)
    assert absolute.solve(model, turn, effects=["toe_by_travel", "roll_centre_height"]).effects
    words = (
        r"^effect 'toe_by_rack' needs exactly one driven input that is the travel.* are 0: \[\] of \['turn'\]"
    )
    with pytest.raises(absolute.DescriptionError, match=words):
        absolute.solve(model, turn, effects=["toe_by_rack"])
    car = KINDS["double wishbone"].random_car(3, True)
    loose = flat(shipped("double_wishbone"), car, ("arm_angle", "rack"), wheel_radius=300.0)
    loose["inputs"]["rack"] = {"height": "tie_rod_inner", "along": "left"}
    for name in ("travel_by_travel", "roll_centre_height", "side_view_swing_arm", "anti_drive"):
        with pytest.raises(
            absolute.DescriptionError, match=f"^effect '{name}' needs.* is not .* are 2: .*arm_angle"
        ):
            absolute.solve(
                absolute.compile(loose), {n: np.zeros((1, 3)) for n in ("arm_angle", "rack")}, effects=[name]
            )


def test_only_what_is_asked_for_is_solved(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[int] = []
    solve = absolute.solve.__globals__["velocities"]
    monkeypatch.setitem(
        absolute.solve.__globals__, "velocities", lambda at, rates: asked.append(1) or solve(at, rates)
    )
    assert solved(NUMBERS).keys() == set(NUMBERS)
    assert not asked
    for names in (
        ["toe_by_travel"],
        ["toe_by_rack", "camber_by_rack"],
        ["roll_centre_height", "travel_by_travel"],
    ):
        asked.clear()
        assert list(solved(names)) == names
        assert len(asked) == 1
    asked.clear()
    solved(GRADIENTS)
    assert len(asked) == 2


def test_a_refused_motion_keeps_its_gradients_before_it() -> None:
    car = KINDS["double wishbone"].random_car(3, True)
    model = steered("double_wishbone", ("wheel_travel", "rack"), mirrored(mirrored(car)))
    racks = np.array([0.0, 10.0, 900.0])
    inputs = {"wheel_travel": np.zeros((3, 3)), "rack": np.stack([racks, 0 * racks, 0 * racks], -1)}
    with pytest.raises(absolute.UnreachableError) as refused:
        absolute.solve(model, inputs, effects=["toe_by_rack"])
    assert refused.value.partial is not None
    whole = absolute.solve(model, {name: law[:2] for name, law in inputs.items()}, effects=["toe_by_rack"])
    assert np.allclose(refused.value.partial.effects["toe_by_rack"], whole.effects["toe_by_rack"], rtol=1e-12)
