"""The parts of an axle have the numbers of their wheels alone; what both make of a printed car."""

from __future__ import annotations

from fractions import Fraction

import pytest
from lotus_front import POINTS as LOTUS
from mechanism_drawings import joined
from plain_mechanisms import plain_mechanism

from validate.published.tables import FOLDER
from validate.reference import Design, instants_of
from validate.reference.effects.effect import PAIR
from validate.reference.effects.registry import EFFECTS

LOTUS_STEERING = FOLDER / "lotus-steering.csv"
TOGETHER = tuple(name for name, one in EFFECTS.items() if PAIR in one.needs)


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
