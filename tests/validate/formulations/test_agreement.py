"""The paper's own verification: two formulations of one mechanism agree in everything they compute."""

import numpy as np
from changed_scenes import scene_with
from hypothesis import assume, given, note, settings

from pointcoord import AssemblyError, InputOutOfRange, MotionNotMapped, Scene
from validate.cars.car import any_rotation
from validate.comparison.compare import Outcome, compare
from validate.formulations.protocol import FormulationError
from validate.strategies import scenes

# The short profile searches briefly: the checks hold 400 random cars to what was answered before, and
# `pointcoord study random` searches long.
EXAMPLES = settings.default.max_examples if settings.default else 100
searched = settings(max_examples=EXAMPLES if EXAMPLES > 100 else 4)


def require_agreement(outcome: Outcome) -> None:
    """Every row agrees; of rates that are lost to underflow when they are multiplied nothing can be said."""
    assert not outcome.disagreements
    for row in outcome.undecided:
        numbers = outcome.solutions[0].numbers[row.quantity].values()
        assert max(float(np.abs(array).max()) for array in numbers) < 1e-280, row


@searched
@given(scenes())
def test_formulations_agree_on_random_cars_and_motions(scene: Scene) -> None:
    note(repr(scene))
    try:
        outcome = compare(scene, "pointcoord", "absolute")
    except FormulationError as error:
        # A motion that cannot be assembled is passed over; one that only the absolute model refuses
        # is a finding.
        assume(not isinstance(error.reason, AssemblyError | InputOutOfRange))
        raise
    require_agreement(outcome)


@settings(max_examples=5)
@given(scenes(samples=3))
def test_the_map_agrees_on_random_cars_and_motions(scene: Scene) -> None:
    """A fold on the way of the inputs may keep a map from covering it; then it must say so."""
    try:
        outcome = compare(scene, "pointcoord-map", "absolute")
    except FormulationError as error:
        assume(not isinstance(error.reason, AssemblyError | InputOutOfRange | MotionNotMapped))
        raise
    require_agreement(outcome)


def test_a_car_that_is_displaced_agrees_whichever_way_its_axes_point() -> None:
    """A chassis point's velocity is the law's times a direction, which nobody rounds: one rounding in all.

    Where a model divides the direction by its length once more some of these disagree.
    """
    laws = {"arm_angle": {"constant": 1.7}, "rack": {"constant": 0.0}, "heave": {"polynomial": [0.0, 33.3]}}
    scene = scene_with("bounce-on-a-heaving-chassis", inputs=laws)
    for seed in range(8):
        require_agreement(compare(_turned(scene, any_rotation(seed)), "pointcoord", "absolute"))


def test_axes_that_are_printed_with_fewer_digits_are_the_same_to_every_formulation() -> None:
    """1 + 4e-13 for a length of 1, as 12 digits leave, is 200 times the tolerance of a position."""
    for name in ("wheel-travel", "bounce-on-a-heaving-chassis"):
        axes = {"up": (0.0, 3e-13, 1.0 + 4e-13), "right": (2e-13, 1.0 - 4e-13, 0.0)}
        scene = scene_with(name, axes, samples=5)
        for other in ("absolute", "reference"):
            require_agreement(compare(scene, "pointcoord", other))


def _turned(scene: Scene, turn: np.ndarray) -> Scene:
    part = scene.mechanism
    places = {name: tuple(turn @ np.array(place)) for name, place in part.points.items()}
    axes = {name: tuple(turn @ np.array(getattr(part, name))) for name in ("up", "right")}
    mechanism = part.model_copy(update={"points": places, **axes})
    return scene.model_copy(update={"mechanism": mechanism})
