"""The errors of this package. Each names what, where, the value, what is allowed, and what to try."""

from collections.abc import Mapping

from absolute.solution import Solution


class AbsoluteError(Exception):
    """Base of every error raised here.

    Attributes:
        name: the point, body, joint, input or effect at fault; "" if there is not a single one.
        value: the value found there.
        instant: index of the first bad instant, or None.
        partial: the motion before that instant, or None if no instant was solved.
    """

    partial: Solution | None = None

    def __init__(
        self, message: str, name: str = "", value: object = None, instant: int | None = None
    ) -> None:
        super().__init__(message)
        self.name, self.value, self.instant = name, value, instant


class DescriptionError(AbsoluteError):
    """The description of the mechanism is wrong: a name, a point, an axis or the number of rows."""


class InputError(AbsoluteError):
    """An input has a wrong name, shape or value, or there is no such effect."""


class PoseError(AbsoluteError):
    """The drawn bodies do not fit together, or there is no pose or no unique pose at the inputs.

    Attributes:
        instant: index of the instant, or None for the drawing.
        inputs: the requested inputs by name, rad or mm.
        reached: the inputs of the last pose that could be solved.
        condition: estimate of the condition number (1-norm) at that pose.
        limits: the joints that block each other there, the strongest first; may be empty.
        limit: the input that meets the end of its range there, or ""; equal to `name`.
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


# Earlier names. A missing Pinocchio raises Python's ImportError.
AssemblyError = UnreachableError = SingularError = PoseError
MissingPinocchioError = ImportError
