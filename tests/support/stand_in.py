"""Something else in the place of a formulation, wherever hard cases ask for one."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from pointcoord import Scene
from validate.formulations.protocol import Solution
from validate.formulations.registry import formulation

Solve = Callable[[Scene], Solution]


def stand_in(monkeypatch: pytest.MonkeyPatch, solve: Solve, *names: str) -> None:
    """Put it in the place of the formulations of these names, or of every one; the others stay."""

    class Stand:
        name = names[0] if names else "stand-in"

        def solve(self, scene: Scene) -> Solution:
            return solve(scene)

    monkeypatch.setattr(
        "validate.hard.answer.formulation",
        lambda name: Stand() if not names or name in names else formulation(name),
    )
