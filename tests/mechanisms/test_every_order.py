"""Time derivatives of points of every order that may be asked for, where a formula gives them."""

import pytest
from mpmath import cos, mpf, pi, sin
from three_mechanics import assert_exact, over_time, solved_by

from pointcoord import Scene
from pointcoord.effects.point_states import NAMED, STATES
from validate.formulations.asked_numbers import per_second
from validate.formulations.input_rates import laws_of

TURN = 3.2  # rad/s, right-handed about the crank's axis, which is y
STOP = 2  # s


def test_a_derivative_is_per_second_as_often_as_its_order_says() -> None:
    assert [*map(per_second, STATES)] == [*range(21)]
    assert STATES[: len(NAMED)] == NAMED
    assert STATES[len(NAMED) :] == tuple(f"derivative_{order}" for order in range(7, 21))


@pytest.mark.parametrize(
    "who", ["pointcoord", "pointcoord-newton", "pointcoord-map", "absolute", "reference"]
)
def test_every_derivative_of_a_crank_that_turns_evenly_is_the_one_before_turned_by_a_right_angle(
    who: str,
) -> None:
    scene = Scene.load("slider-crank").model_dump(exclude_none=True)
    scene["time"] = {"start": 0.0, "stop": float(STOP), "samples": 3}
    asked = Scene.from_mapping(scene | {"effects": STATES[1:]})
    assert {law.shape for law in laws_of(asked, asked.instants).values()} == {(3, 21)}
    solution = solved_by(who, asked)
    x, _, z = map(mpf, scene["mechanism"]["points"]["crank_pin"])
    for order, name in enumerate(STATES):

        def formula(time: mpf, order: int = order, name: str = name) -> dict[tuple[str, str], object]:
            turn, size = mpf(TURN) * STOP * time + order * pi / 2, mpf(TURN) ** order
            place = (x * cos(turn) + z * sin(turn), mpf(0), z * cos(turn) - x * sin(turn))
            return {(name, "crank_pin"): tuple(size * part for part in place)}

        # Claims grow with each order, by so many digits on average.
        digits = {"pointcoord-map": 0.65, "absolute": 0.6}.get(who, 0.5)
        assert_exact(solution, over_time(formula), within=1e-14 * 10.0 ** (digits * order))
