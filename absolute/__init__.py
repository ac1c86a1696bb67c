"""Suspensions in absolute coordinates: bodies with poses, joints as rows, Newton on the manifold."""

from absolute.closing import ClosedDrawing, close_drawing
from absolute.description import Axis, Carried, Input, Joint, Model, Side
from absolute.errors import (
    AbsoluteError,
    AssemblyError,
    BranchError,
    DescriptionError,
    InputError,
    MissingPinocchioError,
    PoseError,
    SingularError,
    UnreachableError,
)
from absolute.macpherson import macpherson
from absolute.solution import Solution
from absolute.solve import solve

__all__ = [
    "AbsoluteError",
    "AssemblyError",
    "Axis",
    "BranchError",
    "Carried",
    "ClosedDrawing",
    "DescriptionError",
    "Input",
    "InputError",
    "Joint",
    "MissingPinocchioError",
    "Model",
    "PoseError",
    "Side",
    "SingularError",
    "Solution",
    "UnreachableError",
    "close_drawing",
    "macpherson",
    "solve",
]
