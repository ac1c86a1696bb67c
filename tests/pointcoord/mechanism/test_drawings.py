"""What is drawn is what is solved, of every suspension that takes its drawing as it stands."""

from collections.abc import Callable

import numpy as np
import pytest
from sample_cars import SampleCar, by_drawn_car

from pointcoord import Scene, SceneError, simulate


@by_drawn_car
def test_a_rack_without_a_centre_starts_at_the_drawn_tie_rod(
    make_scene: Callable[..., Scene], car: SampleCar
) -> None:
    without = {name: place for name, place in car.points.items() if name != "rack_centre"}
    one, other = (
        simulate(make_scene([1.55], [0.0, 10.0], car=car, points=points, stop=1.0))
        for points in ({**without, "rack_centre": without["tie_rod_inner"]}, without)
    )
    for name in one.position:
        assert np.array_equal(one.position[name], other.position[name])


@by_drawn_car
@pytest.mark.parametrize("side", ["left", "right"])
def test_a_wheel_inboard_of_the_chassis_is_refused_with_the_side_to_try(
    make_scene: Callable[..., Scene], car: SampleCar, side: str
) -> None:
    sign = 1.0 if side == car.side else -1.0
    points = {name: (x, sign * y, z) for name, (x, y, z) in car.points.items()}
    assert make_scene(car=car, points=points, side=side)
    other = "right" if side == "left" else "left"
    inboard, wheel = car.topology.inboard, car.topology.wheel_centre
    far = abs(car.points[inboard][1] - car.points[wheel][1])
    with pytest.raises(SceneError, match=f"{far:.6g} mm inboard of {inboard}") as caught:
        make_scene(car=car, points=points, side=other)
    assert f"side = '{side}'" in str(caught.value)


@by_drawn_car
def test_a_spin_axis_without_a_direction_is_refused(make_scene: Callable[..., Scene], car: SampleCar) -> None:
    inner, outer = car.whole.wheel_axis
    with pytest.raises(SceneError, match=f"{inner} and {outer} are at the same place"):
        make_scene(car=car, points={**car.points, inner: car.points[outer]})


def test_the_wheels_of_an_axle_are_checked_as_one_wheel_is() -> None:
    content = Scene.load("axle-opposed").model_dump(exclude_none=True)
    points = content["mechanism"]["points"]
    for moved, words in (
        ({"left.wheel_axis_inner": points["left.wheel_centre"]}, "left.wheel_centre are at the same place"),
        (
            {"left.wheel_centre": points["right.wheel_centre"]},
            "left.wheel_centre lies 1106 mm inboard of left.upper_arm_front for side = 'left'",
        ),
    ):
        part = {**content["mechanism"], "points": {**points, **moved}}
        with pytest.raises(SceneError, match=words):
            Scene.from_mapping({**content, "mechanism": part})
