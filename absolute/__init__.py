"""Suspensions in absolute coordinates: bodies with poses, joints as rows, Newton on the manifold."""

from absolute.description import Axis, Input, Joint, Model, Side
from absolute.errors import (
    AbsoluteError,
    AssemblyError,
    BranchError,
    DescriptionError,
    InputError,
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
    "DescriptionError",
    "Input",
    "InputError",
    "Joint",
    "Model",
    "PoseError",
    "Side",
    "SingularError",
    "Solution",
    "UnreachableError",
    "macpherson",
    "solve",
]
