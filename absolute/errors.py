"""The errors of this package: each names what, where, which value, what is allowed, and what to try."""

from collections.abc import Mapping

from absolute.solution import Solution


class AbsoluteError(Exception):
    """Base of every error raised here.

    Attributes:
        name: the point, body, joint, input or effect at fault; empty if no single one is.
        value: the value found there.
        instant: index of the first bad instant, or None if the fault is not at an instant.
        partial: the motion solved before the failing instant, or None if no instant was solved.
    """

    partial: Solution | None = None

    def __init__(
        self, message: str, name: str = "", value: object = None, instant: int | None = None
    ) -> None:
        super().__init__(message)
        self.name, self.value, self.instant = name, value, instant


class DescriptionError(AbsoluteError):
    """The description of the linkage is unusable: a name, a point, an axis or the row count is wrong."""


class InputError(AbsoluteError):
    """Inputs of a wrong name, shape or value; an unknown effect."""


class PoseError(AbsoluteError):
    """The drawn bodies do not fit together, or the mechanism reaches no pose or no unique pose.

    Attributes:
        instant: index of the instant, or None while the drawing itself is being assembled.
        inputs: the inputs asked for, by name (rad or mm).
        reached: the inputs of the last pose that could be solved on the way there.
        condition: estimate of the condition number (1-norm) at that last pose.
        limits: the joints that block each other there, the strongest first; empty where none do.
        limit: the input that meets the end of its range there, or "" where none does; equal to `name`.
    """

    def __init__(
        self,
        message: str,
        instant: int | None = None,
        inputs: Mapping[str, float] | None = None,
        reached: Mapping[str, float] | None = None,
        condition: float = float("nan"),
        limits: tuple[str, ...] = (),
        limit: str = "",
    ) -> None:
        super().__init__(message, limit, instant=instant)
        self.inputs, self.reached, self.condition = dict(inputs or {}), dict(reached or {}), condition
        self.limits, self.limit = limits, limit


# Earlier names of errors that are now one class; a missing Pinocchio raises Python's own ImportError.
AssemblyError = UnreachableError = SingularError = PoseError
MissingPinocchioError = ImportError
