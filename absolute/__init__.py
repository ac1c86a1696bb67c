"""Mechanisms in absolute coordinates: bodies with poses, joints as rows, Newton on the manifold."""

from absolute.compiler import compile
from absolute.description import Axis, Corner, Input, Joint, Model
from absolute.effects import AXLE_EFFECTS, EFFECTS, Effect, effect_names
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
from absolute.solution import Solution
from absolute.solve import Assembled, ClosedDrawing, close_drawing, solve

__all__ = [
    "AXLE_EFFECTS",
    "EFFECTS",
    "AbsoluteError",
    "Assembled",
    "AssemblyError",
    "Axis",
    "ClosedDrawing",
    "Corner",
    "DescriptionError",
    "Effect",
    "Input",
    "InputError",
    "Joint",
    "MissingPinocchioError",
    "Model",
    "PoseError",
    "SingularError",
    "Solution",
    "UnreachableError",
    "close_drawing",
    "compile",
    "effect_names",
    "solve",
]
