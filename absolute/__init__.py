"""Suspensions in absolute coordinates: bodies with poses, joints as rows, Newton on the manifold."""

from absolute.closing import ClosedDrawing, close_drawing
from absolute.description import Axis, BranchSign, Carried, Corner, Input, Joint, Model
from absolute.effects import EFFECTS
from absolute.effects.effect import Effect
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
from absolute.suspensions import SUSPENSIONS, suspension_of
from absolute.suspensions.macpherson import macpherson
from absolute.suspensions.suspension import Suspension

__all__ = [
    "EFFECTS",
    "SUSPENSIONS",
    "AbsoluteError",
    "AssemblyError",
    "Axis",
    "BranchError",
    "BranchSign",
    "Carried",
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
    "Suspension",
    "UnreachableError",
    "close_drawing",
    "macpherson",
    "solve",
    "suspension_of",
]
