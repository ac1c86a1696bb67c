"""The pytest plugin: tests a user's own solver in five lines.

    import pytest
    from my_solver import solve

    @pytest.mark.suspension_scenes(hard=True)
    def test_my_solver_is_right(scene, plain_scene, assert_agrees):
        assert_agrees(solve(plain_scene(scene)), scene, accuracy=1e-6)

and tests that the solver refuses where no pose exists:

    @pytest.mark.impossible_scenes()
    def test_my_solver_refuses_what_cannot_be(scene, assert_refuses):
        assert_refuses(solve, scene)

Once installed, pytest loads this module at every start, whether or not a test needs it. So the module imports
only pytest, and does not disturb a project that has a package `validate` of its own: this distribution's
`validate` is imported by its name when a fixture or a mark is used, as in `__main__`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from importlib import import_module
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

import pytest

if TYPE_CHECKING:
    from pointcoord import Scene

P = ParamSpec("P")
T = TypeVar("T")

ARGUMENT = "scene"
MARKS = {
    "suspension_scenes": (
        "(*names, hard=False, suspension=None, closure=None, near=1e-3)",
        "built-in scenes (all, without names), hard cases, paths, or scenes themselves; hard=True adds each "
        "hard case that has a pose, at the distance `near` from the singular pose (None: at all distances); "
        "suspension: scenes of this shipped mechanism only, such as 'five_link'",
    ),
    "impossible_scenes": (
        "(*names, suspension=None, closure=None, near=1e-3)",
        "hard cases in which some instants have no pose (all, without names); see assert_refuses",
    ),
}


def pytest_configure(config: pytest.Config) -> None:
    """Describe the marks for `pytest --markers`."""
    for name, (arguments, words) in MARKS.items():
        text = f"{name}{arguments}: run the test with each of these as its argument {ARGUMENT!r}: {words}."
        config.addinivalue_line("markers", text)


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Run a marked test over its scenes."""
    own = {mark.name for mark in metafunc.definition.own_markers}
    marks = [mark for mark in metafunc.definition.iter_markers() if mark.name in MARKS]
    # A mark on a class or a module applies to those of its tests that take a scene.
    if ARGUMENT not in metafunc.fixturenames:
        marks = [mark for mark in marks if mark.name in own]
    if not marks:
        return
    where = f"{metafunc.definition.nodeid}: {marks[0].name}"
    if ARGUMENT not in metafunc.fixturenames:
        raise pytest.Collector.CollectError(f"{where}: the test takes no argument {ARGUMENT!r}; add it")
    found = scenes_of(where, marks)
    metafunc.parametrize(ARGUMENT, list(found.values()), ids=list(found))


def scenes_of(where: str, marks: Iterable[pytest.Mark]) -> Mapping[str, Scene]:
    """The scenes that the marks ask for, by test id.

    Raises:
        CollectError: a mark has a wrong argument, or the marks leave no scene.
    """
    try:
        _require_ours()
        from pointcoord import SceneError

        scenes = import_module("validate.testing.scenes")
    except ImportError as error:
        raise pytest.Collector.CollectError(f"{where}: {_line(error)}") from None
    made: dict[str, Callable[..., Mapping[str, Scene]]] = {
        "suspension_scenes": scenes.scenes_to_try,
        "impossible_scenes": scenes.impossible_scenes,
    }
    found: dict[str, Scene] = {}
    for mark in marks:
        try:
            found |= made[mark.name](mark.args, **mark.kwargs)
        except TypeError as error:
            arguments = MARKS[mark.name][0]
            problem = _line(error).partition("() ")[2] or _line(error)
            raise pytest.Collector.CollectError(f"{where}: {problem}; it takes {arguments}") from None
        except (SceneError, ValueError) as error:
            raise pytest.Collector.CollectError(f"{where}: {_line(error)}") from None
    if not found:
        raise pytest.Collector.CollectError(f"{where}: no scene fits the mark; leave `suspension` out")
    return found


@pytest.fixture(scope="session")
def reference() -> Callable[[Scene | str], Any]:
    """A scene's reference results, proven and rounded once: `reference("bounce").position["..."]`.

    The fixture is a function of a scene, its name or its path. The error bound of each number is in
    `.accuracy.claims`. A scene is solved once per test run.

    Raises, when it is called:
        SceneError: there is no such scene. NoReferenceError: an instant has no pose, or no provable pose.
    """
    reference_solution = _ours("formulations.reference_solution", "reference_solution")
    solved: dict[str, Any] = {}

    def solution(scene: Scene | str) -> Any:
        taken = _loaded(scene)
        key = taken.model_dump_json()
        if key not in solved:
            solved[key] = reference_solution(taken)
        return solved[key]

    return _in_one_line(solution)


@pytest.fixture(scope="session")
def plain_scene() -> Callable[[Scene | str], dict[str, Any]]:
    """A scene as plain data, as a solver receives it (see `validate.solvers.plain`)."""
    given_to_solver = _ours("solvers.plain", "given_to_solver")
    return _in_one_line(lambda scene: given_to_solver(_loaded(scene)))


@pytest.fixture(scope="session")
def assert_agrees() -> Callable[..., Any]:
    """`validate.assert_agrees`; the test is skipped if some numbers are not tested and none disagrees."""
    agrees, not_tested = (_ours("testing.assertion", name) for name in ("assert_agrees", "NotTested"))

    def agrees_or_skips(states: Mapping[str, Any], scene: Scene | str, *more: Any, **options: Any) -> Any:
        try:
            return agrees(states, scene, *more, **options)
        except not_tested as error:
            reason = str(error)
        pytest.skip(reason)

    return _in_one_line(agrees_or_skips)


@pytest.fixture(scope="session")
def assert_refuses() -> Callable[..., None]:
    """`validate.assert_refuses`."""
    refuses: Callable[..., None] = _ours("testing.assertion", "assert_refuses")
    return _in_one_line(refuses)


def _loaded(scene: Scene | str) -> Scene:
    from pointcoord import Scene

    return Scene.load(scene) if isinstance(scene, str) else scene


def _in_one_line(function: Callable[P, T]) -> Callable[P, T]:
    """Wrap a function so that errors about its arguments point at the line of the test, not at the plugin."""
    argument_errors = import_module("validate.testing.assertion").TOLD

    def called(*arguments: P.args, **options: P.kwargs) -> T:
        __tracebackhide__ = True
        try:
            return function(*arguments, **options)
        except argument_errors as error:
            short = error.with_traceback(None)
        raise short from None

    return called


def _ours(module: str, name: str) -> Any:
    """An object of a module of `validate` by its name; without `validate` the test fails with one line."""
    try:
        _require_ours()
    except ImportError as error:
        reason = _line(error)
    else:
        return getattr(import_module(f"validate.{module}"), name)
    pytest.fail(reason, pytrace=False)


def _require_ours() -> None:
    """Raise ImportError unless `validate` is ours and its dependencies are installed."""
    from pointcoord.__main__ import NAME, not_ours

    try:
        validate = import_module("validate")
    except ImportError:
        raise ImportError(not_ours()) from None
    if getattr(validate, "DISTRIBUTION", None) != NAME:
        raise ImportError(not_ours())
    import_module("validate.testing.scenes")  # imports all libraries of the extra


def _line(error: Exception) -> str:
    return " ".join(str(error).split())
