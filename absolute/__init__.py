"""Suspensions in absolute coordinates: bodies with poses, joints as rows, Newton on the manifold."""

from absolute.closing import ClosedDrawing, close_drawing
from absolute.description import Axis, BranchSign, Carried, Input, Joint, Model
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
from absolute.solution import Solution
from absolute.solve import solve
from absolute.suspensions import SUSPENSIONS, suspension
from absolute.suspensions.macpherson import macpherson
from absolute.suspensions.suspension import Suspension

__all__ = [
    "SUSPENSIONS",
    "AbsoluteError",
    "AssemblyError",
    "Axis",
    "BranchError",
    "BranchSign",
    "Carried",
    "ClosedDrawing",
    "DescriptionError",
    "Input",
    "InputError",
    "Joint",
    "MissingPinocchioError",
    "Model",
    "PoseError",
    "SingularError",
    "Solution",
    "Suspension",
    "UnreachableError",
    "close_drawing",
    "macpherson",
    "solve",
    "suspension",
]
