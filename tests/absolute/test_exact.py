"""What is drawn is what moves, however it is drawn: against the reference."""

from typing import Any

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st
from shipped import EPS, Motion, error, exact, off, redrawn, shipped

import absolute
from validate.reference import NoReferenceError

# One scene of each mechanism and input; where hinges are parallel, or a ring closes, other drawings lock.
RANDOM = (
    "bmw-e90-strut",
    "bounce",
    "double-wishbone",
    "five-link",
    "hmmwv-front",
    "off-axis-strut",
    "pushrod-by-damper",
    "semi-trailing-arm",
    "slider-crank",
    "spatial-four-bar",
)


@settings(max_examples=40, deadline=None, phases=[Phase.generate])
@given(scene=st.sampled_from(RANDOM), seed=st.integers(0, 10**6), spread=st.sampled_from([0.0, 3.0, 10.0]))
def test_any_drawing_near_it_moves_as_the_reference_says_or_is_refused(
    scene: str, seed: int, spread: float
) -> None:
    """Points, ends of slides among them, are drawn elsewhere, so that the drawing does not close."""
    try:
        motion = redrawn(shipped(scene), np.random.default_rng(seed), spread)
    except absolute.AssemblyError:
        assert spread == 10.0
        return
    try:
        compare(motion)
    except absolute.PoseError:
        with pytest.raises(NoReferenceError):
            exact(motion)


def compare(motion: Motion, wanted: Any = None) -> None:
    """Points and their rates against the reference; each rate passes through the inverse once more."""
    solution = motion.solve(conditions=True)
    wanted = exact(motion) if wanted is None else wanted
    assert solution.condition is not None
    assert (solution.residual <= solution.accuracy).all()
    size = solution.accuracy.max() / EPS
    for order, found in enumerate(solution.derivatives):
        speed = max(float(np.abs(v).max()) for v in solution.velocity.values())
        scale = size if not order else max(speed, speed**2 / size, 200.0)
        for k, condition in enumerate(solution.condition):
            for point in found:
                allowed = 4 * EPS * condition ** (1 + order) * scale
                assert error(found[point][k], wanted[k][order][point]) <= allowed, (order, point, k)
                if not order:
                    assert error(found[point][k], wanted[k][0][point]) <= off(solution)[k], point
