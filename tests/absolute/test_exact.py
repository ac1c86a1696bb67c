"""What is drawn is what moves: against a witness in many digits, closed forms, and other people's tables."""

from typing import Any

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st
from mechanism_checks import CLOSED, PRINTED, Check, closed_form_check
from mechanism_equations import vector as to_many
from mechanism_files import SCENES, mechanism_file, plain, plain_scene, scene_file
from mechanism_poses import Stuck
from shipped import EPS, Motion, error, exact, off, redrawn, shipped

import absolute

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


@pytest.mark.parametrize("scene", SCENES)
def test_a_shipped_scene_moves_as_the_witness_says(scene: str) -> None:
    motion = shipped(scene, 3)
    compare(motion._replace(chassis=None), exact(motion))


@settings(max_examples=40, deadline=None, phases=[Phase.generate])
@given(scene=st.sampled_from(RANDOM), seed=st.integers(0, 10**6), spread=st.sampled_from([0.0, 3.0, 10.0]))
def test_any_drawing_near_it_moves_as_the_witness_says_or_is_refused(
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
        with pytest.raises(Stuck):
            exact(motion)


def compare(motion: Motion, wanted: Any = None) -> None:
    """Points and their rates against the witness; each rate passes through the inverse once more."""
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


def checked(check: Check) -> None:
    """Poses of a check, whose limits say what the other side rounds."""
    part = {**scene_file(check.scene)["mechanism"], "wheel_radius": check.wheel_radius}
    described = plain(mechanism_file(part["type"]), part, check.path[0])
    inputs = {
        name: np.array([[float(at[name]), 0.0, 0.0] for at in check.path])
        for name in check.path[0]
        if "moves" not in described["inputs"][name]
    }
    motion = Motion(described, inputs).solve(rates=False, conditions=True)
    count = range(len(check.path))
    poses = [{p: to_many(place[k].tolist()) for p, place in motion.position.items()} for k in count]
    for name, value in check.deviations(poses).items():
        # Angles are those of lines of more than 50 mm; turns of several revolutions are rounded.
        turns = 16 * EPS * 500.0 * max(1.0, *(float(np.abs(law).max()) for law in inputs.values()))
        own = off(motion).max() + (turns if "crank" in inputs or "turn" in inputs else 0.0)
        assert value <= check.limits[name] + (own if name in ("position", "track") else own / 10.0), name


# Closed forms are in the chassis' axes; one that turns is held to the witness, which is held to them.
RESTS = [scene for scene in CLOSED if not any("turns" in of for of in plain_scene(scene)["inputs"].values())]


@pytest.mark.parametrize("scene", RESTS)
def test_a_shipped_scene_is_where_its_closed_form_says(scene: str) -> None:
    checked(closed_form_check(scene))


@pytest.mark.parametrize("mechanism", PRINTED)
def test_other_peoples_tables_are_met(mechanism: str) -> None:
    checked(PRINTED[mechanism]())
