"""A car that turns and is displaced in every way while its wheel moves, by all three mechanics."""

import numpy as np
import pytest
from mpmath import mpf
from one_arm import BOTH, DRAWN, place, tables
from three_mechanics import assert_exact, by_each, over_time, scene_of, solved_by

from pointcoord import InputOutOfRange, simulate

# Exact in binary.
LAWS = {
    "turn": [0.1875, -0.375],
    "steer": [-12.0, 40.0],
    "roll": [0.0625, -0.25],
    "pitch": [-0.125, 0.1875],
}
# Of this car, whose x leads rearward and y to the right.
WAYS = {
    **{"up": (0, 0, 1), "down": (0, 0, -1), "left": (0, -1, 0), "right": (0, 1, 0)},
    **{"forward": (-1, 0, 0), "rearward": (1, 0, 0)},
}


@by_each
@pytest.mark.parametrize("turns", [BOTH, BOTH[::-1]])
def test_a_car_turns_in_the_order_of_its_file_and_goes_along_every_direction(
    who: str, turns: tuple[str, ...]
) -> None:
    mechanism = tables(turns=turns)
    mechanism["inputs"] |= {way: {"moves": "chassis", "along": way} for way in WAYS}
    laws = {way: [5.0, 2.0**speed] for speed, way in enumerate(WAYS)}

    def formula(time: mpf) -> dict[tuple[str, str], object]:
        values = {name: a + b * time for name, (a, b) in (LAWS | laws).items()}
        way = sum(values[name] * np.array(along) for name, along in WAYS.items())
        return {("position", name): place(name, values, turns) + way for name in DRAWN}

    assert_exact(solved_by(who, scene_of(mechanism, [], **LAWS, **laws)), over_time(formula))


def test_a_car_that_turns_too_fast_is_refused_with_when_and_what() -> None:
    with pytest.raises(InputOutOfRange, match="below 1e\\+140 rad/s in size"):
        simulate(scene_of(tables(), ["velocity"], **LAWS | {"roll": [0.0, 1e141]}))
