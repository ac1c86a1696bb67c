"""What can go wrong on the way to a proven number.

No function of this package returns a number that it could not prove: it raises one of these.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from flint import arb


class NoReferenceError(Exception):
    """Base of every failure of `validate.reference`."""


class BadInputError(NoReferenceError):
    """A point, input or setting cannot be used.

    Attributes:
        what: the name of the entry.
        value: what was given.
        allowed: what is allowed, in words.
    """

    def __init__(self, what: str, value: object, allowed: str) -> None:
        self.what, self.value, self.allowed = what, value, allowed
        super().__init__(f"{what} is {value!r}; allowed is {allowed}")


class InfeasibleError(NoReferenceError):
    """The assembly of the drawing does not come to these inputs: the way there meets a fold, proven.

    There is no pose beyond a fold on its branch. From the drawing the straight way is tried, and the ways
    that take one input after the other; from one instant of a motion to the next only the straight one.

    Attributes:
        way: which way it is.
        share: how much of it is left behind at the fold, 0 to 1.
        inputs: at the fold, rad or mm, without those that move the whole car.
    """

    def __init__(self, way: str, share: float, inputs: Mapping[str, Fraction]) -> None:
        self.way, self.share, self.inputs = way, share, inputs
        there = ", ".join(f"{name} = {float(value):.9g}" for name, value in inputs.items())
        super().__init__(
            f"{way} turns back at a fold after {share:.9g} of it (needed 1), at {there}: beyond there is no "
            "pose of this assembly; ask for inputs nearer those of the drawing"
        )


class AmbiguousAssemblyError(NoReferenceError):
    """Nothing says which of several assemblies is wanted.

    Attributes:
        what: the choice that is open.
        value: how clear the choice is.
        limit: how clear it must be.
    """

    def __init__(self, what: str, value: float, limit: float, remedy: str) -> None:
        self.what, self.value, self.limit = what, value, limit
        super().__init__(f"{what}: {value:.3g}, limit {limit:.3g}; {remedy}")


class NotDecidedError(NoReferenceError):
    """A certificate does not hold at the present number of digits; more digits may help.

    Attributes:
        what: the claim that could not be proven.
        value: the size that was reached.
        limit: the size that was needed.
    """

    def __init__(self, what: str, value: object, limit: object) -> None:
        # A ball of 400 digits is no message: six say where the proof stands.
        value, limit = (x.str(6) if isinstance(x, arb) else str(x) for x in (value, limit))
        self.what, self.value, self.limit = what, value, limit
        super().__init__(f"{what}: {value}, limit {limit}")


class SingularPoseError(NoReferenceError):
    """No certificate at the greatest number of digits: the pose is singular, or all but singular.

    Attributes:
        digits: the greatest number of digits tried.
        reason: the last `NotDecidedError`.
    """

    def __init__(self, digits: int, reason: NotDecidedError) -> None:
        self.digits, self.reason = digits, reason
        super().__init__(
            f"no certificate with {digits} digits ({reason}); the pose, or one on the way to it, is at a dead"
            " point or a toggle: move an input"
        )


class TooManyStepsError(NoReferenceError):
    """A way is given up: its proven steps are too short for the time that a reference may take.

    Attributes:
        way: in words. share: how much of it was done, 0 to 1. steps: that it took.
    """

    def __init__(self, way: str, share: float, steps: int) -> None:
        self.way, self.share, self.steps = way, share, steps
        super().__init__(
            f"{way} is given up after {steps} proven steps and {share:.3g} of it (needed 1): nothing is said "
            "of the pose; ask for inputs nearer those of the drawing"
        )
