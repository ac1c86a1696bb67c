"""Which derivatives an effect is made of, and that what is proven of a turn covers what moves it."""

import numpy as np
import pytest
from numpy.typing import NDArray

from pointcoord import Scene
from pointcoord.bounds.enclosed_points import EnclosedPoses
from pointcoord.effects.effect import Poses
from pointcoord.effects.knuckle_rates import KNUCKLE_RATES
from pointcoord.effects.registry import ALWAYS, EFFECTS
from pointcoord.linkage.car_axes import CarAxes
from pointcoord.numerics.enclosure import Enclosed
from pointcoord.simulation import scene_mechanism

Array = NDArray[np.float64]
U = 2.0**-53
MECHANISM = scene_mechanism(Scene.load("pushrod"))
UP, RIGHT = np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0])
AXES = CarAxes(UP, RIGHT, RIGHT, wheel_radius=300.0)
OMEGA, ALPHA = np.array([0.3, -1.1, 0.7]), np.array([2.0, 0.4, -0.9])


def turning() -> list[dict[str, Array]]:
    """The drawing, turning about its origin: positions, velocities and accelerations, in its own units."""
    states: list[dict[str, Array]] = [{}, {}, {}]
    for name in MECHANISM.topology.points:
        place = MECHANISM.drawing.vectors[name][None]
        speed = np.cross(OMEGA, place)
        for state, vector in zip(
            states, (place, speed, np.cross(ALPHA, place) + np.cross(OMEGA, speed)), strict=True
        ):
            state[name] = vector
    return states


@pytest.mark.parametrize("effect", [*ALWAYS, *EFFECTS.values()], ids=lambda effect: effect.name)
def test_an_effect_is_made_of_its_derivative_and_of_none_above_it(effect) -> None:
    changed = []
    for order in (1, 2):
        states = turning()
        states[order] = {name: np.full_like(vector, np.nan) for name, vector in states[order].items()}
        moving = dict.fromkeys(("by_travel", "by_rack"), (states[0], states[0]))
        found = effect.evaluate(Poses(MECHANISM, AXES, states, states[0], [None, None, None], moving))
        changed.append(any(np.isnan(a).any() for of in found.values() for a in of.values()))
    assert effect.derivative == max(
        (order for order, seen in zip((1, 2), changed, strict=True) if seen), default=0
    )


@pytest.mark.parametrize("order", range(3))
def test_what_is_proven_of_a_turn_covers_how_far_its_points_may_be_off(order: int) -> None:
    states = turning()
    numbers = KNUCKLE_RATES.evaluate(Poses(MECHANISM, AXES, states, states[0], [None, None, None]))
    body = MECHANISM.topology.knuckle
    first = MECHANISM.topology.bodies[body][0]

    def errors(off: float) -> dict[str, Array]:
        points = [
            {
                name: Enclosed.of(v, 0.0, off if (d, name) == (order, first) else 0.0, U * np.abs(v))
                for name, v in state.items()
            }
            for d, state in enumerate(states)
        ]
        still = [Enclosed.of(np.zeros((1, 3)))] * 3
        poses = EnclosedPoses(MECHANISM, AXES, points, points[0], still, [np.ones(1)] * 3)
        return {quantity: of[body] for quantity, of in KNUCKLE_RATES.errors(poses, numbers).items()}

    exact, unsure = errors(0.0), errors(1e-6)
    for quantity, moved in (("angular_velocity", order < 2), ("angular_acceleration", True)):
        proven, expected = unsure[quantity]
        # A point of a body of the size of 1 that is off by a millionth turns it by about as much.
        assert (proven.max() > 1e-7) == moved
        assert exact[quantity][0].max() < 1e-12
        np.testing.assert_allclose(expected, exact[quantity][1], rtol=1e-3)
