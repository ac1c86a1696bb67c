"""The drawing as it is when its bodies are put together: what closing it moved."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from absolute.description import Model
from absolute.mapping import ReadOnly
from absolute.mechanism import Mechanism
from absolute.solution import Array
from absolute.solve import solve


@dataclass(frozen=True)
class ClosedDrawing:
    """A drawing solved at its own inputs.

    Attributes:
        inputs: input name -> its value in the drawing, rad or mm.
        position: point name -> (3,) where it is when the drawing is closed, mm.
        movement: point name -> how far that is from where it is drawn, mm.
    """

    inputs: Mapping[str, float]
    position: Mapping[str, Array]
    movement: Mapping[str, float]


def close_drawing(model: Model) -> ClosedDrawing:
    """Solve a model at the inputs of its own drawing, chassis at rest.

    Raises:
        DescriptionError, AssemblyError, SingularError: as `solve`.
    """
    mechanism = Mechanism(model)
    # A drawn rack at its centre is at 0, not at -0.
    values = mechanism.named((mechanism.drawn_inputs + 0.0).tolist())
    still = {name: np.array([[value, 0.0, 0.0]]) for name, value in values.items()}
    position = {name: place[0] for name, place in solve(model, still, rates=False).position.items()}
    return ClosedDrawing(
        ReadOnly(values),
        ReadOnly(position),
        ReadOnly(
            {
                name: float(np.linalg.norm(place - np.array(model.points[name])))
                for name, place in position.items()
            }
        ),
    )
