"""Scenes for tests of a solver: the built-in scenes, and hard cases."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

from pointcoord import Scene, SceneError, built_in_scenes
from pointcoord.mechanism import mechanism_file, shipped
from pointcoord.wording import meant
from validate.hard.case import Case
from validate.hard.catalogue import CASES

NEAR = 1e-3

# Hard cases that do not suit a solver: invalid scenes, which are refused when they are read; and scenes that
# a solver may rightly refuse or answer, such as a mechanism with a link too many or too few.
NOT_ASKED = frozenset(case.name for case in CASES if not (case.answered or case.without_pose))


def scenes_to_try(
    names: Sequence[str | Scene] = (),
    hard: bool = False,
    suspension: str | None = None,
    closure: str | None = None,
    near: float | None = NEAR,
) -> dict[str, Scene]:
    """Scenes for a test, by the names that the test cases get.

    Args:
        names: names of built-in scenes or hard cases, paths, or scenes; all built-in scenes if not given.
        hard: whether to add every hard case that is a single scene and has an answer.
        suspension: only scenes of this shipped mechanism, such as "double_wishbone".
        closure: only scenes with this closure of the drawing, such as "drawn".
        near: distance from the singular pose of a hard case: the scene is made with the value of its
            parameter that is nearest to this and has an answer. None: with each such value.
    Raises:
        SceneError: a scene does not exist or is wrong.
        ValueError: the suspension or closure does not exist, or `near` is not a number above 0.
    """
    cases = {case.name: case for case in CASES if case.answered}
    found: dict[str, Scene] = {}
    for name in names or built_in_scenes():
        if isinstance(name, Scene):
            found[name.title or f"scene {len(found)}"] = name
        elif name in cases:
            found.update(_taken(cases[name], cases[name].answered, near))
        else:
            found[name] = _loaded(name)
    if hard:
        for case in cases.values():
            if suspension in (None, case.subject.car.suspension):
                found.update(_taken(case, case.answered, near))
    return _of_kind(found, suspension, closure)


def impossible_scenes(
    names: Sequence[str] = (),
    suspension: str | None = None,
    closure: str | None = None,
    near: float | None = NEAR,
) -> dict[str, Scene]:
    """Hard cases in which some instants have no pose, by the names that the test cases get.

    Args: as for `scenes_to_try`; all such cases if no names are given.
    Raises:
        ValueError: the case, suspension or closure does not exist, or `near` is not a number above 0.
    """
    cases = {case.name: case for case in CASES if case.without_pose}
    for name in names:
        if name not in cases:
            raise ValueError(f"{name!r} is not a case without a pose; there are: {', '.join(cases)}")
    found: dict[str, Scene] = {}
    for name, case in cases.items():
        if (not names or name in names) and suspension in (None, case.subject.car.suspension):
            found.update(_taken(case, case.values, near))
    return _of_kind(found, suspension, closure)


def _loaded(name: str) -> Scene:
    """A scene by its name or path; raises if the name is a hard case without an answer."""
    answered = {case.name: bool(case.answered) for case in CASES}
    if not answered.get(name, True):
        why = (
            "it is not a scene, or a solver may refuse it"
            if name in NOT_ASKED
            else ("it has instants without a pose; mark with impossible_scenes")
        )
        raise ValueError(f"the hard case {name!r} has no answer to compare: {why}")
    try:
        return Scene.load(name)
    except SceneError as error:
        known = (*built_in_scenes(), *(case for case, has_answer in answered.items() if has_answer))
        raise ValueError(f"{error}{meant(str(name), known)}") from error


def _taken(case: Case, values: Sequence[float], near: float | None) -> Iterator[tuple[str, Scene]]:
    """The scenes of a hard case, each named with the value of its parameter."""
    if near is not None:
        if not (math.isfinite(near) and near > 0.0):
            raise ValueError(f"near={near!r} is not a number above 0; give one such as {NEAR:g}, or None")
        values = [min(values, key=lambda v: abs(math.log(abs(v) / near)) if v else math.inf)]
    for value in values:
        name = f"{case.name} at {value:g}"
        yield name, Scene.from_mapping({**case.content(value), "title": name}, name)


def _of_kind(scenes: Mapping[str, Scene], suspension: str | None, closure: str | None) -> dict[str, Scene]:
    """The scenes with the given mechanism and closure."""
    if suspension is not None and suspension not in shipped():
        raise ValueError(f"suspension={suspension!r} does not exist; there are: {', '.join(shipped())}")
    closures = dict.fromkeys(name for one in shipped() for name in mechanism_file(one).closures)
    if closure is not None and closure not in closures:
        raise ValueError(f"closure={closure!r} does not exist; there are: {', '.join(closures)}")
    return {
        name: scene
        for name, scene in scenes.items()
        if suspension in (None, scene.mechanism.name) and closure in (None, scene.mechanism.closure)
    }
