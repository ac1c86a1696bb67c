"""The paper's own verification: two formulations of one mechanism agree in everything they compute."""

from collections import Counter

import badly_drawn_struts as struts
import numpy as np
from changed_scenes import scene_with
from hypothesis import assume, given, note, settings

from pointcoord import AssemblyError, InputOutOfRange, MotionNotMapped, Scene
from validate.cars.car import any_rotation
from validate.comparison.compare import Outcome, compare
from validate.formulations.protocol import FormulationError
from validate.formulations.registry import formulation
from validate.strategies import scenes


def require_agreement(outcome: Outcome) -> None:
    """Every row agrees; of rates that are lost to underflow when they are multiplied nothing can be said."""
    assert not outcome.disagreements
    for row in outcome.undecided:
        numbers = outcome.solutions[0].numbers[row.quantity].values()
        assert max(float(np.abs(array).max()) for array in numbers) < 1e-280, row


def require_random_agreement(scene: Scene, first: str) -> None:
    """Of series the checks hold 400 random cars to what was answered before; `study random` searches long."""
    note(repr(scene))
    try:
        outcome = compare(scene, first, "absolute")
    except FormulationError as error:
        # A motion that cannot be assembled is passed over; one that only the absolute model refuses
        # is a finding. A fold on the way of the inputs may keep a map from covering it.
        assume(not isinstance(error.reason, AssemblyError | InputOutOfRange | MotionNotMapped))
        raise
    require_agreement(outcome)


@settings(max_examples=5)
@given(scenes(samples=3))
def test_the_map_agrees_on_random_cars_and_motions(scene: Scene) -> None:
    require_random_agreement(scene, "pointcoord-map")


def test_badly_drawn_struts_close_to_the_same_assembly_in_both_models_or_are_refused() -> None:
    """However badly a collinear strut is drawn."""
    found = Counter(struts.outcome(struts.badly_drawn(number)) for number in range(80))
    same, one = found[struts.SAME_PLACE], found[struts.ONE]
    assert found[struts.OTHER_PLACE] == 0
    # Of 3,000, 6.9 in a hundred that pointcoord closes are refused; 80 are off by 2.8 more at 68 %.
    assert one <= 0.12 * (same + one)
    assert same >= 0.6 * 80


def test_axes_that_are_printed_with_fewer_digits_or_point_anywhere_are_the_same_to_every_formulation() -> (
    None
):
    """1 + 4e-13 for a length of 1, as 12 digits leave, is 200 times the tolerance of a position.

    A chassis point's velocity is the law's times a direction, which nobody rounds: one rounding in all. Where
    a model divides the direction by its length once more some of these disagree.
    """
    axes = {"up": (0.0, 3e-13, 1.0 + 4e-13), "right": (2e-13, 1.0 - 4e-13, 0.0)}
    for name in ("wheel-travel", "bounce-on-a-heaving-chassis"):
        for other in ("absolute", "reference"):
            require_agreement(compare(scene_with(name, axes, samples=5), "pointcoord", other))
    laws = {"arm_angle": {"constant": 1.7}, "rack": {"constant": 0.0}, "heave": {"polynomial": [0.0, 33.3]}}
    heaving = scene_with("bounce-on-a-heaving-chassis", inputs=laws, samples=9)
    part = heaving.mechanism
    for seed in range(8):
        turn = any_rotation(seed)
        points = {name: tuple(turn @ np.array(place)) for name, place in part.points.items()}
        turned = {axis: tuple(turn @ np.array(getattr(part, axis))) for axis in ("up", "right")}
        mechanism = part.model_copy(update={"points": points, **turned})
        scene = heaving.model_copy(update={"mechanism": mechanism})
        require_agreement(compare(scene, "pointcoord", "absolute"))


def test_a_rod_that_is_called_as_an_angle_has_no_force_from_a_tree() -> None:
    """A five-link has a rod `toe`; a tree of joints gives the angle of that name, and no forces."""
    loaded = {"loads": {"": {"force": [0.0, 0.0, 4000.0]}}, "wheel_radius": 300.0}
    scene = scene_with("five-link", loaded, effects=["toe", "loads"])
    given = formulation("relative").solve(scene).numbers
    assert "toe" in given["wheel"]
    assert "rod_force" not in given
    assert "toe" in formulation("pointcoord").solve(scene).numbers["rod_force"]
