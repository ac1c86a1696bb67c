"""What the angles of a car's lines are drawn, doubted and proven as, of lines that are placed by hand."""

from types import SimpleNamespace

import numpy as np
import pytest

from pointcoord.effects.angle import Angle
from pointcoord.effects.camber import LEAN as CAMBER
from pointcoord.effects.effect import Doubt
from pointcoord.effects.wheel_angles import KINGPIN, WHEEL_ANGLES
from pointcoord.linkage.car_axes import CarAxes
from pointcoord.numerics.enclosure import Enclosed

UP, RIGHT = np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0])
AXES = CarAxes(UP, RIGHT, RIGHT)
LOW = np.array([5.0, 600.0, 200.0])


def topology(stand_ins: dict[str, str]) -> SimpleNamespace:
    """A linkage whose wheel turns about inner - centre, steered about low - high."""
    own = {"inner", "centre", "low", "high"}
    lines = {"wheel_axis": ("inner", "centre"), "steering_axis": ("low", "high")}
    return SimpleNamespace(**lines, role=lambda name: lines.get(name, ()), stand_ins=stand_ins, points=own)


def drawn(camber: float, kingpin: float) -> dict[str, np.ndarray]:
    """Of a right wheel, deg."""
    c, k = np.radians([camber, kingpin])
    return {
        "inner": LOW,
        "centre": LOW + 80.0 * np.array([0.1, np.cos(c), -np.sin(c)]),
        "low": LOW,
        "high": LOW + 300.0 * np.array([0.1, -np.sin(k), np.cos(k)]),
    }


def doubts_of(stand_ins: dict[str, str], points: dict[str, np.ndarray]) -> list[Doubt]:
    return [n.doubt(topology(stand_ins), points, AXES, np.array(False)) for n in (CAMBER, KINGPIN)]


@pytest.mark.parametrize("sign", [-1.0, 1.0])
@pytest.mark.parametrize(
    ("stand_ins", "camber", "kingpin"),
    [
        ({}, 45.0, 45.0),
        # The wheel's axis starts at a point that stands in for its own.
        ({"axis": "inner"}, 10.0, 45.0),
        ({"axis": "low"}, 45.0, 45.0),
        # It has its own.
        ({"inner": "inner"}, 45.0, 45.0),
    ],
)
def test_lines_look_misdrawn_beyond_their_limits_only(
    stand_ins: dict[str, str], camber: float, kingpin: float, sign: float
) -> None:
    for steeper in (False, True):
        by = 0.5 if steeper else -0.5
        points = drawn(sign * (camber + by), sign * (kingpin + by))
        doubts = doubts_of(stand_ins, points)
        assert [bool(doubt.where) for doubt in doubts] == [steeper, steeper]
    doubt = CAMBER.doubt(topology(stand_ins), points, AXES, np.array(True))
    assert not doubt.where
    wrong = doubts_of(stand_ins, drawn(89.5, 90.5))
    assert ["swapped" in doubt.words(()) for doubt in wrong] == [False, True]


def test_angles_are_of_positions_and_their_errors_of_the_places_that_are_enclosed() -> None:
    points, moving = drawn(3.0, 8.0), {name: np.full(3, 7.0) for name in drawn(0.0, 0.0)}
    mechanism = SimpleNamespace(
        topology=topology({}),
        unit=1.0,
        origin=np.zeros(3),
        drawn_places=points,
        drawing=SimpleNamespace(vectors=points),
    )
    states = [points, moving, moving]
    poses = SimpleNamespace(states=states, in_chassis=points, mechanism=mechanism, axes=AXES)
    (found,) = WHEEL_ANGLES.evaluate(poses).values()
    assert {name: float(np.degrees(value)) for name, value in found.items()} == pytest.approx(
        {CAMBER.name: 3.0, KINGPIN.name: 8.0}
    )
    enclosed = [{name: Enclosed.of(place) for name, place in state.items()} for state in (points, moving)]
    numbers = {"wheel": {name: value + 1e-3 for name, value in found.items()}}
    known = SimpleNamespace(points=enclosed, in_chassis=enclosed[0], mechanism=mechanism, axes=AXES)
    (errors,) = WHEEL_ANGLES.errors(known, numbers).values()
    for name in found:
        assert errors[name][0] == pytest.approx(1e-3, rel=1e-5)


def test_only_what_is_measured_from_the_front_or_the_rear_is_lengthwise() -> None:
    def lean(sine: str, cosine: str) -> Angle:
        return Angle(sine, f"{sine} {cosine}", "", "wheel_axis", sine, cosine)

    some = (("forward", "up"), ("rearward", "up"), ("up", "forward"), ("up", "outboard"), ("down", "inboard"))
    angles = [lean(*pair) for pair in some]
    assert [angle.words for angle in angles if angle.lengthwise] == [
        "forward up",
        "rearward up",
        "up forward",
    ]
    effect = type(WHEEL_ANGLES).of("some", "", *angles)
    assert effect.derivative == 0
    assert [quantity.name for quantity in effect.quantities] == ["wheel"]


def test_a_line_without_a_length_is_refused_where_a_point_of_its_own_is_missing() -> None:
    apart = {name: tuple(place.tolist()) for name, place in drawn(3.0, 8.0).items()}
    together = apart | {"centre": apart["inner"]}
    missing = topology({"axis": "inner"})
    assert WHEEL_ANGLES.refusal(missing, apart, None) == ""
    assert "give the axis a point of its own, axis" in WHEEL_ANGLES.refusal(missing, together, None)
    assert WHEEL_ANGLES.refusal(topology({}), together, None) == ""
    assert WHEEL_ANGLES.refusal(topology({"axis": "elsewhere"}), together, None) == ""


def test_an_angle_without_a_limit_may_be_half_a_turn() -> None:
    angle = Angle("some", "some", "", "wheel_axis", "up", "outboard")
    points = {"inner": LOW, "centre": LOW - 80.0 * RIGHT}
    assert not angle.doubt(topology({}), points, AXES, np.array(False)).where
