"""Kinds of reasons for a refusal, so that the names of errors and the words of reasons are free to change.

Whoever renames an error, or words a reason anew, puts the new name to its kind here.
"""

from __future__ import annotations

# By what is at fault: reasons of `validate --json`, and names of errors, which reasons of `hard` begin with.
KINDS = {
    "the scene": (
        "drawing has no assembly",
        "hardpoints make no mechanism",
        "DescriptionError",
        "HardpointsError",
        "MechanismError",
        "SceneError",
    ),
    "an input": ("input out of range", "InputError", "InputNotKnown", "InputOutOfRange"),
    "a pose": (
        "motion leaves its reach",
        "start out of reach",
        "AssemblyError",
        "PoseError",
        "SingularConfiguration",
        "SingularError",
        "UnreachableError",
    ),
    "the effort": ("MotionNotMapped", "MotionTooLong", "MotionTooRough", "NotCovered", "NotFollowed"),
}
KIND_OF = {name: kind for kind, names in KINDS.items() for name in names}


# What a program that does not answer begins its reason with. Where that is anything else, such as the name
# of a point or a body, the scene is at fault.
OF_PROGRAMS = {"input ": "an input", "instant number ": "a pose", "the drawing ": "a pose"}


def kind_of(reason: str) -> str:
    """The kind of a reason; a name that is of no kind is its own."""
    name, _, words = reason.partition(": ")
    if name == "NoAnswer":
        return next((kind for start, kind in OF_PROGRAMS.items() if words.startswith(start)), "the scene")
    return KIND_OF.get(name, name)
