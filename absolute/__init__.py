"""Mechanisms in absolute coordinates: bodies with poses, joints as rows, Newton's method on their poses."""

from absolute.compiler import compile
from absolute.effects import AXLE_EFFECTS, EFFECTS, Effect, effects_in
from absolute.errors import (
    AbsoluteError,
    AssemblyError,
    DescriptionError,
    InputError,
    MissingPinocchioError,
    PoseError,
    SingularError,
    UnreachableError,
)
from absolute.model import Corner, Model
from absolute.solution import Solution
from absolute.solve import Assembled, ClosedDrawing, close_drawing, solve

__all__ = [
    "AXLE_EFFECTS",
    "EFFECTS",
    "AbsoluteError",
    "Assembled",
    "AssemblyError",
    "ClosedDrawing",
    "Corner",
    "DescriptionError",
    "Effect",
    "InputError",
    "MissingPinocchioError",
    "Model",
    "PoseError",
    "SingularError",
    "Solution",
    "UnreachableError",
    "close_drawing",
    "compile",
    "effects_in",
    "solve",
]
