"""What can go wrong on the way to a proven number.

No function of this package returns a number that it could not prove: it raises one of these.
"""

from __future__ import annotations

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
    """The inputs ask for a pose that the links cannot reach, and that is proven.

    Attributes:
        closure: "arm" (the lower ball joint), "tie_rod" (its outer end), or what the suspension's closed form
            names (see its `branches`).
        gap: how far a link of it is too short, mm.
    """

    def __init__(self, closure: str, gap: float) -> None:
        self.closure, self.gap = closure, gap
        remedy = (
            "less rack travel or arm angle" if closure == "tie_rod" else "an arm angle nearer the design's"
        )
        super().__init__(f"the {closure} closure misses by {gap:.6g} mm (limit 0); try {remedy}")


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
            f"no certificate with {digits} digits ({reason}); the pose is at a dead point or a toggle, or the"
            " guess leads to one: move an input, or give a guess nearer the wanted assembly"
        )
