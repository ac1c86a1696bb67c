"""The paper's own verification: two formulations of one mechanism agree in everything they compute."""

import numpy as np
from built_in_cars import STEERED_CARS
from hypothesis import assume, given, note, settings

from pointcoord import AssemblyError, InputOutOfRange, MotionNotMapped, Scene
from validate.comparison.compare import Outcome, compare
from validate.formulations.protocol import FormulationError
from validate.strategies import scenes

# The short profile searches briefly: `pointcoord study random` searches long.
EXAMPLES = settings.default.max_examples if settings.default else 100
searched = settings(max_examples=EXAMPLES if EXAMPLES > 100 else 12)


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


def test_a_tolerance_is_no_wider_than_its_derivation_needs() -> None:
    """A tolerance a thousand times the difference would pass a great deal that is wrong.

    The numbers are rounded to 1.1e-16 of themselves, and the car amplifies that by some ten: with a hundred
    roundings on the way, a tolerance is some 1e-13 of the largest number of its quantity.
    """
    for name in STEERED_CARS:
        outcome = compare(Scene.load(name), "pointcoord", "absolute")
        solution = outcome.solutions[1]
        for row in outcome.rows:
            numbers = solution.numbers[row.quantity]
            largest = max(float(np.abs(array).max()) for array in numbers.values())
            assert row.tolerance < 1e-12 * largest, row
            if row.quantity != "wheel" and row.difference > 0.0 and row.part < 1.0:
                assert row.share > 1e-3, row
