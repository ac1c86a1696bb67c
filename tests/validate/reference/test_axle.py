"""The parts of an axle have the numbers of their wheels alone; what both make of a printed car."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from lotus_front import POINTS as LOTUS
from mechanism_drawings import described, joined
from plain_mechanisms import plain_mechanism

from validate.published.tables import FOLDER
from validate.reference import Design, Instant, instants_of, solve_reference
from validate.reference.dual import Dual
from validate.reference.effects.car import WHEEL, Car, DrawnCar, Line
from validate.reference.effects.effect import PAIR
from validate.reference.effects.registry import EFFECTS

LOTUS_STEERING = FOLDER / "lotus-steering.csv"
TOGETHER = tuple(name for name, one in EFFECTS.items() if PAIR in one.needs)


def wheel(side: int, pivots: Mapping[str, Any]) -> dict[str, Any]:
    """An upright wheel of radius 300 on an arm, at y = 700 or -700."""
    return described(
        {"inner": (1000, side * 650, 300), "centre": (1000, side * 700, 300), **pivots},
        {"chassis": list(pivots), "arm": [*pivots, "inner", "centre"]},
        {"swing": {"angle": "arm", "from": "drawing"}},
        roles={"knuckle": "arm", "wheel_axis": ["inner", "centre"]},
        side="right" if side > 0 else "left",
        wheel_radius=300,
        car={"wheelbase": 2600},
    )


def axle_on(left: Mapping[str, Any], right: Mapping[str, Any]) -> dict[str, Any]:
    return joined({"left": wheel(-1, left), "right": wheel(1, right)})


# Wheels that are turned about upright lines through their contact points, to the left by their inputs.
STEERED = axle_on(*({"low": (1000, y, 0), "high": (1000, y, 100)} for y in (-700, 700)))


def steered(left: object, right: object) -> Instant:
    return solve_reference(
        STEERED,
        {"left.swing": (left, 0, 0), "right.swing": (right, 0, 0)},
        effects=(*TOGETHER, "steer_angle"),
    )


def test_the_axle_of_lotus_turns_on_its_printed_radius_and_with_nearly_its_ackermann() -> None:
    mirrored = {name: (x, -y, z) for name, (x, y, z) in LOTUS.items()}
    driven, car = ["contact_travel"], {"wheelbase": 1600}
    parts = {
        side: plain_mechanism("double_wishbone", points, driven, side=side, wheel_radius=270, car=car)
        for side, points in (("left", mirrored), ("right", LOTUS))
    }
    axle = Design.from_plain(joined(parts, rack={"travel": ["left.rack", "right.rack"]}))
    printed = [row.split(",") for row in LOTUS_STEERING.read_text().splitlines()[1::7]]
    # The printed rack travel is positive to the right, S to the left. The contact points keep their height.
    still = {f"{side}.contact_travel": (0, 0, 0) for side in parts}
    inputs = [{**still, "rack": (-Fraction(row[0]), 0, 0)} for row in printed]
    for row, instant in zip(printed, instants_of(axle, inputs, 20, effects=TOGETHER), strict=True):
        assert float(instant.effects["turning_radius"]) == pytest.approx(float(row[6]), abs=0.005)
        assert float(instant.effects["ackermann"]) == pytest.approx(float(row[5]), abs=0.04)


def corners(turns: np.ndarray) -> list[Car]:
    """Upright wheels steered by angles (N,), duals of slope 1; x rearward, y right, z up."""
    found = []
    for out in (-1.0, 1.0):
        sine, cosine = Dual(np.sin(turns), np.cos(turns)[None]), Dual(np.cos(turns), -np.sin(turns)[None])
        along = (sine * -out, cosine * out, Dual(0.0 * turns, 0.0 * turns[None]))
        centre, drawn = (0.0, 700.0 * out, 300.0), (0.0, out, 0.0)
        as_drawn = {WHEEL: Line(centre, centre, drawn)}
        axes = (0.0, 0.0, 1.0), (-1.0, 0.0, 0.0), (0.0, out, 0.0)
        whole = DrawnCar({}, as_drawn, *axes, 300.0, (0.0, 0.0, 0.0), {"wheelbase": 2600.0})
        lines = {WHEEL: Line(centre, centre, along)}
        found.append(Car(whole, lines, lines))
    return found


@pytest.mark.parametrize("name", ["turning_radius", "ackermann", "ackermann_error"])
def test_in_arrays_of_duals_the_numbers_and_their_slopes_are_those_of_balls(name: str) -> None:
    turns = np.array([0.3, -0.2, 0.0])
    step = 1e-6
    with np.errstate(divide="ignore", invalid="ignore"):  # the last wheels are not steered
        found = EFFECTS[name].evaluate(*corners(turns))
        ahead, behind = (EFFECTS[name].evaluate(*corners(turns + s)).value for s in (step, -step))
    for i, turn in enumerate(turns[:2]):
        want = float(steered(Fraction(turn), Fraction(turn)).effects[name])
        assert found.value[i] == pytest.approx(want, rel=1e-9, abs=1e-9)
        slope = (ahead[i] - behind[i]) / (2 * step)
        assert found.slope[0, i] == pytest.approx(slope, rel=1e-6, abs=1e-6 * abs(found.value[0]))
    assert np.isnan(found.value[2])
