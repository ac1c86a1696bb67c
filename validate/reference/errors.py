"""Errors of the reference, which returns only numbers that it has proven."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from flint import arb


class NoReferenceError(Exception):
    """No proven number: an input is unusable, the assembly is not determined, or a path takes too many steps.
    Other reasons are subclasses.

    Args:
        what: the entry, assembly, path or statement at fault.
        problem: what is wrong with it, with the value.
        allowed: what is allowed, or what to try.
        value: the value found, if it is a number.
    """

    def __init__(self, what: str, problem: str, allowed: str, value: object = None) -> None:
        self.what, self.problem, self.allowed, self.value = what, problem, allowed, value
        super().__init__(f"{what} {problem}; allowed: {allowed}")

    @property
    def reason(self) -> str:
        """The reason in words without numbers."""
        return self.what if type(self) is NoReferenceError else type(self).__name__


class InfeasibleError(NoReferenceError):
    """The assembly of the drawing cannot reach these inputs: it is proven that the path to them meets a fold.

    A branch has no pose beyond its fold. From the drawing, the straight path is tried and then paths that
    change one input after the other; between instants of a motion, only the straight path is.

    Attributes:
        way: name of the path.
        share: share of the path before the fold, 0 to 1.
        inputs: inputs at the fold, rad or mm, without those that move the whole car.
    """

    def __init__(self, way: str, share: float, inputs: Mapping[str, Fraction]) -> None:
        self.way, self.share, self.inputs = way, share, inputs
        there = ", ".join(f"{name} = {float(value):.9g}" for name, value in inputs.items())
        problem = f"turns back at a fold after {share:.9g} of its length, at {there}: there is no pose beyond"
        super().__init__(way, problem, "inputs nearer to those of the drawing")


class NotDecidedError(NoReferenceError):
    """A proof fails with the present number of digits, as a value is not within a limit; more may help."""

    def __init__(self, what: str, value: object, limit: object) -> None:
        # A ball of 400 digits is unreadable in a message; six digits are enough.
        value, limit = (x.str(6) if isinstance(x, arb) else str(x) for x in (value, limit))
        super().__init__(what, f"is {value}", limit, value)


class SingularPoseError(NoReferenceError):
    """The proofs fail with the greatest number of digits: the pose is singular or nearly so.

    Attributes:
        digits: the greatest number of digits tried.
        doubt: the last `NotDecidedError`.
    """

    def __init__(self, digits: int, doubt: NotDecidedError) -> None:
        self.digits, self.doubt = digits, doubt
        problem = f"or one on the path to it, is at a dead point or a toggle to {digits} digits ({doubt})"
        super().__init__("the pose,", problem, "inputs away from there")
