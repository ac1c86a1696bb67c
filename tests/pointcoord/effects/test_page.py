"""The page of effects names every effect and number that there is, with its unit's kind."""

from pathlib import Path

import pytest

import pointcoord
from pointcoord.effects.registry import EFFECTS, NUMBERS_OF_THE_CAR

PAGE = (Path(pointcoord.__file__).parent / "effects" / "README.md").read_text(encoding="utf-8")
WAYS = ("_by_travel", "_by_rack")


@pytest.mark.parametrize("name", [n for n in (*EFFECTS, *NUMBERS_OF_THE_CAR) if not n.endswith(WAYS)])
def test_the_page_of_effects_says_what_each_is(name: str) -> None:
    assert f"`{name}`" in PAGE


def test_every_effect_of_positions_of_the_car_has_gradients_along_both_ways() -> None:
    plain = {n for n in NUMBERS_OF_THE_CAR if not n.endswith(WAYS)} - {"roll_centre_height"}
    assert {n + way for n in plain for way in WAYS} <= NUMBERS_OF_THE_CAR.keys()
