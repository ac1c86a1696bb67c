"""The pytest plugin: a solver of one's own, tested in five lines.

    import pytest
    from my_solver import solve

    @pytest.mark.suspension_scenes(hard=True)
    def test_my_solver_is_right(scene, plain_scene, assert_agrees):
        assert_agrees(solve(plain_scene(scene)), scene, accuracy=1e-6)

pytest loads this module at each start where it is installed, whether a test needs it or not: what it needs
itself is imported when a fixture or the mark is used.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from pointcoord import Scene
    from validate.comparison.compare import Outcome
    from validate.formulations.protocol import Solution

MARK = "suspension_scenes"
ARGUMENT = "scene"


def pytest_configure(config: pytest.Config) -> None:
    """Say what the mark is for."""
    config.addinivalue_line(
        "markers",
        f"{MARK}(*names, hard=False, suspension=None, near=1e-3): run the test with each of these scenes as "
        f"its argument {ARGUMENT!r}: built-in ones (all, without names), hard cases, paths, or scenes "
        "themselves; hard=True adds all hard cases, each as near to its singular place as `near` says.",
    )


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Run a marked test over its scenes."""
    marks = list(metafunc.definition.iter_markers(MARK))
    if not marks:
        return
    from pointcoord import SceneError

    where = metafunc.definition.nodeid
    if ARGUMENT not in metafunc.fixturenames:
        raise pytest.UsageError(f"{where} is marked with {MARK} and takes no argument {ARGUMENT!r}; add it")
    from validate.testing.scenes import scenes_to_try

    found: dict[str, Scene] = {}
    for mark in marks:
        try:
            found |= scenes_to_try(mark.args, **mark.kwargs)
        except (SceneError, TypeError, ValueError) as error:
            raise pytest.UsageError(f"{where}: {MARK}: {error}") from None
    if not found:
        raise pytest.UsageError(f"{where}: no scene is as its mark {MARK} says; leave `suspension` out")
    metafunc.parametrize(ARGUMENT, list(found.values()), ids=list(found))


@pytest.fixture(scope="session")
def reference() -> Callable[[Scene | str], Solution]:
    """A scene's numbers in many digits, proven and rounded once: `reference("bounce").position["..."]`.

    The fixture is a function of a scene, its name or its path. What each number may be off by is in
    `.accuracy.claims`. A scene is solved once in a run.

    Raises, when it is called:
        SceneError: there is no such scene. NoReferenceError: an instant has no pose, or none can be proven.
    """
    from pointcoord import Scene
    from validate.adjudication.reference_solution import reference_solution

    solved: dict[str, Solution] = {}

    def solution(scene: Scene | str) -> Solution:
        taken = Scene.load(scene) if isinstance(scene, str) else scene
        key = taken.model_dump_json()
        if key not in solved:
            solved[key] = reference_solution(taken)
        return solved[key]

    return solution


@pytest.fixture(scope="session")
def plain_scene() -> Callable[[Scene | str], dict[str, Any]]:
    """What a solver is given: a scene as plain data (see `validate.solvers.plain`)."""
    from pointcoord import Scene
    from validate.solvers.plain import given_to_solver

    def plain(scene: Scene | str) -> dict[str, Any]:
        return given_to_solver(Scene.load(scene) if isinstance(scene, str) else scene)

    return plain


@pytest.fixture(scope="session")
def assert_agrees() -> Callable[..., Outcome]:
    """`validate.assert_agrees`; where some numbers are not tested and none disagrees, the test is skipped."""
    from validate.testing import assertion

    def agrees(states: Mapping[str, Any], scene: Scene | str, **options: Any) -> Outcome:
        __tracebackhide__ = True
        try:
            return assertion.assert_agrees(states, scene, **options)
        except assertion.NotTested as error:
            reason = str(error)
        pytest.skip(reason)

    return agrees
