"""The motion of a scene, and motions of the scene with a change, each solved when first needed."""

from __future__ import annotations

import copy
from collections.abc import Callable, Hashable
from contextlib import suppress
from functools import cached_property
from typing import Any

from pointcoord import Motion, PointcoordError, Scene, simulate
from pointcoord.simulation import finest_tolerance

Content = dict[str, Any]
"""The content of a scene, a copy that may be changed."""


class Solved:
    """The motions of a scene and of its changed copies."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self._others: dict[Hashable, Motion | None] = {}

    def other(
        self,
        key: Hashable,
        put: Callable[[Content], None],
        solve: Callable[[Scene], Motion] = simulate,
    ) -> Motion | None:
        """The motion of the scene with changed content; None if it is refused.

        Args:
            key: identifies the change. put: changes the content.
        """
        if key not in self._others:
            content = copy.deepcopy(self.content)
            put(content)
            self._others[key] = None
            with suppress(PointcoordError):
                self._others[key] = solve(Scene.from_mapping(content, "another car"))
        return self._others[key]

    @cached_property
    def motion(self) -> Motion | None:
        """The motion of the scene itself; None if it cannot be solved."""
        return self.other("as it is", lambda content: None)

    @cached_property
    def content(self) -> Content:
        """The scene's content, with every point, the finest tolerance that rounding allows, and the first and
        last instant only: a motion can be read at any instant between."""
        time = self.scene.time.model_copy(update={"samples": min(2, self.scene.time.samples)})
        tolerance = min(self.scene.tolerance, finest_tolerance(self.scene))
        fine = self.scene.model_copy(update={"tolerance": tolerance, "points": None, "time": time})
        return fine.model_dump(mode="json", exclude_none=True)
