"""Errors of the reference.

No function of this package returns a number that it could not prove: it raises one of these errors.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from flint import arb


class NoReferenceError(Exception):
    """There is no proven number: an input cannot be used, or does not determine the assembly, or a path takes
    too many steps. The other reasons have their own classes, because the program handles them differently.

    Args:
        what: the entry, the undetermined choice, the path or the claim.
        problem: what is wrong with it, with the value.
        allowed: what is allowed, or what to try.
        value: the value given or reached, if it is a number.
    """

    def __init__(self, what: str, problem: str, allowed: str, value: object = None) -> None:
        self.what, self.problem, self.allowed, self.value = what, problem, allowed, value
        super().__init__(f"{what} {problem}; allowed: {allowed}")

    @property
    def reason(self) -> str:
        """In words without numbers."""
        return self.what if type(self) is NoReferenceError else type(self).__name__


class InfeasibleError(NoReferenceError):
    """The assembly of the drawing cannot reach these inputs: it is proven that the path to them meets a fold.

    A branch has no pose beyond its fold. From the drawing the straight path is tried, and the paths that
    change one input after the other; from one instant of a motion to the next only the straight path.

    Attributes:
        way: name of the path.
        share: share of the path before the fold, 0 to 1.
        inputs: inputs at the fold, rad or mm, without those that move the whole car.
    """

    def __init__(self, way: str, share: float, inputs: Mapping[str, Fraction]) -> None:
        self.way, self.share, self.inputs = way, share, inputs
        there = ", ".join(f"{name} = {float(value):.9g}" for name, value in inputs.items())
        super().__init__(
            way,
            f"turns back at a fold after {share:.9g} of it (needed 1), at {there}: beyond there is no pose "
            "of this assembly",
            "inputs nearer those of the drawing",
        )


class NotDecidedError(NoReferenceError):
    """A certificate does not hold at the present number of digits; more digits may help.

    Args:
        what: the claim that could not be proven.
        value: the size that was reached.
        limit: the required size.
    """

    def __init__(self, what: str, value: object, limit: object) -> None:
        # A ball of 400 digits is unreadable in a message; six digits are enough.
        value, limit = (x.str(6) if isinstance(x, arb) else str(x) for x in (value, limit))
        super().__init__(what, f"is {value}", limit, value)


class SingularPoseError(NoReferenceError):
    """No certificate at the greatest number of digits: the pose is singular or nearly singular.

    Attributes:
        digits: the greatest number of digits tried.
        doubt: the last `NotDecidedError`.
    """

    def __init__(self, digits: int, doubt: NotDecidedError) -> None:
        self.digits, self.doubt = digits, doubt
        super().__init__(
            "the pose",
            f"has no certificate with {digits} digits ({doubt}): it, or one on the way to it, is at a dead "
            "point or a toggle",
            "inputs off that place",
        )
