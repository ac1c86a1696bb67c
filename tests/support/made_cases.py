"""Hard cases with given answers, and something else in the place of a formulation that they ask for."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import pytest

from pointcoord import Scene
from validate.formulations.protocol import Solution
from validate.formulations.registry import formulation
from validate.hard.answer import Answer
from validate.hard.case import RIGHT, Case, Expected, Setup
from validate.hard.catalogue import chosen


def made_case(
    answers: Mapping[float, Answer | BaseException],
    expected: Expected = RIGHT,
    name: str = "made",
    of: str = "absolute",
) -> Case:
    """A case of one formulation that has these answers by value, or is ended by one."""

    def scene(_: object, value: float) -> Setup:
        found = answers[value]
        if isinstance(found, BaseException):
            raise found
        return Setup({}, judge=lambda *_: found)

    (one,) = chosen(["arm-hardly-moves"])
    more: dict[str, Any] = {"expected": {of: expected}, "values": tuple(answers), "group": "0. Made"}
    return replace(one, name=name, scene=scene, **more)


def stand_in(monkeypatch: pytest.MonkeyPatch, solve: Callable[[Scene], Solution], *names: str) -> None:
    """Put it in the place of the formulations of these names, or of every one; the others stay."""

    class Stand:
        name = names[0] if names else "stand-in"

        def solve(self, scene: Scene) -> Solution:
            return solve(scene)

    monkeypatch.setattr(
        "validate.hard.answer.formulation",
        lambda name: Stand() if not names or name in names else formulation(name),
    )
