"""What each effect costs: a solved scene read at many instants with none, with each alone and with all.

A scene is solved once for each choice of effects; timed is reading the motion into arrays that are there
already, and beside it, in the same rounds, a copy of the same bytes: less than that nothing can take that
fills such arrays. Both rates of all points are read together too.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache, partial
from typing import Any

import numpy as np

from pointcoord import Motion, Scene, simulate
from pointcoord.effects.registry import EFFECTS
from pointcoord.results.even_instants import even_instants
from validate.cost.race import Found, Runner
from validate.cost.scenes import StudyScene
from validate.cost.table import Row

INSTANTS, INSTANTS_QUICK = 100_000, 10_000
NO_EFFECT = "no effect"


def choices(scene: Scene) -> dict[str, tuple[str, ...]]:
    """Which effects are asked for, by what a row says of it."""
    # Gradients are solved for at each instant, which no copy is like.
    had = tuple(name for name in scene.mechanism.effects if not EFFECTS[name].way)
    return {
        NO_EFFECT: (),
        **{name: (name,) for name in had},
        "both rates of points": tuple(name for name in had if EFFECTS[name].reports_states),
        "all effects": had,
    }


def runners_of(study: StudyScene, quick: bool = False) -> list[Runner]:
    """Reading and copying, for each choice of effects."""
    count = INSTANTS_QUICK if quick else INSTANTS
    scene, asked = study.scene, choices(study.scene)
    instants = even_instants(scene.time.start, scene.time.stop, count)

    @cache
    def motion(choice: str) -> Motion:
        return simulate(scene.model_copy(update={"effects": asked[choice]}))

    @cache
    def arrays(height: int) -> Any:
        return np.zeros((2, height, count))

    def ready(choice: str, quantity: str) -> Callable[[], Any]:
        solved = motion(choice)
        out, other = arrays(solved.height)
        return partial(solved.at, instants, out) if quantity == "read" else partial(np.copyto, other, out)

    def found(choice: str, quantity: str, _: Any) -> Found:
        return {quantity: {"numbers": motion(choice).height}}

    row = Row("effects", study.name, "series", dense=True, poses=count, digest=study.digest, quick=quick)
    return [
        Runner(
            replace(row, setting=choice), partial(ready, choice, quantity), partial(found, choice, quantity)
        )
        for choice in asked
        for quantity in ("read", "copy")
    ]
