"""What an accuracy that a solver states, in mm, makes of each number that it gives."""

from __future__ import annotations

import numpy as np

from pointcoord import Scene
from validate.formulations.asked_numbers import asked_numbers
from validate.formulations.protocol import Accuracy, Numbers, shape_of


def accuracy_for(scene: Scene, accuracy: float) -> Accuracy:
    """How far off each number of a scene may be that a solver of some accuracy, mm, gives."""
    count = len(scene.instants)
    claims = {
        quantity: {name: np.full(shape_of(quantity, count), accuracy) for name in names}
        for quantity, names in asked_numbers(scene).items()
    }
    return Accuracy(np.ones(count), claims, blind=np.zeros(count, dtype=bool))


def claims_for(scene: Scene, accuracy: float) -> Numbers:
    """The claims of `accuracy_for`."""
    return accuracy_for(scene, accuracy).claims
