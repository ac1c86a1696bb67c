"""The two sides of a scene's first comparison as a page draws them: what each really gives, when it does.

Of a scene that is refused there is one side at most: what pointcoord solves of it before it stops.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from validate.comparison.given import given
from validate.html.run import Told

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Side:
    """One model.

    Attributes:
        name: of the formulation.
        at: which of the scene's instants it gives, (M,).
        numbers: by quantity and name, (M, 3) or (M,).
    """

    name: str
    at: NDArray[np.intp]
    numbers: Mapping[str, Mapping[str, Array]]


def sides(one: Told) -> tuple[Side, ...]:
    """The first and the second; without a comparison pointcoord as far as it comes, if it does."""
    if one.scene is None:
        return ()
    if one.examined.outcomes:
        found = (given(solution, one.scene.instants) for solution in one.examined.outcomes[0].solutions)
        return tuple(Side(side.formulation, np.flatnonzero(side.found), side.numbers) for side in found)
    if one.motion is None:
        return ()
    numbers = {quantity: dict(channel) for quantity, channel in one.motion.numbers.items()}
    return (Side("pointcoord", np.arange(len(one.motion.times)), numbers),)
