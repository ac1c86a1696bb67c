"""Drawings at the ends of the floating-point range are solved or refused, and nothing overflows."""

import dataclasses
import warnings
from collections.abc import Callable, Iterator

import numpy as np
import pytest
from kinds import Car, Kind
from numpy.typing import NDArray

import absolute
from absolute import Axis, DescriptionError

Array = NDArray[np.float64]
Held = Callable[[float, float], dict[str, Array]]
HUGE = [1.1e100, 1e154, 1.4e154, 1e155, 1e200, 1e300, 1.7976931348623157e308]
TINY = [5e-324, 1e-310, 2.3e-308, 1e-200, 1e-110]


@pytest.fixture(autouse=True)
def _warnings_are_errors() -> Iterator[None]:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        yield


def with_coordinate(car: Car, name: str, place: int, value: float) -> Car:
    point = car[name].copy()
    point[place] = value
    return {**car, name: point}


@pytest.mark.parametrize("value", [sign * huge for huge in HUGE for sign in (1, -1)])
def test_a_huge_coordinate_is_refused_with_its_point_and_the_limit(kind: Kind, value: float) -> None:
    for name in kind.car:
        for place in range(3):
            with pytest.raises(DescriptionError, match=r"products .* overflow.*1e\+100 mm") as caught:
                kind.build(with_coordinate(kind.car, name, place, value))
            assert caught.value.name == name
    with pytest.raises(DescriptionError, match=r"1e\+100"):
        kind.build(dict.fromkeys(kind.car, (value, value, value)))


@pytest.mark.parametrize(
    "value", [sign * large for large in (1e10, 1e15, 1e30, 1e60, 1e100) for sign in (1, -1)]
)
def test_one_coordinate_far_from_the_others_is_solved_or_refused_without_a_warning(
    kind: Kind, held: Held, value: float
) -> None:
    for name in kind.car:
        for place in range(3):
            model = kind.build(with_coordinate(kind.car, name, place, value))
            try:
                motion = absolute.solve(model, held(1.6, 0.0))
            except (DescriptionError, absolute.PoseError):
                continue
            assert all(np.isfinite(array).all() for array in motion.acceleration.values())


@pytest.mark.parametrize("factor", [1e-90, 1e-30, 1e30, 1e97, -1e97])
def test_a_car_drawn_in_another_unit_moves_the_same_up_to_the_ends_of_the_range(
    kind: Kind, held: Held, factor: float
) -> None:
    scaled = {name: tuple(factor * x for x in point) for name, point in kind.car.items()}
    # A negative factor turns every vector round: the car's own axes as well.
    sense = float(np.sign(factor))
    model = kind.build(scaled, up=(0, 0, sense), right=(0, sense, 0))
    goal = {"arm_angle": np.array([[1.5, 0.3, 0.2]]), "rack": np.array([[10.0, 4.0, 3.0]])}
    plain = absolute.solve(kind.build(kind.car), goal)
    motion = absolute.solve(model, {**goal, "rack": goal["rack"] * abs(factor)})
    for name in kind.car:
        for a, b in (
            (motion.position, plain.position),
            (motion.velocity, plain.velocity),
            (motion.acceleration, plain.acceleration),
        ):
            # Two solutions of a car of 500 mm, condition number below 60.
            assert np.allclose(a[name] / factor, b[name], rtol=0, atol=2 * np.finfo(float).eps * 500 * 60)


@pytest.mark.parametrize("factor", TINY)
def test_a_car_too_small_for_products_of_its_lengths_is_refused(
    kind: Kind, held: Held, factor: float
) -> None:
    small = {name: tuple(factor * x for x in point) for name, point in kind.car.items()}
    with pytest.raises(DescriptionError, match="at least 1e-100 mm"):
        absolute.solve(kind.build(small), held(1.6, 0.0))


@pytest.mark.parametrize("value", [-0.0, 5e-324, -1e-110])
def test_a_coordinate_that_is_almost_zero_is_as_good_as_zero(kind: Kind, held: Held, value: float) -> None:
    for name in kind.car:
        for place in range(3):
            outcomes = []
            for number in (0.0, value):
                model = kind.build(with_coordinate(kind.car, name, place, number))
                try:
                    outcomes.append(absolute.solve(model, held(1.6, 0.0)).position["wheel_centre"].tolist())
                except (DescriptionError, absolute.PoseError) as error:
                    outcomes.append(type(error))
            assert outcomes[0] == outcomes[1]


@pytest.mark.parametrize("value", [0.0, 5e-324, 1.0, 1e90])
def test_a_drawing_without_size_is_refused(kind: Kind, model: absolute.Model, value: float) -> None:
    point = dict.fromkeys(kind.car, (value, value, value))
    with pytest.raises(DescriptionError, match="coincide"):
        kind.build(point)
    with pytest.raises(DescriptionError, match="at least 1e-100 mm"):
        absolute.solve(
            dataclasses.replace(model, points=point),
            {"arm_angle": np.zeros((1, 3)), "rack": np.zeros((1, 3))},
        )


@pytest.mark.parametrize("scale", [5e-324, 1e-200, 1e155, 1.7e308])
def test_the_length_of_a_direction_does_not_matter(model: absolute.Model, held: Held, scale: float) -> None:
    slide = Axis("rack_centre", (0.0, -scale, 0.0)), Axis("tie_rod_inner", (0.0, -scale, 0.0))
    joint = dataclasses.replace(model.joints["slide rack"], on_first=slide[0], on_second=slide[1])
    drive = dataclasses.replace(model.inputs["rack"], axis=slide[0])
    other = dataclasses.replace(
        model,
        joints={**model.joints, "slide rack": joint},
        inputs={**model.inputs, "rack": drive},
    )
    plain, motion = absolute.solve(model, held(1.6, 10.0)), absolute.solve(other, held(1.6, 10.0))
    for name in model.points:
        assert (motion.position[name] == plain.position[name]).all()
