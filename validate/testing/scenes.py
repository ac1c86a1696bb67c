"""Scenes that a test of a solver runs over: the built-in ones, and what is hard for any solver."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from pointcoord import Scene, built_in_scenes
from pointcoord.suspensions import SUSPENSIONS
from validate.hard.case import Case
from validate.hard.catalogue import CASES
from validate.solvers.check import AGAINST

NEAR = 1e-3


def scenes_to_try(
    names: Sequence[str | Scene] = (), hard: bool = False, suspension: str | None = None, near: float = NEAR
) -> dict[str, Scene]:
    """Scenes by the names that tests over them get.

    Args:
        names: of built-in or hard scenes, paths, or scenes themselves; all built-in ones if not given.
        hard: whether the hard cases are added: every one that is one scene and has an answer.
        suspension: scenes of this type only, such as "double_wishbone".
        near: how near to its singular place each hard case is taken: at the value of its parameter that is
            nearest to this, of those where an answer is expected.
    Raises:
        SceneError: there is no such scene, or it is wrong.
        ValueError: there is no such suspension, or `near` is no number above 0.
    """
    if suspension is not None and suspension not in SUSPENSIONS:
        raise ValueError(f"suspension={suspension!r}: there is none; there are: {', '.join(SUSPENSIONS)}")
    if not (math.isfinite(near) and near > 0.0):
        raise ValueError(f"near={near!r} is no number above 0; give one such as {NEAR:g}")
    cases = {case.name: case for case in CASES if case.content is not None and _answered(case)}
    found: dict[str, Scene] = {}
    for name in names or built_in_scenes():
        if isinstance(name, Scene):
            found[name.title or f"scene {len(found)}"] = name
        elif name in cases:
            found.update(_at(cases[name], near))
        else:
            found[name] = Scene.load(name)
    if hard:
        for case in cases.values():
            found.update(_at(case, near))
    return {name: scene for name, scene in found.items() if suspension in (None, scene.mechanism.type)}


def _answered(case: Case) -> tuple[float, ...]:
    """The values at which there is an answer, and no refusal is allowed."""
    expected = case.expected.get(AGAINST)
    return tuple(
        v for v in case.values if expected and expected.met(v, "right") and not expected.met(v, "refused")
    )


def _at(case: Case, near: float) -> Iterator[tuple[str, Scene]]:
    if case.content is not None:
        value = min(_answered(case), key=lambda v: abs(math.log(abs(v) / near)) if v else math.inf)
        yield f"{case.name} at {value:g}", Scene.from_mapping(case.content(value), case.name)
