"""Mechanisms from plain data alone: other people's tables, closed forms, and what is refused."""

import dataclasses
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from flat import built_in, flat, shipped
from numpy.typing import NDArray
from reach_of_accuracy import off
from wishbones import LOTUS, LOTUS_ANGLES, LOTUS_BUMP, TYRE_RADIUS

import absolute
from absolute.mechanism import Mechanism

Array = NDArray[np.float64]
DATA = Path(__file__).parent / "data"
EPS = float(np.finfo(float).eps)
TURN: dict[str, Any] = {"turn": {"angle": "crank", "from": "drawing", "on": "chassis"}}


def at(values: Any, rate: float = 0.0, second: float = 0.0) -> Array:
    """Value, rate and acceleration at N instants."""
    values = np.asarray(values, dtype=float)
    return np.stack([values, np.full_like(values, rate), np.full_like(values, second)], axis=-1)


def plain(
    bodies: dict[str, Any], points: dict[str, Any], inputs: dict[str, Any], **told: Any
) -> dict[str, Any]:
    """A mechanism that is no car."""
    axes = {"up": (0.0, 0.0, 1.0), "right": (0.0, 1.0, 0.0), "side": "left"}
    return {"name": "mechanism", "bodies": bodies, "points": points, "inputs": inputs, **axes, **told}


# The arm's table comes from a solver that stopped early: the closed form is 3e-8 rad and 2e-9 m off it.
@pytest.mark.parametrize(
    ("name", "angle", "length"), [("five_link", 1e-14, 1e-12), ("semi_trailing_arm", 5e-8, 5e-6)]
)
def test_other_peoples_tables_are_met(name: str, angle: float, length: float) -> None:
    case = json.loads((DATA / f"{name}.json").read_text())
    points = {point: 1000.0 * np.array(place) for point, place in case["points"].items()}
    # x forward, y left.
    model = built_in(name, points, ["wheel_travel"], right=(0.0, -1.0, 0.0))
    travel, _, camber, toe, track = np.array(case["table"]).T
    motion = absolute.solve(model, {"wheel_travel": at(1000.0 * travel)}, effects=["camber", "toe"])
    assert np.abs(motion.effects["camber"] - camber).max() <= angle
    assert np.abs(motion.effects["toe"] - toe).max() <= angle
    side = motion.position["wheel_centre"][:, 1] - points["wheel_centre"][1]
    assert np.abs(side - 1000.0 * track).max() <= length
    assert (
        np.abs(motion.position["wheel_centre"][:, 2] - points["wheel_centre"][2] - 1000.0 * travel).max()
        < 1e-10
    )


def test_the_height_of_the_contact_point_drives_the_printed_car() -> None:
    file = shipped("double_wishbone")
    file["inputs"]["bump"] = {"contact": ["wheel_axis_inner", "wheel_centre"]}
    model = absolute.compile(flat(file, LOTUS, ["bump", "rack"], side="right", wheel_radius=TYRE_RADIUS))
    bump, rest = np.array(LOTUS_BUMP), np.zeros(len(LOTUS_BUMP))
    motion = absolute.solve(model, {"bump": at(bump), "rack": at(rest)}, effects=tuple(LOTUS_ANGLES))
    for name, printed in LOTUS_ANGLES.items():
        assert np.abs(np.degrees(motion.effects[name]) - printed).max() <= 5e-5, name
    assert set(motion.position) == set(LOTUS)
    assert set(motion.angular_velocity) == {"lower_arm", "upper_arm", "knuckle"}


def test_rates_of_the_contact_height_are_those_of_its_differences() -> None:
    file = shipped("semi_trailing_arm")
    file["inputs"]["bump"] = {"contact": ["wheel_axis_inner", "wheel_centre"]}
    case = json.loads((DATA / "semi_trailing_arm.json").read_text())
    points = {point: 1000.0 * np.array(place) for point, place in case["points"].items()}
    points["wheel_axis_inner"] = points["wheel_axis_inner"] + [10.0, 0.0, 12.0]
    model = absolute.compile(flat(file, points, ["bump"], right=(0.0, -1.0, 0.0), wheel_radius=305.0))
    h, v, a = 1e-3, 30.0, 20.0
    t = np.array([-h, 0.0, h])
    motion = absolute.solve(
        model, {"bump": np.stack([40.0 + v * t + a * t * t / 2, v + a * t, a + 0.0 * t], -1)}
    )
    # The lowest point of the disc from its axis alone.
    axis = motion.position["wheel_centre"] - motion.position["wheel_axis_inner"]
    axis /= np.linalg.norm(axis, axis=1)[:, None]
    height = motion.position["wheel_centre"][:, 2] - 305.0 * np.sqrt(1.0 - axis[:, 2] ** 2)
    drawn = points["wheel_centre"] - points["wheel_axis_inner"]
    lowest = points["wheel_centre"][2] - 305.0 * np.sqrt(1.0 - (drawn[2] / np.linalg.norm(drawn)) ** 2)
    assert height - lowest == pytest.approx(40.0 + v * t + a * t * t / 2, abs=1e-10)
    centre = motion.position["wheel_centre"]
    # Differences: truncation h^2 times third and fourth derivatives below 1e3 and 1e4.
    assert motion.velocity["wheel_centre"][1] == pytest.approx(
        (centre[2] - centre[0]) / (2 * h), abs=1e3 * h * h
    )
    second = (centre[2] - 2 * centre[1] + centre[0]) / h**2
    assert motion.acceleration["wheel_centre"][1] == pytest.approx(second, abs=1e4 * h * h)


def crank_of(inputs: dict[str, Any], **told: Any) -> absolute.Model:
    """A crank of 300 mm about x, and beside it a rod of 700 mm to a point that slides to the right."""
    points = {
        "a": (0, 0, 0),
        "b": (100, 0, 0),
        "end": (0, 180, 240),
        "slide": (0, 180 + np.sqrt(700**2 - 240**2), 0),
    }
    return absolute.compile(
        plain({"chassis": ["a", "b"], "crank": ["a", "b", "end"]}, points, inputs, **told)
    )


RIDING = {
    "rods": {"rod": ["end", "slide"]},
    "slides": {
        "bore": {"points": ["slide"], "body": "chassis", "through": "a", "along": "right", "turns": True}
    },
}


def test_a_hinge_turns_from_the_drawing_by_any_number_of_turns() -> None:
    with pytest.raises(absolute.DescriptionError, match="belong to no body"):
        crank_of(TURN)
    model = crank_of(TURN, **RIDING)
    turn = np.array([0.0, 1.0, 3.0, 7.0, 20.0, -50.0, -1.0])
    motion = absolute.solve(model, {"turn": at(turn, 2.0, -3.0)}, conditions=True)
    angle = np.arctan2(240, 180) + turn
    y, z = 300 * np.cos(angle), 300 * np.sin(angle)
    root = np.sqrt(700**2 - z**2)
    # y + sqrt(l^2 - z^2), with y' = -z w, z' = y w, w = 2, w' = -3.
    y1, z1 = -2 * z, 2 * y
    y2, z2 = 3 * z - 4 * y, -3 * y - 4 * z
    root1 = -z * z1 / root
    root2 = (-(z1**2) - z * z2 - root1**2) / root
    for found, expected, fast in (
        (motion.position, y + root, 1.0),
        (motion.velocity, y1 + root1, 2.0),
        (motion.acceleration, y2 + root2, 7.0),
    ):
        # The turns asked for are rounded, and so is this form.
        rounding = 16 * EPS * (1.0 + np.abs(turn)) * np.abs(expected).max()
        assert (np.abs(found["slide"][:, 1] - expected) <= fast * off(motion) + rounding).all()
    assert np.allclose(motion.angular_velocity["crank"], [2.0, 0.0, 0.0], rtol=0, atol=1e-14)
    assert set(motion.angular_velocity) == {"crank"}


@pytest.mark.parametrize(
    "given",
    [
        {"travel": ["bore"]},
        {"distance": ["a", "slide"]},
        {"height": "slide", "along": "right"},
        {"height": "end"},
        {"angle": "crank", "of": "end", "about": "a", "from": "up"},
    ],
    ids=["travel", "distance", "height along", "height", "angle"],
)
def test_every_input_leads_to_the_pose_that_the_turn_leads_to(given: dict[str, Any]) -> None:
    turned = absolute.solve(crank_of(TURN, **RIDING), {"turn": at([0.3], 0.5, -0.25)})
    slide, end = turned.position["slide"][0], turned.position["end"][0]
    rates = [turned.velocity, turned.acceleration]
    if "angle" in given:
        value = np.arctan2(180, 240) - 0.3
        law = [value, -0.5, 0.25]
    elif given.get("height") == "end":
        law = [end[2] - 240, *(rate["end"][0, 2] for rate in rates)]
    else:
        drawn = 180 + np.sqrt(700**2 - 240**2) if "height" in given else 0.0
        law = [slide[1] - drawn, *(rate["slide"][0, 1] for rate in rates)]
    motion = absolute.solve(crank_of({"in": given}, **RIDING), {"in": np.array([law])}, conditions=True)
    assert motion.condition is not None
    tolerance = 64 * EPS * 1000 * motion.condition[0]
    for name in ("end", "slide"):
        for quantity in ("position", "velocity", "acceleration"):
            found, expected = (getattr(solved, quantity)[name] for solved in (motion, turned))
            assert np.allclose(found, expected, rtol=0, atol=tolerance), (name, quantity)


def four_bar(tilt: float = 0.0) -> absolute.Model:
    """Hinges along x at (0, 0), (40, 30), (160, 60), (150, 0) in y and z; the last one tilted."""
    places = [(0, 0), (40, 30), (160, 60), (150, 0)]
    points = {f"p{i}": (0, y, z) for i, (y, z) in enumerate(places)}
    points |= {f"q{i}": (100, y + (100 * tilt if i == 3 else 0), z) for i, (y, z) in enumerate(places)}
    bodies = {
        "chassis": ["p0", "q0", "p3", "q3"],
        "crank": ["p0", "q0", "p1", "q1"],
        "coupler": ["p1", "q1", "p2", "q2"],
        "rocker": ["p2", "q2", "p3", "q3"],
    }
    return absolute.compile(plain(bodies, points, TURN))


def test_a_four_bar_of_hinges_follows_its_circles() -> None:
    model = four_bar()
    left_out = Mechanism(model).redundant
    assert left_out is not None
    assert left_out.count == 3
    turn = np.linspace(-0.4, 0.9, 27)
    motion = absolute.solve(model, {"turn": at(turn, 1.0)}, conditions=True)
    pin = 50.0 * np.exp(1j * (np.arctan2(30, 40) + turn))
    # The joint is where circles about the pin and about the other pivot meet, on the drawn side.
    across = 150.0 - pin
    coupler, rocker = np.hypot(120, 30), np.hypot(10, 60)
    along = (coupler**2 - rocker**2 + np.abs(across) ** 2) / (2 * np.abs(across))
    joint = pin + across / np.abs(across) * (along + 1j * np.sqrt(coupler**2 - along**2))
    found = motion.position["p2"]
    error = np.abs(found[:, 1] + 1j * found[:, 2] - joint)
    assert (error <= off(motion) + 32 * EPS * 200.0).all()
    assert np.abs(found[:, 0]).max() < 1e-12
    slope = (found[2:] - found[:-2]) / (turn[2] - turn[0])
    assert motion.velocity["p2"][1:-1] == pytest.approx(slope, abs=1.0)


@pytest.mark.parametrize("tilt", [1e-10, 1e-9])
def test_a_four_bar_whose_hinges_are_not_quite_parallel_is_locked(tilt: float) -> None:
    with pytest.raises(absolute.PoseError, match="hinge of"):
        absolute.solve(four_bar(tilt), {"turn": at([0.0, 0.5])})


def test_a_gradient_by_an_input_that_cannot_move_is_refused_as_its_rates_are() -> None:
    bars = four_bar(1e-10)
    roles = dataclasses.replace(bars.corner, roles={"wheel_axis": ("q1", "q2")})
    model = dataclasses.replace(bars, corner=roles)
    assert absolute.solve(model, {"turn": at([0.0])}, effects=["toe"]).effects
    for rate, effects in ((1.0, ["toe"]), (0.0, ["toe_by_travel"])):
        with pytest.raises(absolute.AssemblyError, match=r"hinge of.*locked"):
            absolute.solve(model, {"turn": at([0.0], rate)}, effects=effects)


def test_a_four_bar_whose_hinges_are_not_parallel_is_held_more_than_once() -> None:
    with pytest.raises(absolute.DescriptionError, match=r"hinge of.*held more than once"):
        absolute.solve(four_bar(0.01), {"turn": at([0.0])})


def bricard() -> tuple[absolute.Model, Array, Array]:
    case = json.loads((DATA / "bricard.json").read_text())
    places, axes = 1000.0 * np.array(case["points"], float), np.array(case["axes"], float)
    points = {f"p{i}": places[i] for i in range(6)} | {f"q{i}": places[i] + 100.0 * axes[i] for i in range(6)}
    bodies = {"chassis": ["p5", "q5", "p0", "q0"]}
    bodies |= {
        ("crank", "b", "c", "d", "e")[i]: [f"p{i}", f"q{i}", f"p{i + 1}", f"q{i + 1}"] for i in range(5)
    }
    turns, ends = zip(*case["table"], strict=True)
    return absolute.compile(plain(bodies, points, TURN)), np.radians(turns), 1000.0 * np.array(ends)


def test_bricards_six_hinges_move_as_their_closed_form_says() -> None:
    model, turns, ends = bricard()
    motion = absolute.solve(model, {"turn": at(turns)}, conditions=True)
    error = np.abs(motion.position["p3"] - ends)
    # The turns are rounded once, and near its fold the end moves by some ten times as much.
    assert (error <= off(motion)[:, None] + 10 * EPS * 1000.0).all()
    assert error.max() < 1e-11


@pytest.mark.parametrize(
    ("degrees", "limit"), [(-31.0, -30.0), (211.0, 210.0), (360.0, 210.0), (720.0, 210.0)]
)
def test_bricards_six_hinges_are_not_led_beyond_their_fold(degrees: float, limit: float) -> None:
    # One row follows from the others up to there only: without it bodies could go on, torn apart.
    model, _, _ = bricard()
    with pytest.raises(absolute.UnreachableError) as caught:
        absolute.solve(model, {"turn": at([np.radians(degrees)])})
    assert np.degrees(caught.value.reached["turn"]) == pytest.approx(limit, abs=1e-6)


def test_andrews_squeezer_is_where_its_printed_angles_say_after_two_and_a_half_turns() -> None:
    case = json.loads((DATA / "andrews_squeezer.json").read_text())
    c = {name: 1000.0 * length for name, length in case["constants_m"].items()}

    def joints(angles: list[float]) -> dict[str, complex]:
        q = dict(zip(case["order"], angles, strict=True))
        pin = c["rr"] * np.exp(1j * q["beta"])
        middle = pin - c["d"] * np.exp(1j * (q["beta"] + q["theta"]))
        e = middle + 1j * c["e"] * np.exp(1j * (q["phi"] + q["delta"]))
        f = middle - c["zf"] * np.exp(1j * (q["omega"] + q["epsilon"]))
        return {"pin": pin, "middle": middle, "e": e, "f": f}

    drawn = joints(case["q0"]) | {"o": 0.0, "a": complex(c["xa"], c["ya"]), "b": complex(c["xb"], c["yb"])}
    points = {f"{n}{z}": (complex(p).real, complex(p).imag, z) for n, p in drawn.items() for z in (0.0, 20.0)}

    def body(*names: str) -> list[str]:
        return [f"{name}{z}" for name in names for z in (0.0, 20.0)]

    bodies = {
        "chassis": body("o", "a", "b"),
        "crank": body("o", "pin"),
        "second": body("pin", "middle"),
        **{
            f"arm {k}": body(*ends.split())
            for k, ends in enumerate(("middle b", "middle e", "e a", "middle f", "f a"))
        },
    }
    turn = case["q_t003"][0] - case["q0"][0]
    motion = absolute.solve(
        absolute.compile(plain(bodies, points, TURN)), {"turn": at([turn])}, conditions=True
    )
    for name, place in joints(case["q_t003"]).items():
        found = motion.position[f"{name}0.0"][0]
        # The angles are printed to 16 digits, and hold to 2.1e-15 rad.
        rounding = 50.0 * (2.1e-15 + 4 * EPS * turn)
        assert abs(complex(*found[:2]) - place) <= off(motion)[0] + rounding, name


def test_a_slide_of_two_points_of_one_body_may_turn_or_not() -> None:
    points = {"a": (0, 0, 0), "b": (0, 100, 0), "c": (0, 300, 0), "d": (30, 350, 40), "e": (200, 300, 0)}
    slide = {"points": ["b", "c"], "body": "chassis", "through": "a", "along": "right"}
    bodies = {"chassis": ["a", "e"], "ram": ["b", "c", "d"]}
    travel = {"out": {"travel": ["bore"]}}
    fixed = absolute.compile(plain(bodies, points, travel, slides={"bore": {**slide, "turns": False}}))
    motion = absolute.solve(fixed, {"out": at([130.0])})
    assert motion.position["d"][0] == pytest.approx([30.0, 380.0, 40.0], abs=1e-12)
    turning = {**travel, "lift": {"height": "d"}}
    free = absolute.compile(plain(bodies, points, turning, slides={"bore": {**slide, "turns": True}}))
    motion = absolute.solve(free, {"out": at([130.0]), "lift": at([-10.0])})
    assert motion.position["d"][0] == pytest.approx([40.0, 380.0, 30.0], abs=1e-11)


def test_several_slides_take_one_value() -> None:
    points = {"a": (0, 0, 0), "p": (0, 10, 0), "q": (0, -20, 0)}
    slides = {
        name: {"points": [end], "body": "chassis", "through": "a", "along": "right", "turns": True}
        for name, end in (("one", "p"), ("two", "q"))
    }
    both = {"both": {"travel": ["one", "two"]}}
    model = absolute.compile(plain({"chassis": ["a"]}, points, both, slides=slides))
    assert model.values == ("both",)
    motion = absolute.solve(model, {"both": at([30.0], 4.0)})
    assert [motion.position[end][0, 1] for end in "pq"] == pytest.approx([30.0, 30.0], abs=1e-12)
    assert [motion.velocity[end][0, 1] for end in "pq"] == pytest.approx([4.0, 4.0], abs=1e-12)


@pytest.mark.parametrize(
    ("change", "say"),
    [
        ({"rods": {"rod": ["end", "nowhere"]}}, "end of rod 'rod' is 'nowhere'"),
        ({"rods": {"rod": ["end", "a"]}}, "keep their distance"),
        ({"rods": {"rod": ["end"]}}, "1 points; two"),
        ({"inputs": {"in": {"angle": "crank", "from": "above"}}}, "`from` of input 'in' is 'above'"),
        ({"inputs": {"in": {"angle": "chassis", "from": "drawing"}}}, "a hinge of two is needed"),
        ({"inputs": {"in": {"travel": ["bore"]}}}, "a slide of input 'in' is 'bore'"),
        ({"inputs": {"in": {"height": "a"}}}, "name a point of another body"),
        ({"inputs": {"in": {"contact": ["a", "end"]}}}, "wheel_radius"),
        ({"inputs": {"in": {"pull": "a"}}}, "kind of input 'in'"),
        ({"inputs": {}}, "5 rows for 6"),
        ({"side": "top"}, "side is 'top'"),
        ({"right": (0.0, 1.0, 0.1)}, "right angle"),
        ({"roles": {"wheel_axis": ["a", "hub"]}}, "wheel_axis is 'hub'"),
        ({"bodies": {"crank": ["a"]}}, "the ground is 'chassis'"),
        ({"bodies": {"chassis": ["a", "b", "end"], "crank": ["a", "b", "end"]}}, "two make a hinge"),
    ],
)
def test_what_cannot_be_compiled_is_refused_in_a_line(change: dict[str, Any], say: str) -> None:
    points = {"a": (0, 0, 0), "b": (100, 0, 0), "end": (0, 180, 240)}
    bodies = {"chassis": ["a", "b"], "crank": ["a", "b", "end"]}
    with pytest.raises(absolute.DescriptionError, match=say) as caught:
        absolute.compile({**plain(bodies, points, TURN), **change})
    assert "\n" not in str(caught.value)


def test_an_effect_without_its_role_is_refused_by_the_roles_name() -> None:
    case = json.loads((DATA / "five_link.json").read_text())
    model = built_in("five_link", case["points"], ["wheel_travel"], right=(0.0, -1.0, 0.0))
    still = {"wheel_travel": at([0.0])}
    assert absolute.solve(model, still, effects=["toe"]).effects["toe"][0] == pytest.approx(0.0, abs=1e-14)
    with pytest.raises(absolute.DescriptionError, match="steering_axis"):
        absolute.solve(model, still, effects=["caster"])
