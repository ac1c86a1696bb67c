"""Error and time of every way with every setting on a scene: a race for each scene.

A scene is solved for its positions alone and, where it asks for more, for everything. Positions are judged
by the first and all else by the second, so that nobody's positions wait for rates.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache, partial
from importlib.util import find_spec
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene
from validate.cost.errors import Truth, errors_of, truth_of
from validate.cost.instants import study_instants
from validate.cost.race import Found, LeftOut, NoNumbers, Runner
from validate.cost.row import Row
from validate.cost.scenes import StudyScene
from validate.cost.way import Answer, Way
from validate.reference import NoReferenceError

Array = NDArray[np.float64]

SETTINGS_QUICK = 3  # of a way, the first and the last among them


def runners_of(study: StudyScene, ways: Sequence[Way], quick: bool = False) -> list[Runner]:
    """Every way with every setting, for positions and for everything."""
    scene, instants = study.scene, study_instants(study.scene, quick=quick)
    asked = [study.positions_only(), *([scene] if scene.effects else [])]

    @cache
    def truth() -> Truth | NoReferenceError:
        try:
            return truth_of(scene, instants)
        except NoReferenceError as error:
            return error

    def found(part: Scene, answer: Answer) -> Found:
        known = truth()
        if isinstance(known, NoReferenceError):
            raise NoNumbers(f"there is no reference to hold it to: {known}")
        others = [quantity for quantity in known.exact if quantity != "position"]
        return errors_of(answer, known.of(*(others if part.effects else ["position"])))

    return [
        Runner(
            Row(
                "accuracy",
                study.name,
                way.name,
                way.says(value),
                value,
                way.dense,
                poses=len(instants),
                quantity="" if part.effects else "position",
                digest=study.digest,
                quick=quick,
            ),
            partial(made_ready, way, part, value, instants),
            partial(found, part),
        )
        for way in ways
        for value in chosen(way.values, SETTINGS_QUICK if quick else None)
        for part in asked
        if part.effects or not way.rates_only
    ]


def chosen(values: Sequence[Any], most: int | None) -> list[Any]:
    """Some of the values, evenly from the first to the last."""
    if most is None or len(values) <= most:
        return list(values)
    return [values[place] for place in np.linspace(0, len(values) - 1, most).round().astype(int)]


def made_ready(way: Way, scene: Scene, value: float | None, instants: Array) -> Callable[[], Answer]:
    """A way's set-up.

    Raises:
        LeftOut: its package is not installed, or it does not apply; and whatever it refuses a scene with.
    """
    require(way.package)
    return partial(way.prepare(scene, value), instants)


def require(package: str) -> None:
    """See that an optional package is there.

    Raises:
        LeftOut: it is not.
    """
    if package and find_spec(package) is None:
        raise LeftOut(f"needs the package {package!r}, which is not installed")
