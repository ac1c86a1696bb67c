"""The double wishbone: against a printed table, in all its assemblies, and as other cars draw it."""

from collections.abc import Callable

import numpy as np
import pytest
from jets import DIGITS, errors_of
from kinds import KINDS, Array, Car, inputs_at
from mpmath import mp
from reach_of_accuracy import off
from strut_motion import drawn_inputs
from wishbone_motion import ASSEMBLIES, Signs, wishbone_motion
from wishbones import LOTUS, LOTUS_ANGLES, LOTUS_BUMP, TYRE_RADIUS, short_lower_arm

import absolute
from absolute.mechanism import Mechanism

EPS = float(np.finfo(float).eps)
SIZE = 500.0
KIND = KINDS["double wishbone"]
UP = np.array([0.0, 0.0, 1.0])


def contact_height(motion: absolute.Solution) -> Array:
    """Height of the lowest point of a thin wheel:  c = wheel centre - r unit(z - (z . n) n)."""
    n = motion.position["wheel_centre"] - motion.position["wheel_axis_inner"]
    n /= np.linalg.norm(n, axis=1)[:, None]
    down = UP - n[:, 2:] * n
    down /= np.linalg.norm(down, axis=1)[:, None]
    return np.asarray(motion.position["wheel_centre"][:, 2] - TYRE_RADIUS * down[:, 2])


def over_bump(effects: tuple[str, ...]) -> absolute.Solution:
    """The printed car at the printed bumps, the travel of the contact point; rack held."""
    model = KIND.build(LOTUS, side="right")
    drawn = absolute.close_drawing(model).inputs["arm_angle"]

    def at(angles: Array) -> absolute.Solution:
        still = np.zeros_like(angles)
        inputs = {"arm_angle": np.stack([angles, still, still], -1), "rack": np.zeros((len(angles), 3))}
        return absolute.solve(model, inputs, rates=False, effects=effects)

    static = contact_height(at(np.array([drawn])))
    angles, nudge = np.full(len(LOTUS_BUMP), drawn), 1e-4
    for _ in range(10):
        here = contact_height(at(angles)) - static
        slope = (contact_height(at(angles + nudge)) - static - here) / nudge
        angles = angles - (here - np.array(LOTUS_BUMP)) / slope
    motion = at(angles)
    assert np.abs(contact_height(motion) - static - np.array(LOTUS_BUMP)).max() < 1e-9
    return motion


def test_angles_over_bump_are_those_of_the_printed_table() -> None:
    motion = over_bump(tuple(LOTUS_ANGLES))
    for name, printed in LOTUS_ANGLES.items():
        # To four decimals of a degree.
        assert np.abs(np.degrees(motion.effects[name]) - printed).max() <= 5e-5, name


def redrawn(car: Car, signs: Signs) -> Car:
    """The car drawn in another of its assemblies."""
    exact = wishbone_motion(car, *((value, 0, 0) for value in drawn_inputs(car)), signs)
    assert exact is not None
    with mp.workdps(DIGITS):
        moved = {name: np.array([float(jet.x) for jet in place]) for name, place in exact.points.items()}
    return {**car, **moved}


@pytest.mark.parametrize("signs", ASSEMBLIES)
def test_each_of_the_eight_assemblies_keeps_to_its_own(signs: Signs) -> None:
    for seed in range(4):
        car = redrawn(short_lower_arm(seed), signs)
        angle, rack = drawn_inputs(car)
        t = np.linspace(0.0, 1.0, 12)
        inputs = {
            "arm_angle": np.stack([angle + 0.12 * np.sin(6 * t), 0 * t, 0 * t], -1),
            "rack": np.stack([rack + 12.0 * t, 0 * t, 0 * t], -1),
        }
        motion = absolute.solve(KIND.build(car), inputs, rates=False, conditions=True)
        for k in range(len(t)):
            goal = (inputs[name][k].tolist() for name in ("arm_angle", "rack"))
            exact = wishbone_motion(car, *goal)
            assert exact is not None
            for name, place in exact.points.items():
                error = errors_of([jet.x for jet in place], motion.position[name][k])
                assert (error <= off(motion)[k]).all(), (seed, name)


def test_the_eight_assemblies_of_a_drawing_are_eight() -> None:
    car = short_lower_arm(1)
    others = [redrawn(car, signs) for signs in ASSEMBLIES]
    places = [np.concatenate(list(other.values())) for other in others]
    for k, place in enumerate(places):
        for other in places[:k]:
            assert np.abs(place - other).max() > 1.0
    # Told apart by the model's own signs.
    signs = set()
    for other in others:
        mechanism = Mechanism(KIND.build(other))
        signs.add(
            tuple(
                mechanism.signs(
                    mechanism.stack.jacobian(mechanism.stack.place(*mechanism.poses(mechanism.drawn)))
                ).tolist()
            )
        )
    # The arm has a sign of its own; what hangs between upper arm and tie rod has one for both.
    assert len(signs) == 4


@pytest.mark.parametrize(
    ("moved", "links"),
    [
        # The ball joint straight above its arm's axis; the upper one in the plane of its pivots and the lower
        # one; the tie rod's end in the plane of the kingpin and its other end.
        (
            lambda car: {
                "lower_arm_rear": car["lower_arm_front"] + [200.0, 0.0, 0.0],
                "lower_ball_joint": car["lower_arm_front"] + [100.0, 0.0, -60.0],
            },
            "hinge of lower_arm on chassis",
        ),
        (
            lambda car: {
                "upper_ball_joint": 0.5 * (car["upper_arm_front"] + car["upper_arm_rear"])
                + 1.5 * (0.5 * (car["upper_arm_front"] + car["upper_arm_rear"]) - car["lower_ball_joint"])
            },
            "hinge of upper_arm on chassis",
        ),
        (
            lambda car: {
                "tie_rod_outer": car["lower_ball_joint"]
                + 0.5 * (car["upper_ball_joint"] - car["lower_ball_joint"])
                - 0.25 * (car["tie_rod_inner"] - car["lower_ball_joint"])
            },
            "rod tie_rod",
        ),
    ],
    ids=["lower arm", "upper arm", "tie rod"],
)
def test_a_drawing_at_a_dead_point_is_refused_with_its_links(moved: Callable[[Car], Car], links: str) -> None:
    car = dict(KIND.car)
    car.update(moved(car))
    inputs = inputs_at(*((value, 0, 0) for value in drawn_inputs(car)))
    with pytest.raises((absolute.SingularError, absolute.AssemblyError), match=links) as caught:
        absolute.solve(KIND.build(car), inputs)
    assert links in caught.value.limits
    assert caught.value.instant is None


def test_an_arm_without_length_is_refused() -> None:
    for name in ("lower_arm_rear", "upper_arm_rear"):
        front = name.replace("rear", "front")
        with pytest.raises(absolute.DescriptionError, match=f"{front}|{name}"):
            absolute.solve(KIND.build({**KIND.car, name: KIND.car[front]}), inputs_at((1.5, 0, 0), (0, 0, 0)))
    with pytest.raises(absolute.DescriptionError, match="coincide"):
        KIND.build({**KIND.car, "lower_ball_joint": KIND.car["lower_arm_front"]})
